// Leaves whose division shows where their light is.
#include <gtest/gtest.h>

#include "solve/steps/steps.h"

namespace relamp {
namespace {

/// Fractions of the light: `parts` of a leaf that was divided, every other leaf gives 0.05.
std::vector<uint8_t> peaksOf(std::array<float, 4> parts, std::vector<uint32_t>& divided) {
    LightLeaves leaves = LightLeaves::uniform(2);
    const Leaf parent = leaves[5];
    leaves.split(5);
    std::vector<Rgb> fractions(leaves.size(), Rgb(0.05f));
    divided.clear();
    for (uint32_t i = 0; i < leaves.size(); ++i)
        if (leaves[i].level == parent.level + 1) divided.push_back(i);
    for (size_t k = 0; k < divided.size(); ++k) fractions[divided[k]] = Rgb(parts[k]);
    return peaksAmongBrothers(leaves, fractions);
}

TEST(Peaks, AreThePartsThatTakeALeafsLight) {
    std::vector<uint32_t> d;
    const std::vector<uint8_t> sun = peaksOf({0.02f, 0.3f, 0.02f, 0.02f}, d);
    ASSERT_EQ(d.size(), 4u);
    EXPECT_EQ((std::vector<uint8_t>{sun[d[0]], sun[d[1]], sun[d[2]], sun[d[3]]}), (std::vector<uint8_t>{0, 1, 0, 0}));
    EXPECT_EQ(std::count(sun.begin(), sun.end(), 1), 1);
    const std::vector<uint8_t> onBorder = peaksOf({0.2f, 0.02f, 0.17f, 0.01f}, d);
    EXPECT_EQ(onBorder[d[0]] + onBorder[d[2]], 2);
    const std::vector<uint8_t> window = peaksOf({0.1f, 0.12f, 0.09f, 0.1f}, d);
    EXPECT_EQ(std::count(window.begin(), window.end(), 1), 0);
}

TEST(Peaks, ASunOnTheMiddleOfALeafIsDividedOnceMore) {
    LightLeaves leaves = LightLeaves::uniform(2);
    leaves.split(5);
    const uint32_t sun = uint32_t(leaves.size()) - 1;
    std::vector<Rgb> fractions(leaves.size(), Rgb(0.01f));
    fractions[sun] = Rgb(0.6f);
    std::set<LeafCell> peaks;
    EXPECT_EQ(leavesToDivide(leaves, fractions, false, nullptr), std::vector<uint32_t>{});
    EXPECT_EQ(leavesToDivide(leaves, fractions, false, &peaks), std::vector<uint32_t>{sun});
    ASSERT_EQ(peaks.size(), 1u);
    const int level = leaves[sun].level;
    leaves.split(sun);
    const auto finest = [&](int at) {
        fractions.assign(leaves.size(), Rgb(0.01f));
        for (uint32_t i = 0; i < leaves.size(); ++i)
            if (leaves[i].level == at) fractions[i] = Rgb(0.15f);
    };
    finest(level + 1);
    const std::vector<uint32_t> quarters = leavesToDivide(leaves, fractions, false, &peaks);
    EXPECT_EQ(quarters.size(), 4u);
    EXPECT_EQ(peaks.size(), 1u) << "none of them is a peak";
    for (auto q = quarters.rbegin(); q != quarters.rend(); ++q) leaves.split(*q);
    finest(level + 2);
    EXPECT_EQ(leavesToDivide(leaves, fractions, false, &peaks), std::vector<uint32_t>{}) << "a window is even";
}

}  // namespace
}  // namespace relamp
