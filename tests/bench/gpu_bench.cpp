// What a graphics card makes of a dragged emitter: gpu_bench [--json FILE] [--sizes N,N] [--software] [--drags N].
// Headless: EGL alone. The program runs on another machine as it is, with the libraries that ldd names.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/log.h"
#include "base/parallel.h"
#include "bench/bench_world.h"
#include "relight/live/near_device.h"
#include "relight/live/shadow_device.h"
#include "viewport/gpu_devices.h"

namespace {
using namespace relamp;
using Clock = std::chrono::steady_clock;
using Json = nlohmann::ordered_json;

double msSince(Clock::time_point start) {
    return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

double median(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    return values.empty() ? 0 : std::round(1e3 * values[values.size() / 2]) / 1e3;
}

/// Tells how long the calls of a device took.
template <class Device, class Query, class Answers>
class Timed : public Device {
public:
    explicit Timed(std::shared_ptr<Device> inner) : inner_(std::move(inner)) {}
    std::vector<double> startMs, finishMs;
    std::string name() const override { return inner_->name(); }
    void start(const Query& query) override {
        const auto begin = Clock::now();
        inner_->start(query);
        startMs.push_back(msSince(begin));
    }
    void finish(Answers out) override {
        const auto begin = Clock::now();
        inner_->finish(out);
        finishMs.push_back(msSince(begin));
    }
    void forget() override { inner_->forget(); }
    void clear() override { inner_->clear(); }
    void restart() {
        startMs.clear();
        finishMs.clear();
    }

private:
    std::shared_ptr<Device> inner_;
};
using TimedNear = Timed<NearDevice, NearQuery, std::span<NearAnswer>>;
using TimedShadow = Timed<ShadowDevice, ShadowQuery, ShadowAnswers&>;

/// What a LiveScene is given, and the clocks in it.
struct Card {
    LiveDevices devices;
    std::shared_ptr<TimedNear> near;
    std::shared_ptr<TimedShadow> shadows;
    explicit Card(const LiveDevices& of)
        : near(std::make_shared<TimedNear>(of.near)), shadows(std::make_shared<TimedShadow>(of.shadows)) {
        devices.sums = of.sums;
        devices.near = near;
        devices.shadows = shadows;
    }
    void restart() {
        near->restart();
        shadows->restart();
    }
};

/// Relative root mean square difference over what does not emit.
double rms(const LiveFrame& a, const LiveFrame& b, const Estimate& estimate) {
    double difference = 0, sum = 0;
    for (size_t v = 0; v < b.radiance.size(); ++v) {
        if (v < estimate.emitters.emitterOfVertex.size() && estimate.emitters.emitterOfVertex[v] >= 0) continue;
        const Rgb d = a.radiance[v] - b.radiance[v];
        difference += double(glm::dot(d, d));
        sum += double(glm::dot(b.radiance[v], b.radiance[v]));
    }
    return sum > 0 ? std::sqrt(difference / sum) : 0;
}

Mat4 step(int i) {
    Mat4 m(1);
    m[3] = Vec4(0.1f * float(i % 7), 0.05f * float(i % 5), 0, 1);
    return m;
}

struct Dragged {
    Json figures;
    std::shared_ptr<const LiveFrame> first, refined;
};

Dragged drag(LiveScene& live, int drags, Card* card) {
    Progress progress;
    Look look;
    look.emitters.push_back({"emitter-1", true, Mat4(1), Rgb(1)});
    const auto answer = [&](int i, double& setLook) {
        look.emitters[0].matrix = step(i);
        const auto begin = Clock::now();
        live.setLook(look);
        setLook = msSince(begin);
        live.refine(0, progress);
    };
    double part = 0;
    for (int i = 0; i < 3; ++i) answer(i, part);
    if (card) card->restart();
    std::vector<double> all, look_, coarse;
    for (int i = 0; i < drags; ++i) {
        const auto begin = Clock::now();
        answer(i, part);
        all.push_back(msSince(begin));
        look_.push_back(part);
        coarse.push_back(live.frame()->report.moveMs);
    }
    Dragged out;
    out.figures["first_image_ms"] = median(all);
    out.figures["frames_a_second"] = std::round(1e3 / std::max(1e-6, median(all)));
    out.figures["of_that_set_look_ms"] = median(look_);
    out.figures["of_that_light_ms"] = median(coarse);
    if (card) {
        out.figures["near_begun_ms"] = median(card->near->startMs);
        out.figures["near_waited_and_read_ms"] = median(card->near->finishMs);
        out.figures["shadow_begun_ms"] = median(card->shadows->startMs);
        out.figures["shadow_waited_and_read_ms"] = median(card->shadows->finishMs);
        card->restart();
    }
    out.first = live.frame();
    const auto begin = Clock::now();
    while (!live.refine(0.05, progress)) {}
    out.figures["refined_ms"] = std::round(msSince(begin));
    out.refined = live.frame();
    return out;
}

Json measure(size_t vertices, const LiveDevices& devices, int drags) {
    Progress progress;
    Json out;
    const bench::World world = bench::makeWorld(vertices, false);
    out["vertices"] = world.vertices;
    out["triangles"] = world.scene->mesh.triangles.size();
    const auto building = Clock::now();
    const BoxTree tree = BoxTree::of(world.scene->mesh);
    out["box_tree_ms"] = std::round(msSince(building));
    out["box_tree_mb"] =
        std::round(1e-6 * double(tree.nodes.size() * sizeof(BoxTree::Node) + tree.triangles.size() * sizeof(Vec4)));
    const std::filesystem::path folder = std::filesystem::temp_directory_path() /
                                         fmt::format("relamp-gpu-bench-{}", Clock::now().time_since_epoch().count());
    LiveOptions options;
    options.cacheFolder = folder;
    const auto baking = Clock::now();
    LiveScene here(world.scene, world.estimate, options, progress);
    out["bake_s"] = std::round(msSince(baking)) / 1e3;
    const Dragged processor = drag(here, drags, nullptr);
    out["processor"] = processor.figures;
    out["processor"]["first_image_error"] = rms(*processor.first, *processor.refined, *world.estimate);
    if (devices.near) {
        Card clocks(devices);
        options.devices = clocks.devices;
        options.forceDevice = true;
        LiveScene there(world.scene, world.estimate, options, progress);
        const LiveReport& report = there.frame()->report;
        out["chosen"] = {{"near_processor_ms", report.cpuNearMs},     {"near_card_ms", report.deviceNearMs},
                         {"shadow_processor_ms", report.cpuShadowMs}, {"shadow_card_ms", report.deviceShadowMs},
                         {"sums_processor_ms", report.cpuApplyMs},    {"sums_card_ms", report.deviceApplyMs}};
        if (report.nearDevice.empty() || report.shadowDevice.empty()) {
            out["card"] = "the device failed, see the log";
        } else {
            const Dragged card = drag(there, drags, &clocks);
            out["card"] = card.figures;
            out["card"]["first_image_error"] = rms(*card.first, *card.refined, *world.estimate);
            out["card"]["first_image_against_processor"] = rms(*card.first, *processor.first, *world.estimate);
            out["card"]["refined_against_processor"] = rms(*card.refined, *processor.refined, *world.estimate);
            const Dragged again = drag(there, drags, &clocks);
            out["card"]["same_bits_again"] = again.first->radiance == card.first->radiance;
        }
    }
    std::error_code ignored;
    std::filesystem::remove_all(folder, ignored);
    return out;
}

}  // namespace

int main(int argc, char** argv) try {
    std::string json;
    std::vector<size_t> sizes{50000, 300000, 1000000};
    bool software = false;
    int drags = 21;
    for (int i = 1; i < argc; ++i) {
        const bool more = i + 1 < argc;
        if (!std::strcmp(argv[i], "--json") && more) json = argv[++i];
        else if (!std::strcmp(argv[i], "--software")) software = true;
        else if (!std::strcmp(argv[i], "--drags") && more) drags = std::max(1, std::atoi(argv[++i]));
        else if (!std::strcmp(argv[i], "--sizes") && more) {
            sizes.clear();
            for (const char* at = argv[++i]; at; at = std::strchr(at, ',') ? std::strchr(at, ',') + 1 : nullptr)
                sizes.push_back(std::strtoull(at, nullptr, 10));
        } else {
            std::fprintf(stderr, "gpu_bench [--json FILE] [--sizes N,N] [--software] [--drags N]\n");
            return 2;
        }
    }
    setLogSink([](LogLevel, const std::string& line) { std::fprintf(stderr, "%s\n", line.c_str()); });
    std::string why;
    const LiveDevices devices = ui::makeGpuDevices(software, &why);
    Json out;
    out["device"] = devices.near ? devices.near->name() : "none: " + why;
    out["threads"] = availableThreads();
    for (const size_t n : sizes) {
        out["scenes"].push_back(measure(n, devices, drags));
        std::printf("%s\n", out["scenes"].back().dump(2).c_str());
        std::fflush(stdout);
        if (!json.empty()) std::ofstream(json) << out.dump(2) << '\n';
    }
    std::printf("device: %s, %d threads\n", out["device"].get<std::string>().c_str(), availableThreads());
    return 0;
} catch (const std::exception& error) {
    std::fprintf(stderr, "gpu_bench: %s\n", error.what());
    return 1;
}
