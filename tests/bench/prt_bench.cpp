// What an edit costs: milliseconds per kind of edit and number of vertices, beside the bandwidth of memory measured in the same run, brute
// force on the grid and published rates. tests/bench/run builds it, runs it and prints the table.
#include <benchmark/benchmark.h>
#include <sys/resource.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>

#include "base/parallel.h"
#include "bench/bench_world.h"
#include "relight/live_scene.h"
#include "relight/live_visibility.h"
#include "transport/transport_store.h"
#include "wavelet/haar.h"
#include "wavelet/tripling.h"

namespace relamp::bench {
namespace {

using Clock = std::chrono::steady_clock;

double processorSeconds() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return double(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) + 1e-6 * double(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec);
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
template <class Body>
Cost costOf(Body&& body) {
    const double before = processorSeconds();
    const auto start = Clock::now();
    body();
    return {1e3 * std::chrono::duration<double>(Clock::now() - start).count(), 1e3 * (processorSeconds() - before) / availableThreads()};
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
    const Cost bake = costOf([&] { s.live = std::make_unique<LiveScene>(s.world.scene, s.world.estimate, options, s.progress); });
    s.bakeSeconds = bake.wallMs / 1e3;
    s.bakeProcessor = bake.processorMs / 1e3;
    s.live->setEye(s.eyeAt(0));
    s.look.emitters.push_back({"emitter-1", true, Mat4(1), Rgb(1)});
    s.answer();
    s.finish();
    return s;
}

/// Runs `edit(i)` once an iteration under Google Benchmark's own count, keeps the median of wall time and the mean of processor time.
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

void add(const std::string& name, int iterations, std::function<void(benchmark::State&)> body) {
    benchmark::RegisterBenchmark(name.c_str(), std::move(body))->UseManualTime()->Iterations(iterations)->Unit(benchmark::kMillisecond);
}

std::vector<uint8_t> lampVertices(const Estimate& e) {
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
    const std::vector<uint8_t> lamp = lampVertices(*s.world.estimate);
    std::vector<uint32_t> out;
    for (uint32_t v = 0; v < lamp.size(); ++v)
        if (!lamp[v]) out.push_back(v);
    return out;
}

// ---- the machine

void copyRate(benchmark::State& state) {
    std::vector<char> from(size_t(256) << 20, 1), to(from.size(), 2);
    double best = 1e30;
    for (auto _ : state) {
        const Cost cost = costOf([&] { parallelBlocks(from.size(), size_t(1) << 20, [&](size_t b, size_t e) { std::memcpy(&to[b], &from[b], e - b); }); });
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

/// The whole edit, from the look to the picture, and the part of it that turns light into light of vertices.
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
    measured["env_swap_over_copy_limit_" + sizeName(n)] = sums[sums.size() / 2] / limit;
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
    // Refined until within a hundredth of what is reached in the end: the pictures on the way are kept.
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

/// Every vertex, every quarter cell it sees, cosine x radiance: what there is to do without coefficients, from the same visibility.
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
    // Half of the vertices' visibility would do: one pattern a hundred vertices share reads the same bytes as one each.
    std::vector<uint8_t> masks(grid.nibbleBytes() * 1024, 0x7e);
    std::vector<Rgb> out(mesh.vertexCount());
    timeEdits(state, "env_brute_force_ms_" + sizeName(n), [&](int) {
        parallelFor(mesh.vertexCount(), 64, [&](size_t v) {
            const Vec3 normal = mesh.normals[v];
            const uint8_t* own = &masks[(v % 1024) * grid.nibbleBytes()];
            Rgb sum(0);
            for (size_t q = 0; q < quarters; ++q)
                if (nibbleOf(own, q / 4) >> (q % 4) & 1) sum += std::max(0.0f, glm::dot(normal, direction[q])) * radiance[q];
            out[v] = sum * (4 / float(quarters));
        });
        benchmark::DoNotOptimize(out.data());
    });
    measured["over_brute_force_" + sizeName(n)] = measured["env_brute_force_ms_" + sizeName(n)] / measured["env_swap_ms_" + sizeName(n)];
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
            measured[fmt::format("terms_per_vertex_{}_side{}", sizeName(n), side)] = s.live->frame()->report.termsPerVertex;
            total += sums[4];
        }
        state.SetIterationTime(total / 1e3);
    }
    held.reset();
}

// ---- glossy scenes

/// Light of the environment through the glossy lobes at one vertex, every cell of the environment behind every quarter cell traced.
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
            const int x0 = (int(c) % grid.grid().side * 2 + q % 2) * cut, y0 = (int(c) / grid.grid().side * 2 + q / 2) * cut;
            for (int y = y0; y < y0 + cut; ++y)
                for (int x = x0; x < x0 + cut; ++x) {
                    const int cell = y * fine + x;
                    const Vec3 light = toLocal * distant.grid().direction(cell);
                    if (light.z <= 0) continue;
                    Rgb reflectance(0);
                    for (size_t k = 1; k < r.weight.size(); ++k)
                        if (maxChannel(r.weight[k][v]) > 0) reflectance += r.weight[k][v] * evaluateLobe(r.basis.lobes[k], light, towardEye);
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
    // The lamp off and everything refined: what is left besides the matte light is the environment in the lobes.
    s.look.emitters[0].enabled = false;
    s.answer();
    s.finish();
    const auto off = s.live->frame();
    s.look.emitters[0].enabled = true;
    s.answer();
    s.finish();
    const Mesh& mesh = s.world.scene->mesh;
    const std::vector<uint8_t> lamp = lampVertices(*s.world.estimate);
    std::vector<uint32_t> chosen;
    for (uint32_t i = 0; chosen.size() < 500 && i < 20000; ++i) {
        const uint32_t v = uint32_t(mixBits(i) % mesh.vertexCount());
        if (!lamp[v] && glm::dot(mesh.normals[v], glm::normalize(now.position - mesh.positions[v])) > 0.02f) chosen.push_back(v);
    }
    const LiveGrid grid(32);
    std::vector<Rgb> truth(chosen.size()), reference(mesh.vertexCount()), referenceGloss(mesh.vertexCount()), firstGloss(mesh.vertexCount()), refinedGloss(mesh.vertexCount());
    const Cost full = costOf([&] { parallelFor(chosen.size(), 1, [&](size_t i) { truth[i] = fullTerms(s, *off->distant, grid, chosen[i], now); }); });
    for (size_t i = 0; i < chosen.size(); ++i) {
        const uint32_t v = chosen[i];
        const Rgb matte = s.world.estimate->reflectance.weight[0][v] * off->distantMatte[v], nearPart = refined->radiance[v] - off->radiance[v];
        reference[v] = nearPart + matte + truth[i];
        referenceGloss[v] = truth[i];
        refinedGloss[v] = off->radiance[v] - matte;
        firstGloss[v] = first->radiance[v] - nearPart - matte;
    }
    if (std::getenv("PRT_DEBUG")) {
        std::vector<std::pair<double, size_t>> worst;
        for (size_t i = 0; i < chosen.size(); ++i) worst.emplace_back(glm::length(refined->radiance[chosen[i]] - reference[chosen[i]]), i);
        std::sort(worst.rbegin(), worst.rend());
        for (int w = 0; w < 12; ++w) {
            const uint32_t v = chosen[worst[size_t(w)].second];
            std::printf("%u off %g refined gloss %g first %g true %g ref %g pos %g %g %g facing %g\n", v, worst[size_t(w)].first, refinedGloss[v].y, firstGloss[v].y, referenceGloss[v].y, reference[v].y,
                        mesh.positions[v].x, mesh.positions[v].y, mesh.positions[v].z, glm::dot(mesh.normals[v], glm::normalize(now.position - mesh.positions[v])));
        }
    }
    measured["glossy_error_" + k] = rms(first->radiance, reference, chosen);
    measured["glossy_error_refined_" + k] = rms(refined->radiance, reference, chosen);
    measured["glossy_part_error_" + k] = rms(firstGloss, referenceGloss, chosen);
    measured["glossy_part_error_refined_" + k] = rms(refinedGloss, referenceGloss, chosen);
    const double facing = double(first->report.glossyVertices);
    measured["glossy_brute_force_ms_" + k] = full.processorMs * facing / double(chosen.size());
}

// ---- the program

void registerAll(bool large) {
    add("copy", 7, copyRate);
    std::vector<size_t> sizes{10000, 50000};
    if (large) sizes.insert(sizes.end(), {200000, 1000000});
    for (size_t n : sizes) {
        const std::string k = "/" + sizeName(n);
        add("bake" + k, 1, [n](benchmark::State& s) { bake(s, n); });
        if (n == 50000) add("rays", 3, [n](benchmark::State& s) { rayRate(s, n); });
        add("environment" + k, 9, [n](benchmark::State& s) { environment(s, n); });
        add("exposure" + k, 9, [n](benchmark::State& s) { exposure(s, n); });
        add("power" + k, 9, [n](benchmark::State& s) { power(s, n); });
        add("drag" + k, 7, [n](benchmark::State& s) { drag(s, n, false, 1); });
        if (n == 50000) add("drag large lamp" + k, 5, [n](benchmark::State& s) { drag(s, n, false, 8); });
        add("brute force" + k, 3, [n](benchmark::State& s) { bruteForce(s, n); });
    }
    for (size_t n : sizes) {
        if (n > 200000) continue;
        const std::string k = "/" + sizeName(n);
        add("eye" + k, 7, [n](benchmark::State& s) { eye(s, n); });
        add("drag glossy" + k, 5, [n](benchmark::State& s) { drag(s, n, true, 1); });
    }
    add("cells/10k", 1, [](benchmark::State& s) { cells(s, 10000); });
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
    for (const auto& [name, value] : measured) std::printf("%-44s %.4g\n", name.c_str(), value);
    if (!json.empty()) {
        std::ofstream out(json);
        out << nlohmann::json(measured).dump(2) << "\n";
        if (!out) return 1;
    }
    return 0;
}
