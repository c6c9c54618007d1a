// Lighting states that have an environment of their own, or none, solved together.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "pipeline/pipeline.h"
#include "pipeline/shot_of.h"
#include "relight/state_look.h"
#include "shot/relit_looks.h"
#include "support/known_world.h"

namespace relamp {
namespace {

using Sky = test::KnownWorld::Sky;

/// A floor with things on it by day without its lamp, in the evening under it, and with nothing but the lamp at a half.
struct DayAndEvening {
    test::TemporaryFolder folder;
    test::KnownWorld world = test::paintKnownWorld(folder / "room", true, 5, 12, false, false, {0, 1, 0.5f},
                                                   {Sky::day, Sky::evening, Sky::none});
    static DayAndEvening& get() {
        static DayAndEvening painted;
        return painted;
    }
};

struct SolvedStates {
    std::filesystem::path room = DayAndEvening::get().folder / "room";
    const test::KnownWorld& world = DayAndEvening::get().world;
    PipelineOptions options;
    Progress progress;
    StageMeter meter{progress};
    Capture capture = loadCapture(room, {}, progress);
    Prepared prepared;

    SolvedStates() {
        options.solve = solveOptionsFor("draft");
        options.texture = 0;
        prepared = prepare(capture, options, meter, progress);
    }
    Estimate solved(const SolveExtras& extras = {}) {
        return solvePrepared(capture, *prepared.scene, prepared, options, meter, progress, extras);
    }
};

/// Solved once, with what it put by between its steps.
struct WholeSolve : SolvedStates {
    std::vector<SolveCheckpoint> kept;
    Estimate found;
    WholeSolve() {
        SolveListener listener;
        listener.checkpoint = [&](const SolveCheckpoint& c) {
            if (c.between) kept.push_back(checkpointFromBytes(checkpointBytes(c)));
        };
        found = solved({&listener, nullptr, {}});
    }
    static WholeSolve& get() {
        static WholeSolve one;
        return one;
    }
};

/// Root mean square of what an environment does to surfaces that face all ways, over what the true sky does: relative.
double skyError(const std::vector<Rgb>& cells, int side, Sky sky) {
    const DirectionGrid grid{side};
    double squares = 0, all = 0;
    for (const Vec3& normal : {Vec3(0, 0, 1), Vec3(1, 0, 0), Vec3(-1, 0, 0), Vec3(0, 1, 0), Vec3(0, -1, 0)}) {
        DVec3 found(0);
        for (int c = 0; c < grid.cells(); ++c)
            found += DVec3(cells[size_t(c)]) * double(std::max(0.0f, glm::dot(normal, grid.direction(c))));
        const DVec3 truth =
            DVec3(test::skyIrradiance([&](const Vec3& d) { return test::KnownWorld::skyAt(sky, d); }, normal));
        const DVec3 off = found * double(grid.cellSolidAngle()) - truth;
        squares += glm::dot(off, off);
        all += glm::dot(truth, truth);
    }
    return std::sqrt(squares / all);
}

/// Largest relative error of a background where many pixels of photographs see it. `first`: its state's first cell
/// among those that were observed.
float backgroundError(const Panorama& background, const RadianceSamples& samples, size_t first, Sky sky) {
    const DirectionGrid& grid = samples.backgroundGrid;
    float worst = -1;
    for (int c = 0; c < grid.cells(); ++c) {
        if (samples.backgroundPixels[first + size_t(c)] < 20) continue;
        const Rgb truth = test::KnownWorld::skyAt(sky, grid.direction(c));
        const Rgb off = glm::abs(background.radiance(grid.direction(c)) - truth);
        worst = std::max(worst, maxChannel(off) / maxChannel(truth));
    }
    return worst;
}

TEST(StateEnvironments, AreFoundEachByItselfAndAShotKeepsThem) {
    WholeSolve& s = WholeSolve::get();
    ASSERT_EQ(s.capture.environmentOfState, (std::vector<int>{0, 1, -1}));
    // The background of the dark state, which is black, is no distant light.
    const size_t cells = size_t(s.prepared.samples->backgroundGrid.cells());
    ASSERT_EQ(s.prepared.samples->background.size(), 2 * cells);
    const Estimate& found = s.found;
    double both = 0, own = 0;
    for (size_t v = 0; v < s.world.floorVertices; ++v) {
        if (!found.reflectance.observed[v]) continue;
        both += double(glm::dot(found.reflectance.weight[0][v], s.world.albedo[v]));
        own += double(glm::dot(found.reflectance.weight[0][v], found.reflectance.weight[0][v]));
    }
    EXPECT_NEAR(both / own, 1, 0.02);
    ASSERT_EQ(found.lighting.emitterRadiance.size(), 1u);
    EXPECT_NEAR(found.lighting.emitterRadiance[0].x / s.world.emitterRadiance.x, 1, 0.005);
    // The lamp is brightest in the evening: that is the estimate's own environment.
    ASSERT_EQ(found.states.size(), 3u);
    ASSERT_EQ(found.otherEnvironments.size(), 1u);
    EXPECT_EQ(found.states[0].environment, 1);
    EXPECT_EQ(found.states[1].environment, 0);
    EXPECT_EQ(found.states[2].environment, -1);
    EXPECT_LT(skyError(found.environment, found.environmentSide, Sky::evening), 0.08);
    EXPECT_LT(skyError(found.otherEnvironments[0].environment, found.environmentSide, Sky::day), 0.08);
    EXPECT_EQ(found.otherEnvironments[0].sigma.size(), found.environment.size());
    ASSERT_TRUE(found.background && found.otherEnvironments[0].background);
    const RadianceSamples& samples = *s.prepared.samples;
    const float evening = backgroundError(*found.background, samples, cells, Sky::evening),
                day = backgroundError(*found.otherEnvironments[0].background, samples, 0, Sky::day);
    EXPECT_GE(evening, 0) << "no photograph sees the sky";
    EXPECT_LT(evening, 0.05);
    EXPECT_LT(day, 0.05);
    ASSERT_EQ(found.reproduction.views.size(), 15u);
    for (const ViewReproduction& view : found.reproduction.views) EXPECT_GT(view.psnr, 24) << view.name;

    ShotSource source;
    source.captureFolder = s.room;
    const test::TemporaryFolder kept;
    const std::filesystem::path place = kept / "room.relamp";
    saveShot(shotOf(found, source), s.capture.mesh, place, false);
    EXPECT_EQ(nlohmann::json::parse(std::ifstream(place / "shot.json"))["version"], 3);
    const Shot shot = openShot(place, false, s.progress);
    ASSERT_EQ(shot.estimate.otherEnvironments.size(), 1u);
    ASSERT_TRUE(shot.estimate.background && shot.estimate.otherEnvironments[0].background);
    EXPECT_NEAR(backgroundError(*shot.estimate.background, samples, cells, Sky::evening), evening, 0.01);
    EXPECT_NEAR(backgroundError(*shot.estimate.otherEnvironments[0].background, samples, 0, Sky::day), day, 0.01);
    EXPECT_EQ(shot.estimate.otherEnvironments[0].environment, found.otherEnvironments[0].environment);
    for (size_t state = 0; state < 3; ++state)
        EXPECT_EQ(shot.estimate.states[state].environment, found.states[state].environment);

    const test::TemporaryFolder broken;
    std::filesystem::copy(place, broken / "room.relamp", std::filesystem::copy_options::recursive);
    nlohmann::json document = nlohmann::json::parse(std::ifstream(place / "shot.json"));
    document["states"][2]["environment"] = "sky.exr";
    std::ofstream(broken / "room.relamp" / "shot.json") << document.dump();
    try {
        openShot(broken / "room.relamp", false, s.progress);
        ADD_FAILURE() << "a shot with an environment that does not exist was opened";
    } catch (const Error& error) {
        EXPECT_NE(std::string(error.what()).find("states[2].environment: is sky.exr, expected environment.exr"),
                  std::string::npos)
            << error.what();
    }

    // Frames of a view have the light of its state, and a state can be asked for.
    const LookTrack track(Look{});
    RelitLooks looks(shot.estimate, *s.prepared.scene, track);
    EXPECT_EQ(looks.at(1, s.progress).distant->cells(), shot.estimate.environment);
    EXPECT_EQ(looks.at(1, s.progress, 0).distant->cells(), shot.estimate.otherEnvironments[0].environment);
    EXPECT_TRUE(looks.at(1, s.progress, 2).distant->black());
    looks.base(1);
    EXPECT_EQ(looks.at(1, s.progress, 2).distant->cells(), shot.estimate.environment);
}

TEST(StateEnvironments, ASolveThatWasPutAsideGoesOnInTheSameBits) {
    const Estimate& whole = WholeSolve::get().found;
    const std::vector<SolveCheckpoint>& kept = WholeSolve::get().kept;
    ASSERT_GT(kept.size(), 3u);
    SolvedStates s;
    s.options.reproduce = false;
    const Estimate resumed = s.solved({nullptr, &kept[kept.size() / 2], {}});
    EXPECT_EQ(resumed.reflectance.weight, whole.reflectance.weight);
    ASSERT_EQ(resumed.otherEnvironments.size(), 1u);
    EXPECT_EQ(resumed.otherEnvironments[0].environment, whole.otherEnvironments[0].environment);
}

}  // namespace
}  // namespace relamp
