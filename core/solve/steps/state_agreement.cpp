// Do lighting states that share an environment show one?
#include <map>

#include "base/log.h"
#include "base/statistics.h"
#include "capture/lighting_states.h"
#include "solve/steps/steps.h"

namespace relamp {
namespace {

constexpr size_t leastVertices = 50;
constexpr float mostDisagreement = 0.06f;  // relative, beyond noise
constexpr double medianOfNormal = 0.6745;  // of its absolute value, in standard deviations

/// How far ratios of radiance between two states are off under the light found.
struct Disagreement {
    std::vector<float> residual, noise;  ///< per vertex: absolute, and its median by noise

    float beyondNoise() const {
        const float all = medianOf(residual), known = medianOf(noise);
        return std::sqrt(std::max(0.0f, all * all - known * known));
    }
};

}  // namespace

std::vector<std::string> statesThatDisagree(const SolveRun& s, const Irradiance& irradiance) {
    const MatteObservations& matte = s.observed.matte;
    std::map<std::pair<size_t, size_t>, Disagreement> between;
    for (const AlbedoPair& p : s.observed.pairs) {
        if (!p.same) continue;
        const auto states = std::minmax({matte.stateOf(p.a), matte.stateOf(p.b)});
        const LightLeaves& leaves = s.light.lighting.leaves;
        if (leaves.environmentOf(states.first) != leaves.environmentOf(states.second)) continue;
        const double ya = double(luminance(matte.radiance[p.a])), yb = double(luminance(matte.radiance[p.b])),
                     la = double(luminance(irradiance.value[p.a])), lb = double(luminance(irradiance.value[p.b])),
                     noise = RatioResidual::variance(ya, yb, la, lb, double(luminance(matte.sigma[p.a])) * lb,
                                                     double(luminance(matte.sigma[p.b])) * la);
        Disagreement& d = between[states];
        d.residual.push_back(float(std::abs(RatioResidual::value(ya, yb, la, lb))));
        d.noise.push_back(float(medianOfNormal * std::sqrt(noise)));
    }
    std::vector<std::string> warnings;
    for (const auto& [states, d] : between) {
        if (d.residual.size() < leastVertices) continue;
        const std::string &before = s.in.capture.states[states.first], &now = s.in.capture.states[states.second];
        const float off = d.beyondNoise();
        logInfo("ratios between states {} and {}: {:.1f} % off beyond noise, {} vertices", before, now, 100 * off,
                d.residual.size());
        if (off <= mostDisagreement) continue;
        warnings.push_back(
            fmt::format("one environment does not explain states {} and {}: ratios between them are {:.0f} % off. {}",
                        before, now, 100 * off, howToSayOwnEnvironment(now)));
        logWarning("{}", warnings.back());
    }
    return warnings;
}

}  // namespace relamp
