// The colour that a swatch opens, in numbers.
#include "image/image_io.h"
#include "ui/panels/panel_harness.h"
#include "widgets.h"

namespace relamp::ui::test {
namespace {

struct Picker : Panels {
    std::string id;
    size_t entries = 0;
    Picker() : Panels(360, 420) {
        openSolved();
        id = editor->emitters()[0].id;
        entries = editor->history().entries().size();
        frame([this] {
            colourLook(*editor, "colour", "Colour of it", light(), 20, "", [this](Look& look, const Rgb& radiance) {
                setRadiance(look, *editor->estimate(), id, radiance);
            });
        });
        frames(2);
        click({16, 16});
    }
    Rgb light() const { return editor->emitter(id)->radiance; }
    std::optional<ImVec2> field(const char* row, const char* part) {
        const ImVector<ImGuiPopupData>& open = ImGui::GetCurrentContext()->OpenPopupStack;
        if (open.empty()) return {};
        return find(ImHashStr(part, 0, ImHashStr(row, 0, open.back().Window->ID)));
    }
    size_t made() const { return editor->history().entries().size() - entries; }
};

TEST(ColourPicker, aTypedHexadecimalIsOneEntryAndTheBrightnessStays) {
    Picker p;
    const float before = luminance(p.light());
    const auto hex = p.field("##hex", "##Text");
    ASSERT_TRUE(hex);
    p.click(*hex);
    for (int i = 0; i < 8; ++i) p.key(keyRight);
    for (int i = 0; i < 8; ++i) p.key(keyBackspace);
    p.type("FF8000");
    p.key(keyEnter);
    const Rgb now = p.light() / std::max(maxChannel(p.light()), 1e-9f);
    EXPECT_NEAR(now.x, 1, 1e-3f);
    EXPECT_NEAR(now.y, srgbDecode(128 / 255.0f), 1e-3f);
    EXPECT_NEAR(now.z, 0, 1e-3f);
    EXPECT_NEAR(luminance(p.light()), before, 1e-3f * before);
    EXPECT_EQ(p.made(), 1u);
    EXPECT_EQ(p.editor->history().entries().back().label, "Colour of it");
}

TEST(ColourPicker, aDragOfTheSaturationKeepsHueAndBrightness) {
    Picker p;
    p.editor->edit("Orange", [&](Look& look) { setRadiance(look, *p.editor->estimate(), p.id, Rgb(4, 2, 1)); });
    p.frames(2);
    const float before = luminance(p.light());
    const auto saturation = p.field("##hsv", "##Y");
    ASSERT_TRUE(saturation);
    p.mouse(*saturation);
    p.frames(2);
    p.press(true);
    for (int i = 1; i <= 30; ++i) p.mouse({saturation->x - 3.0f * float(i), saturation->y}), p.frames(1);
    p.press(false);
    p.frames(2);
    const Rgb now = p.light();
    EXPECT_NEAR(luminance(now), before, 1e-3f * before);
    EXPECT_GT(now.z / now.x, 0.3f) << "paler";
    EXPECT_GT(now.x, now.y);
    EXPECT_GT(now.y, now.z);
    EXPECT_EQ(p.made(), 2u);
}

}  // namespace
}  // namespace relamp::ui::test
