#include "shot/ratio_frame.h"

#include <gtest/gtest.h>

namespace relamp {
namespace {

/// One pixel of each model and of the photograph, on one surface.
struct Pixel {
    Frame captured, look;
    Image photograph{1, 1};
    RatioOptions options{Ratio::quotient};
    Pixel(float photo, float before, float after) {
        for (Frame* frame : {&captured, &look}) {
            const float value = frame == &look ? after : before;
            frame->width = frame->height = 1;
            frame->beauty = {Rgb(value)};
            frame->world = {Rgb(value / 4)};
            frame->byEmitter = {{Rgb(value * 3 / 4)}};
            frame->depth = {2};
            frame->position = {Vec3(0, 0, 1)};
        }
        photograph.pixels[0] = Rgb(photo);
    }
    float relit() {
        applyRatio(options, photograph, 0, captured, look);
        return look.beauty[0].x;
    }
};

TEST(RatioFrame, MultipliesThePhotographByTheChangeOfTheModel) {
    EXPECT_NEAR(Pixel(0.3f, 0.2f, 0.6f).relit(), 0.9f, 1e-6);
    EXPECT_NEAR(Pixel(0.3f, 0.2f, 0.05f).relit(), 0.075f, 1e-6);
}

TEST(RatioFrame, IsThePhotographWhereNothingChanges) {
    EXPECT_EQ(Pixel(0.37f, 0.2f, 0.2f).relit(), 0.37f);
    Pixel difference(0.37f, 0.2f, 0.2f);
    difference.options.kind = Ratio::difference;
    EXPECT_EQ(difference.relit(), 0.37f);
}

TEST(RatioFrame, AddsTheChangeOfTheModel) {
    Pixel brighter(0.3f, 0.2f, 0.6f), darker(0.3f, 0.9f, 0.1f);
    brighter.options.kind = darker.options.kind = Ratio::difference;
    EXPECT_NEAR(brighter.relit(), 0.7f, 1e-6);
    EXPECT_EQ(darker.relit(), 0);  // never below black
}

TEST(RatioFrame, TrustsTheModelMoreTheMoreTheLightChanges) {
    // Photograph 1.5 times its model; the light grows 8, 80, 8000 times.
    EXPECT_NEAR(Pixel(0.15f, 0.1f, 0.8f).relit(), 1.2f, 1e-5);
    EXPECT_NEAR(Pixel(0.15f, 0.1f, 8).relit(), 8 * std::pow(1.5f, 0.1f), 1e-4);
    EXPECT_NEAR(Pixel(0.15f, 0.1f, 800).relit(), 800, 0.5);
    EXPECT_NEAR(Pixel(150, 100, 0.1f).relit(), 0.1f, 0.001);
}

TEST(RatioFrame, KeepsTheModelWhereAnotherSurfaceIsSeenOrThePhotographIsNotUsable) {
    Pixel moved(0.3f, 0.2f, 0.6f), gone(0.3f, 0.2f, 0.6f), masked(0.3f, 0.2f, 0.6f);
    moved.look.position[0].x = 0.1f;
    EXPECT_FLOAT_EQ(moved.relit(), 0.6f);
    gone.look.depth[0] = 1e30f;
    EXPECT_FLOAT_EQ(gone.relit(), 0.6f);
    masked.photograph.usable = {0};
    EXPECT_FLOAT_EQ(masked.relit(), 0.6f);
}

TEST(RatioFrame, AddsToClippedPixelsBecauseTheirQuotientIsUnknown) {
    Pixel clipped(1, 4, 4.5f);
    clipped.options.saturation = 0.99f;
    EXPECT_NEAR(clipped.relit(), 1.5f, 1e-6);
}

TEST(RatioFrame, GroupsStillAddUpToTheQuotient) {
    Pixel pixel(0.3f, 0.2f, 0.6f);
    const float relit = pixel.relit();
    EXPECT_NEAR(pixel.look.world[0].x + pixel.look.byEmitter[0][0].x, relit, 1e-6);
    EXPECT_NEAR(pixel.look.world[0].x / relit, 0.25f, 1e-5);
}

TEST(RatioFrame, StaysFiniteWhereTheModelWasBlack) {
    Pixel black(0.3f, 0, 0.6f);
    black.options.floor = 1e-3f;
    EXPECT_TRUE(std::isfinite(black.relit()));
    EXPECT_LT(black.look.beauty[0].x, 1.0f);
}

}  // namespace
}  // namespace relamp
