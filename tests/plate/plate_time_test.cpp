// A relit plate over time: light that is keyed, and colours that change from frame to frame.
#include <gtest/gtest.h>

#include "plate/plate_world.h"
#include "relight/model_confidence.h"

namespace relamp {
namespace {

using test::PlateWorld;
using test::Relighting;
using test::TemporaryFolder;

/// From the first frame's look to the last one's.
Look keyed(const Look& first, const Look& last) {
    Look look;
    look.keys = {{1001, first, KeyEase::linear}, {1005, last, KeyEase::linear}};
    return look;
}

Look movedBy(float x) {
    Look look;
    EmitterLook emitter;
    emitter.id = "emitter-1";
    emitter.matrix = test::translation({x, 0, 0});
    look.emitters.push_back(emitter);
    return look;
}

Look poweredBy(const Rgb& scale) {
    Look look = PlateWorld::dimmed();
    look.emitters[0].powerScale = scale;
    return look;
}

/// The third frame of many samples.
Frame thirdOf(const PlateWorld& world, const Look& look) {
    FrameOptions many;
    many.samplesPerPixel = 64;
    Progress progress;
    return renderFrame(world.relit(look), world.cameras[2], many, progress);
}

/// Root mean square of the relit third frame against many samples, with one sample a pixel. `old` and `next`: it
/// before and after the edit.
double noiseOf(const PlateWorld& world, const TemporaryFolder& folder, PlateRequest request, const Look& look,
               int neighbours, const Frame& old, const Frame& next) {
    request.neighbours = neighbours;
    Relighting run(world, request, look);
    run.options.denoise = false;
    run.options.samplesPerPixel = 1;
    PlateRelighter relighter(run.plate, request, run.looks, run.options, run.progress);
    const Image relit = relighter.relit(2, run.progress).image;
    float saturation = 0;
    const Image plate = readPlate(folder / "plate.1003.exr", PlateCurve::automatic, saturation);
    std::vector<double> off;
    for (size_t p = 0; p < relit.pixels.size(); ++p)
        if (old.depth[p] < 5 && old.emittersSeen[p][0].emitter < 0 && next.emittersSeen[p][0].emitter < 0)
            off.push_back(double(relit.pixels[p].x / plate.pixels[p].x * old.beauty[p].x / next.beauty[p].x - 1));
    return test::rootMeanSquare(off);
}

TEST(PlateTime, AKeyedLightIsSteadiedAsAStillOneIs) {
    const PlateWorld world;
    const TemporaryFolder folder;
    PlateRequest request = world.writePlate(folder);
    request.match = PlateMatching::off;
    const Frame old = thirdOf(world, {});
    for (const Look& look : {keyed(movedBy(0.3f), movedBy(0.34f)), keyed(poweredBy(Rgb(0.2f)), poweredBy(Rgb(0.6f)))}) {
        const Frame next = thirdOf(world, Relighting(world, request, look).looks.lookAt(1003));
        const double alone = noiseOf(world, folder, request, look, 0, old, next),
                     among = noiseOf(world, folder, request, look, PlateRequest{}.neighbours, old, next);
        EXPECT_GT(alone, 0.005);
        EXPECT_LT(among, 0.68 * alone);
    }
}

TEST(PlateTime, KeyedLightHasTheSameBitsWhicheverFramesCameBefore) {
    const PlateWorld world;
    const TemporaryFolder folder;
    PlateRequest request = world.writePlate(folder, {}, 1);
    request.match = PlateMatching::off;
    Look held = keyed({}, movedBy(0.2f));
    held.keys[0].ease = KeyEase::hold;  // nothing is edited before the last frame
    for (const Look& look : {keyed(movedBy(0.1f), movedBy(0.3f)), keyed({}, poweredBy(Rgb(0.3f))), held}) {
        Relighting all(world, request, look, 4), one(world, request, look, 4);
        for (const size_t frame : {0, 1, 2, 3}) all.relighter.relit(frame, all.progress);
        EXPECT_EQ(all.relighter.relit(4, all.progress).image.pixels, one.relighter.relit(4, one.progress).image.pixels);
    }
}

TEST(PlateTime, EachOfManyFramesHasAGainOfItsOwn) {
    constexpr int count = 28;
    const PlateWorld world(count);
    const TemporaryFolder folder;
    std::vector<Rgb> gains;
    for (int i = 0; i < count; ++i) gains.push_back(Rgb(1.1f, 1, 0.9f) * (i % 3 == 1 ? 1.3f : 1.0f));
    PlateRequest request = world.writePlate(folder, gains, 2);
    for (const PlateMatching kind : {PlateMatching::frames, PlateMatching::automatic}) {
        request.match = kind;
        Relighting run(world, request, {}, 4);
        for (int i = 0; i < count; ++i) {
            const Rgb gain = run.relighter.relit(size_t(i), run.progress).gain;
            for (int c = 0; c < 3; ++c) EXPECT_NEAR(gain[c] / gains[size_t(i)][c], 1, 0.015) << i;
        }
        // A part of the sequence has the same.
        Relighting part(world, request, {}, 4);
        EXPECT_EQ(part.relighter.relit(17, part.progress).gain, run.relighter.relit(17, run.progress).gain);
    }
}

/// Of the red channel: relit over plate.
float factorAt(const Image& relit, const Image& plate, size_t p) { return relit.pixels[p].x / plate.pixels[p].x; }

TEST(PlateUnsure, TheFactorComesFromConfidentSurfacesAroundOrIsOne) {
    PlateWorld world(1);
    const TemporaryFolder folder;
    PlateRequest request = world.writePlate(folder);
    request.match = PlateMatching::off;
    // The ball was filled in.
    for (size_t v = 0; v < world.scene.mesh.vertexCount(); ++v)
        if (world.scene.mesh.positions[v].z > 0.02f) world.shot.estimate.reflectance.confidence[v] = 0;
    std::map<PlateUnsure, Image> relit;
    for (const PlateUnsure unsure : {PlateUnsure::model, PlateUnsure::smooth, PlateUnsure::keep}) {
        request.unsure = unsure;
        Relighting run(world, request, PlateWorld::dimmed());
        relit[unsure] = run.relighter.relit(0, run.progress).image;
    }
    float saturation = 0;
    const Image plate = readPlate(folder / "plate.1001.exr", PlateCurve::automatic, saturation);
    const RelitScene captured = world.relit({});
    const std::vector<float> confidence = modelConfidence(captured, world.cameras[0], 0, 48);
    Progress progress;
    const Frame seen = renderFrame(captured, world.cameras[0], {}, progress);
    size_t unsure = 0, sure = 0;
    double smoothed = 0;
    float low = 1, high = 0;
    for (const bool first : {true, false})
        for (size_t p = 0; p < plate.pixels.size(); ++p) {
            if (p == 5 || seen.depth[p] > 1e29f || seen.emittersSeen[p][0].emitter >= 0) continue;
            const float smooth = factorAt(relit[PlateUnsure::smooth], plate, p);
            if (first && confidence[p] > 0.6f) {
                ++sure;
                low = std::min(low, smooth), high = std::max(high, smooth);
                ASSERT_EQ(relit[PlateUnsure::smooth].pixels[p], relit[PlateUnsure::model].pixels[p]);
                ASSERT_EQ(relit[PlateUnsure::keep].pixels[p], relit[PlateUnsure::model].pixels[p]);
            } else if (!first && confidence[p] == 0) {
                ++unsure;
                smoothed += double(smooth);
                ASSERT_EQ(relit[PlateUnsure::keep].pixels[p], plate.pixels[p]);
                ASSERT_GT(smooth, low * 0.999f);
                ASSERT_LT(smooth, high * 1.001f);
            }
        }
    EXPECT_GT(sure, 500u);
    EXPECT_GT(unsure, 50u);
    EXPECT_LT(smoothed / double(unsure), 0.95);
}

}  // namespace
}  // namespace relamp
