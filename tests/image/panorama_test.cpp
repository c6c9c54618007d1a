#include "image/panorama.h"

#include <gtest/gtest.h>

#include "image/environment_map.h"
#include "image/pull_push.h"

namespace relamp {
namespace {

Image numbered(int width) {
    Image map(width, width / 2);
    for (int y = 0; y < map.height; ++y)
        for (int x = 0; x < map.width; ++x) map.at(x, y) = Rgb(float(x), float(y), float(x + y)) / float(width);
    return map;
}

TEST(Panorama, ShowsItsTexelsAndWhatLiesBetween) {
    const Image map = numbered(64);
    const Panorama panorama(map);
    for (const Vec2& at : {Vec2(0.3f, 0.4f), Vec2(0.001f, 0.6f), Vec2(0.999f, 0.2f), Vec2(0.7f, 0.999f)}) {
        const Vec3 d = directionFromLatLong(at);
        EXPECT_LT(glm::length(panorama.radiance(d) - environmentRadiance(map, d)), 1e-3f) << at.x << " " << at.y;
    }
    EXPECT_LT(glm::length(panorama.image().at(17, 5) - map.at(17, 5)), 1e-3f);
}

TEST(Panorama, HoldsASunAndTheShadeBesideIt) {
    Image map(64, 32, Rgb(0.25f));
    map.at(10, 3) = Rgb(4e6f, 2e6f, 1e6f);
    map.at(20, 3) = Rgb(-1);
    const Panorama panorama(map);
    EXPECT_NEAR(panorama.at(10, 3).x / 4e6f, 1, 1e-3);
    EXPECT_NEAR(panorama.at(30, 3).x, 0.25, 2.5e-3);
    EXPECT_EQ(panorama.at(20, 3), Rgb(0));
}

TEST(Panorama, IsHalvedUntilItIsSmallEnough) {
    const Panorama panorama(numbered(64), 20);
    EXPECT_EQ(panorama.width(), 16);
    EXPECT_EQ(panorama.height(), 8);
    EXPECT_NEAR(panorama.at(0, 0).x, 1.5f / 64, 1e-4) << "mean of columns 0 to 3";
}

TEST(PullPush, KeepsWhatIsKnownAndFillsHolesBetween) {
    Image image(64, 32, Rgb(7));
    std::vector<float> weight(image.pixels.size(), 1);
    for (int y = 0; y < 32; ++y)
        for (int x = 0; x < 64; ++x) {
            image.at(x, y) = Rgb(x < 32 ? 1 : 2);
            if (x > 24 && x < 40) image.at(x, y) = Rgb(1e6f), weight[size_t(y * 64 + x)] = 0;
        }
    pullPush(image, weight);
    EXPECT_EQ(image.at(24, 9), Rgb(1));
    EXPECT_EQ(image.at(40, 9), Rgb(2));
    float before = 1;
    for (int x = 25; x < 40; ++x) {
        EXPECT_GE(image.at(x, 9).x, before - 1e-5f) << x;
        EXPECT_LT(image.at(x, 9).x - before, 0.35f) << "no jump at " << x;
        before = image.at(x, 9).x;
    }
}

TEST(PullPush, GoesRoundFromTheLastColumnToTheFirst) {
    Image image(64, 32, Rgb(1));
    std::vector<float> weight(image.pixels.size(), 1);
    for (int y = 0; y < 32; ++y)
        for (int x = 0; x < 64; ++x) {
            if (x >= 32) image.at(x, y) = Rgb(3);
            if (x < 4) image.at(x, y) = Rgb(0), weight[size_t(y * 64 + x)] = 0;
        }
    pullPush(image, weight);
    EXPECT_GT(image.at(0, 9).x, 1.8f) << "beside column 63";
    EXPECT_LT(image.at(3, 9).x, 1.8f) << "beside column 4";
}

TEST(PullPush, EvensOutWhatIsHardlyKnown) {
    Image image(64, 32);
    for (int y = 0; y < 32; ++y)
        for (int x = 0; x < 64; ++x) image.at(x, y) = Rgb(x % 2 ? 3 : 1);
    pullPush(image, std::vector<float>(image.pixels.size(), 1 / 16.0f));
    for (int x = 8; x < 56; ++x) EXPECT_NEAR(image.at(x, 9).x, 2, 0.15) << x;
}

}  // namespace
}  // namespace relamp
