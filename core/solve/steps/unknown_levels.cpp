// Levels of emitters in lighting states whose photographs do not show them: from what their light does to surfaces.
#include "base/log.h"
#include "solve/steps/steps.h"

namespace relamp {
namespace {

constexpr double levelBend = 0.05 * 0.05;  // of a ratio, squared: beyond it a vertex counts little
constexpr int levelsTried = 32;
constexpr float levelSettled = 0.01f;

/// A vertex in the state in question and in another one.
struct LevelPair {
    double shown = 0, other = 0;       ///< radiance
    double without = 0, otherLit = 0;  ///< irradiance: here without the emitter, there with all
    double byLevel = 0;                ///< irradiance here by the emitter at full level
};

double misfitAt(const std::vector<LevelPair>& pairs, double level) {
    double sum = 0;
    for (const LevelPair& p : pairs) {
        const double r = RatioResidual::value(p.shown, p.other, p.without + level * p.byLevel, p.otherLit);
        sum += std::log1p(r * r / levelBend);
    }
    return sum;
}

/// The level under which the ratios fit best: from 0 to 4, because the brightest state may be another one than it seems
/// where all are clipped.
float bestLevel(const std::vector<LevelPair>& pairs) {
    constexpr double most = 4;
    double best = most / 2, width = most / 2;
    for (int round = 0; round < 4; ++round) {
        const double from = std::max(0.0, best - width), to = std::min(most, best + width);
        double least = std::numeric_limits<double>::infinity();
        for (int k = 0; k <= levelsTried; ++k) {
            const double level = from + (to - from) * k / levelsTried;
            if (const double misfit = misfitAt(pairs, level); misfit < least) least = misfit, best = level;
        }
        width = 2 * (to - from) / levelsTried;
    }
    return float(best);
}

/// `lit`: irradiance of all observations under the present levels.
std::vector<LevelPair> levelPairs(const SolveRun& s, size_t emitter, size_t state, const std::vector<Rgb>& lit) {
    const MatteObservations& matte = s.observed.matte;
    const double power = double(luminance(s.light.lighting.emitterRadiance[emitter])),
                 now = double(s.emitters.levels[state][emitter]);
    std::vector<LevelPair> pairs;
    for (const AlbedoPair& p : s.observed.pairs) {
        if (!p.same) continue;
        const bool first = matte.stateOf(p.a) == state;
        if (!first && matte.stateOf(p.b) != state) continue;
        const uint32_t here = first ? p.a : p.b, there = first ? p.b : p.a;
        if (s.emitters.clusters.emitters[emitter].inState[matte.stateOf(there)] < 0) continue;
        LevelPair pair;
        pair.byLevel = double(s.light.nearField.at(matte.vertices[here], emitter)) * power;
        if (!(pair.byLevel > 0)) continue;
        pair.shown = double(luminance(matte.radiance[here]));
        pair.other = double(luminance(matte.radiance[there]));
        pair.without = std::max(0.0, double(luminance(lit[here])) - now * pair.byLevel);
        pair.otherLit = double(luminance(lit[there]));
        pairs.push_back(pair);
    }
    return pairs;
}

}  // namespace

bool fitUnknownLevels(SolveRun& s) {
    bool changed = false;
    const MatteObservations& matte = s.observed.matte;
    const size_t leaves = s.light.lighting.leaves.size();
    for (size_t e = 0; e < s.emitters.clusters.emitters.size(); ++e) {
        const EmitterCluster& emitter = s.emitters.clusters.emitters[e];
        for (size_t state = 0; state < emitter.inState.size(); ++state) {
            if (emitter.inState[state] >= 0) continue;
            const std::vector<LevelPair> pairs = levelPairs(s, e, state, s.irradiance().value);
            float& level = s.emitters.levels[state][e];
            const float found = pairs.empty() ? level : bestLevel(pairs);
            changed |= std::abs(found - level) > levelSettled;
            level = found;
            for (size_t i = matte.beginOf(state); i < matte.endOf(state); ++i)
                s.light.influence.row(i)[leaves + e] = level * s.light.nearField.at(matte.vertices[i], e);
        }
    }
    return changed;
}

void keepFittedLevels(SolveRun& s) {
    for (size_t e = 0; e < s.emitters.clusters.emitters.size(); ++e) {
        EmitterCluster& emitter = s.emitters.clusters.emitters[e];
        for (size_t state = 0; state < emitter.inState.size(); ++state) {
            if (emitter.inState[state] >= 0) continue;
            emitter.inState[state] = s.emitters.levels[state][e];
            if (emitter.unobserved)
                logInfo("{} in state {}: by the shading its level is {:.3f}", emitter.id, s.in.capture.states[state],
                        emitter.inState[state]);
            else
                logWarning("no photograph of state {} shows {} unclipped: by the shading its level is {:.3f}",
                           s.in.capture.states[state], emitter.id, emitter.inState[state]);
        }
    }
}

}  // namespace relamp
