// Near-field beside distant-only: of a capture whose photographs are of several lighting states.
#include "report/compare.h"

#include <gtest/gtest.h>

#include "relight/relit_scene.h"
#include "shot/shot_file.h"
#include "support/known_world.h"

namespace relamp {
namespace {

TEST(Compare, DistantOnlyHasALightOfItsOwnForEachLightingState) {
    const test::TemporaryFolder folder;
    test::paintKnownWorld(folder / "room", true, 5, 12, false, false, {1, 0});
    CompareOptions options;
    options.solve = solveOptionsFor("draft");
    options.quality = "draft";
    Progress progress;
    const std::filesystem::path page = writeComparison(folder / "room", folder / "out", options, progress);
    const std::string html = test::TemporaryFolder::read(page);
    EXPECT_EQ(html.find("<script"), std::string::npos);
    for (const char* words : {"2 lighting states", "<small>lamp 1</small>", "<small>lamp 0</small>",
                              "environment below are those of <i>lamp 1</i>", ", lamp 0</h3>"})
        EXPECT_NE(html.find(words), std::string::npos) << words;

    const Shot near = openShot(folder / "out/near-field.relamp", false, progress),
               distant = openShot(folder / "out/distant-only.relamp", false, progress);
    ASSERT_EQ(near.estimate.emitters.emitters.size(), 1u);
    EXPECT_EQ(near.estimate.emitters.emitters[0].inState, (std::vector<float>{1, 0}));
    EXPECT_TRUE(near.estimate.otherEnvironments.empty());
    ASSERT_EQ(distant.estimate.states.size(), 2u);
    EXPECT_TRUE(distant.estimate.emitters.emitters.empty());
    ASSERT_EQ(distant.estimate.otherEnvironments.size(), 1u);
    EXPECT_NE(distant.estimate.states[0].environment, distant.estimate.states[1].environment);
    // The lamp's light comes from afar then, where it is on.
    const auto mean = [&](size_t state) {
        Rgb sum(0);
        for (const Rgb& cell : environmentOf(distant.estimate, distant.estimate.states[state])) sum += cell;
        return luminance(sum);
    };
    EXPECT_GT(mean(0), 1.1f * mean(1));
    // Both explain the state without the lamp, and near-field the one with it clearly better.
    const Reproduction &byNear = near.estimate.reproduction, &byDistant = distant.estimate.reproduction;
    ASSERT_EQ(byNear.views.size(), 10u);
    ASSERT_EQ(byDistant.views.size(), 10u);
    double gainOn = 0, gainOff = 0;
    for (size_t v = 0; v < 5; ++v) {
        gainOn += (byNear.views[v].psnr - byDistant.views[v].psnr) / 5;
        gainOff += (byNear.views[5 + v].psnr - byDistant.views[5 + v].psnr) / 5;
    }
    EXPECT_GT(gainOn, 3);
    EXPECT_GT(gainOn, gainOff);
}

}  // namespace
}  // namespace relamp
