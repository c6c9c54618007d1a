// What a texture costs on photographs as large as cameras take them: texture_bench CAPTURE FACTOR VIEWS SIDE.
// The capture's photographs are enlarged FACTOR times along each axis and repeated until there are VIEWS of them; the
// vertices have the mean of what they show as albedo, under even light. Prints the texture's side, seconds, memory
// beyond the photographs, a mark of its bits, and how far its seams are apart (of the surface's mean albedo).
#include <algorithm>
#include <cstdio>
#include <cstring>

#include "base/parallel.h"
#include "base/random.h"
#include "base/stage_meter.h"
#include "bench/processor_time.h"
#include "capture/load_capture.h"
#include "radiance/gather.h"
#include "support/estimates.h"
#include "texture/fit_texture.h"
#include "texture/seams.h"

namespace {
using namespace relamp;

void enlarge(View& view, int factor) {
    const Image from = view.image;
    Camera& camera = view.camera;
    camera.width *= factor;
    camera.height *= factor;
    for (double* value : {&camera.focalX, &camera.focalY, &camera.centreX, &camera.centreY}) *value *= factor;
    view.image = Image(camera.width, camera.height);
    parallelFor(size_t(camera.height), 16, [&](size_t y) {
        for (int x = 0; x < camera.width; ++x) {
            const float u = std::clamp((float(x) + 0.5f) / float(factor) - 0.5f, 0.0f, float(from.width) - 1.001f),
                        v = std::clamp((float(y) + 0.5f) / float(factor) - 0.5f, 0.0f, float(from.height) - 1.001f);
            const int x0 = int(u), y0 = int(v);
            const float fx = u - float(x0), fy = v - float(y0);
            view.image.at(x, int(y)) = glm::mix(glm::mix(from.at(x0, y0), from.at(x0 + 1, y0), fx),
                                                glm::mix(from.at(x0, y0 + 1), from.at(x0 + 1, y0 + 1), fx), fy);
        }
    });
}

void printSeams(const Mesh& mesh, const AlbedoTexture& texture, const Rgb& mean) {
    std::vector<float> apart;
    for (const SeamPoint& p : seamPoints(mesh, texture, 7))
        if (goesOn(p, texture))
            apart.push_back(glm::length(texture.at(p.here) - texture.at(p.there)) / glm::length(mean));
    if (apart.empty()) return;
    std::sort(apart.begin(), apart.end());
    double sum = 0;
    for (const float a : apart) sum += double(a) / double(apart.size());
    std::printf("%zu places on seams: apart %.2f %% in the mean, 99 of 100 below %.2f %%, %.2f %% of them above 1 %%\n",
                apart.size(), 100 * sum, 100 * double(apart[apart.size() * 99 / 100]),
                100 * double(apart.end() - std::upper_bound(apart.begin(), apart.end(), 0.01f)) / double(apart.size()));
}

}  // namespace

int main(int argc, char** argv) try {
    if (argc != 5) return std::fprintf(stderr, "texture_bench CAPTURE FACTOR VIEWS SIDE\n"), 2;
    const int factor = std::max(1, std::atoi(argv[2]));
    const size_t views = size_t(std::max(4, std::atoi(argv[3])));
    Progress progress;
    Capture capture = loadCapture(argv[1], {}, progress);
    const Scene scene = buildScene(capture.mesh, progress);
    const RadianceSamples samples = gatherRadiance(capture, scene, {}, progress);
    Estimate estimate = test::matteEstimate(scene, Rgb(0.5f), Rgb(1));
    std::vector<Rgb>& albedo = estimate.reflectance.weight[0];
    Rgb all(0);
    for (uint32_t v = 0; v < scene.mesh.vertexCount(); ++v) {
        Rgb sum(0);
        for (uint32_t k = samples.start[v]; k < samples.start[v + 1]; ++k) sum += samples.samples[k].radiance;
        albedo[v] = samples.countOf(v) ? sum / float(samples.countOf(v)) : Rgb(0.5f);
        all += albedo[v] / float(scene.mesh.vertexCount());
    }
    estimate.surfaceLight.white = {std::vector<Rgb>(albedo.size(), Rgb(1))};
    estimate.surfaceLight.coating = {std::vector<Rgb>(albedo.size(), Rgb(0))};
    for (View& view : capture.views) enlarge(view, factor);
    for (size_t i = 0; capture.views.size() < views; ++i) capture.views.push_back(capture.views[i]);
    double pixels = 0;
    for (const View& view : capture.views) pixels += double(view.camera.width) * double(view.camera.height);

    TextureOptions options;
    options.mostSide = std::atoi(argv[4]);
    options.always = true;
    StageMeter meter(progress);
    meter.begin(Stage::texture);
    const double before = processorMs();
    const TextureFit fit = fitTexture(capture, scene, estimate, options, progress);
    const double processor = 1e-3 * (processorMs() - before) / availableThreads();
    meter.end();
    std::printf("squared error of views left out %+.0f %%, %.0f %% of the photographs' resolution\n",
                -fit.gain.percent(), 100 * double(fit.scale));
    if (!fit.texture) return std::fprintf(stderr, "no texture: %s\n", fit.why.c_str()), 1;
    uint64_t mark = 0;
    for (const Rgb& texel : fit.texture->texels)
        for (int c = 0; c < 3; ++c) {
            uint32_t bits;
            std::memcpy(&bits, &texel[c], 4);
            mark = mixBits(mark ^ bits);
        }
    std::printf(
        "%zu views, %.0f million pixels, %zu triangles: %d x %d texels in %zu charts, %.1f s wall, "
        "%.1f s processor a core, %.0f MiB, bits %016llx\n",
        capture.views.size(), pixels * 1e-6, scene.mesh.triangles.size(), fit.texture->width, fit.texture->height,
        fit.charts, meter.stages()[0].seconds, processor, meter.stages()[0].mib, static_cast<unsigned long long>(mark));
    printSeams(scene.mesh, *fit.texture, all);
} catch (const std::exception& e) { return std::fprintf(stderr, "texture_bench: %s\n", e.what()), 1; }
