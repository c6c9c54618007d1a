#include "bench/prt_stage.h"

#include <sys/resource.h>

#include <cstring>

#include "relight/live/visibility.h"

namespace relamp::bench {

std::map<std::string, double> measured;

namespace {
std::unique_ptr<Stage> held;
}

std::string sizeName(size_t n) { return n >= 1000000 ? fmt::format("{}M", n / 1000000) : fmt::format("{}k", n / 1000); }

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

Stage& stage(size_t n, bool glossy, int side) {
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

std::vector<uint8_t> emitterVertices(const Estimate& e) {
    std::vector<uint8_t> mark(e.emitters.emitterOfVertex.size());
    for (size_t v = 0; v < mark.size(); ++v) mark[v] = e.emitters.emitterOfVertex[v] >= 0;
    return mark;
}

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

void dropStage() { held.reset(); }

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

}  // namespace relamp::bench
