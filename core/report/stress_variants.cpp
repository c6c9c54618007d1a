#include "report/stress_variants.h"

#include <limits>
#include <numeric>

#include "base/box.h"
#include "base/random.h"
#include "base/statistics.h"
#include "display/display_image.h"
#include "scene/mesh_io.h"

namespace relamp {
namespace {

/// Standard normal value from a counter.
float normalOf(uint64_t bits) {
    const float u = std::max(unitFloat(mixBits(bits)), 1e-7f), v = unitFloat(mixBits(bits ^ 0x5bd1e995ull));
    return std::sqrt(-2 * std::log(u)) * std::cos(2 * pi * v);
}

}  // namespace

Capture withSmallImages(Capture capture, int longestSide) {
    for (View& view : capture.views) {
        view.camera = smallerCamera(view.camera, longestSide);
        view.image = shrunk(view.image, view.camera.width, view.camera.height);
    }
    return capture;
}

Capture withRadianceTimes(Capture capture, const Rgb& factor) {
    for (View& view : capture.views) {
        for (Rgb& pixel : view.image.pixels) pixel *= factor;
        view.saturation *= maxChannel(factor);
    }
    return capture;
}

Capture withNoise(Capture capture, float relative, uint64_t seed) {
    for (size_t i = 0; i < capture.views.size(); ++i)
        for (size_t p = 0; p < capture.views[i].image.pixels.size(); ++p)
            for (int c = 0; c < 3; ++c)
                capture.views[i].image.pixels[p][c] *=
                    std::max(0.0f, 1 + relative * normalOf(mixBits(seed * 31 + i) ^ (uint64_t(p) * 3 + uint64_t(c))));
    return capture;
}

Capture withExposures(Capture capture, float relative, uint64_t seed) {
    for (size_t i = 0; i < capture.views.size(); ++i)
        for (Rgb& pixel : capture.views[i].image.pixels) pixel *= std::exp(relative * normalOf(mixBits(seed * 53 + i)));
    return capture;
}

Capture withOutliers(Capture capture, float fraction, uint64_t seed) {
    for (size_t i = 0; i < capture.views.size(); ++i)
        for (size_t p = 0; p < capture.views[i].image.pixels.size(); ++p) {
            const uint64_t bits = mixBits(mixBits(seed * 77 + i) ^ p);
            if (unitFloat(bits) < fraction) capture.views[i].image.pixels[p] *= bits & 1 ? 1000.0f : 0.0f;
        }
    return capture;
}

Capture withViews(Capture capture, size_t count) {
    std::vector<View> kept;
    for (size_t i = 0; i < std::min(count, capture.views.size()); ++i)
        kept.push_back(std::move(capture.views[i * capture.views.size() / count]));
    capture.views = std::move(kept);
    return capture;
}

Capture withClipping(Capture capture, float percentile) {
    for (View& view : capture.views) {
        std::vector<float> values;
        for (const Rgb& pixel : view.image.pixels) values.push_back(maxChannel(pixel));
        if (values.empty()) continue;
        const float white = selectQuantile(values, double(percentile) / 100);
        if (!(white > 0)) continue;
        view.saturation = white;
        for (Rgb& pixel : view.image.pixels) pixel = glm::min(pixel, Rgb(view.saturation));
    }
    return capture;
}

double extentOf(const Capture& capture) { return boxOf(capture.mesh.positions).diagonal(); }

Capture movedBy(Capture capture, double scale, const glm::dmat3& turn, const DVec3& offset) {
    std::vector<DVec3> places;
    DBox box;
    for (const Vec3& p : capture.mesh.positions) {
        places.push_back(scale * (turn * (capture.origin + DVec3(p))) + offset);
        box.grow(places.back());
    }
    const DVec3 before = capture.origin;
    capture.origin = originFor(box.min, box.max);
    for (size_t v = 0; v < places.size(); ++v) capture.mesh.positions[v] = Vec3(places[v] - capture.origin);
    for (Vec3& n : capture.mesh.normals) n = Vec3(turn * DVec3(n));
    for (View& view : capture.views) {
        DMat4& m = view.camera.worldFromCamera;
        for (int k = 0; k < 3; ++k) m[k] = glm::dvec4(turn * DVec3(m[k]), 0);
        m[3] = glm::dvec4(scale * (turn * (before + DVec3(m[3]))) + offset - capture.origin, 1);
    }
    return capture;
}

Capture withVerticesShuffled(Capture capture, uint64_t seed, std::vector<uint32_t>& newIndex) {
    const size_t n = capture.mesh.vertexCount();
    std::vector<uint32_t> order(n);
    std::iota(order.begin(), order.end(), 0u);
    std::sort(order.begin(), order.end(),
              [&](uint32_t a, uint32_t b) { return mixBits(seed ^ a) < mixBits(seed ^ b); });
    newIndex.assign(n, 0);
    Mesh mesh = capture.mesh;
    for (uint32_t i = 0; i < n; ++i) {
        newIndex[order[i]] = i;
        mesh.positions[i] = capture.mesh.positions[order[i]];
        mesh.normals[i] = capture.mesh.normals[order[i]];
    }
    for (Triangle& t : mesh.triangles)
        for (uint32_t& v : t) v = newIndex[v];
    std::reverse(mesh.triangles.begin(), mesh.triangles.end());
    capture.mesh = std::move(mesh);
    return capture;
}

Capture withViewsReversed(Capture capture) {
    std::reverse(capture.views.begin(), capture.views.end());
    return capture;
}

}  // namespace relamp
