// What the measurements of edits share: the clock, the scene being measured, and the measurements themselves.
#pragma once
#include <benchmark/benchmark.h>

#include <chrono>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "base/parallel.h"
#include "bench/bench_world.h"
#include "relight/live/live_scene.h"

namespace relamp::bench {

using Clock = std::chrono::steady_clock;

/// "50k".
std::string sizeName(size_t n);
/// Processor time of this process so far.
double processorSeconds();
/// The most memory it has held.
double peakGiB();

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
extern std::map<std::string, double> measured;

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

/// The scene of about `n` vertices, made when it is not the one that is held.
Stage& stage(size_t n, bool glossy, int side = 32);
/// Frees the scene that is held.
void dropStage();

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

/// Which vertices emit.
std::vector<uint8_t> emitterVertices(const Estimate& e);
/// Relative root mean square difference over the chosen vertices.
double rms(const std::vector<Rgb>& a, const std::vector<Rgb>& b, const std::vector<uint32_t>& of);
/// The vertices that do not emit.
std::vector<uint32_t> litVertices(const Stage& s);

// The machine (prt_stage.cpp).
void copyRate(benchmark::State& state);
void rayRate(benchmark::State& state, size_t n);
// Edits of a matte scene (prt_matte.cpp).
void bake(benchmark::State& state, size_t n);
void bakeCached(benchmark::State& state, size_t n);
void environment(benchmark::State& state, size_t n);
void exposure(benchmark::State& state, size_t n);
void power(benchmark::State& state, size_t n);
void drag(benchmark::State& state, size_t n, bool glossy, float grow);
void bruteForce(benchmark::State& state, size_t n);
void cells(benchmark::State& state, size_t n);
void compression(benchmark::State& state, size_t n);
// Glossy scenes (prt_gloss.cpp).
void eye(benchmark::State& state, size_t n);
void glossyPaths(benchmark::State& state, size_t n);

}  // namespace relamp::bench
