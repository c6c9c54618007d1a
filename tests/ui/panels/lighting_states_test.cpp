// The list of lighting states above the table of lights, and the mix of two of them.
#include <fstream>
#include <nlohmann/json.hpp>

#include "edit/state_edits.h"
#include "ui/panels/panel_harness.h"

namespace relamp::ui::test {
namespace {

/// The solved room as if its photographs had been taken with its light on and, at a half and none, in two more states.
struct SeveralStates : Panels {
    std::string lamp;
    explicit SeveralStates(bool dark = false) {
        openSolved();
        lamp = editor->emitters()[0].id;
        const std::filesystem::path shot = folder / "states.relamp";
        std::filesystem::copy(PaintedRoom::get().shot, shot, std::filesystem::copy_options::recursive);
        nlohmann::json document;
        std::ifstream(shot / "shot.json") >> document;
        for (const auto& [name, level] : {std::pair{"on", 1.0}, {"half", 0.5}, {"off", 0.0}})
            document["states"].push_back(
                {{"name", name}, {"views", {"a"}}, {"emitters", {{{"id", lamp}, {"level", level}}}}});
        // Without its light the room has no sky either.
        if (dark) document["states"][2]["environment"] = "none";
        std::ofstream(shot / "shot.json") << document.dump();
        editor->openNow(shot);
        until([&] { return !editor->job() && editor->estimate() && editor->estimate()->states.size() == 3; });
        windowSize(420, 260);
        frame([this] { drawEmittersPanel(*editor); });
        frames(2);
    }
    /// Opens a list and chooses its `index`th row.
    void choose(const char* list, int index) {
        const auto at = find(idOf("test", {list}));
        ASSERT_TRUE(at) << list;
        click(*at);
        ImGuiWindow* rows = ImGui::GetCurrentContext()->OpenPopupStack.empty()
                                ? nullptr
                                : ImGui::GetCurrentContext()->OpenPopupStack.back().Window;
        ASSERT_NE(rows, nullptr) << list;
        const float row = ImGui::GetTextLineHeightWithSpacing();
        click({rows->Pos.x + 20, rows->Pos.y + ImGui::GetStyle().WindowPadding.y + row * (float(index) + 0.4f)});
    }
    EmitterState light() const { return *editor->emitter(lamp); }
};

TEST(LightingStates, oneThatIsChosenIsOneEntryAndUndoBringsTheOthersBack) {
    SeveralStates t;
    const Rgb full = t.light().radiance;
    const size_t entries = t.editor->history().entries().size();
    t.choose("##state", 2);
    EXPECT_EQ(t.editor->history().entries().size(), entries + 1);
    EXPECT_EQ(t.editor->history().entries().back().label, "State off");
    EXPECT_FALSE(t.light().enabled);
    t.choose("##state", 1);
    EXPECT_TRUE(t.light().enabled);
    EXPECT_NEAR(t.light().radiance.x / full.x, 0.5f, 1e-5f);
    EXPECT_EQ(shownState(t.editor->look(), *t.editor->estimate()), 1u);
    t.editor->undo();
    EXPECT_FALSE(t.light().enabled);
    t.editor->undo();
    EXPECT_TRUE(t.light().enabled);
    EXPECT_EQ(t.light().radiance, full);
    EXPECT_EQ(shownState(t.editor->look(), *t.editor->estimate()), 0u);
}

TEST(LightingStates, aDragMixesTwoAsOneEntry) {
    SeveralStates t;
    const Rgb full = t.light().radiance;
    t.choose("##mixed", 1);  // "off": the first end of the mix is not offered
    const size_t entries = t.editor->history().entries().size();
    const auto at = t.find(t.idOf("test", {"##mix"}));
    ASSERT_TRUE(at);
    t.mouse(*at);
    t.press(true);
    for (int i = 1; i <= 12; ++i) t.mouse({at->x + 5.0f * float(i), at->y}), t.frames(1);
    t.press(false);
    t.frames(2);
    EXPECT_EQ(t.editor->history().entries().size(), entries + 1);
    EXPECT_EQ(t.editor->history().entries().back().label, "Mix lighting states");
    const float mix = shownMix(t.editor->look(), *t.editor->estimate(), 0, 2);
    EXPECT_GT(mix, 0.1f);
    EXPECT_LT(mix, 0.9f);
    EXPECT_NEAR(t.light().radiance.x / full.x, 1 - mix, 1e-4f);
    EXPECT_FALSE(shownState(t.editor->look(), *t.editor->estimate()));
    t.editor->undo();
    EXPECT_EQ(t.light().radiance, full);
}

TEST(LightingStates, oneWithoutAnEnvironmentTakesItAwayAndUndoBringsItBack) {
    SeveralStates t(true);
    t.choose("##state", 2);
    EXPECT_EQ(t.editor->look().environment.state, "off");
    EXPECT_EQ(shownState(t.editor->look(), *t.editor->estimate()), 2u);
    t.choose("##state", 1);
    EXPECT_EQ(t.editor->look().environment, EnvironmentLook{});
    t.editor->undo();
    EXPECT_EQ(t.editor->look().environment.state, "off");
    t.editor->undo();
    EXPECT_EQ(t.editor->look().environment, EnvironmentLook{});
}

TEST(LightingStates, aShotOfOneStateHasNoList) {
    Panels t;
    t.openSolved();
    t.windowSize(420, 260);
    t.frame([&] { drawEmittersPanel(*t.editor); });
    EXPECT_FALSE(t.find(t.idOf("test", {"##state"}), 12));
}

TEST(LightingStates, anEditedColourAndPlaceAreKeptOrGoAsTheListSays) {
    SeveralStates t;
    t.editor->edit("Move", [&](Look& look) {
        moveEmitter(look, t.lamp, relamp::test::translation(Vec3(0.1f, 0, 0)));
        renameEmitter(look, t.lamp, "Ceiling");
    });
    t.choose("##state", 1);
    EXPECT_EQ(t.light().name, "Ceiling");
    EXPECT_NEAR(t.light().matrix[3].x, 0.1f, 1e-6f);
    Look look = t.editor->look();
    showLevels(look, *t.editor->estimate(), {1});
    ASSERT_EQ(look.emitters.size(), 1u) << "its name and its place stay";
    EXPECT_EQ(look.emitters[0].powerScale, Rgb(1));
}

}  // namespace
}  // namespace relamp::ui::test
