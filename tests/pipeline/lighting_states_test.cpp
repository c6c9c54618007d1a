// Photographs of one scene in several lighting states, solved together.
#include "pipeline/pipeline.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "clusters/state_emitters.h"
#include "pipeline/shot_of.h"
#include "pipeline/state_checks.h"
#include "radiance/state_parts.h"
#include "relight/state_look.h"
#include "shot/relit_looks.h"
#include "solve/ratio/pairs.h"
#include "support/known_world.h"

namespace relamp {
namespace {

/// A lamp over a floor with things on it: at a quarter, full, off; five views each. Painted once.
struct PaintedStates {
    test::TemporaryFolder folder;
    test::KnownWorld world = test::paintKnownWorld(folder / "room", true, 5, 12, false, false, {0.25f, 1, 0});
    static PaintedStates& get() {
        static PaintedStates painted;
        return painted;
    }
};

struct ThreeStates {
    const std::filesystem::path folder = PaintedStates::get().folder / "room";
    const test::KnownWorld& world = PaintedStates::get().world;
    PipelineOptions options;
    Progress progress;
    StageMeter meter{progress};
    Capture capture = loadCapture(folder, {}, progress);

    ThreeStates() {
        options.solve = solveOptionsFor("draft");
        options.texture = 0;
    }
    Prepared prepared() { return prepare(capture, options, meter, progress); }
};

/// True over found albedo of observed floor vertices, least squares over the channels.
double scaleOf(const test::KnownWorld& world, const Estimate& estimate) {
    double both = 0, own = 0;
    for (size_t v = 0; v < world.floorVertices; ++v) {
        if (!estimate.reflectance.observed[v]) continue;
        const Rgb a = estimate.reflectance.weight[0][v], b = world.albedo[v];
        both += double(glm::dot(a, b));
        own += double(glm::dot(a, a));
    }
    return both / own;
}

TEST(LightingStates, LevelsOfALampAreMeasuredInThePhotographs) {
    ThreeStates s;
    const Prepared prepared = s.prepared();
    ASSERT_EQ(prepared.samples->states, 3u);
    ASSERT_EQ(prepared.clusters.emitters.size(), 1u);
    const EmitterCluster& lamp = prepared.clusters.emitters[0];
    ASSERT_EQ(lamp.inState.size(), 3u);
    EXPECT_NEAR(lamp.inState[0], 0.25f, 1e-3f);
    EXPECT_EQ(lamp.inState[1], 1);
    EXPECT_EQ(lamp.inState[2], 0);
    EXPECT_NEAR(lamp.radiance.x, s.world.emitterRadiance.x, 0.05f);
    EXPECT_EQ(brightestState(prepared.clusters, *prepared.samples), 1u);
    EXPECT_TRUE(clustersInState(*prepared.scene, prepared.clusters, 2).emitters.empty());
    EXPECT_NEAR(clustersInState(*prepared.scene, prepared.clusters, 0).emitters[0].radiance.x,
                0.25f * s.world.emitterRadiance.x, 0.05f);
}

TEST(LightingStates, EachTakesItsOwnPhotographs) {
    ThreeStates s;
    const Prepared prepared = s.prepared();
    size_t observations = 0;
    for (uint32_t state = 0; state < 3; ++state) {
        const RadianceSamples of = samplesOfState(*prepared.samples, state);
        observations += of.samples.size();
        for (const RadianceSample& sample : of.samples) EXPECT_EQ(s.capture.views[sample.view].state, state);
        const Capture part = captureOfState(s.capture, state);
        const RadianceSamples ofPart = samplesOfPart(*prepared.samples, state);
        ASSERT_EQ(part.views.size(), 5u);
        ASSERT_EQ(ofPart.geometry.size(), 5u);
        EXPECT_EQ(ofPart.samples.size(), of.samples.size());
        for (size_t k = 0; k < of.samples.size(); ++k)
            EXPECT_EQ(part.views[ofPart.samples[k].view].name, s.capture.views[of.samples[k].view].name);
    }
    EXPECT_EQ(observations, prepared.samples->samples.size());
}

TEST(LightingStates, TogetherTheyFixTheScaleAndEveryStateIsReproduced) {
    ThreeStates s;
    Prepared prepared = s.prepared();
    const Corrections done = correctCapture(s.options, s.capture, prepared, s.meter, s.progress);
    EXPECT_TRUE(done.photometric.empty());
    const Estimate found = solvePrepared(s.capture, *prepared.scene, prepared, s.options, s.meter, s.progress);
    EXPECT_NEAR(scaleOf(s.world, found), 1, 0.02);
    ASSERT_EQ(found.states.size(), 3u);
    EXPECT_EQ(found.states[1].name, "lamp 1");
    EXPECT_EQ(found.states[1].views.size(), 5u);
    ASSERT_EQ(found.lighting.emitterRadiance.size(), 1u);
    EXPECT_NEAR(found.lighting.emitterRadiance[0].x / s.world.emitterRadiance.x, 1, 0.005);
    ASSERT_EQ(found.reproduction.views.size(), 15u);
    for (const ViewReproduction& view : found.reproduction.views) EXPECT_GT(view.psnr, 24) << view.name;

    // The shot keeps them.
    ShotSource source;
    source.captureFolder = s.folder;
    const test::TemporaryFolder kept;
    saveShot(shotOf(found, source), s.capture.mesh, kept / "room.relamp", false);
    const Shot shot = openShot(kept / "room.relamp", false, s.progress);
    ASSERT_EQ(shot.estimate.states.size(), 3u);
    EXPECT_EQ(shot.estimate.states[2].views, found.states[2].views);
    EXPECT_EQ(shot.estimate.emitters.emitters[0].inState, found.emitters.emitters[0].inState);
    EXPECT_EQ(shot.capture.views[12].state, 2u);

    // Frames of a view have the light of its state, and a state can be asked for.
    const LookTrack track(Look{});
    RelitLooks looks(shot.estimate, *prepared.scene, track);
    const auto power = [](const RelitScene& relit) { return relit.emitters[0].emission.level.x; };
    const float full = power(looks.at(1, s.progress));
    EXPECT_EQ(power(looks.at(1, s.progress, 2)), 0);
    EXPECT_NEAR(power(looks.at(1, s.progress, 0)) / full, 0.25f, 1e-3f);
    looks.base(0);
    EXPECT_NEAR(power(looks.at(1, s.progress, 2)) / full, 0.25f, 1e-3f);
}

TEST(LightingStates, ALevelThatNoPhotographShowsFollowsFromTheShading) {
    ThreeStates s;
    s.options.reproduce = false;
    Prepared prepared = s.prepared();
    ASSERT_EQ(prepared.clusters.emitters.size(), 1u);
    prepared.clusters.emitters[0].inState[0] = prepared.clusters.emitters[0].inState[2] = -1;
    const Estimate found = solvePrepared(s.capture, *prepared.scene, prepared, s.options, s.meter, s.progress);
    ASSERT_EQ(found.emitters.emitters.size(), 1u);
    EXPECT_NEAR(found.emitters.emitters[0].inState[0], 0.25f, 0.02f);
    EXPECT_NEAR(found.emitters.emitters[0].inState[2], 0, 0.02f);
}

TEST(LightingStates, AClippedLightIsOffWhereItIsDarkAndUnknownWhereItIsDimmed) {
    ThreeStates s;
    const float clip = 0.2f * s.world.emitterRadiance.z;
    for (View& view : s.capture.views) {
        view.saturation = clip;
        for (Rgb& pixel : view.image.pixels) pixel = glm::min(pixel, Rgb(clip));
    }
    s.options.reproduce = false;
    Prepared prepared = s.prepared();
    const std::vector<EmitterCluster>& found =
        prepared.clusters.emitters.empty() ? prepared.clusters.candidates : prepared.clusters.emitters;
    ASSERT_FALSE(found.empty());
    // Both are clipped, so which is brighter is not known; that it is off in the third state is.
    EXPECT_EQ(std::count(found[0].inState.begin(), found[0].inState.end(), 1.0f), 1);
    EXPECT_EQ(std::count(found[0].inState.begin(), found[0].inState.end(), -1.0f), 1);
    EXPECT_EQ(found[0].inState[2], 0);
    // What it lights brightly may be asked too, and is none.
    const Vec3 place = found[0].centroid;
    const Estimate solved = solvePrepared(s.capture, *prepared.scene, prepared, s.options, s.meter, s.progress);
    ASSERT_EQ(solved.emitters.emitters.size(), 1u);
    EXPECT_LT(glm::distance(solved.emitters.emitters[0].centroid, place), 0.01f);
}

TEST(LightingStates, EachVertexIsPairedWithItselfBetweenThem) {
    ThreeStates s;
    const Prepared prepared = s.prepared();
    std::vector<uint8_t> skip(s.capture.mesh.vertexCount(), 0);
    for (size_t v = 0; v < skip.size(); ++v) skip[v] = prepared.clusters.emitterOfVertex[v] >= 0;
    const RatioObservations all = ratioObservations(*prepared.scene, *prepared.samples, skip, 1);
    ASSERT_EQ(all.matte.states(), 3u);
    std::vector<float> weight(all.matte.vertices.size(), 0);
    for (const AlbedoPair& p : all.pairs) {
        const size_t a = all.matte.stateOf(p.a), b = all.matte.stateOf(p.b);
        EXPECT_EQ(p.same, a != b);
        if (!p.same) continue;
        EXPECT_EQ(all.matte.vertices[p.a], all.matte.vertices[p.b]);
        weight[p.a] += p.weight;
        weight[p.b] += p.weight;
    }
    size_t inAll = 0;
    for (const float w : weight) inAll += std::abs(w - 8.0f / 3) < 1e-4f;
    EXPECT_GT(inAll, all.matte.vertices.size() / 2) << "two partners of weight 4/3 for most";
    // One state alone has the pairs that it would have by itself.
    const RatioObservations one = ratioObservations(*prepared.scene, samplesOfState(*prepared.samples, 1), skip, 1);
    EXPECT_EQ(one.matte.vertices, all.matte.inState(1).vertices);
    EXPECT_EQ(one.matte.radiance, all.matte.inState(1).radiance);
}

TEST(LightingStates, ASolveThatWasPutAsideGoesOnInTheSameBits) {
    ThreeStates s;
    s.options.reproduce = false;
    Prepared prepared = s.prepared();
    std::vector<SolveCheckpoint> kept;
    SolveListener listener;
    listener.checkpoint = [&](const SolveCheckpoint& c) {
        if (c.between) kept.push_back(checkpointFromBytes(checkpointBytes(c)));
    };
    const Estimate whole =
        solvePrepared(s.capture, *prepared.scene, prepared, s.options, s.meter, s.progress, {&listener, nullptr, {}});
    ASSERT_GT(kept.size(), 3u);
    const Estimate resumed = solvePrepared(s.capture, *prepared.scene, prepared, s.options, s.meter, s.progress,
                                           {nullptr, &kept[kept.size() / 2], {}});
    EXPECT_EQ(resumed.reflectance.weight, whole.reflectance.weight);
    EXPECT_EQ(resumed.environment, whole.environment);
}

TEST(LightingStates, ABackgroundThatChangesIsWarnedOfByNameUnlessItIsSaid) {
    ThreeStates s;
    for (View& view : s.capture.views)
        if (view.state == 2)
            for (Rgb& pixel : view.image.pixels) pixel *= 1.4f;
    RadianceSamples samples = *s.prepared().samples;
    const std::vector<std::string> warnings = warnOfOtherEnvironments(s.capture, samples);
    ASSERT_EQ(warnings.size(), 1u);
    for (const char* words : {"states lamp 0.25 and lamp 0 show differs by 40 %", "--state-environment \"lamp 0=own\""})
        EXPECT_NE(warnings[0].find(words), std::string::npos) << warnings[0];
    for (const std::vector<int>& said : {std::vector{0, 0, 1}, {0, 0, -1}}) {
        samples.environmentOfState = said;
        EXPECT_TRUE(warnOfOtherEnvironments(s.capture, samples).empty());
    }
}

TEST(LightingStates, ALookMixesTwoOfThem) {
    std::vector<EmitterCluster> emitters(2);
    emitters[0].id = "emitter-1";
    emitters[0].inState = {1, 0};
    emitters[1].id = "emitter-2";
    emitters[1].inState = {0.5f, 1};
    EXPECT_EQ(levelsBetween(emitters, 0, 1, 0.25f), (std::vector<float>{0.75f, 0.625f}));
    Look look;
    look.emitters.push_back({"emitter-2"});
    look.emitters[0].powerScale = Rgb(2, 1, 1);
    const Look dimmed = withLevels(look, emitters, levelsInState(emitters, 0));
    ASSERT_EQ(dimmed.emitters.size(), 1u);
    EXPECT_EQ(dimmed.emitters[0].powerScale, Rgb(1, 0.5f, 0.5f));
    EXPECT_EQ(withLevels(Look{}, emitters, levelsInState(emitters, 1)).emitters[0].powerScale, Rgb(0));
}

}  // namespace
}  // namespace relamp
