// What a step of a drag costs and how far its image is off: the first image of each step against the light at rest with
// the emitter in the same place.
//
//   drag_bench SHOT|VERTICES... [--steps 8] [--glossy] [--wide]
//
// SHOT: a shot's folder; VERTICES: the made scene of that size (bench_world.h), matte unless --glossy. The first
// emitter moves by a hundredth of the scene a step. Wall time is the median, processor time of all threads the
// least of the steps: other work on the machine disturbs that the least. Error: root mean square and 99th percentile of
// the difference of display values (sRGB, exposed so that the 90th percentile of the image at rest is white), over all
// lit vertices.

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstring>

#include "bench/bench_world.h"
#include "bench/processor_time.h"
#include "relight/live/gaze.h"
#include "relight/live/live_scene.h"
#include "shot/shot_file.h"

namespace {
using namespace relamp;
using Clock = std::chrono::steady_clock;

float display(float radiance, float white) {
    const float x = std::clamp(radiance / white, 0.0f, 1.0f);
    return x < 0.0031308f ? 12.92f * x : 1.055f * std::pow(x, 1 / 2.4f) - 0.055f;
}

struct Error {
    double rms = 0, most = 0;  // most: 99th percentile
};

/// Emitters are left out: they show their own radiance.
Error errorOf(const LiveFrame& coarse, const LiveFrame& rest, const Gaze& gaze) {
    std::vector<uint8_t> counts(rest.radiance.size(), 0);
    for (size_t t = 0; t < rest.emitterOfTriangle->size(); ++t)
        for (uint32_t v : rest.mesh->triangles[t])
            counts[v] =
                (*rest.emitterOfTriangle)[t] < 0 && !gaze.misses(rest.mesh->positions[v], rest.mesh->normals[v]);
    std::vector<float> bright, off;
    for (size_t v = 0; v < counts.size(); ++v)
        if (counts[v]) bright.push_back(maxChannel(rest.radiance[v]));
    if (bright.empty()) return {};
    const auto at = [](std::vector<float>& values, double share) {
        const auto place = values.begin() + long(share * double(values.size() - 1));
        std::nth_element(values.begin(), place, values.end());
        return *place;
    };
    const float white = std::max(at(bright, 0.9), 1e-20f);
    double sum = 0;
    for (size_t v = 0; v < counts.size(); ++v) {
        if (!counts[v]) continue;
        for (int c = 0; c < 3; ++c) {
            off.push_back(std::abs(display(coarse.radiance[v][c], white) - display(rest.radiance[v][c], white)));
            sum += double(off.back()) * off.back();
        }
    }
    return {std::sqrt(sum / double(off.size())), at(off, 0.99)};
}

struct Subject {
    std::shared_ptr<const Scene> scene;
    std::shared_ptr<const Estimate> estimate;
};

Subject subjectOf(const std::string& name, bool glossy) {
    if (name.find_first_not_of("0123456789") == std::string::npos) {
        bench::World world = bench::makeWorld(std::stoul(name), glossy);
        return {world.scene, world.estimate};
    }
    Progress progress;
    const Shot shot = openShot(name, false, progress);
    return {std::make_shared<const Scene>(buildScene(shot.capture.mesh, progress)),
            std::make_shared<const Estimate>(shot.estimate)};
}

void measure(const std::string& name, int steps, bool glossy, bool wide) {
    const Subject subject = subjectOf(name, glossy);
    Progress progress;
    LiveOptions options;
    const char* cache = std::getenv("RELAMP_BENCH_CACHE");
    if (cache) options.cacheFolder = cache;
    LiveScene live(subject.scene, subject.estimate, options, progress);
    const Scene& scene = *subject.scene;
    Vec3 centre(0);
    for (const Vec3& p : scene.mesh.positions) centre += p / float(scene.mesh.vertexCount());
    const Eye eye{centre + Vec3(0.7f, -0.7f, 0.5f) * scene.diagonal, glm::normalize(-Vec3(0.7f, -0.7f, 0.5f)), false,
                  wide ? 0.0f : 0.5f};
    live.setEye(eye);
    const Gaze gaze = wide ? Gaze{} : Gaze{eye.position, eye.forward, std::cos(eye.halfAngle)};
    const auto finish = [&] {
        while (!live.refine(0.05, progress)) {}
    };
    finish();
    Look look;
    look.emitters.push_back({subject.estimate->emitters.emitters.at(0).id, true, Mat4(1), Rgb(1)});
    std::vector<double> wall;
    std::vector<std::pair<Look, std::shared_ptr<const LiveFrame>>> images;
    double processor = 1e30;
    for (int i = 0; i < steps + 1; ++i) {
        look.emitters[0].matrix[3] = Vec4(0.01f * scene.diagonal * float(i + 1), 0, 0, 1);
        const double before = processorMs();
        const auto start = Clock::now();
        live.setLook(look);
        live.refine(0, progress);
        if (i == 0) continue;  // to warm up
        wall.push_back(1e3 * std::chrono::duration<double>(Clock::now() - start).count());
        processor = std::min(processor, processorMs() - before);
        if (i == 1 || i == steps / 2 || i == steps) images.emplace_back(look, live.frame());
    }
    std::sort(wall.begin(), wall.end());
    Error error;
    double rest = 0;
    for (const auto& [at, coarse] : images) {
        const double before = processorMs();
        live.setLook(at);
        finish();
        rest = (processorMs() - before) / 1e3;
        const Error own = errorOf(*coarse, *live.frame(), gaze);
        error.rms = std::max(error.rms, own.rms);
        error.most = std::max(error.most, own.most);
    }
    std::printf(
        "%-22s%8zu vertices, %2.0f %% between others: step %7.1f ms wall, %7.1f ms processor; off by %.4f rms, "
        "%.4f 99 %%; rest %.2f s processor\n",
        name.c_str(), scene.mesh.vertexCount(),
        100 * double(images.back().second->report.lightBetween) / double(scene.mesh.vertexCount()),
        wall[wall.size() / 2], processor, error.rms, error.most, rest);
    std::fflush(stdout);
}
}  // namespace

int main(int argc, char** argv) {
    int steps = 8;
    bool glossy = false, wide = false;
    std::vector<std::string> names;
    for (int i = 1; i < argc; ++i) {
        if (!std::strcmp(argv[i], "--steps") && i + 1 < argc) steps = std::max(1, std::atoi(argv[++i]));
        else if (!std::strcmp(argv[i], "--glossy")) glossy = true;
        else if (!std::strcmp(argv[i], "--wide")) wide = true;
        else names.push_back(argv[i]);
    }
    if (names.empty()) return 2;
    for (const std::string& name : names) measure(name, steps, glossy, wide);
    return 0;
}
