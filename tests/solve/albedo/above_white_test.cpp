#include "solve/albedo/above_white.h"

#include <gtest/gtest.h>

namespace relamp {
namespace {

/// `count` vertices of one component under irradiance 2 with an albedo of 0.4.
struct Seen {
    MatteObservations matte;
    Irradiance irradiance;
    std::vector<uint32_t> component;
    explicit Seen(size_t count = 50) : component(count, 0) {
        matte.componentGlossy = {0};
        for (uint32_t v = 0; v < count; ++v) {
            matte.vertices.push_back(v);
            matte.radiance.push_back(Rgb(0.8f));
            irradiance.value.push_back(Rgb(2));
            irradiance.sigma.push_back(Rgb(0.01f));
        }
    }
    std::vector<Rgb> reflected() const { return reflectedAtMost(matte, irradiance.value, component); }
};

TEST(AboveWhite, SurfacesSendWhatTheyShow) {
    const Seen seen;
    EXPECT_EQ(seen.reflected(), seen.matte.radiance);
    EXPECT_EQ(unsureAboveWhite(seen.matte, seen.irradiance).sigma, seen.irradiance.sigma);
}

TEST(AboveWhite, AnEmitterShownPastItsEdgeIsNotSent) {
    Seen seen;
    seen.matte.radiance[7] = Rgb(0.8f, 0.8f, 20);
    EXPECT_EQ(seen.reflected()[7], Rgb(0.8f, 0.8f, 0.95f * 2));
    const Irradiance unsure = unsureAboveWhite(seen.matte, seen.irradiance);
    EXPECT_GE(unsure.sigma[7].x, 10 * unsure.value[7].x);  // one channel shows that all are mixed
    EXPECT_EQ(unsure.sigma[8], seen.irradiance.sigma[8]);
}

TEST(AboveWhite, LightFoundTooWeakIsNoEmitter) {
    Seen seen;
    for (Rgb& y : seen.matte.radiance) y = Rgb(3);  // every surface needs 1.5
    EXPECT_EQ(seen.reflected(), seen.matte.radiance);
    EXPECT_EQ(unsureAboveWhite(seen.matte, seen.irradiance).sigma, seen.irradiance.sigma);
}

TEST(AboveWhite, MetalsSendWhatTheyShow) {
    Seen seen;
    seen.component[7] = 1;
    seen.matte.componentGlossy = {0, 2};
    seen.matte.radiance[7] = Rgb(20);
    EXPECT_EQ(seen.reflected()[7], Rgb(20));
}

TEST(AboveWhite, NothingSeenIsNoFault) {
    const Seen none(0);
    EXPECT_TRUE(none.reflected().empty());
    EXPECT_TRUE(unsureAboveWhite(none.matte, none.irradiance).value.empty());
}

}  // namespace
}  // namespace relamp
