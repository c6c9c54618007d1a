// What an edit costs: milliseconds per kind of edit and number of vertices, beside the bandwidth of memory measured in
// the same run, brute force on the grid and published rates. tests/bench/run builds it, runs it and prints the table.
#include <benchmark/benchmark.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <numeric>

#include "base/parallel.h"
#include "bench/bench_world.h"
#include "relight/live/gloss_triple.h"
#include "relight/live/live_scene.h"
#include "relight/live/visibility.h"
#include "transport/transport_store.h"
#include "wavelet/haar.h"
#include "wavelet/tripling.h"

namespace relamp::bench {
namespace {

using Clock = std::chrono::steady_clock;

double processorSeconds() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return double(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) +
           1e-6 * double(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec);
}
double peakGiB() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return double(usage.ru_maxrss) / 1048576;
}

/// Wall time, and processor time over the number of cores: the wall time of a machine nobody else works on.
struct Cost {
    double wallMs = 0, processorMs = 0;
};
template <class Part>
Cost costOf(Part&& part) {
    const double before = processorSeconds();
    const auto start = Clock::now();
    part();
    return {1e3 * std::chrono::duration<double>(Clock::now() - start).count(),
            1e3 * (processorSeconds() - before) / availableThreads()};
}

/// Everything measured, by name: the JSON file and the table are made of it.
std::map<std::string, double> measured;
std::vector<std::string> remarks;

std::string sizeName(size_t n) { return n >= 1000000 ? fmt::format("{}M", n / 1000000) : fmt::format("{}k", n / 1000); }

/// The scene being measured. One at a time, because a large one fills the machine.
struct Stage {
    World world;
    std::unique_ptr<LiveScene> live;
    Look look;
    Progress progress;
    size_t size = 0;
    bool glossy = false;
    double bakeSeconds = 0, bakeProcessor = 0;

    void answer() {
        live->setLook(look);
        live->refine(0, progress);
    }
    void finish() {
        while (!live->refine(0.05, progress)) {}
    }
    Eye eyeAt(float turn) const {
        const Vec3 from = world.middle + 9.0f * Vec3(std::cos(0.8f + turn), std::sin(0.8f + turn), 0.7f);
        return Eye{from, glm::normalize(world.middle - from), false};
    }
};
std::unique_ptr<Stage> held;

Stage& stage(size_t n, bool glossy, int side = 32) {
    static int heldSide = 0;
    if (held && held->size == n && held->glossy == glossy && heldSide == side) return *held;
    held.reset();
    held = std::make_unique<Stage>();
    heldSide = side;
    Stage& s = *held;
    s.size = n;
    s.glossy = glossy;
    s.world = makeWorld(n, glossy);
    LiveOptions options;
    options.gridSide = side;
    const Cost bake =
        costOf([&] { s.live = std::make_unique<LiveScene>(s.world.scene, s.world.estimate, options, s.progress); });
    s.bakeSeconds = bake.wallMs / 1e3;
    s.bakeProcessor = bake.processorMs / 1e3;
    s.live->setEye(s.eyeAt(0));
    s.look.emitters.push_back({"emitter-1", true, Mat4(1), Rgb(1)});
    s.answer();
    s.finish();
    return s;
}

/// Runs `edit(i)` once an iteration under Google Benchmark's own count, keeps the median of wall time and the mean of
/// processor time.
template <class Edit>
void timeEdits(benchmark::State& state, const std::string& name, Edit&& edit) {
    std::vector<double> wall;
    double processor = 0;
    int i = 0;
    edit(i++);  // once to warm up
    for (auto _ : state) {
        const Cost cost = costOf([&] { edit(i); });
        ++i;
        wall.push_back(cost.wallMs);
        processor += cost.processorMs;
        state.SetIterationTime(cost.wallMs / 1e3);
    }
    std::sort(wall.begin(), wall.end());
    measured[name] = wall[wall.size() / 2];
    measured[name + "_processor"] = processor / double(wall.size());
    state.counters["median_ms"] = measured[name];
    state.counters["processor_ms_a_core"] = measured[name + "_processor"];
}

