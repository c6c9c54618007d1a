// A planar emitter's light at a vertex: area sampling with rays (what live relighting does) against affine double and
// triple products of visibility on the plane parallel to the emitter. planar_bench prints microseconds a vertex on one
// core and the error against 4096 rays.
#include <benchmark/benchmark.h>

#include <functional>

#include "bench/bench_world.h"
#include "relight/live/near.h"
#include "relight/live/visibility.h"
#include "wavelet/affine_products.h"

namespace relamp::bench {
namespace {

constexpr float reach = 4;  // of the plane: 76 degrees

struct Panel {
    const char* name;
    Vec3 corner, edgeU, edgeV;  // shines along cross(edgeU, edgeV)
    Vec3 normal() const { return glm::normalize(glm::cross(edgeU, edgeV)); }
};
Panel above(const char* name, float side, float height) {
    return {name, {0.3f - side / 2, -0.2f - side / 2, height}, {0, side, 0}, {side, 0, 0}};
}
const Panel panels[] = {
    above("0.5 m at 3 m", 0.5f, 3), above("2 m at 3 m", 2, 3),
    above("2 m at 6 m", 2, 6),      above("2 m at 12 m", 2, 12),
    above("4 m at 2.5 m", 4, 2.5f), {"2 m upright, things behind", {-1.2f, -1.5f, 0.5f}, {0, 2, 0}, {0, 0, 2}},
};

/// The bench's scene without its emitter, some of its vertices and what they show of one panel.
struct Stage {
    Scene scene;
    LiveOccluders occluders;
    LiveVertices vertices;
    NearEmitter emitter;
    Panel panel{};
    std::vector<uint32_t> chosen;
    std::vector<float> open, reference, sky;
    std::vector<HaarTree> seen, seenNear, seenMask, lambert;
    const HaarTree one{std::vector<float>{1}, 1};
    Vec3 axisX{0};
    int side = 0;

