// Figures of live relighting on a solved shot: live_bench SHOT.relamp [IMAGE.exr]. Medians of several runs; copy
// bandwidth beside them, because the machine is shared and only ratios mean something. IMAGE: view 0 as the first
// image of a drag shows it that ends where the emitter stood; IMAGE-refined.exr: the same at rest.

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <functional>

#include "base/parallel.h"
#include "bench/processor_time.h"
#include "edit/light_brush.h"
#include "image/image_io.h"
#include "relight/live/live_scene.h"
#include "shot/shot_file.h"

namespace {
using namespace relamp;
using Clock = std::chrono::steady_clock;

/// Processor time of this process over the number of cores: what the wall clock would say if nobody else worked here
/// and no core idled.
double coreMs() { return processorMs() / availableThreads(); }

struct Cost {
    double wall = 0, processor = 0;
    bool operator<(const Cost& other) const { return wall < other.wall; }
};

Cost costOf(const std::function<void()>& part) {
    const auto start = Clock::now();
    const double before = coreMs();
    part();
    return {1e3 * std::chrono::duration<double>(Clock::now() - start).count(), coreMs() - before};
}
double msOf(const std::function<void()>& part) { return costOf(part).wall; }

Cost medianCost(int runs, const std::function<void(int)>& part) {
    std::vector<Cost> costs;
    double processor = 0;
    for (int i = 0; i < runs; ++i) {
        costs.push_back(costOf([&] { part(i); }));
        processor += costs.back().processor / runs;
    }
    std::sort(costs.begin(), costs.end());
    return {costs[costs.size() / 2].wall, processor};
}
double medianMs(int runs, const std::function<void(int)>& part) { return medianCost(runs, part).wall; }

void print(const char* what, const Cost& cost, const std::string& remark = "") {
    std::printf("%-26s%9.2f ms wall, %9.2f ms processor a core  %s\n", what, cost.wall, cost.processor, remark.c_str());
}

/// Bytes read a second when memory is copied by all cores.
double copyBandwidth() {
    std::vector<char> from(size_t(256) << 20, 1), to(from.size());
    const double ms = medianMs(5, [&](int) {
        parallelBlocks(from.size(), size_t(1) << 20, [&](size_t b, size_t e) { std::memcpy(&to[b], &from[b], e - b); });
    });
    return double(from.size()) / (ms / 1e3);
}

/// Relative root mean square difference of two images, emitters left out.
double rms(const LiveFrame& one, const LiveFrame& two) {
    const auto &a = one.radiance, &b = two.radiance;
    std::vector<uint8_t> shines(b.size(), 0);
    for (size_t t = 0; t < two.emitterOfTriangle->size(); ++t)
        if ((*two.emitterOfTriangle)[t] >= 0)
            for (uint32_t v : two.mesh->triangles[t]) shines[v] = 1;
    double difference = 0, sum = 0;
    for (size_t v = 0; v < std::min(a.size(), b.size()); ++v) {
        if (shines[v]) continue;
        difference += double(glm::dot(a[v] - b[v], a[v] - b[v]));
        sum += double(glm::dot(b[v], b[v]));
    }
    return sum > 0 ? std::sqrt(difference / sum) : 0;
}
/// The image at half its camera's size, 4 x 4 rays a pixel, black where nothing is.
void writeImage(const std::string& file, const LiveFrame& frame, const Camera& camera) {
    const Mesh& mesh = *frame.mesh;
    const RayTracer tracer(mesh);
    Image image(camera.width / 2, camera.height / 2);
    parallelFor(image.pixels.size(), 64, [&](size_t i) {
        Rgb sum(0);
        for (int k = 0; k < 16; ++k) {
            const Vec2 pixel(float(i % size_t(image.width)) + (float(k % 4) + 0.5f) / 4,
                             float(i / size_t(image.width)) + (float(k / 4) + 0.5f) / 4);
            const Hit hit = tracer.closest({Vec3(camera.position()), camera.rayDirection(2.0f * pixel), 0, 1e30f});
            if (!hit) continue;
            const Triangle& t = mesh.triangles[hit.triangle];
            sum += (1 - hit.barycentric.x - hit.barycentric.y) * frame.radiance[t[0]] +
                   hit.barycentric.x * frame.radiance[t[1]] + hit.barycentric.y * frame.radiance[t[2]];
        }
        image.pixels[i] = sum / 16.0f;
    });
    writeImage(file, image);
}
}  // namespace