void add(const std::string& name, int iterations, std::function<void(benchmark::State&)> part) {
    benchmark::RegisterBenchmark(name.c_str(), std::move(part))
        ->UseManualTime()
        ->Iterations(iterations)
        ->Unit(benchmark::kMillisecond);
}

std::vector<uint8_t> emitterVertices(const Estimate& e) {
    std::vector<uint8_t> mark(e.emitters.emitterOfVertex.size());
    for (size_t v = 0; v < mark.size(); ++v) mark[v] = e.emitters.emitterOfVertex[v] >= 0;
    return mark;
}

/// Relative root mean square difference over the chosen vertices.
double rms(const std::vector<Rgb>& a, const std::vector<Rgb>& b, const std::vector<uint32_t>& of) {
    double difference = 0, sum = 0;
    for (uint32_t v : of) {
        difference += double(glm::dot(a[v] - b[v], a[v] - b[v]));
        sum += double(glm::dot(b[v], b[v]));
    }
    return sum > 0 ? std::sqrt(difference / sum) : 0;
}
std::vector<uint32_t> litVertices(const Stage& s) {
    const std::vector<uint8_t> emitter = emitterVertices(*s.world.estimate);
    std::vector<uint32_t> out;
    for (uint32_t v = 0; v < emitter.size(); ++v)
        if (!emitter[v]) out.push_back(v);
    return out;
}

// ---- the machine

void copyRate(benchmark::State& state) {
    std::vector<char> from(size_t(256) << 20, 1), to(from.size(), 2);
    double best = 1e30;
    for (auto _ : state) {
        const Cost cost = costOf([&] {
            parallelBlocks(from.size(), size_t(1) << 20,
                           [&](size_t b, size_t e) { std::memcpy(&to[b], &from[b], e - b); });
        });
        best = std::min(best, cost.wallMs);
        state.SetIterationTime(cost.wallMs / 1e3);
    }
    measured["copy_gb_s"] = double(from.size()) / best / 1e6;
    state.counters["GB_a_second"] = measured["copy_gb_s"];
}

void rayRate(benchmark::State& state, size_t n) {
    Stage& s = stage(n, false);
    const LiveGrid grid(32);
    const Mesh& mesh = s.world.scene->mesh;
    const float offset = 4 * s.world.scene->tracer->surfaceOffset();
    double rays = 0, seconds = 0;
    for (auto _ : state) {
        size_t count = 0;
        const Cost cost = costOf([&] {
            count = parallelSum(size_t(4096), 64, size_t(0), [&](size_t begin, size_t end) {
                size_t own = 0;
                Ray packet[8];
                for (size_t i = begin; i < end; ++i) {
                    const size_t v = i * mesh.vertexCount() / 4096;
                    size_t k = 0;
                    for (uint16_t c : grid.packetOrder()) {
                        if (glm::dot(grid.centre(c), mesh.normals[v]) <= 0) continue;
                        packet[k++] = {mesh.positions[v] + offset * mesh.normals[v], grid.centre(c), 0, 1e30f};
                        if (k < 8) continue;
                        benchmark::DoNotOptimize(s.world.scene->tracer->occluded8({packet, k}));
                        own += k;
                        k = 0;
                    }
                }
                return own;
            });
        });
        rays += double(count);
        seconds += cost.processorMs / 1e3 * availableThreads();
        state.SetIterationTime(cost.wallMs / 1e3);
    }
    measured["mrays_per_core_s"] = rays / seconds / 1e6;
}

// ---- edits of a matte scene

void bake(benchmark::State& state, size_t n) {
    held.reset();
    for (auto _ : state) {
        Stage& s = stage(n, false);
        state.SetIterationTime(s.bakeSeconds);
        const std::string k = sizeName(n);
        measured["bake_s_" + k] = s.bakeSeconds;
        measured["bake_s_" + k + "_processor"] = s.bakeProcessor;
        const LiveReport report = s.live->frame()->report;
        measured["bytes_per_vertex_" + k] = double(report.bytesPerVertex);
        measured["terms_per_vertex_" + k] = report.termsPerVertex;
        measured["store_mb_" + k] = double(report.storeBytes) / 1e6;
        measured["peak_gib_" + k] = peakGiB();
    }
}

