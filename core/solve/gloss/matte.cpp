#include "solve/gloss/matte.h"

#include <numeric>

#include "base/statistics.h"
#include "radiance/seen_background.h"
#include "radiance/state_parts.h"
#include "radiance/view_spread.h"

namespace relamp {
namespace {
constexpr float coatedSpread = 0.06f, metalSpread = 0.35f;

/// The first of sorted observations at which their weights reach `sum`.
const MatteObservation& observationAt(const std::vector<MatteObservation>& observations, float sum) {
    float run = 0;
    for (const MatteObservation& l : observations) {
        run += l.weight;
        if (run >= sum) return l;
    }
    return observations.back();
}

/// The quantile below the median, of what noise leaves of the spread: a low quantile of noise alone is no surface's
/// radiance.
float centreOf(const std::vector<MatteObservation>& observations, float quantile, float total) {
    const MatteObservation& middle = observationAt(observations, 0.5f * total);
    if (quantile >= 0.5f) return middle.radiance;
    constexpr float quartileDeviations = 0.6745f;
    const float low = observationAt(observations, quantile * total).radiance,
                high = observationAt(observations, (1 - quantile) * total).radiance,
                spread = (high - low) / (2 * quartileDeviations),
                noise = middle.sigma * (1 + 1 / std::sqrt(float(observations.size())));
    if (!(spread > noise)) return middle.radiance;
    return middle.radiance - std::sqrt(1 - noise * noise / (spread * spread)) * (middle.radiance - low);
}
}  // namespace

MatteValue robustMatteValue(std::vector<MatteObservation>& observations, float quantile) {
    std::sort(observations.begin(), observations.end(), [](const MatteObservation& a, const MatteObservation& b) {
        return a.radiance != b.radiance ? a.radiance < b.radiance : a.weight < b.weight;
    });
    float total = 0, best = 0;
    for (const MatteObservation& l : observations) {
        total += l.weight;
        best = std::max(best, l.weight);
    }
    const float count = float(observations.size()), sigma = observationAt(observations, 0.5f * total).sigma,
                centre = centreOf(observations, quantile, total), reach = std::max(3 * sigma, 0.06f * centre);
    float sum = 0, weight = 0, noise = 0, deviation = 0;
    for (const MatteObservation& l : observations)
        if (std::abs(l.radiance - centre) <= reach) {
            sum += l.weight * l.radiance;
            noise += l.weight * l.sigma;
            weight += l.weight;
        }
    MatteValue value{weight > 0 ? sum / weight : centre, 0};
    noise = weight > 0 ? noise / weight : sigma;
    for (const MatteObservation& l : observations)
        deviation += l.weight * std::min(std::abs(l.radiance - value.radiance), reach);
    deviation /= total;
    value.sigma = std::sqrt(noise * noise / count / best + 0.25f * deviation * deviation / count);
    return value;
}

size_t MatteObservations::stateOf(size_t i) const {
    if (stateStart.empty()) return 0;
    return size_t(std::upper_bound(stateStart.begin() + 1, stateStart.end(), uint32_t(i)) - stateStart.begin()) - 1;
}

MatteObservations MatteObservations::inState(size_t state) const {
    const auto part = [&](const auto& list) {
        return std::decay_t<decltype(list)>(list.begin() + ptrdiff_t(beginOf(state)),
                                            list.begin() + ptrdiff_t(endOf(state)));
    };
    return {part(vertices), part(radiance), part(sigma), viewSpread, componentGlossy};
}

namespace {

MatteObservations matteOfOneState(const Scene& scene, const RadianceSamples& samples, const std::vector<uint8_t>& skip,
                                  const std::vector<uint8_t>* componentGlossy) {
    MatteObservations result;
    const size_t n = scene.mesh.vertexCount();
    // How much each component's look changes with the view, beyond noise: the spread of the better observations.
    std::vector<std::vector<float>> spreads(scene.materials);
    for (uint32_t v = 0; v < n; ++v) {
        if (skip[v] || samples.countOf(v) < 2) continue;
        if (const float spread = viewSpread(samples, v); spread >= 0) spreads[scene.material[v]].push_back(spread);
    }
    result.viewSpread.assign(scene.materials, 0);
    result.componentGlossy.assign(scene.materials, 0);
    for (uint32_t p = 0; p < scene.materials; ++p) {
        const float upper = selectQuantile(spreads[p], 0.75), middle = selectQuantile(spreads[p], 0.5);
        result.viewSpread[p] = middle;
        if (scene.shines[p]) result.componentGlossy[p] = 1;
        if (spreads[p].size() < 12) continue;
        result.componentGlossy[p] = middle > metalSpread ? 2 : (upper > coatedSpread || scene.shines[p] ? 1 : 0);
    }
    if (componentGlossy) result.componentGlossy = *componentGlossy;
    std::vector<MatteObservation> observations;
    for (uint32_t v = 0; v < n; ++v) {
        if (skip[v] || !scene.referenced[v]) continue;
        const uint8_t glossy = result.componentGlossy[scene.material[v]];
        float best = 0;
        for (uint32_t s = samples.start[v]; s < samples.start[v + 1]; ++s)
            if (!samples.samples[s].clipped) best = std::max(best, samples.samples[s].weight);
        if (best < 0.1f) continue;
        Rgb value(0), sigma(0);
        for (int c = 0; c < 3; ++c) {
            observations.clear();
            for (uint32_t s = samples.start[v]; s < samples.start[v + 1]; ++s) {
                const RadianceSample& r = samples.samples[s];
                if (r.clipped || r.weight < 0.2f * best) continue;
                observations.push_back({r.radiance[c], r.weight, samples.sigma(r.radiance[c])});
            }
            // A glossy surface only adds to its matte part, so it takes the lower observations.
            const MatteValue matte = robustMatteValue(observations, glossy ? 0.25f : 0.5f);
            value[c] = matte.radiance;
            sigma[c] = glossy ? std::hypot(matte.sigma, 0.05f * value[c]) : matte.sigma;
        }
        result.vertices.push_back(v);
        result.radiance.push_back(value);
        result.sigma.push_back(sigma);
    }
    return result;
}

/// A component shines if it does in any state: without the emitter there may be nothing to mirror. It is a metal only
/// where it is none that is matte in another state.
std::vector<uint8_t> glossyInAny(const std::vector<MatteObservations>& states, size_t components) {
    std::vector<uint8_t> glossy(components, 0);
    for (size_t p = 0; p < components; ++p) {
        bool matte = false;
        for (const MatteObservations& state : states) {
            glossy[p] = std::max(glossy[p], state.componentGlossy[p]);
            matte |= state.componentGlossy[p] == 0 && state.viewSpread[p] > 0;
        }
        if (matte) glossy[p] = std::min<uint8_t>(glossy[p], 1);
    }
    return glossy;
}

}  // namespace

MatteObservations matteObservations(const Scene& scene, const RadianceSamples& samples,
                                    const std::vector<uint8_t>& skip, const std::vector<uint8_t>* componentGlossy) {
    if (samples.states == 1) return matteOfOneState(scene, samples, skip, componentGlossy);
    std::vector<RadianceSamples> parts;
    std::vector<MatteObservations> states;
    for (uint32_t s = 0; s < samples.states; ++s) parts.push_back(samplesOfState(samples, s));
    for (const RadianceSamples& part : parts) states.push_back(matteOfOneState(scene, part, skip, componentGlossy));
    MatteObservations all;
    all.componentGlossy = componentGlossy ? *componentGlossy : glossyInAny(states, scene.materials);
    all.viewSpread.assign(scene.materials, 0);
    for (size_t s = 0; s < states.size(); ++s) {
        MatteObservations& state = states[s];
        for (size_t p = 0; p < scene.materials; ++p)
            all.viewSpread[p] = std::max(all.viewSpread[p], state.viewSpread[p]);
        if (state.componentGlossy != all.componentGlossy)
            state = matteOfOneState(scene, parts[s], skip, &all.componentGlossy);
        all.stateStart.push_back(uint32_t(all.vertices.size()));
        all.vertices.insert(all.vertices.end(), state.vertices.begin(), state.vertices.end());
        all.radiance.insert(all.radiance.end(), state.radiance.begin(), state.radiance.end());
        all.sigma.insert(all.sigma.end(), state.sigma.begin(), state.sigma.end());
    }
    all.stateStart.push_back(uint32_t(all.vertices.size()));
    return all;
}

double backgroundOverSurfaces(const RadianceSamples& samples, const MatteObservations& matte, bool inexact) {
    const std::vector<float> seen = seenBackground(samples);
    std::vector<float> surfaces;
    if (matte.radiance.empty() || seen.empty()) return -1;
    for (const Rgb& y : matte.radiance) surfaces.push_back(maxChannel(y));
    float brightest = *std::max_element(seen.begin(), seen.end());
    if (inexact && brightest <= quantileOf(surfaces, 0.99)) brightest = quantileOf(seen, 0.95);
    return double(brightest) / std::max(double(medianOf(std::move(surfaces))), 1e-30);
}

std::vector<size_t> observationsOfComponents(const Scene& scene, const MatteObservations& matte) {
    std::vector<size_t> counts(scene.materials, 0);
    for (const uint32_t v : matte.vertices) ++counts[scene.material[v]];
    return counts;
}

}  // namespace relamp