int main(int argc, char** argv) {
    if (argc < 2) return 2;
    Progress progress;
    const Shot shot = openShot(argv[1], false, progress);
    auto scene = std::make_shared<const Scene>(buildScene(shot.capture.mesh, progress));
    auto estimate = std::make_shared<const Estimate>(shot.estimate);
    std::unique_ptr<LiveScene> live;
    const Cost bake = costOf([&] { live = std::make_unique<LiveScene>(scene, estimate, LiveOptions{}, progress); });
    const size_t n = scene->mesh.vertexCount();
    const auto finish = [&] {
        while (!live->refine(0.03, progress)) {}
    };
    Look look;
    const auto answer = [&] {
        live->setLook(look);
        live->refine(0, progress);
    };
    Vec3 centre(0);
    for (const Vec3& p : scene->mesh.positions) centre += p / float(n);
    const auto eyeAt = [&](float turn) {
        return Eye{centre + Vec3(0.7f, -0.7f + turn, 0.5f) * scene->diagonal, Vec3(0, 1, 0), false};
    };
    live->setEye(eyeAt(0));
    const Cost rest = costOf(finish);
    const LiveReport report = live->frame()->report;
    const double bandwidth = copyBandwidth();
    std::printf("%s: %zu vertices, %zu triangles, %zu emitters, %d threads\n", argv[1], n, scene->mesh.triangles.size(),
                estimate->emitters.emitters.size(), availableThreads());
    std::printf(
        "copy bandwidth %.1f GB/s; stored %zu bytes a vertex, %.0f terms, coefficients %.1f MB: %.2f ms at copy "
        "bandwidth\n",
        bandwidth / 1e9, report.bytesPerVertex, report.termsPerVertex, double(report.storeBytes) / 1e6,
        1e3 * double(report.storeBytes) / bandwidth);
    print("bake", bake);
    print("first refinement", rest);
    double light = 0;
    const Cost yaw = medianCost(9, [&](int i) {
        look.environment.yawDegrees = 10.0f * float(i + 1);
        answer();
        light += live->frame()->report.lightMs / 9;
    });
    print("environment turned", yaw, fmt::format("of that matte surfaces {:.2f} ms", light));
    print("refined", costOf(finish));
    print("exposure", medianCost(9, [&](int i) {
              look.environment.exposureStops = 0.25f * float(i);
              answer();
          }));
    look = {};
    answer();
    finish();
    if (!estimate->emitters.emitters.empty()) {
        look.emitters.push_back({estimate->emitters.emitters[0].id, true, Mat4(1), Rgb(1)});
        print("power", medianCost(9, [&](int i) {
                  look.emitters[0].powerScale = Rgb(1 + 0.1f * float(i));
                  answer();
              }));
        const auto shown = live->frame();
        std::vector<PaintedVertex> painted;
        for (uint32_t v = 0; v < n / 50; ++v) painted.push_back({v, 1});
        PaintedLights all{{}, true};
        for (size_t e = 0; e < shown->formFactor.size(); ++e) all.emitters.push_back(e);
        print("stroke of light",
              medianCost(9, [&](int) { reachGoal(brushedGoal(*shown, *estimate, look, painted, {}, all), {false}); }));
        double setLook = 0;
        const Cost drag = medianCost(9, [&](int i) {
            look.emitters[0].matrix[3] = Vec4(0.01f * scene->diagonal * float(i + 1), 0, 0, 1);
            setLook += msOf([&] { live->setLook(look); }) / 9;
            live->refine(0, progress);
        });
        print("drag, first image", drag, fmt::format("of that setLook {:.2f}", setLook));
        const auto coarse = live->frame();
        const Cost refined = costOf(finish);
        print("refined at rest", refined,
              fmt::format("coarse was off by {:.1f} %", 100 * rms(*coarse, *live->frame())));
        if (argc > 2) {
            const std::string file = argv[2];
            look.emitters[0].powerScale = Rgb(1);
            look.emitters[0].matrix = Mat4(1);
            answer();
            writeImage(file, *live->frame(), shot.capture.views[0].camera);
            finish();
            writeImage(file.substr(0, file.rfind('.')) + "-refined.exr", *live->frame(), shot.capture.views[0].camera);
        }
        look.emitters[0].enabled = false;
        print("switched off", costOf(answer));
        look.emitters[0].enabled = true;
        // The smallest component of some size stands for an emitter's shade or stand.
        std::vector<size_t> size(scene->components, 0);
        for (uint32_t p : scene->component) ++size[p];
        uint32_t seed = 0;
        for (uint32_t v = 0; v < n; ++v)
            if (scene->referenced[v] && estimate->emitters.emitterOfVertex[v] < 0 && size[scene->component[v]] > 100 &&
                size[scene->component[v]] < size[scene->component[seed]])
                seed = v;
        look.parts.push_back({seed, Mat4(1), ""});
        print("part taken up", costOf(answer), fmt::format("{} vertices", size[scene->component[seed]]));
        print("part, first image", medianCost(5, [&](int i) {
                  look.parts[0].matrix[3] = Vec4(0, 0, 0.01f * scene->diagonal * float(i + 1), 1);
                  answer();
              }));
        print("refined at rest", costOf(finish));
    }
    const Cost eye = medianCost(7, [&](int i) {
        live->setEye(eyeAt(0.05f * float(i)));
        live->refine(0, progress);
    });
    const auto coarse = live->frame();
    const Cost refined = costOf(finish);
    print("eye", eye,
          fmt::format("{} glossy vertices, off by {:.1f} %", live->frame()->report.glossyVertices,
                      100 * rms(*coarse, *live->frame())));
    print("refined at rest", refined);
    return 0;
}