/// Baking while a file is written, and the same scene opened again.
void bakeCached(benchmark::State& state, size_t n) {
    held.reset();
    const std::string k = sizeName(n);
    const std::filesystem::path folder =
        std::filesystem::temp_directory_path() / fmt::format("relamp-bench-{}", ::getpid());
    for (auto _ : state) {
        const World world = makeWorld(n, false);
        LiveOptions options;
        options.cacheFolder = folder;
        Progress progress;
        const Cost first = costOf([&] { LiveScene live(world.scene, world.estimate, options, progress); });
        const Cost second = costOf([&] { LiveScene live(world.scene, world.estimate, options, progress); });
        measured["bake_streamed_s_" + k] = first.wallMs / 1e3;
        measured["bake_cached_s_" + k] = second.wallMs / 1e3;
        measured["bake_cached_s_" + k + "_processor"] = second.processorMs / 1e3;
        state.SetIterationTime(second.wallMs / 1e3);
    }
    std::error_code ignored;
    std::filesystem::remove_all(folder, ignored);
}

/// The whole edit, from the look to the image, and the part of it that turns light into light of vertices.
void environment(benchmark::State& state, size_t n) {
    Stage& s = stage(n, false);
    std::vector<double> sums;
    timeEdits(state, "env_edit_ms_" + sizeName(n), [&](int i) {
        s.look.environment.yawDegrees = 10.0f * float(i + 1);
        s.answer();
        sums.push_back(s.live->frame()->report.lightMs);
    });
    std::sort(sums.begin(), sums.end());
    const LiveReport report = s.live->frame()->report;
    const double limit = double(report.storeBytes) / measured["copy_gb_s"] / 1e6;
    measured["env_swap_ms_" + sizeName(n)] = sums[sums.size() / 2];
    measured["env_copy_limit_ms_" + sizeName(n)] = limit;
    // Best over best: the copy is the best of its runs too, and a busy machine disturbs single ones.
    measured["env_swap_best_ms_" + sizeName(n)] = sums.front();
    measured["env_swap_over_copy_limit_" + sizeName(n)] = sums.front() / limit;
    state.counters["light_ms"] = sums[sums.size() / 2];
    s.look.environment = {};
    s.answer();
    s.finish();
}

void exposure(benchmark::State& state, size_t n) {
    Stage& s = stage(n, false);
    timeEdits(state, "exposure_ms_" + sizeName(n), [&](int i) {
        s.look.environment.exposureStops = 0.1f * float(i + 1);
        s.answer();
    });
    s.look.environment = {};
    s.answer();
}

void power(benchmark::State& state, size_t n) {
    Stage& s = stage(n, false);
    timeEdits(state, "power_change_ms_" + sizeName(n), [&](int i) {
        s.look.emitters[0].powerScale = Rgb(1 + 0.1f * float(i));
        s.answer();
    });
    s.look.emitters[0].powerScale = Rgb(1);
    s.answer();
}

