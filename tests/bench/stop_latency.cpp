// How long after a request to stop each long function returns: stop_latency CAPTURE [QUALITY [MOMENTS]]. The work runs
// once undisturbed, which tells when each of its stages begins; then anew for every moment, one in the middle of each
// stage and MOMENTS spread over the whole. Wall time, so a busy machine makes it longer.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include "image/image_io.h"
#include "pipeline/pipeline.h"
#include "relight/live/live_scene.h"
#include "relight/look.h"
#include "relight/relit_scene.h"
#include "shot/export_frame.h"

namespace {
using namespace relamp;
using Clock = std::chrono::steady_clock;

double secondsSince(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

struct Stage {
    std::string label;
    double begin = 0, end = 0;
};

std::vector<Stage> stagesOf(const std::function<void(Progress&)>& work) {
    std::vector<Stage> stages;
    std::mutex mutex;
    Progress progress;
    const auto start = Clock::now();
    progress.setListener([&](const std::string& label, double) {
        std::lock_guard lock(mutex);
        const double now = secondsSince(start);
        if (!stages.empty() && stages.back().label == label) return;
        if (!stages.empty()) stages.back().end = now;
        stages.push_back({label, now, now});
    });
    work(progress);
    if (!stages.empty()) stages.back().end = secondsSince(start);
    return stages;
}

struct Latency {
    std::string stage;
    double ms = 0;
};

/// Nothing when the work had ended before.
std::unique_ptr<Latency> latencyAt(const std::function<void(Progress&)>& work, double moment) {
    Progress progress;
    Latency found;
    Clock::time_point asked{};
    std::mutex mutex;
    std::condition_variable ended;
    bool done = false;
    std::thread watcher([&] {
        std::unique_lock lock(mutex);
        if (ended.wait_for(lock, std::chrono::duration<double>(moment), [&] { return done; })) return;
        found.stage = progress.label();
        asked = Clock::now();
        progress.requestStop();
    });
    try {
        work(progress);
    } catch (const Cancelled&) {}
    const auto returned = Clock::now();
    {
        std::lock_guard lock(mutex);
        done = true;
    }
    ended.notify_all();
    watcher.join();
    if (!progress.stopRequested()) return nullptr;
    found.ms = 1e3 * std::chrono::duration<double>(returned - asked).count();
    return std::make_unique<Latency>(found);
}

void measure(const char* name, const std::function<void(Progress&)>& work, int spread) {
    const std::vector<Stage> stages = stagesOf(work);
    std::vector<double> moments;
    for (const Stage& stage : stages)
        if (stage.end - stage.begin > 2e-3) moments.push_back(0.5 * (stage.begin + stage.end));
    const double whole = stages.empty() ? 0 : stages.back().end;
    for (int i = 0; i < spread; ++i) moments.push_back(whole * (i + 0.5) / spread);
    std::map<std::string, std::vector<double>> found;
    std::vector<double> all;
    for (const double moment : moments)
        if (const auto latency = latencyAt(work, moment)) {
            found[latency->stage].push_back(latency->ms);
            all.push_back(latency->ms);
        }
    if (all.empty()) return;
    std::sort(all.begin(), all.end());
    std::printf("%s: %.1f s, stopped %zu times: median %.0f ms, worst %.0f ms\n", name, whole, all.size(),
                all[all.size() / 2], all.back());
    for (auto& [stage, ms] : found)
        std::printf("  %-44s %3zu times, worst %5.0f ms\n", stage.c_str(), ms.size(),
                    *std::max_element(ms.begin(), ms.end()));
    std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
    if (argc < 2) {
        std::fputs("stop_latency CAPTURE [QUALITY [MOMENTS]]\n", stderr);
        return 2;
    }
    try {
        PipelineOptions options;
        options.solve = solveOptionsFor(argc > 2 ? argv[2] : "standard");
        const int moments = argc > 3 ? std::atoi(argv[3]) : 40;
        const std::filesystem::path capture = argv[1];
        // Somebody listens, so that a solve has a best answer to keep, as in the window.
        SolveListener listener;
        listener.snapshot = [](Estimate) {};
        Progress progress;
        const PipelineResult solved = runPipeline(capture, options, progress, &listener);
        const auto scene = solved.scene;
        const auto estimate = std::make_shared<const Estimate>(solved.estimate);
        const std::filesystem::path folder =
            std::filesystem::temp_directory_path() /
            ("relamp-stop-latency-" + std::to_string(Clock::now().time_since_epoch().count()));
        std::filesystem::create_directories(folder);
        measure(
            "bake",
            [&](Progress& p) {
                LiveScene live(scene, estimate, {}, p);
                live.setLook({});
                while (!live.refine(0.04, p)) {}
            },
            moments);
        measure(
            "export, 1500 x 1000, all layers",
            [&](Progress& p) {
                const RelitScene relit = applyLook(*scene, *estimate, {}, p);
                Camera camera = solved.capture.views.at(0).camera;
                const double factor = 1500.0 / camera.width;
                camera.width = 1500;
                camera.height = 1000;
                camera.focalX *= factor;
                camera.focalY *= factor;
                camera.centreX = 750;
                camera.centreY = 500;
                FrameSources sources;
                sources.look = sources.captured = &relit;
                FrameOptions frame;
                FrameFileOptions file;
                file.layers = "groups,albedo,correction,normal,position,depth,cryptomatte";
                writeFrameFile(folder / "frame.exr", camera, sources, frame, file, p);
            },
            moments);
        Image large(6000, 4000);
        for (size_t i = 0; i < large.pixels.size(); ++i)
            large.pixels[i] = Rgb(float(i * 2654435761u >> 8 & 255) / 512 + float(i % 6000) / 12000);
        for (const std::string ending : {".exr", ".png", ".jpg"}) {
            const auto file = folder / ("large" + ending);
            writeImage(file, large);
            measure(("reading 6000 x 4000 pixels, " + ending).c_str(),
                    [&](Progress& p) {
                        p.begin("Reading", 1);
                        readImage(file, nullptr, false, size_t(1) << 28, [&] { p.check(); });
                    },
                    moments);
        }
        std::filesystem::remove_all(folder);
        measure(
            "solve, reading included", [&](Progress& p) { runPipeline(capture, options, p, &listener); }, moments);
        return 0;
    } catch (const std::exception& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return 1;
    }
}