    const Vec3& point(size_t k) const { return scene.mesh.positions[chosen[k]]; }
    const Vec3& normal(size_t k) const { return scene.mesh.normals[chosen[k]]; }
    AffineMap map(size_t k) const {
        return *planarEmitterMap(point(k), -panel.normal(), axisX, panel.corner, panel.edgeU, panel.edgeV, reach);
    }
    Vec3 direction(const Vec2& square) const {
        const Vec3 z = -panel.normal(), y = glm::cross(z, axisX);
        return z + (2 * square.x - 1) * reach * axisX + (2 * square.y - 1) * reach * y;
    }
};

Stage& stage(const Panel& panel) {
    static std::unique_ptr<Stage> held;
    static const char* name = nullptr;
    if (name == panel.name) return *held;
    name = panel.name;
    held = std::make_unique<Stage>();
    Stage& s = *held;
    const World world = makeWorld(10000, false);
    Mesh mesh = world.scene->mesh, with = mesh;
    mesh.triangles.clear();
    for (size_t t = 0; t < with.triangles.size(); ++t)
        if (world.estimate->emitters.emitterOfVertex[with.triangles[t][0]] < 0)
            mesh.triangles.push_back(with.triangles[t]);
    s.scene = test::sceneOf(mesh);
    s.occluders.ground = std::shared_ptr<const RayTracer>(std::shared_ptr<void>(), s.scene.tracer.get());
    s.occluders.offset = s.scene.tracer->surfaceOffset();
    s.panel = panel;
    s.axisX = glm::normalize(panel.edgeU);
    Mesh sheet = test::sheet(panel.corner, panel.edgeU, panel.edgeV);
    EmitterCluster cluster;
    cluster.triangles = {0, 1};
    s.emitter.tree = LiveEmitterTree(emitterSurface(sheet, cluster), true);
    s.emitter.centre = s.emitter.tree.surface().centroid;
    s.emitter.radius = s.emitter.tree.surface().radius;
    for (uint32_t v = 0; v < s.scene.mesh.vertexCount(); v += 7) {
        const Vec3 &p = s.scene.mesh.positions[v], &n = s.scene.mesh.normals[v];
        if (!s.scene.referenced[v] || glm::dot(p - panel.corner, panel.normal()) < 1e-3f) continue;
        float exact = 0, unused = 0;
        for (const auto& c : s.emitter.tree.surface().corners) exact += triangleFormFactor(p, n, c, false);
        if (exact < 1e-4f) continue;
        const float full = nearFactor(s.emitter, s.occluders, p, n, fineCut, 4096, mixBits(v), unused);
        s.chosen.push_back(v);
        s.open.push_back(exact);
        s.reference.push_back(unused > 0 ? exact * full / unused : 0);
    }
    return s;
}

benchmark::Counter perVertex(const Stage& s, const benchmark::State& state) {
    return benchmark::Counter(double(s.chosen.size()) * double(state.iterations()) / 1e6,
                              benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

/// Relative root mean square error of a method over the stage's vertices, and microseconds a vertex on one core.
void measure(benchmark::State& state, Stage& s, const std::function<float(size_t)>& factor) {
    for (auto _ : state)
        for (size_t k = 0; k < s.chosen.size(); ++k) benchmark::DoNotOptimize(factor(k));
    double difference = 0, sum = 0;
    for (size_t k = 0; k < s.chosen.size(); ++k) {
        const double f = double(factor(k)), r = double(s.reference[k]);
        difference += (f - r) * (f - r);
        sum += r * r;
    }
    state.counters["error_%"] = 100 * std::sqrt(difference / sum);
    state.counters["us_vertex"] = perVertex(s, state);
}

/// Visibility per cell of the plane by a ray through its middle, as far as anything stands, or only up to the emitter's
/// plane.
HaarTree traced(const Stage& s, size_t k, int side, bool upToPanel) {
    const Vec3 origin = s.occluders.origin(s.point(k), s.normal(k));
    const float height = glm::dot(s.panel.corner - origin, -s.panel.normal());
    std::vector<float> cells(size_t(side * side));
    Ray rays[8];
    for (int c = 0; c < side * side; c += 8) {
        for (int i = 0; i < 8; ++i) {
            const Vec3 d = s.direction((Vec2(float((c + i) % side), float((c + i) / side)) + 0.5f) / float(side));
            const float length = glm::length(d);
            rays[i] = {origin, d / length, 0, upToPanel ? height * length * (1 - 1e-4f) : 1e30f};
        }
        const uint32_t blocked = s.occluders.groundOccluded8({rays, 8});
        for (int i = 0; i < 8; ++i) cells[size_t(c + i)] = blocked >> i & 1 ? 0.0f : 1.0f;
    }
    return HaarTree(cells, side);
}

const LiveGrid& liveGrid() {
    static const LiveGrid grid(32);
    return grid;
}
std::vector<uint8_t> masksOf(const Stage& s, size_t k) {
    std::vector<uint8_t> masks(liveGrid().nibbleBytes());
    traceCells(
        liveGrid(), s.occluders.origin(s.point(k), s.normal(k)), s.normal(k), false,
        [&](std::span<const Ray> r) { return s.occluders.groundOccluded8(r); }, masks);
    return masks;
}
/// Visibility on the plane from the baked quarter cells of the direction square.
HaarTree fromMasks(const std::vector<uint8_t>& masks, const std::vector<uint16_t>& quarterOfCell, int side) {
    std::vector<float> cells(quarterOfCell.size());
    for (size_t c = 0; c < cells.size(); ++c)
        cells[c] = nibbleOf(masks.data(), quarterOfCell[c] / 4) >> (quarterOfCell[c] % 4) & 1 ? 1.0f : 0.0f;
    return HaarTree(cells, side);
}
std::vector<uint16_t> quartersOnPlane(const Stage& s, int side) {
    std::vector<uint16_t> out(size_t(side * side));
    for (int c = 0; c < side * side; ++c)
        out[size_t(c)] = uint16_t(liveGrid().quarterAt(sphereToSquare(
            glm::normalize(s.direction((Vec2(float(c % side), float(c / side)) + 0.5f) / float(side))))));
    return out;
}
/// Cosine / (pi r^4) per cell: the reflectance of a matte vertex on the plane.
HaarTree lambertOnPlane(const Stage& s, size_t k, int side) {
    std::vector<float> cells(size_t(side * side));
    for (int c = 0; c < side * side; ++c)
        for (int q = 0; q < 4; ++q) {
            const Vec3 d = s.direction((Vec2(float(c % side), float(c / side)) +
                                        Vec2(0.25f + 0.5f * float(q % 2), 0.25f + 0.5f * float(q / 2))) /
                                       float(side));
            const float r2 = glm::dot(d, d);
            cells[size_t(c)] += std::max(0.0f, glm::dot(d, s.normal(k))) / (pi * r2 * r2) * reach * reach;
        }
    return HaarTree(cells, side);
}

void fill(Stage& s, int side) {
    if (s.side == side) return;
    s.side = side;
    s.seen.clear(), s.seenNear.clear(), s.seenMask.clear(), s.lambert.clear();
    const std::vector<uint16_t> quarters = quartersOnPlane(s, side);
    for (size_t k = 0; k < s.chosen.size(); ++k) {
        s.seen.push_back(traced(s, k, side, false));
        s.seenNear.push_back(traced(s, k, side, true));
        s.seenMask.push_back(fromMasks(masksOf(s, k), quarters, side));
        s.lambert.push_back(lambertOnPlane(s, k, side));
    }
}

float byDouble(const Stage& s, size_t k, const HaarTree& seen) {
    float open = 0;
    for (const auto& c : s.emitter.tree.surface().corners)
        open += triangleFormFactor(s.point(k), s.normal(k), c, false);
    const AffineMap map = s.map(k);
    const double covered = sharedArea(map, {0, 0}, 1);
    return covered > 0 ? open * float(affineDoubleProduct(seen, s.one, map) / covered) : 0;
}

void registerAll() {
    for (const Panel& panel : panels) {
        const auto add = [&](const std::string& name, std::function<void(benchmark::State&)> part) {
            benchmark::RegisterBenchmark((std::string(panel.name) + "/" + name).c_str(), std::move(part))
                ->Unit(benchmark::kMillisecond)
                ->MinTime(0.2);
        };
        for (const auto& [count, coarse] :
             {std::pair{4, true}, {8, true}, {16, true}, {64, true}, {16, false}, {64, false}, {256, false}})
            add(fmt::format("area sampling, {} rays{}", count, coarse ? ", coarse cut" : ""),
                [&panel, count = count, coarse = coarse](benchmark::State& state) {
                    Stage& s = stage(panel);
                    measure(state, s, [&](size_t k) {
                        float open = 0;
                        return nearFactor(s.emitter, s.occluders, s.point(k), s.normal(k), coarse ? coarseCut : fineCut,
                                          count, mixBits(s.chosen[k] + 77), open);
                    });
                });
        add("closed form, no shadow", [&panel](benchmark::State& state) {
            Stage& s = stage(panel);
            measure(state, s, [&](size_t k) {
                return triangleFormFactor(s.point(k), s.normal(k), s.emitter.tree.surface().corners[0], false) +
                       triangleFormFactor(s.point(k), s.normal(k), s.emitter.tree.surface().corners[1], false);
            });
        });
        for (int side : {16, 32, 64}) {
            const auto with = [&](const std::string& name, std::function<float(Stage&, size_t)> factor) {
                add(fmt::format("{}, side {}", name, side), [&panel, side, factor](benchmark::State& state) {
                    Stage& s = stage(panel);
                    fill(s, side);
                    measure(state, s, [&](size_t k) { return factor(s, k); });
                });
            };
            with("double, baked masks", [](Stage& s, size_t k) { return byDouble(s, k, s.seenMask[k]); });
            with("double, own rays", [](Stage& s, size_t k) { return byDouble(s, k, s.seen[k]); });
            with("double, rays end at the panel", [](Stage& s, size_t k) { return byDouble(s, k, s.seenNear[k]); });
            with("triple, baked masks", [](Stage& s, size_t k) {
                return float(affineTripleProduct(s.seenMask[k], s.lambert[k], s.one, s.map(k)));
            });
            with("triple, own rays", [](Stage& s, size_t k) {
                return float(affineTripleProduct(s.seen[k], s.lambert[k], s.one, s.map(k)));
            });
            add(fmt::format("set-up of reflectance, side {}", side), [&panel, side](benchmark::State& state) {
                Stage& s = stage(panel);
                for (auto _ : state)
                    for (size_t k = 0; k < s.chosen.size(); ++k) benchmark::DoNotOptimize(lambertOnPlane(s, k, side));
                state.counters["us_vertex"] = perVertex(s, state);
            });
            add(fmt::format("set-up from masks, side {}", side), [&panel, side](benchmark::State& state) {
                Stage& s = stage(panel);
                const std::vector<uint16_t> quarters = quartersOnPlane(s, side);
                const std::vector<uint8_t> masks = masksOf(s, 0);
                for (auto _ : state)
                    for (size_t k = 0; k < s.chosen.size(); ++k)
                        benchmark::DoNotOptimize(fromMasks(masks, quarters, side));
                state.counters["us_vertex"] = perVertex(s, state);
            });
        }
    }
}

}  // namespace
}  // namespace relamp::bench

int main(int argc, char** argv) {
    benchmark::Initialize(&argc, argv);
    if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
    relamp::bench::registerAll();
    benchmark::RunSpecifiedBenchmarks();
    return 0;
}