void drag(benchmark::State& state, size_t n, bool glossy, float grow) {
    Stage& s = stage(n, glossy);
    const std::string suffix = (glossy ? "glossy_" : grow > 1 ? "large_lamp_" : "") + sizeName(n);
    const Vec3 centre = s.world.estimate->emitters.emitters[0].centroid;
    timeEdits(state, "drag_first_ms_" + suffix, [&](int i) {
        Mat4 m(grow);
        m[3] = Vec4((1 - grow) * centre + Vec3(0.1f * float(i % 7), 0.05f * float(i % 5), grow > 1 ? 2 : 0), 1);
        s.look.emitters[0].matrix = m;
        s.answer();
    });
    const auto coarse = s.live->frame();
    const auto near = s.live->frame();
    // Refined until within a hundredth of what is reached in the end: the images on the way are kept.
    std::vector<std::pair<double, std::shared_ptr<const LiveFrame>>> way;
    const auto start = Clock::now();
    bool done = false;
    while (!done) {
        done = s.live->refine(0.04, s.progress);
        way.emplace_back(std::chrono::duration<double>(Clock::now() - start).count(), s.live->frame());
    }
    const std::vector<uint32_t> lit = litVertices(s);
    measured["drag_first_error_" + suffix] = rms(coarse->radiance, way.back().second->radiance, lit);
    for (const auto& [seconds, frame] : way)
        if (rms(frame->radiance, way.back().second->radiance, lit) < 0.01) {
            measured["drag_refined_s_" + suffix] = seconds;
            break;
        }
    measured["drag_finished_s_" + suffix] = way.back().first;
    s.look.emitters[0].matrix = Mat4(1);
    s.answer();
    s.finish();
}

/// Every vertex, every quarter cell it sees, cosine x radiance: what there is to do without coefficients, from the same
/// visibility.
void bruteForce(benchmark::State& state, size_t n) {
    Stage& s = stage(n, false);
    const Mesh& mesh = s.world.scene->mesh;
    const LiveGrid grid(32);
    const size_t quarters = 4 * grid.cells();
    std::vector<Vec3> direction(quarters);
    std::vector<Rgb> radiance(quarters);
    for (size_t q = 0; q < quarters; ++q) {
        direction[q] = grid.quarter(q / 4, int(q % 4));
        radiance[q] = Rgb(1, 0.5f, 0.2f) * (1 + direction[q].x);
    }
    // Real visibility of 1024 vertices stands for that of all.
    constexpr size_t patterns = 1024;
    std::vector<uint8_t> masks(grid.nibbleBytes() * patterns);
    std::vector<Vec3> normals(patterns);
    const Occluded8 occluded = [&](std::span<const Ray> rays) { return s.world.scene->tracer->occluded8(rays); };
    for (size_t i = 0; i < patterns; ++i) {
        const size_t v = mixBits(i) % mesh.vertexCount();
        normals[i] = mesh.normals[v];
        traceCells(grid, mesh.positions[v] + 4 * s.world.scene->tracer->surfaceOffset() * mesh.normals[v],
                   mesh.normals[v], false, occluded,
                   std::span(masks).subspan(i * grid.nibbleBytes(), grid.nibbleBytes()));
    }
    std::vector<Rgb> out(mesh.vertexCount());
    timeEdits(state, "env_brute_force_ms_" + sizeName(n), [&](int) {
        parallelFor(mesh.vertexCount(), 64, [&](size_t v) {
            const Vec3 normal = normals[v % patterns];
            const uint8_t* own = &masks[(v % patterns) * grid.nibbleBytes()];
            Rgb sum(0);
            for (size_t q = 0; q < quarters; ++q)
                if (nibbleOf(own, q / 4) >> (q % 4) & 1)
                    sum += std::max(0.0f, glm::dot(normal, direction[q])) * radiance[q];
            out[v] = sum * (4 / float(quarters));
        });
        benchmark::DoNotOptimize(out.data());
    });
    measured["over_brute_force_" + sizeName(n)] =
        measured["env_brute_force_ms_" + sizeName(n)] / measured["env_swap_ms_" + sizeName(n)];
}

/// The same scene on finer and coarser squares: how the cost grows with cells.
void cells(benchmark::State& state, size_t n) {
    for (auto _ : state) {
        double total = 0;
        for (int side : {16, 32, 64}) {
            Stage& s = stage(n, false, side);
            std::vector<double> sums;
            for (int i = 0; i < 9; ++i) {
                s.look.environment.yawDegrees = 10.0f * float(i + 1);
                s.answer();
                sums.push_back(s.live->frame()->report.lightMs);
            }
            std::sort(sums.begin(), sums.end());
            measured[fmt::format("env_swap_ms_{}_side{}", sizeName(n), side)] = sums[4];
            measured[fmt::format("terms_per_vertex_{}_side{}", sizeName(n), side)] =
                s.live->frame()->report.termsPerVertex;
            total += sums[4];
        }
        state.SetIterationTime(total / 1e3);
    }
    held.reset();
}

