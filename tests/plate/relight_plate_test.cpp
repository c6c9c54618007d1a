#include "plate/relight_plate.h"

#include <gtest/gtest.h>

#include "plate/plate_world.h"

namespace relamp {
namespace {

using test::PlateWorld;
using test::Relighting;
using test::TemporaryFolder;

TEST(RelightPlate, IsTheSceneUnderTheNewLight) {
    const PlateWorld world;
    const TemporaryFolder folder;
    const PlateRequest request = world.writePlate(folder);
    Relighting run(world, request, PlateWorld::dimmed());
    const RelitPlate relit = run.relighter.relit(2, run.progress);
    FrameOptions many;
    many.samplesPerPixel = 64;
    const Frame truth = renderFrame(world.relit(PlateWorld::dimmed()), world.cameras[2], many, run.progress);
    std::vector<double> off;
    for (size_t p = 0; p < truth.beauty.size(); ++p)
        if (truth.emittersSeen[p][0].emitter < 0 && p != 5)
            for (int c = 0; c < 3; ++c) off.push_back(double(relit.image.pixels[p][c] / truth.beauty[p][c] - 1));
    EXPECT_LT(test::rootMeanSquare(off), 0.03);
    EXPECT_NEAR(relit.gain.x, 1, 0.01);
    EXPECT_GT(relit.covered, 0.3f);
}

TEST(RelightPlate, AsADifferenceAddsTheChangeOfLightToWhateverThePlateShows) {
    const PlateWorld world(1);
    const TemporaryFolder folder;
    PlateRequest request = world.writePlate(folder);
    float saturation = 0;
    Image plate = readPlate(folder / "plate.1001.exr", PlateCurve::automatic, saturation);
    for (size_t p = 0; p < plate.pixels.size(); p += 3) plate.pixels[p] *= 1.4f;  // what no model knows
    writeImage(folder / "plate.1001.exr", plate);
    plate = readPlate(folder / "plate.1001.exr", PlateCurve::automatic, saturation);
    request.match = PlateMatching::off;
    request.ratio = Ratio::difference;
    Relighting run(world, request, PlateWorld::dimmed());
    const Image relit = run.relighter.relit(0, run.progress).image;
    FrameOptions many;
    many.samplesPerPixel = 64;
    const Frame before = renderFrame(world.relit({}), world.cameras[0], many, run.progress),
                after = renderFrame(world.relit(PlateWorld::dimmed()), world.cameras[0], many, run.progress);
    std::vector<double> off, changes;
    for (size_t p = 0; p < after.beauty.size(); ++p) {
        if (after.emittersSeen[p][0].emitter >= 0 || p == 5) continue;
        const double change = double(after.beauty[p].x - before.beauty[p].x);
        changes.push_back(change);
        off.push_back(double(relit.pixels[p].x - plate.pixels[p].x) - change);
    }
    EXPECT_GT(test::rootMeanSquare(changes), 0.02);
    EXPECT_LT(test::rootMeanSquare(off), 0.05 * test::rootMeanSquare(changes));
}

TEST(PlateLight, OfAnEditOfPowersIsKnownWithoutRenderingIt) {
    const PlateWorld world;
    Look look = PlateWorld::dimmed();
    look.environment.exposureStops = -1;
    look.environment.tint = Rgb(1, 0.8f, 0.6f);
    const RelitScene captured = world.relit({}), changed = world.relit(look);
    const auto factors = groupFactors(captured, look);
    ASSERT_TRUE(factors);
    FrameOptions options;
    options.samplesPerPixel = 4;
    Progress progress;
    const auto ground = [&](const std::set<int>& groups) {
        return std::make_shared<const PlateGround>(
            plateGround(captured, world.cameras[0], groups, false, options, progress));
    };
    const PlateLight quick = plateLight(ground(factors->changed()), *factors),
                     whole = plateLight(ground({}), changed, world.cameras[0], options, progress);
    const std::vector<Rgb> quickly = steadied({&quick, &world.cameras[0]}, {}),
                           wholly = steadied({&whole, &world.cameras[0]}, {});
    // Another tint draws other samples of the environment: the rest is their noise.
    double quickSum = 0, wholeSum = 0;
    std::vector<double> off;
    for (size_t p = 0; p < quickly.size(); ++p)
        for (int c = 0; c < 3; ++c) {
            off.push_back(double(quickly[p][c] / wholly[p][c] - 1));
            quickSum += double(quickly[p][c]);
            wholeSum += double(wholly[p][c]);
        }
    EXPECT_LT(test::rootMeanSquare(off), 0.02);
    EXPECT_NEAR(quickSum / wholeSum, 1, 1e-3);
    look.emitters[0].matrix = test::translation({0.1f, 0, 0});
    EXPECT_FALSE(groupFactors(captured, look));
    look = {};
    look.environment.yawDegrees = 5;
    EXPECT_FALSE(groupFactors(captured, look));
}

TEST(RelightPlate, WithoutAnEditIsThePlateBitForBit) {
    const PlateWorld world(2);
    const TemporaryFolder folder;
    const PlateRequest request = world.writePlate(folder, {Rgb(1.3f, 1, 0.8f), Rgb(1.3f, 1, 0.8f)});
    Relighting run(world, request, {});
    float saturation = 0;
    const Image plate = readPlate(folder / "plate.1001.exr", PlateCurve::automatic, saturation);
    EXPECT_EQ(run.relighter.relit(0, run.progress).image.pixels, plate.pixels);
}

TEST(RelightPlate, TheSameBitsWhicheverFramesCameBefore) {
    const PlateWorld world;
    const TemporaryFolder folder;
    const PlateRequest request = world.writePlate(folder);
    Relighting all(world, request, PlateWorld::dimmed(), 4), one(world, request, PlateWorld::dimmed(), 4);
    all.relighter.relit(0, all.progress);
    all.relighter.relit(1, all.progress);
    EXPECT_EQ(all.relighter.relit(3, all.progress).image.pixels, one.relighter.relit(3, one.progress).image.pixels);
}

TEST(RelightPlate, NeighboursSteadyTheLight) {
    const PlateWorld world;
    const TemporaryFolder folder;
    PlateRequest request = world.writePlate(folder);
    FrameOptions many;
    many.samplesPerPixel = 64;
    Progress progress;
    const Frame old = renderFrame(world.relit({}), world.cameras[2], many, progress),
                next = renderFrame(world.relit(PlateWorld::dimmed()), world.cameras[2], many, progress);
    const auto noise = [&](int neighbours) {
        request.neighbours = neighbours;
        Relighting run(world, request, PlateWorld::dimmed());
        run.options.denoise = false;
        run.options.samplesPerPixel = 1;
        PlateRelighter relighter(run.plate, request, run.looks, run.options, run.progress);
        const Image relit = relighter.relit(2, run.progress).image;
        float saturation = 0;
        const Image plate = readPlate(folder / "plate.1003.exr", PlateCurve::automatic, saturation);
        std::vector<double> off;
        for (size_t p = 0; p < relit.pixels.size(); ++p)
            if (old.depth[p] < 5 && old.emittersSeen[p][0].emitter < 0)
                off.push_back(double(relit.pixels[p].x / plate.pixels[p].x * old.beauty[p].x / next.beauty[p].x - 1));
        return test::rootMeanSquare(off);
    };
    const double alone = noise(0), among = noise(PlateRequest{}.neighbours);
    EXPECT_GT(alone, 0.005);
    EXPECT_LT(among, 0.68 * alone);
}

TEST(RelightPlate, FollowsAPlateThatBreathesAndAStillOneNot) {
    const PlateWorld world(8);
    const TemporaryFolder folder;
    std::vector<Rgb> gains;
    for (int i = 0; i < 8; ++i) gains.push_back(Rgb(1.2f, 1, 0.9f) * (1 + 0.05f * std::sin(0.9f * float(i))));
    Relighting breathing(world, world.writePlate(folder, gains), PlateWorld::dimmed());
    EXPECT_TRUE(breathing.relighter.gains().breathes);
    for (int i = 0; i < 8; ++i)
        for (int c = 0; c < 3; ++c)
            EXPECT_NEAR(breathing.relighter.gains().at(1001 + i)[c] / gains[size_t(i)][c], 1, 0.01) << i;
    const TemporaryFolder quiet;
    Relighting still(world, world.writePlate(quiet, std::vector<Rgb>(8, Rgb(1.2f, 1, 0.9f))), PlateWorld::dimmed());
    EXPECT_FALSE(still.relighter.gains().breathes);
    EXPECT_NEAR(still.relighter.gains().at(1004).x, 1.2f, 0.01f);
    EXPECT_NEAR(still.relighter.gains().at(1004).z, 0.9f, 0.01f);
}

TEST(RelightPlate, LeavesWhatIsHeldOutBitForBit) {
    const PlateWorld world(3);
    const TemporaryFolder folder;
    PlateRequest request = world.writePlate(folder, std::vector<Rgb>(3, Rgb(1.31f, 1.01f, 0.83f)));
    for (int i = 0; i < 3; ++i) {
        Image matte(64, 48);
        for (int y = 12; y < 40; ++y)
            for (int x = 20 + 3 * i; x < 30 + 3 * i; ++x) matte.at(x, y) = Rgb(y < 13 ? 0.5f : 1.0f);
        writeImage(folder / fmt::format("matte.{}.exr", 1001 + i), matte);
    }
    request.matte = folder / "matte.####.exr";
    Relighting run(world, request, PlateWorld::dimmed());
    const RelitPlate relit = run.relighter.relit(1, run.progress);
    float saturation = 0;
    const Image plate = readPlate(folder / "plate.1002.exr", PlateCurve::automatic, saturation);
    for (int y = 13; y < 40; ++y)
        for (int x = 23; x < 33; ++x) ASSERT_EQ(relit.image.at(x, y), plate.at(x, y));
    EXPECT_NE(relit.image.at(10, 40), plate.at(10, 40));
    EXPECT_FALSE(relit.matteLight);

    request.relightMatte = true;
    Relighting lit(world, request, PlateWorld::dimmed());
    const RelitPlate actor = lit.relighter.relit(1, lit.progress);
    ASSERT_TRUE(actor.matteLight);
    EXPECT_LT(std::abs(actor.matteLight->place.foot.z), 0.02f);
    EXPECT_GT(actor.matteLight->place.middle.z, 0.1f);
    // The light from above fell to a quarter in red and stayed in blue.
    const MatteLight& there = *actor.matteLight;
    EXPECT_LT(there.after[4].x, 0.9f * there.before[4].x);
    EXPECT_NEAR(there.after[4].z, there.before[4].z, 0.01f * there.before[4].z);
    EXPECT_NE(matteLightJson(1002, there, DVec3(0)).find("\"frame\": 1002"), std::string::npos);
}

TEST(MatteFactors, FollowAnUprightCylinder) {
    // Seen along +Y, so that +X is to the right; light from the right doubles.
    const Camera camera = test::cameraAt({0, -4, 1}, {0, 0, 1}, 41, 20, 40);
    MatteLight light;
    light.place.middle = {0, 0, 1};
    light.before.fill(Rgb(1));
    light.after = light.before;
    light.after[0] = Rgb(2);
    std::vector<float> matte(41 * 20, 0);
    for (int y = 5; y < 15; ++y)
        for (int x = 10; x < 31; ++x) matte[size_t(y) * 41 + size_t(x)] = 1;
    const std::vector<Rgb> factor = matteFactors(light, camera, matte);
    const auto at = [&](int x, int y) { return factor[size_t(y) * 41 + size_t(x)].x; };
    EXPECT_EQ(at(20, 2), 1);
    EXPECT_NEAR(at(20, 10), 1, 1e-4);
    EXPECT_NEAR(at(10, 10), 1, 1e-4);
    const float u = 10.0f / 10.5f;
    EXPECT_NEAR(at(30, 10), 1 + u * u, 1e-3);
}

TEST(RelightPlate, AMatteIsRelitAfterAFrameWithoutAnEdit) {
    const PlateWorld world(3);
    const TemporaryFolder folder;
    PlateRequest request = world.writePlate(folder);
    Image matte(64, 48);
    for (int y = 12; y < 40; ++y)
        for (int x = 20; x < 30; ++x) matte.at(x, y) = Rgb(1);
    writeImage(folder / "matte.exr", matte);
    request.matte = folder / "matte.exr";
    request.relightMatte = true;
    Look look;
    look.keys = {{1001, {}, KeyEase::hold}, {1003, PlateWorld::dimmed(), KeyEase::hold}};
    Relighting run(world, request, look);
    run.looks.at(1001, run.progress);
    EXPECT_FALSE(run.relighter.relit(0, run.progress).matteLight);
    const RelitScene* captured = &run.looks.captured(run.progress);
    const RelitPlate relit = run.relighter.relit(2, run.progress);
    EXPECT_EQ(&run.looks.captured(run.progress), captured);
    ASSERT_TRUE(relit.matteLight);
    EXPECT_LT(relit.matteLight->after[4].x, 0.9f * relit.matteLight->before[4].x);
}

TEST(RelightPlate, NamesFramesThatLackSomething) {
    const PlateWorld world(4);
    const TemporaryFolder folder;
    PlateRequest request = world.writePlate(folder);
    std::filesystem::remove(folder / "plate.1002.exr");
    Image other(64, 48);
    writeImage(folder / "plate.1006.exr", other);
    writeImage(folder / "plate.1007.exr", other);
    Progress progress;
    const Plate plate = openPlate(world.shot.capture, request, progress);
    ASSERT_EQ(plate.frames.size(), 3u);
    ASSERT_EQ(plate.faults.size(), 2u);
    EXPECT_NE(plate.faults[0].find("no camera for frames 1006 to 1007"), std::string::npos) << plate.faults[0];
    EXPECT_NE(plate.faults[1].find("frames 1002, 1005 are missing"), std::string::npos) << plate.faults[1];
    // A frame of another size is refused by itself.
    writeImage(folder / "plate.1003.exr", Image(32, 24));
    request.match = PlateMatching::off;
    Relighting run(world, request, PlateWorld::dimmed());
    EXPECT_THROW(run.relighter.relit(1, run.progress), Error);
    // Numbers that never meet are an error that says both.
    request.track.offset = 500;
    EXPECT_THROW(openPlate(world.shot.capture, request, progress), Error);
}

TEST(RelightPlate, ACameraThatLeavesTheCaptureKeepsThePlate) {
    PlateWorld world(1);
    world.cameras[0] = test::cameraAt({0, -3, 1.6}, {0, -9, 3}, 64, 48, 70);
    const TemporaryFolder folder;
    const PlateRequest request = world.writePlate(folder);
    Relighting run(world, request, PlateWorld::dimmed());
    const RelitPlate relit = run.relighter.relit(0, run.progress);
    EXPECT_EQ(relit.covered, 0);
    float saturation = 0;
    EXPECT_EQ(relit.image.pixels, readPlate(folder / "plate.1001.exr", PlateCurve::automatic, saturation).pixels);
}

TEST(IrradianceCube, OfAConstantEnvironmentIsItAndOfAnEmitterItsFormFactor) {
    Mesh mesh = test::squareAbove(1, 0, 0, 2);
    const Scene scene = test::sceneOf(mesh);
    const Estimate estimate =
        test::matteEstimate(scene, Rgb(0.5f), Rgb(0.25f), test::emittersOf(scene, {{0, 1}}, {Rgb(4)}));
    Look off;
    EmitterLook dark;
    dark.id = "emitter-1";
    dark.enabled = false;
    off.emitters.push_back(dark);
    const RelitScene sky = test::relitOf(scene, estimate, off), lit = test::relitOf(scene, estimate);
    const IrradianceCube before = irradianceCube(sky, {0, 0, 0}, 256, 1),
                         after = irradianceCube(lit, {0, 0, 0}, 256, 1);
    EXPECT_NEAR(before[5].x, 0.25f, 2e-3);
    // The square hides as much of the sky as it covers.
    const double factor = test::centredSquareFormFactor(1, 2);
    EXPECT_NEAR(before[4].x, 0.25 * (1 - factor), 3e-3);
    EXPECT_NEAR(after[4].x - before[4].x, 4 * factor, 5e-3);
    EXPECT_NEAR(irradianceFor(after, glm::normalize(Vec3(1, 0, 1))).x, 0.5f * (after[0].x + after[4].x), 1e-5);
}

}  // namespace
}  // namespace relamp
