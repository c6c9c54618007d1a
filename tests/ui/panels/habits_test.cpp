// What hands expect of any editor: keys, menus, dialogs, hints, numbers.
#include "actions.h"
#include "gui.h"
#include "layout.h"
#include "panels/dialogs.h"
#include "panels/emitter_controls.h"
#include "panels/panels.h"
#include "ui/panels/panel_harness.h"

namespace relamp::ui::test {
namespace {

void drawMenus(Panels& p) {
    p.frame([&] {
        if (ImGui::BeginMainMenuBar()) {
            drawMenuBar(*p.editor);
            ImGui::EndMainMenuBar();
        }
    });
}

int openPopups() { return ImGui::GetCurrentContext()->OpenPopupStack.Size; }

TEST(Habits, escClosesAMenuAndNothingElse) {
    Panels p;
    p.openSolved();
    p.editor->state.selection.emitters = {p.editor->emitters()[0].id};
    drawMenus(p);
    p.frames(2);
    p.click({20, 8});
    ASSERT_EQ(openPopups(), 1);
    p.key(keyEscape);
    p.frames(2);
    EXPECT_EQ(openPopups(), 0);
    EXPECT_EQ(p.editor->state.selection.emitters.size(), 1u);
}

TEST(Habits, aClickThatOpensAMenuChoosesNothingInAShortWindow) {
    Panels p(900, 300);
    p.openSolved();
    drawMenus(p);
    p.frames(2);
    const ViewMode mode = p.editor->state.viewport.mode;
    for (float x = 10; x < 260; x += 20) {
        p.mouse({x, 8});
        p.frames(2);
        p.press(true);
        p.frames(6);
        p.press(false);
        p.frames(2);
        for (const ImGuiPopupData& popup : ImGui::GetCurrentContext()->OpenPopupStack) {
            ASSERT_TRUE(popup.Window);
            EXPECT_GE(popup.Window->Pos.y, 12) << "over the bar, at " << x;
            EXPECT_LE(popup.Window->Pos.y + popup.Window->Size.y, 300);
        }
        EXPECT_EQ(p.editor->state.viewport.mode, mode);
        EXPECT_FALSE(p.editor->job());
        p.key(keyEscape);
        p.frames(2);
    }
}

TEST(Habits, aLightsMenuStaysOpenWhereSceneAndInspectorShareAColumn) {
    Panels p(1024, 640);
    p.openSolved();
    Editor& e = *p.editor;
    const auto frames = [&](int count) {
        for (int i = 0; i < count; ++i) {
            ImGui::NewFrame();
            drawLayout(e, nullptr, "tests have no window");
            ImGui::Render();
            input().pressed = 0;
        }
    };
    frames(4);
    for (float y = 64; y < 560 && e.state.selection.emitters.empty(); y += 8) {
        p.mouse({780, y});
        frames(2);
        ImGui::GetIO().MouseDown[1] = true;
        frames(1);
        ImGui::GetIO().MouseDown[1] = false;
        frames(1);
    }
    ASSERT_EQ(e.state.selection.emitters.size(), 1u) << "a right click selects";
    frames(5);
    EXPECT_EQ(openPopups(), 1) << "the column with the menu is still there";
    EXPECT_FALSE(e.state.panels.narrowInspector);
    input().pressed = keyEscape;
    frames(4);
    EXPECT_EQ(openPopups(), 0);
    EXPECT_TRUE(e.state.panels.narrowInspector);
}

TEST(Palette, ranksWhatIsTypedAndNeverRunsAnotherCommand) {
    std::string best;
    int score = -1;
    for (const Action& action : actions())
        if (const int s = fuzzyScore(action.label, "sol"); s > score) score = s, best = action.id;
    EXPECT_EQ(best, "light.solo");
    // Nothing is selected, so solo cannot run; Enter then does nothing.
    Panels p;
    p.openSolved();
    p.editor->state.panels.palette = true;
    p.frame({});
    p.frames(3);
    p.type("sol");
    p.key(keyEnter);
    p.frames(2);
    EXPECT_FALSE(p.editor->job());
    EXPECT_TRUE(p.editor->state.viewport.solo.empty());
    EXPECT_TRUE(p.editor->state.panels.palette);
}

TEST(Habits, aDialogStaysInTheMiddleWhenTheWindowChanges) {
    Panels p;
    p.editor->state.panels.about = true;
    p.frame({});
    p.frames(4);
    const auto offCentre = [] {
        const ImGuiWindow* dialog = ImGui::FindWindowByName("About relamp###about");
        const ImVec2 screen = ImGui::GetIO().DisplaySize;
        return std::max(std::abs(dialog->Pos.x + dialog->Size.x / 2 - screen.x / 2),
                        std::abs(dialog->Pos.y + dialog->Size.y / 2 - screen.y / 2));
    };
    EXPECT_LT(offCentre(), 2);
    ImGui::GetIO().DisplaySize = {1500, 1100};
    p.frames(4);
    EXPECT_LT(offCentre(), 2);
}

/// The pointer rests on the second of eight controls below each other.
const ImGuiWindow* hintInColumn(Panels& p) {
    p.frame([] {
        for (int i = 0; i < 8; ++i) {
            ImGui::PushID(i);
            button("A control", "What it does, in a sentence that is long enough to need more than one line of text.");
            ImGui::PopID();
        }
    });
    p.mouse({40, 40});
    for (int i = 0; i < 60; ++i) p.frames(1);
    return ImGui::FindWindowByName("##Tooltip_00");
}

TEST(Habits, aHintCoversNoControlOfItsPanel) {
    Panels p;
    p.windowSize(300, 400);
    const ImGuiWindow* hint = hintInColumn(p);
    ASSERT_TRUE(hint && hint->Active);
    EXPECT_GE(hint->Pos.x, 300);
}

TEST(Habits, aHintIsNarrowerWhereThereIsLittleRoomBesideADialog) {
    Panels p(820, 700);
    p.windowSize(490, 400);
    const ImGuiWindow* hint = hintInColumn(p);
    ASSERT_TRUE(hint && hint->Active);
    EXPECT_GE(hint->Pos.x, 490);
    EXPECT_LE(hint->Pos.x + hint->Size.x, 820);
}

TEST(Habits, aHintGoesWhileItsFieldIsTypedInto) {
    Panels p;
    p.windowSize(300, 400);
    std::string words;
    p.frame([&] {
        inputText("##words", words);
        tooltip("What it is for");
    });
    const auto shows = [&](const ImVec2& at) {
        p.mouse(at);
        for (int i = 0; i < 60; ++i) p.frames(1);
        const ImGuiWindow* hint = ImGui::FindWindowByName("##Tooltip_00");
        return hint && hint->Active;
    };
    EXPECT_TRUE(shows({40, 15}));
    p.click({40, 15});
    EXPECT_FALSE(shows({40, 15}));
}

/// Opens a shot and the lights' panel; where the first one's exposure stands in it.
auto exposureOfFirstLight(Panels& p) {
    p.openSolved();
    p.windowSize(640, 300);
    p.frame([&p] { drawEmittersPanel(*p.editor); });
    p.frames(2);
    return p.find(Panels::idOf("test", {"##emitters", p.editor->emitters()[0].id.c_str(), "##stops"}));
}

TEST(Habits, aDoubleClickIsOneAtAnyFrameRateAndWhatIsTypedStaysInTheField) {
    DoubleClicks clicks;
    EXPECT_FALSE(clicks.second(0, 10));
    EXPECT_FALSE(clicks.second(1, 10.1)) << "another button";
    EXPECT_TRUE(clicks.second(0, 10.3));
    EXPECT_FALSE(clicks.second(0, 10.5)) << "the third press begins another pair";
    EXPECT_FALSE(clicks.second(0, 11.5));

    Panels p;
    const auto at = exposureOfFirstLight(p);
    ASSERT_TRUE(at);
    const std::string id = p.editor->emitters()[0].id;
    ImGuiIO& io = ImGui::GetIO();
    io.DeltaTime = 0.35f;  // seconds
    const auto press = [&](double seconds) {
        io.MouseDoubleClickTime = clicks.second(0, seconds) ? 1e6f : 0.0f;
        p.press(true);
        p.press(false);
    };
    p.mouse(*at);
    p.frames(2);
    press(20);
    press(20.2);
    p.frames(1);
    EXPECT_TRUE(io.WantTextInput);
    p.type("2");
    p.key(keyEnter);
    EXPECT_FLOAT_EQ(stopsOf(*p.editor, *p.editor->emitter(id)), 2);
    EXPECT_EQ(p.editor->state.viewport.mode, ViewMode::relit) << "the key 2 meant nothing else";
}

TEST(Habits, shiftIsFineInFieldsAsInTheViewport) {
    Panels p;
    const auto at = exposureOfFirstLight(p);
    ASSERT_TRUE(at);
    const std::string id = p.editor->emitters()[0].id;
    const auto dragged = [&](bool shift) {
        p.mouse(*at);
        p.frames(2);
        p.press(true);
        p.shift(shift);
        for (int i = 1; i <= 40; ++i) p.mouse({at->x + 3.0f * float(i), at->y}), p.frames(1);
        const float stops = stopsOf(*p.editor, *p.editor->emitter(id));
        p.press(false);
        p.shift(false);
        p.frames(2);
        p.editor->undo();
        return stops;
    };
    const float coarse = dragged(false), fine = dragged(true);
    EXPECT_GT(coarse, 1);
    EXPECT_GT(fine, 0);
    EXPECT_LT(fine, 0.2f * coarse);
}

TEST(Lights, newOnesStandBesideEachOther) {
    Panels p;
    p.openSolved();
    for (int i = 0; i < 4; ++i) addNewEmitter(*p.editor, EmitterShape::sphere);
    const auto& added = p.editor->look().added;
    ASSERT_EQ(added.size(), 4u);
    for (size_t i = 0; i < 4; ++i)
        for (size_t k = 0; k < i; ++k)
            EXPECT_GT(glm::distance(Vec3(added[i].matrix[3]), Vec3(added[k].matrix[3])), 0.5f * added[0].size.x);
}

TEST(Lights, anObjectLightIsDuplicatedAsALightOfItsOwn) {
    Panels p;
    p.openSolved();
    Editor& editor = *p.editor;
    std::string id;
    editor.edit("Object", [&](Look& look) {
        AddedEmitter part;
        part.shape = EmitterShape::part;
        part.seedVertex = 0;
        id = addEmitter(look, *editor.estimate(), part);
    });
    duplicateEmitters(editor, {id});
    ASSERT_EQ(editor.look().added.size(), 2u);
    const EmitterState *first = editor.emitter(id), *copy = editor.emitter(editor.state.selection.active());
    ASSERT_TRUE(first && copy);
    EXPECT_NE(copy->id, id);
    EXPECT_NEAR(powerOf(editor, *copy), powerOf(editor, *first), 0.02 * double(powerOf(editor, *first)));
    editor.undo();
    EXPECT_EQ(editor.look().added.size(), 1u);
}

TEST(Lights, copiesAreNamedAfterTheirSource) {
    Panels p;
    p.openSolved();
    const std::string id = p.editor->emitters()[0].id;
    duplicateEmitters(*p.editor, {id});
    duplicateEmitters(*p.editor, {id});
    EXPECT_EQ(p.editor->emitters()[0].name, "Light 1");
    EXPECT_EQ(p.editor->emitters()[1].name, "Light 1 copy");
    EXPECT_EQ(p.editor->emitters()[2].name, "Light 1 copy 2");
    p.editor->edit("Name", [&](Look& look) { renameEmitter(look, id, "Desk"); });
    EXPECT_EQ(p.editor->emitters()[1].name, "Desk copy");
}

TEST(Lights, deletingARecoveredOneSaysThatItIsSwitchedOff) {
    Panels p;
    p.openSolved();
    const std::string id = p.editor->emitters()[0].id;
    deleteEmitters(*p.editor, {id});
    EXPECT_FALSE(p.editor->emitter(id)->enabled);
    EXPECT_EQ(p.editor->state.message, "Light 1 switched off: it is part of the scene");
    EXPECT_EQ(p.editor->history().entries().back().label, "Switch off Light 1");
}

TEST(Lights, altWithGRAndSClearsOneOfThreeAndIsUndone) {
    Panels p;
    p.openSolved();
    Editor& editor = *p.editor;
    const std::string id = editor.emitters()[0].id;
    const Vec3 home = editor.emitters()[0].pivot;
    editor.state.selection.emitters = {id};
    Mat4 m(Mat3(Vec3(0, 2, 0), Vec3(-2, 0, 0), Vec3(0, 0, 2)));
    m[3] = Vec4(0.3f, 0.1f, 0.2f, 1);
    editor.edit("Move", [&](Look& look) { moveEmitter(look, id, m); });
    const Look moved = editor.look();
    ASSERT_TRUE(runKey(editor, {'G', false, false, true}));
    EXPECT_NEAR(glm::distance(editor.emitter(id)->pivot, home), 0, 1e-4);
    EXPECT_NEAR(editor.emitter(id)->matrix[0].y, 2, 1e-4) << "turned and as large as it was";
    ASSERT_TRUE(runKey(editor, {'R', false, false, true}));
    EXPECT_NEAR(editor.emitter(id)->matrix[0].x, 2, 1e-4);
    ASSERT_TRUE(runKey(editor, {'S', false, false, true}));
    EXPECT_NEAR(editor.emitter(id)->matrix[0].x, 1, 1e-4);
    EXPECT_NEAR(glm::distance(editor.emitter(id)->pivot, home), 0, 1e-4);
    for (int i = 0; i < 3; ++i) editor.undo();
    EXPECT_EQ(editor.look(), moved);
}

TEST(BottomPanel, foldsAfterAnEstimateAndUnfoldsByATab) {
    Panels p;
    p.openSolved();
    Editor& editor = *p.editor;
    EXPECT_TRUE(editor.state.panels.bottomFolded) << "a shot needs no plot";
    p.windowSize(1000, bottomPanelFoldedHeight());
    p.frame([&] { drawBottomPanel(editor); });
    p.frames(3);
    const auto at = p.find(Panels::idOf("test", {"##bottom", "History"}), 4);
    ASSERT_TRUE(at);
    p.click(*at);
    EXPECT_FALSE(editor.state.panels.bottomFolded);
    EXPECT_EQ(editor.state.panels.bottomTab, 3);
    // Where frames are slow, the pointer comes and presses between two of them.
    const auto other = p.find(Panels::idOf("test", {"##bottom", "Log"}), 4);
    ASSERT_TRUE(other);
    p.mouse(*at);
    p.frames(3);
    p.mouse(*other);
    p.press(true);
    p.press(false);
    p.frames(2);
    EXPECT_EQ(editor.state.panels.bottomTab, 2);
}

TEST(StartPage, showsWhatWasOpenLastAndOpensIt) {
    Panels p;
    p.editor->state.recent = {PaintedRoom::get().capture};
    p.windowSize(700, 500);
    p.frame([&] { drawStartPage(*p.editor); });
    p.frames(4);
    ImGuiID card = 0;
    for (const ImGuiWindow* window : ImGui::GetCurrentContext()->Windows)
        if (std::string(window->Name).find("##start") != std::string::npos) {
            const int index = 0;
            card = ImHashStr("##card", 0, ImHashData(&index, sizeof index, window->ID));
        }
    const auto at = p.find(card, 10);
    ASSERT_TRUE(at);
    p.click(*at);
    p.until([&] { return !p.editor->job(); });
    EXPECT_EQ(p.editor->state.document.captureFolder, PaintedRoom::get().capture);
}

}  // namespace
}  // namespace relamp::ui::test