/// The error that was asked for, the bytes it takes, and the error of matte light under an environment that no test
/// knew.
void compression(benchmark::State& state, size_t n) {
    held.reset();
    const World world = makeWorld(n, false);
    Progress progress;
    const auto matteAt = [&](float error, LiveReport& report) {
        LiveOptions options;
        options.error = error;
        LiveScene live(world.scene, world.estimate, options, progress);
        Look look;
        look.environment.yawDegrees = 77;
        live.setLook(look);
        while (!live.refine(1, progress)) {}
        report = live.frame()->report;
        return live.frame()->distantMatte;
    };
    for (auto _ : state) {
        const auto start = Clock::now();
        LiveReport report;
        const std::vector<Rgb> whole = matteAt(1e-5f, report);
        std::vector<uint32_t> all(whole.size());
        std::iota(all.begin(), all.end(), 0u);
        measured["compression_full_terms"] = report.termsPerVertex;
        for (const float error : {0.05f, 0.02f, 0.01f, 0.005f}) {
            const std::vector<Rgb> kept = matteAt(error, report);
            measured[fmt::format("compression_{}_terms", error)] = report.termsPerVertex;
            measured[fmt::format("compression_{}_bytes_a_vertex", error)] = double(report.bytesPerVertex);
            measured[fmt::format("compression_{}_error", error)] = rms(kept, whole, all);
        }
        state.SetIterationTime(std::chrono::duration<double>(Clock::now() - start).count());
    }
}

// ---- glossy scenes

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

// ---- the program

void registerAll(bool large) {
    add("copy", 7, copyRate);
    std::vector<size_t> sizes{10000, 50000};
    if (large) sizes.insert(sizes.end(), {200000, 1000000});
    for (size_t n : sizes) {
        const std::string k = "/" + sizeName(n);
        if (n != 200000) add("bake cached" + k, 1, [n](benchmark::State& s) { bakeCached(s, n); });
        add("bake" + k, 1, [n](benchmark::State& s) { bake(s, n); });
        if (n == 50000) add("rays", 3, [n](benchmark::State& s) { rayRate(s, n); });
        add("environment" + k, 9, [n](benchmark::State& s) { environment(s, n); });
        add("exposure" + k, 9, [n](benchmark::State& s) { exposure(s, n); });
        add("power" + k, 9, [n](benchmark::State& s) { power(s, n); });
        add("drag" + k, 7, [n](benchmark::State& s) { drag(s, n, false, 1); });
        if (n == 50000) add("drag large light" + k, 5, [n](benchmark::State& s) { drag(s, n, false, 3); });
        add("brute force" + k, 3, [n](benchmark::State& s) { bruteForce(s, n); });
    }
    for (size_t n : sizes) {
        if (n > 200000) continue;
        const std::string k = "/" + sizeName(n);
        add("eye" + k, 7, [n](benchmark::State& s) { eye(s, n); });
        if (n == 50000) add("glossy paths" + k, 1, [n](benchmark::State& s) { glossyPaths(s, n); });
        add("drag glossy" + k, 5, [n](benchmark::State& s) { drag(s, n, true, 1); });
    }
    add("compression/10k", 1, [](benchmark::State& s) { compression(s, 10000); });
    add("cells/10k", 1, [](benchmark::State& s) { cells(s, 10000); });
}

