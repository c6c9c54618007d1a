#include "display/vertex_images.h"

#include <algorithm>
#include <array>

#include "base/statistics.h"
#include "display/display_image.h"

namespace relamp {
namespace {

const Rgb unobserved(0.18f, 0.19f, 0.22f);  // display
const Rgb unobservedLinear(0.027f, 0.030f, 0.040f);

/// Weighted mean of a vertex's observations; false when it has none.
bool observed(const RadianceSamples& samples, size_t v, int view, Rgb& mean) {
    Rgb sum(0);
    float weight = 0;
    for (uint32_t i = samples.start[v]; i < samples.start[v + 1]; ++i) {
        const RadianceSample& s = samples.samples[i];
        if (view >= 0 && s.view != uint32_t(view)) continue;
        sum += s.weight * s.radiance;
        weight += s.weight;
    }
    if (!(weight > 0)) return false;
    mean = sum / weight;
    return true;
}

}  // namespace

std::vector<Rgb> photographColours(const RadianceSamples& samples, int view, const MeshColours* own) {
    std::vector<Rgb> colours(samples.start.size() - 1, unobservedLinear);
    std::vector<uint8_t> seen(colours.size(), 0);
    for (size_t v = 0; v < colours.size(); ++v) seen[v] = observed(samples, v, view, colours[v]);
    if (!own || own->empty()) return colours;
    const size_t count = std::min(colours.size(), own->linear.size());
    std::vector<float> ratio;
    for (size_t v = 0; v < count; ++v)
        if (seen[v] && own->painted[v] && luminance(own->linear[v]) > 1e-3f)
            ratio.push_back(luminance(colours[v]) / luminance(own->linear[v]));
    if (ratio.empty()) return colours;
    const float gain = medianOf(std::move(ratio));
    for (size_t v = 0; v < count; ++v)
        if (!seen[v] && own->painted[v]) colours[v] = gain * own->linear[v];
    return colours;
}

std::vector<Rgb> albedoColours(const Estimate& estimate) {
    const Reflectance& r = estimate.reflectance;
    std::vector<Rgb> colours(r.vertexCount(), Rgb(0));
    for (size_t k = 0; k < r.lobes(); ++k) {
        const float fraction = lobeAlbedo(r.basis.lobes[k]);
        for (size_t v = 0; v < colours.size(); ++v) colours[v] += fraction * r.lobe(k)[v];
    }
    return colours;
}

std::vector<Rgb> correctionColours(const Estimate& estimate) {
    const std::vector<Rgb> albedo = albedoColours(estimate);
    return tintsOf(albedo, std::vector<float>(albedo.size(), 1.0f));
}

Rgb clusterColour(size_t emitter) {
    // Distinct in hue and in brightness, so that they can be told apart without colour vision.
    static constexpr std::array<std::array<float, 3>, 8> palette{{{0.98f, 0.75f, 0.24f},
                                                                  {0.35f, 0.65f, 0.95f},
                                                                  {0.90f, 0.40f, 0.45f},
                                                                  {0.40f, 0.82f, 0.60f},
                                                                  {0.76f, 0.55f, 0.92f},
                                                                  {0.95f, 0.93f, 0.55f},
                                                                  {0.32f, 0.45f, 0.62f},
                                                                  {0.72f, 0.46f, 0.28f}}};
    const auto& c = palette[emitter % palette.size()];
    return Rgb(c[0], c[1], c[2]);
}

std::vector<Rgb> clusterColours(const Estimate& estimate) {
    std::vector<Rgb> colours(estimate.emitters.emitterOfVertex.size(), Rgb(0.42f));
    for (size_t v = 0; v < colours.size(); ++v)
        if (const int e = estimate.emitters.emitterOfVertex[v]; e >= 0) colours[v] = clusterColour(size_t(e));
    return colours;
}

Rgb confidenceColour(float confidence) {
    // Purple, blue, teal, green, yellow: brightness rises along the scale.
    static constexpr std::array<std::array<float, 3>, 5> scale{{{0.27f, 0.00f, 0.33f},
                                                                {0.23f, 0.32f, 0.55f},
                                                                {0.13f, 0.57f, 0.55f},
                                                                {0.37f, 0.79f, 0.38f},
                                                                {0.99f, 0.91f, 0.14f}}};
    const float x = std::clamp(confidence, 0.0f, 1.0f) * 4;
    const size_t i = std::min<size_t>(3, size_t(x));
    const float t = x - float(i);
    Rgb c;
    for (int k = 0; k < 3; ++k) c[k] = (1 - t) * scale[i][size_t(k)] + t * scale[i + 1][size_t(k)];
    return c;
}

std::vector<Rgb> confidenceColours(const Estimate& estimate) {
    const Reflectance& r = estimate.reflectance;
    std::vector<Rgb> colours(r.confidence.size(), unobserved);
    for (size_t v = 0; v < colours.size(); ++v)
        if (v >= r.observed.size() || r.observed[v]) colours[v] = confidenceColour(r.confidence[v]);
    return colours;
}

std::vector<Rgb> differenceColours(const std::vector<Rgb>& model, const RadianceSamples& samples, int view) {
    const size_t count = samples.start.size() - 1;
    std::vector<Rgb> colours(count, unobserved);
    const Rgb tooBright(0.95f, 0.52f, 0.15f), tooDark(0.20f, 0.50f, 0.95f), equal(0.5f);
    for (size_t v = 0; v < count && v < model.size(); ++v) {
        Rgb seen;
        if (!observed(samples, v, view, seen)) continue;
        const float floor = std::max(samples.noiseFloor, 1e-6f);
        const float stops =
            std::clamp(std::log2((luminance(model[v]) + floor) / (luminance(seen) + floor)), -1.0f, 1.0f);
        colours[v] = glm::mix(equal, stops > 0 ? tooBright : tooDark, std::abs(stops));
    }
    return colours;
}

std::vector<Rgb> irradianceColours(const std::vector<float>& formFactor, const Rgb& radiance) {
    std::vector<Rgb> colours(formFactor.size());
    for (size_t v = 0; v < colours.size(); ++v) colours[v] = formFactor[v] * radiance;
    return colours;
}

}  // namespace relamp
