#include "solve/solve.h"

#include "base/log.h"
#include "solve/albedo_free.h"
#include "solve/solve_state.h"

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
        o.maxLeaves = 200;
    } else if (quality == "fine") {
        o.maxLeaves = 900;
        o.splitShare = 0.006f;
        o.startIterations = 40;
        o.refineIterations = 8;
        o.glossRounds = 4;
    } else if (quality != "standard") {
        throw Error("--quality {}: unknown, expected draft, standard or fine", quality);
    }
    return o;
}

Estimate solveScene(const Capture& capture, const Scene& scene, const RadianceSamples& samples, const EmitterClusters& clusters,
                    const SolveOptions& options, Progress& progress, const SolveListener* listener) {
    if (options.gauge.kind == GaugeChoice::Kind::whitePatch && (options.gauge.view < 0 || size_t(options.gauge.view) >= capture.views.size()))
        throw Error("--gauge white-patch: view {} does not exist, expected 0 to {}", options.gauge.view, capture.views.size() - 1);
    SolveState s(capture, scene, samples, options, progress, listener);
    s.takeClusters(clusters);
    s.prepare();                       // matte observations, pairs, visibility, near field: D and N
    if (!s.hasMatte()) {
        s.startFromConstantReflectance();
        s.confirmEmitters();
    } else if (options.nearField) {
        s.startFromRatios();           // METHOD 11
        if (s.confirmEmitters()) s.startFromRatios();
        s.leaveOutBlackEnvironment();
        s.decideBounce();
    } else {
        s.startFromConstantAlbedo();   // the baseline's own way
    }
    s.showSnapshot();
    for (int round = 0; round < options.refineRounds && s.refineLeaves(); ++round) {
        if (options.nearField || !s.hasMatte()) s.improveLight(options.refineIterations);
        else s.alternate();
        s.updateBounce();
        s.showSnapshot();
    }
    s.solveReflectance();
    s.showSnapshot();
    for (int round = 0; round < options.glossRounds && s.hasGloss() && !s.stopped(); ++round) {
        s.improveLight(options.refineIterations);
        s.solveReflectance();
        s.updateBounce();
    }
    for (int round = 0; round < options.turns && s.hasMatte() && !s.hasGloss() && !s.stopped(); ++round) s.alternate();
    return s.finish();
}

}  // namespace relamp