/// One table: a row a kind of edit, a column a number of vertices; processor time over cores in brackets.
void printTable(bool large) {
    std::vector<std::string> sizes{"10k", "50k"};
    if (large) sizes.insert(sizes.end(), {"200k", "1M"});
    const auto row = [&](const std::string& what, const std::string& key, double scale = 1) {
        bool any = false;
        std::string line = fmt::format("{:<52}", what);
        for (const std::string& n : sizes) {
            const auto at = measured.find(key + n), processor = measured.find(key + n + "_processor");
            any |= at != measured.end();
            std::string cell = at == measured.end() ? "-" : fmt::format("{:.3g}", scale * at->second);
            if (processor != measured.end()) cell += fmt::format(" ({:.3g})", scale * processor->second);
            line += fmt::format("{:>20}", cell);
        }
        if (any) std::printf("%s\n", line.c_str());
    };
    std::string head = fmt::format("\n{:<52}", "vertices");
    for (const std::string& n : sizes) head += fmt::format("{:>20}", n);
    std::printf("%s\n", head.c_str());
    for (const auto& [n, vertices] :
         {std::pair("10k", 1e4), std::pair("50k", 5e4), std::pair("200k", 2e5), std::pair("1M", 1e6)})
        measured[std::string("ng04_published_ms_") + n] = 4000 * vertices / 3e5;
    row("bake, s", "bake_s_");
    row("  while its file is written, s", "bake_streamed_s_");
    row("  found in the cache, s", "bake_cached_s_");
    row("environment: light of all vertices, ms", "env_swap_ms_");
    row("  its bytes at copy bandwidth, ms", "env_copy_limit_ms_");
    row("  best run, ms", "env_swap_best_ms_");
    row("  best run over that limit", "env_swap_over_copy_limit_");
    row("  brute force on the grid, ms", "env_brute_force_ms_");
    row("  times faster", "over_brute_force_");
    row("  turned, the whole edit, ms", "env_edit_ms_");
    row("exposure, ms", "exposure_ms_");
    row("emitter power, ms", "power_change_ms_");
    row("emitter dragged, first image, ms", "drag_first_ms_");
    row("  off by, %", "drag_first_error_", 100);
    row("  within 1 % after, s", "drag_refined_s_");
    row("a light of a third of the scene dragged, ms", "drag_first_ms_large_lamp_");
    row("glossy scene, emitter dragged, ms", "drag_first_ms_glossy_");
    row("glossy scene, eye moved, ms", "glossy_view_ms_");
    row("  image off by, %", "glossy_error_", 100);
    row("  its glossy part off by, %", "glossy_part_error_", 100);
    row("  refined after, s", "glossy_refined_s_");
    row("  brute force on the environment's cells, ms", "glossy_brute_force_ms_");
    row("[Ng04] published: 3-5 s at 300k, scaled, ms", "ng04_published_ms_");
    row("stored bytes a vertex", "bytes_per_vertex_");
    row("coefficients a vertex", "terms_per_vertex_");
    row("most memory so far, GiB", "peak_gib_");
    for (const char* name : {"copy_gb_s", "mrays_per_core_s", "cores"})
        if (measured.count(name)) std::printf("%-52s%20.3g\n", name, measured[name]);
    std::printf("\n");
    for (const auto& [name, value] : measured)
        if (name.starts_with("gloss_") || name.starts_with("compression_") || name.find("_side") != std::string::npos)
            std::printf("%-44s %.4g\n", name.c_str(), value);
}

}  // namespace
}  // namespace relamp::bench

int main(int argc, char** argv) {
    using namespace relamp;
    using namespace relamp::bench;
    std::string json;
    bool large = false;
    std::vector<char*> passed{argv[0]};
    for (int i = 1; i < argc; ++i) {
        if (!std::strcmp(argv[i], "--json") && i + 1 < argc) json = argv[++i];
        else if (!std::strcmp(argv[i], "--large")) large = true;
        else passed.push_back(argv[i]);
    }
    int count = int(passed.size());
    benchmark::Initialize(&count, passed.data());
    if (benchmark::ReportUnrecognizedArguments(count, passed.data())) return 2;
    registerAll(large);
    measured["cores"] = availableThreads();
    benchmark::RunSpecifiedBenchmarks();
    held.reset();
    if (measured.count("bytes_per_vertex_50k")) measured["bytes_per_vertex"] = measured["bytes_per_vertex_50k"];
    printTable(large);
    if (!json.empty()) {
        std::ofstream out(json);
        out << nlohmann::json(measured).dump(2) << "\n";
        if (!out) return 1;
    }
    return 0;
}
