#include "brdf/lobe_weights.h"

#include <gtest/gtest.h>

namespace relamp {
namespace {

const StoredWeights stored{{Rgb(0.1f), Rgb(0.2f), Rgb(0.4f)}, {Rgb(1), Rgb(0), Rgb(0.5f)}};

TEST(LobeWeights, AtAVertexAreThoseStoredForIt) {
    const LobesAtVertex at(stored, 2);
    EXPECT_EQ(at.size(), 2u);
    EXPECT_EQ(at.albedo(), Rgb(0.4f));
    EXPECT_EQ(at[1], Rgb(0.5f));
    EXPECT_TRUE(at.known());
    EXPECT_FALSE(LobesAtVertex(stored, 3).known());
}

TEST(LobeWeights, AtAHitAreInterpolatedBetweenItsCorners) {
    for (uint32_t k = 0; k < 3; ++k) {
        const LobesAtHit corner(stored, {0, 1, 2}, Vec2(k == 1, k == 2));
        for (size_t lobe = 0; lobe < 2; ++lobe) EXPECT_EQ(corner[lobe], stored[lobe][k]) << k;
    }
    const LobesAtHit middle(stored, {0, 1, 2}, Vec2(0.25f, 0.5f));
    EXPECT_NEAR(middle.albedo().x, 0.25f * 0.1f + 0.25f * 0.2f + 0.5f * 0.4f, 1e-6f);
    EXPECT_NEAR(middle[1].y, 0.25f * 1 + 0.5f * 0.5f, 1e-6f);
}

TEST(LobeWeights, WithoutLobesThereIsNoAlbedo) {
    const StoredWeights none;
    EXPECT_EQ(LobesAtVertex(none, 0).albedo(), Rgb(0));
    EXPECT_FALSE(LobesAtVertex(none, 0).known());
}

}  // namespace
}  // namespace relamp
