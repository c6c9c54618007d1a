#include "capture/photometric.h"

#include "base/parallel.h"
#include "capture/capture.h"

namespace relamp {

Rgb PhotometricFix::gainOf(const std::string& view) const {
    for (const ViewGain& g : gains)
        if (g.view == view) return g.gain;
    return Rgb(1);
}

float PhotometricFix::falloffAt(float r2) const { return std::exp(falloff2 * r2 + falloff4 * r2 * r2); }

float radiusSquared(const Camera& camera, const Vec2& pixel) {
    const Vec2 middle(0.5f * float(camera.width), 0.5f * float(camera.height)), d = pixel - middle;
    return glm::dot(d, d) / std::max(1e-20f, glm::dot(middle, middle));
}

void applyPhotometric(const PhotometricFix& fix, View& view) {
    if (fix.empty()) return;
    const Rgb gain = fix.gainOf(view.name);
    const float clip = view.saturation;
    // The lowest radiance that a clipped pixel may stand for: everything at and above it is a lower bound.
    if (clip > 0) view.saturation = clip / (maxChannel(gain) * std::max(1.0f, fix.falloffAt(1)));
    parallelFor(size_t(view.image.height), 32, [&](size_t y) {
        for (int x = 0; x < view.image.width; ++x) {
            Rgb& pixel = view.image.at(x, int(y));
            const bool clipped = clip > 0 && maxChannel(pixel) >= clip;
            pixel /= gain * fix.falloffAt(radiusSquared(view.camera, Vec2(float(x) + 0.5f, float(y) + 0.5f)));
            if (clipped && maxChannel(pixel) < view.saturation) pixel *= view.saturation / maxChannel(pixel);
        }
    });
}

}  // namespace relamp
