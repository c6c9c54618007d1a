#include "solve/solve.h"

#include "base/log.h"
#include "solve/steps/steps.h"

namespace relamp {

SolveOptions solveOptionsFor(const std::string& quality) {
    SolveOptions o;
    if (quality == "draft") {
        o.visibilitySide = 32;
        o.startLevel = 3;
        o.refineRounds = 2;
        o.startIterations = 8;
        o.refineIterations = 3;
        o.glossRounds = 1;
        o.metalRounds = 1;
        o.maxLeaves = 200;
        o.askForStrength = false;
    } else if (quality == "fine") {
        o.maxLeaves = 900;
        o.splitFraction = 0.006f;
        o.startIterations = 40;
        o.refineIterations = 8;
        o.glossRounds = 4;
    } else if (quality != "standard") {
        throw Error("--quality {}: unknown, expected draft, standard or fine", quality);
    }
    return o;
}

std::vector<SolveStep> stepsOf(const SolveOptions& options) {
    using enum SolveStep;
    std::vector<SolveStep> steps{firstLight, strongLight, firstSurfaces, startLight, bounces, lightStrength};
    for (int round = 0; round < options.refineRounds; ++round) steps.insert(steps.end(), {splitStrong, refineLight});
    steps.push_back(surfaces);
    const int rounds = options.glossRounds > 0 ? options.glossRounds + options.metalRounds : 0;
    for (int round = 0; round < rounds; ++round) steps.insert(steps.end(), {glossLight, glossSurfaces});
    for (int round = 0; round < options.turns; ++round) steps.push_back(turn);
    return steps;
}

Estimate solveScene(const Capture& capture, const Scene& scene, const RadianceSamples& samples,
                    const EmitterClusters& clusters, const SolveOptions& options, Progress& progress,
                    const SolveListener* listener, const SolveCheckpoint* resume) {
    if (options.gauge.kind == GaugeChoice::Kind::whitePatch &&
        (options.gauge.view < 0 || size_t(options.gauge.view) >= capture.views.size()))
        throw Error("--gauge white-patch: view {} does not exist, expected 0 to {}", options.gauge.view,
                    capture.views.size() - 1);
    for (const KnownPatch& patch : options.patches)
        if (patch.view >= capture.views.size())
            throw Error("{}: view {} does not exist, expected 0 to {}", patch.name, patch.view,
                        capture.views.size() - 1);
    SolveRun s(capture, scene, samples, options, progress, listener);
    if (resume) resumeSolve(s, *resume);
    else beginSolve(s, clusters);  // matte observations, pairs, visibility, near field: D and N
    const std::vector<SolveStep> steps = stepsOf(options);
    for (size_t i = resume ? resume->step : 0; i < steps.size(); ++i) {
        runStep(s, steps[i], uint32_t(i));
        finishedStep(s, uint32_t(i + 1), steps[i]);
    }
    return finishSolve(s);
}

}  // namespace relamp
