#include "changed_parts.h"

#include "ui/panels/panel_harness.h"

namespace relamp::ui::test {
namespace {

bool holds(const ChangedPart& part, const ImVec2& low, const ImVec2& high) {
    return part.low.x <= low.x && part.low.y <= low.y && part.high.x >= high.x && part.high.y >= high.y;
}
float areaOf(const ChangedPart& part) { return (part.high.x - part.low.x) * (part.high.y - part.low.y); }

/// A column of numbers over an image.
struct Column : Panels {
    int number = 10;
    const ImTextureID image = textureId(77);
    ImVec2 numberLow, numberHigh, imageLow, imageHigh;
    ChangedParts parts;

    std::vector<ChangedPart> next(ImTextureID changing = textureId(99)) {
        frame([this] {
            for (int i = 0; i < 8; ++i) {
                ImGui::Text("%d", i == 3 ? number : i);
                if (i == 3) numberLow = ImGui::GetItemRectMin(), numberHigh = ImGui::GetItemRectMax();
            }
            ImGui::Image(image, {200, 100});
            imageLow = ImGui::GetItemRectMin(), imageHigh = ImGui::GetItemRectMax();
        });
        return parts.next(*ImGui::GetDrawData(), changing);
    }
};

TEST(ChangedParts, areTheWholeScreenAtFirstAndNothingWhereNothingChanges) {
    Column c;
    c.next();
    c.parts.forget();
    const std::vector<ChangedPart> first = c.next();
    ASSERT_EQ(first.size(), 1u);
    EXPECT_TRUE(holds(first[0], {0, 0}, ImGui::GetIO().DisplaySize));
    EXPECT_TRUE(c.next().empty());
}

TEST(ChangedParts, holdTheFieldThatChangesAlsoWhereItsTextGrows) {
    Column c;
    for (int i = 0; i < 3; ++i) c.next();
    for (const int number : {11, 12345, 7}) {
        c.number = number;
        const ImVec2 low = c.numberLow, high = c.numberHigh;  // what was there before
        const std::vector<ChangedPart> changed = c.next();
        ASSERT_EQ(changed.size(), 1u) << number;
        EXPECT_LT(areaOf(changed[0]), 2000) << number;
        // Both texts, without the empty rim about their letters.
        EXPECT_GE(changed[0].low.y, low.y - 2);
        EXPECT_LE(changed[0].high.y, high.y + 2);
        EXPECT_GE(changed[0].high.x, std::max(high.x, c.numberHigh.x) - 4);
    }
    EXPECT_TRUE(c.next().empty());
}

TEST(ChangedParts, holdTheImageThatIsNewInEachFrame) {
    Column c;
    for (int i = 0; i < 3; ++i) c.next(c.image);
    const std::vector<ChangedPart> changed = c.next(c.image);
    ASSERT_EQ(changed.size(), 1u);
    EXPECT_TRUE(holds(changed[0], c.imageLow, c.imageHigh));
    EXPECT_LT(areaOf(changed[0]), 1.1f * 200 * 100);
}

TEST(ChangedParts, areTheWholeScreenWhereAWindowComes) {
    Column c;
    for (int i = 0; i < 3; ++i) c.next();
    c.editor->fail("Trouble", "Something happened.");
    c.frames(3);
    const std::vector<ChangedPart> changed = c.next();
    ASSERT_EQ(changed.size(), 1u);
    EXPECT_TRUE(holds(changed[0], {0, 0}, ImGui::GetIO().DisplaySize));
}

}  // namespace
}  // namespace relamp::ui::test
