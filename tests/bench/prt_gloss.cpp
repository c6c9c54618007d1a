// Glossy scenes: the eye moved, and the ways to light one glossy vertex.
#include <numeric>

#include "bench/prt_stage.h"
#include "relight/live/gloss_triple.h"
#include "relight/live/visibility.h"
#include "transport/transport_store.h"
#include "wavelet/haar.h"
#include "wavelet/tripling.h"

namespace relamp::bench {
namespace {

/// Light of the environment through the glossy lobes at one vertex, every cell of the environment behind every quarter
/// cell traced.
Rgb fullTerms(const Stage& s, const DistantLight& distant, const LiveGrid& grid, uint32_t v, const Eye& eye) {
    const Mesh& mesh = s.world.scene->mesh;
    const Reflectance& r = s.world.estimate->reflectance;
    const Vec3 normal = mesh.normals[v];
    const Mat3 toLocal = glm::transpose(frameAround(normal));
    const Vec3 towardEye = toLocal * glm::normalize(eye.position - mesh.positions[v]);
    const Vec3 origin = mesh.positions[v] + 4 * s.world.scene->tracer->surfaceOffset() * normal;
    const int fine = distant.grid().side, cut = fine / (2 * grid.grid().side);
    Rgb sum(0);
    for (uint16_t c : grid.packetOrder())
        for (int q = 0; q < 4; ++q) {
            const Vec3 d = grid.quarter(c, q);
            if (glm::dot(d, normal) <= 0 || s.world.scene->tracer->occluded({origin, d, 0, 1e30f})) continue;
            const int x0 = (int(c) % grid.grid().side * 2 + q % 2) * cut,
                      y0 = (int(c) / grid.grid().side * 2 + q / 2) * cut;
            for (int y = y0; y < y0 + cut; ++y)
                for (int x = x0; x < x0 + cut; ++x) {
                    const int cell = y * fine + x;
                    const Vec3 light = toLocal * distant.grid().direction(cell);
                    if (light.z <= 0) continue;
                    Rgb reflectance(0);
                    for (size_t k = 1; k < r.weight.size(); ++k)
                        if (maxChannel(r.weight[k][v]) > 0)
                            reflectance += r.weight[k][v] * evaluateLobe(r.basis.lobes[k], light, towardEye);
                    sum += reflectance * light.z * distant.cells()[size_t(cell)];
                }
        }
    return sum * distant.grid().cellSolidAngle();
}

}  // namespace

void eye(benchmark::State& state, size_t n) {
    Stage& s = stage(n, true);
    const std::string k = sizeName(n);
    int last = 0;
    timeEdits(state, "glossy_view_ms_" + k, [&](int i) {
        last = i;
        s.live->setEye(s.eyeAt(0.11f * float(i + 1)));
        s.live->refine(0, s.progress);
    });
    const Eye now = s.eyeAt(0.11f * float(last + 1));
    const auto first = s.live->frame();
    const Cost rest = costOf([&] { s.finish(); });
    const auto refined = s.live->frame();
    measured["glossy_refined_s_" + k] = rest.wallMs / 1e3;
    measured["glossy_vertices_" + k] = double(first->report.glossyVertices);
    // The emitter off and everything refined: what is left besides the matte light is the environment in the lobes.
    s.look.emitters[0].enabled = false;
    s.answer();
    s.finish();
    const auto off = s.live->frame();
    s.look.emitters[0].enabled = true;
    s.answer();
    s.finish();
    const Mesh& mesh = s.world.scene->mesh;
    const std::vector<uint8_t> emitter = emitterVertices(*s.world.estimate);
    std::vector<uint32_t> chosen;
    for (uint32_t i = 0; chosen.size() < 500 && i < 20000; ++i) {
        const uint32_t v = uint32_t(mixBits(i) % mesh.vertexCount());
        if (!emitter[v] && glm::dot(mesh.normals[v], glm::normalize(now.position - mesh.positions[v])) > 0.02f)
            chosen.push_back(v);
    }
    const LiveGrid grid(32);
    std::vector<Rgb> truth(chosen.size()), reference(mesh.vertexCount()), referenceGloss(mesh.vertexCount()),
        firstGloss(mesh.vertexCount()), refinedGloss(mesh.vertexCount());
    const Cost full = costOf([&] {
        parallelFor(chosen.size(), 1, [&](size_t i) { truth[i] = fullTerms(s, *off->distant, grid, chosen[i], now); });
    });
    for (size_t i = 0; i < chosen.size(); ++i) {
        const uint32_t v = chosen[i];
        const Rgb matte = s.world.estimate->reflectance.weight[0][v] * off->distantMatte[v],
                  nearPart = refined->radiance[v] - off->radiance[v];
        reference[v] = nearPart + matte + truth[i];
        referenceGloss[v] = truth[i];
        refinedGloss[v] = off->radiance[v] - matte;
        firstGloss[v] = first->radiance[v] - nearPart - matte;
    }
    measured["glossy_error_" + k] = rms(first->radiance, reference, chosen);
    measured["glossy_error_refined_" + k] = rms(refined->radiance, reference, chosen);
    measured["glossy_part_error_" + k] = rms(firstGloss, referenceGloss, chosen);
    measured["glossy_part_error_refined_" + k] = rms(refinedGloss, referenceGloss, chosen);
    const double facing = double(first->report.glossyVertices);
    measured["glossy_brute_force_ms_" + k] = full.processorMs * facing / double(chosen.size());
}

/// Glossy light of single vertices on one core: taps as the viewport takes them, triple products of the largest
/// coefficients, the sum over the grid.
void glossyPaths(benchmark::State& state, size_t n) {
    Stage& s = stage(n, true);
    const Mesh& mesh = s.world.scene->mesh;
    const Reflectance& r = s.world.estimate->reflectance;
    const std::vector<uint8_t> emitter = emitterVertices(*s.world.estimate);
    const Eye from = s.eyeAt(0);
    const LiveGrid grid(32);
    const DistantLight& distant = *s.live->frame()->distant;
    struct Point {
        Mat3 frame;
        Vec3 eye;
        std::vector<uint8_t> masks;
        std::vector<LobeWeight> lobes;
    };
    std::vector<Point> points;
    for (uint32_t i = 0; points.size() < 300 && i < 20000; ++i) {
        const uint32_t v = uint32_t(mixBits(i) % mesh.vertexCount());
        const Vec3 to = glm::normalize(from.position - mesh.positions[v]);
        if (emitter[v] || glm::dot(mesh.normals[v], to) < 0.02f) continue;
        Point p{frameAround(mesh.normals[v]), Vec3(0), std::vector<uint8_t>(grid.nibbleBytes()), {}};
        p.eye = glm::transpose(p.frame) * to;
        const Occluded8 occluded = [&](std::span<const Ray> rays) { return s.world.scene->tracer->occluded8(rays); };
        traceCells(grid, mesh.positions[v] + 4 * s.world.scene->tracer->surfaceOffset() * mesh.normals[v],
                   mesh.normals[v], false, occluded, p.masks);
        for (size_t k = 1; k < r.weight.size(); ++k)
            if (maxChannel(r.weight[k][v]) > 0) p.lobes.push_back({uint8_t(k), r.weight[k][v]});
        points.push_back(std::move(p));
    }
    const auto perVertex = [&](auto&& part) {
        const ThreadLimit one(1);
        const double before = processorSeconds();
        for (size_t i = 0; i < points.size(); ++i) part(i);
        return 1e6 * (processorSeconds() - before) / double(points.size());
    };
    std::vector<Rgb> truth(points.size()), got(points.size());
    const auto error = [&] {
        double difference = 0, sum = 0;
        for (size_t i = 0; i < points.size(); ++i) {
            difference += double(glm::dot(got[i] - truth[i], got[i] - truth[i]));
            sum += double(glm::dot(truth[i], truth[i]));
        }
        return std::sqrt(difference / sum);
    };
    for (auto _ : state) {
        const EnvironmentPyramid pyramid(distant);
        // Every cell of the environment behind the same masks is what all of them stand for.
        for (size_t i = 0; i < points.size(); ++i) {
            const Point& p = points[i];
            truth[i] = Rgb(0);
            for (int c = 0; c < distant.grid().cells(); ++c) {
                const Vec3 light = glm::transpose(p.frame) * distant.grid().direction(c);
                const size_t q =
                    grid.quarterAt((Vec2(float(c % distant.grid().side), float(c / distant.grid().side)) + Vec2(0.5f)) /
                                   float(distant.grid().side));
                if (light.z <= 0 || !(nibbleOf(p.masks.data(), q / 4) >> (q % 4) & 1)) continue;
                for (const LobeWeight& l : p.lobes)
                    truth[i] += l.weight * evaluateLobe(r.basis.lobes[l.lobe], light, p.eye) * light.z *
                                distant.cells()[size_t(c)] * distant.grid().cellSolidAngle();
            }
        }
        for (int taps : {16, 32, 64, 128, 256}) {
            const TapPattern pattern(taps);
            measured[fmt::format("gloss_taps{}_us", taps)] = perVertex([&](size_t i) {
                got[i] = tapEnvironment(pyramid, r.basis, points[i].lobes, pattern, points[i].frame, points[i].eye,
                                        grid, points[i].masks.data());
            });
            measured[fmt::format("gloss_taps{}_error", taps)] = error();
        }
        for (size_t terms : {32, 64, 128, 256, 0}) {
            const TripleGloss triple(grid, distant, {4 * terms, 2 * terms, terms});
            const std::string name = terms ? fmt::format("gloss_triple{}", terms) : "gloss_triple_full";
            std::vector<SparseCoefs> seen(points.size());
            std::vector<std::vector<SparseCoefs>> shape(points.size());
            for (size_t i = 0; i < points.size(); ++i) seen[i] = triple.visibility(points[i].masks.data());
            measured["gloss_reflectance_coefs_us"] = perVertex([&](size_t i) {
                for (const LobeWeight& l : points[i].lobes)
                    shape[i].push_back(triple.reflectance(r.basis.lobes[l.lobe], points[i].frame, points[i].eye));
            });
            measured[name + "_us"] = perVertex([&](size_t i) {
                got[i] = Rgb(0);
                for (size_t l = 0; l < points[i].lobes.size(); ++l)
                    got[i] += points[i].lobes[l].weight * triple.light(seen[i], shape[i][l]);
            });
            measured[name + "_error"] = error();
        }
        const TripleGloss whole(grid, distant, {});
        measured["gloss_on_grid_us"] = perVertex([&](size_t i) {
            got[i] = whole.onGrid(r.basis, points[i].lobes, points[i].frame, points[i].eye, points[i].masks.data());
        });
        measured["gloss_on_grid_error"] = error();
        state.SetIterationTime(1e-6 * measured["gloss_taps64_us"]);
    }
}

}  // namespace relamp::bench
