// Every panel and dialog, drawn without a window in every state of the document, and edited with a mouse.
#include "panels/panels.h"

#include <fstream>

#include "actions.h"
#include "panels/dialogs.h"
#include "panels/emitter_controls.h"
#include "panels/export_dialog.h"
#include "panels/inspector.h"
#include "ui/panels/panel_harness.h"

namespace relamp::ui::test {
namespace {

/// All areas, at widths from the narrowest column to a wide screen, at three scales of the screen.
void drawEverything(Panels& p) {
    Editor& editor = *p.editor;
    void (*const areas[])(Editor&) = {drawScenePanel,    drawInspectorPanel, drawBottomPanel,      drawStatusBar,
                                      drawViewsPanel,    drawEmittersPanel,  drawEnvironmentPanel, drawMaterialsPanel,
                                      drawEstimatePanel, drawTimelinePanel,  drawLogPanel,         drawHistoryPanel,
                                      drawPlanPanel};
    for (const float scale : {1.0f, 2.0f})
        for (const float width : {200.0f, 240.0f, 520.0f, 990.0f}) {
            applyTheme(scale);
            ImGui::GetIO().FontGlobalScale = scale;
            p.windowSize(width, 640);
            for (const auto area : areas) {
                p.frame([&] { area(editor); });
                p.mouse({width / 2, 60});
                p.frames(2);
            }
            for (int tab = 0; tab < 5; ++tab) {
                editor.state.panels.bottomTab = tab;
                p.frame([&] { drawBottomPanel(editor); });
                p.frames(3);
                EXPECT_EQ(editor.state.panels.bottomTab, tab);
            }
        }
    applyTheme(1);
    ImGui::GetIO().FontGlobalScale = 1;
    p.windowSize(0, 0);
    p.frame([&] {
        if (ImGui::BeginMainMenuBar()) {
            drawMenuBar(editor);
            ImGui::EndMainMenuBar();
        }
    });
}

void drawEveryDialog(Panels& p) {
    PanelState& panels = p.editor->state.panels;
    for (bool PanelState::*flag :
         {&PanelState::doctor, &PanelState::keys, &PanelState::palette, &PanelState::exportFrames, &PanelState::about,
          &PanelState::openBrowser, &PanelState::saveBrowser, &PanelState::environmentBrowser}) {
        panels.*flag = true;
        p.frame({});
        p.frames(4);
        EXPECT_TRUE(flag == &PanelState::doctor || dialogOpen(*p.editor));
        p.key(keyEscape);
        p.frames(3);
        panels.doctor = false;
        EXPECT_FALSE(dialogOpen(*p.editor));
        EXPECT_EQ(ImGui::GetCurrentContext()->OpenPopupStack.Size, 0);
    }
}

TEST(QualityBanner, namesTheCauseOfAPoorEstimateUntilItIsClosed) {
    Panels p;
    p.openSolved();
    Editor& editor = *p.editor;
    EXPECT_FALSE(qualityBannerShown(editor));
    // The same shot with figures of a poor one.
    const std::filesystem::path shot = p.folder / "poor.relamp";
    std::filesystem::copy(PaintedRoom::get().shot, shot, std::filesystem::copy_options::recursive);
    nlohmann::json document = nlohmann::json::parse(std::ifstream(shot / "shot.json"));
    document["capture"] = PaintedRoom::get().capture.string();
    document["reproduction"]["psnr"] = 13;
    document["reproduction"]["advice"] =
        "The cameras' poses do not belong to the photographs: check that they are in the same order.";
    std::ofstream(shot / "shot.json") << document.dump();
    editor.openNow(shot);
    p.until([&] { return !editor.job(); });
    ASSERT_TRUE(qualityBannerShown(editor));
    p.windowSize(600, 200);
    p.frame([&] { EXPECT_GT(qualityBannerHeight(editor, 300), qualityBannerHeight(editor, 900)); });
    p.frame([&] { drawQualityBanner(editor); });
    const auto close = p.find(Panels::idOf("test", {"Close"}));
    ASSERT_TRUE(close.has_value());
    p.click(*close);
    EXPECT_FALSE(qualityBannerShown(editor));
}

TEST(InterruptedEstimate, isOfferedAboveTheButtonUntilItIsThrownAway) {
    Panels p;
    p.openCapture();
    Editor& editor = *p.editor;
    EXPECT_FALSE(interruptedOfferShown(editor));
    InterruptedEstimate offer;
    offer.record = p.folder / "one.estimate.json";
    offer.captureFolder = offer.project = editor.state.document.captureFolder;
    offer.time = "2026-11-21 14:03:11";
    offer.seconds = 12;
    editor.state.interrupted = offer;
    ASSERT_TRUE(interruptedOfferShown(editor));
    p.windowSize(400, 200);
    p.frame([&] { drawEstimateButton(editor); });
    EXPECT_TRUE(p.find(Panels::idOf("test", {"Go on with the interrupted estimate", "##button"})).has_value());
    const auto discard = p.find(Panels::idOf("test", {"##discard interrupted"}));
    ASSERT_TRUE(discard.has_value());
    p.click(*discard);
    EXPECT_FALSE(interruptedOfferShown(editor));
}

TEST(PanelDrawing, everythingDrawsWithoutADocument) {
    Panels p;
    drawEverything(p);
    drawEveryDialog(p);
}

TEST(PanelDrawing, everythingDrawsWithADocumentButNoEstimate) {
    Panels p;
    p.openCapture();
    drawEverything(p);
    drawEveryDialog(p);
}

TEST(PanelDrawing, everythingDrawsWithAnEstimateInEveryStateOfTheSelection) {
    Panels p;
    p.openSolved();
    Editor& editor = *p.editor;
    editor.state.curves[0].entries = editor.estimate()->timeline;
    editor.state.curves[1].entries = editor.estimate()->timeline;
    editor.state.recentEnvironments = {"/nowhere/studio.exr"};
    drawEverything(p);
    drawEveryDialog(p);
    addNewEmitter(editor, AddedEmitter::Shape::sphere);
    addNewEmitter(editor, AddedEmitter::Shape::rectangle);
    ASSERT_EQ(editor.look().added.size(), 2u);
    drawEverything(p);
    runAction(editor, "edit.selectAll");
    editor.state.viewport.solo = {editor.emitters()[0].id};
    editor.state.viewport.clickTask = ClickTask::aim;
    drawEverything(p);
    editor.state.selection.emitters.clear();
    PickedPoint point;
    point.normal = {0, 0, 1};
    editor.pick(point);
    drawEverything(p);
    PointLight light;
    light.normal = {0, 0, 1};
    light.fromEnvironment = Rgb(0.2f, 0.3f, 0.4f);
    light.fromEmitter.assign(editor.emitters().size(), Rgb(0.5f, 0.4f, 0.2f));
    light.incident.assign(size_t(light.grid.cells()), Rgb(0.3f));
    editor.state.pointLight = light;
    p.frame([&] { drawInspectorPanel(editor); });
    p.frames(2);
}

TEST(PanelDrawing, runningJobsShowInTheStatusBarAndCanBeStopped) {
    Panels p;
    p.openCapture();
    p.editor->solve(p.editor->state.solve);
    ASSERT_TRUE(p.editor->job());
    drawEverything(p);
    const ImGuiID stop = Panels::idOf("test", {"##stop"});
    p.windowSize(900, 60);
    p.frame([&] { drawStatusBar(*p.editor); });
    if (!p.editor->job()) GTEST_SKIP() << "the estimate was faster than the drawing";
    const auto at = p.find(stop, 8);
    if (p.editor->job() && at) p.click(*at);
    p.until([&] { return !p.editor->job(); });
}

/// The table of emitters alone, 520 pixels wide.
struct Table : Panels {
    std::string id;
    Table() {
        openSolved();
        id = editor->emitters()[0].id;
        windowSize(640, 300);
        frame([this] { drawEmittersPanel(*editor); });
        frames(2);
    }
    ImGuiID control(const char* name) { return idOf("test", {"##emitters", id.c_str(), name}); }
};

TEST(EmitterTable, draggingStopsIsOneEntryAndUndoRestores) {
    Table t;
    const Look before = t.editor->look();
    const size_t entries = t.editor->history().entries().size();
    const auto at = t.find(t.control("##stops"));
    ASSERT_TRUE(at);
    t.mouse(*at);
    t.press(true);
    for (int i = 1; i <= 10; ++i) {
        t.mouse({at->x + 10.0f * float(i), at->y});
        t.frames(1);
    }
    EXPECT_TRUE(t.editor->inGesture());
    EXPECT_EQ(t.editor->history().entries().size(), entries);
    t.press(false);
    t.frames(2);
    EXPECT_FALSE(t.editor->inGesture());
    ASSERT_EQ(t.editor->history().entries().size(), entries + 1);
    EXPECT_EQ(t.editor->history().entries().back().label, "Brightness of " + t.id);
    // 0.02 stops a pixel, less the few pixels before a drag begins.
    const EmitterState& now = *t.editor->emitter(t.id);
    EXPECT_GT(now.radiance.x, 2 * now.recoveredRadiance.x);
    EXPECT_NEAR(now.radiance.y / now.radiance.x, now.recoveredRadiance.y / now.recoveredRadiance.x, 1e-4);
    t.editor->undo();
    EXPECT_EQ(t.editor->look(), before);
}

TEST(EmitterTable, escDuringADragLeavesNoEntryAndDoesNotStartAgain) {
    Table t;
    const Look before = t.editor->look();
    const size_t entries = t.editor->history().entries().size();
    const auto at = t.find(t.control("##stops"));
    ASSERT_TRUE(at);
    t.mouse(*at);
    t.press(true);
    for (int i = 1; i <= 5; ++i) t.mouse({at->x + 10.0f * float(i), at->y}), t.frames(1);
    ASSERT_TRUE(t.editor->inGesture());
    t.key(keyEscape);
    EXPECT_FALSE(t.editor->inGesture());
    for (int i = 6; i <= 9; ++i) t.mouse({at->x + 10.0f * float(i), at->y}), t.frames(1);
    EXPECT_FALSE(t.editor->inGesture());
    t.press(false);
    t.frames(2);
    EXPECT_EQ(t.editor->history().entries().size(), entries);
    EXPECT_EQ(t.editor->look(), before);
}

TEST(EmitterTable, aClickWithoutADragChangesNothing) {
    Table t;
    const size_t entries = t.editor->history().entries().size();
    const auto at = t.find(t.control("##stops"));
    ASSERT_TRUE(at);
    t.click(*at);
    EXPECT_EQ(t.editor->history().entries().size(), entries);
    EXPECT_FALSE(t.editor->inGesture());
}

TEST(EmitterTable, theMuteButtonSwitchesOffAndOn) {
    Table t;
    const auto at = t.find(t.control("##mute"));
    ASSERT_TRUE(at);
    t.click(*at);
    EXPECT_FALSE(t.editor->emitter(t.id)->enabled);
    t.click(*at);
    EXPECT_TRUE(t.editor->emitter(t.id)->enabled);
}

TEST(EmitterTable, soloIsNotAnEdit) {
    Table t;
    const size_t entries = t.editor->history().entries().size();
    const auto at = t.find(t.control("##solo"));
    ASSERT_TRUE(at);
    t.click(*at);
    EXPECT_EQ(t.editor->state.viewport.solo, std::vector<std::string>{t.id});
    t.click(*at);
    EXPECT_TRUE(t.editor->state.viewport.solo.empty());
    EXPECT_EQ(t.editor->history().entries().size(), entries);
}

TEST(EmitterTable, anEditGoesToAllSelectedAsOneEntry) {
    Table t;
    addNewEmitter(*t.editor, AddedEmitter::Shape::disk);
    const std::string added = t.editor->emitters().back().id;
    EXPECT_EQ(t.editor->state.selection.emitters, std::vector<std::string>{added});
    selectEmitter(*t.editor, t.id, true, false);
    ASSERT_EQ(t.editor->state.selection.emitters.size(), 2u);
    t.frames(2);
    const size_t entries = t.editor->history().entries().size();
    const auto at = t.find(t.control("##mute"));
    ASSERT_TRUE(at);
    t.click(*at);
    EXPECT_EQ(t.editor->history().entries().size(), entries + 1);
    for (const EmitterState& e : t.editor->emitters()) EXPECT_FALSE(e.enabled) << e.id;
    const float before = luminance(t.editor->emitter(added)->radiance);
    const auto stops = t.find(t.control("##stops"));
    ASSERT_TRUE(stops);
    t.mouse(*stops);
    t.press(true);
    for (int i = 1; i <= 6; ++i) t.mouse({stops->x + 10.0f * float(i), stops->y}), t.frames(1);
    t.press(false);
    EXPECT_EQ(t.editor->history().entries().size(), entries + 2);
    const EmitterState& first = *t.editor->emitter(t.id);
    EXPECT_NEAR(luminance(t.editor->emitter(added)->radiance) / before,
                luminance(first.radiance) / luminance(first.recoveredRadiance), 1e-3);
}

TEST(EmitterTable, shiftExtendsAndCtrlToggles) {
    Table t;
    addNewEmitter(*t.editor, AddedEmitter::Shape::disk);
    addNewEmitter(*t.editor, AddedEmitter::Shape::sphere);
    const auto& all = t.editor->emitters();
    selectEmitter(*t.editor, all.front().id, false, false);
    selectEmitter(*t.editor, all.back().id, false, true);
    EXPECT_EQ(t.editor->state.selection.emitters.size(), all.size());
    EXPECT_EQ(t.editor->state.selection.active(), all.front().id);
    selectEmitter(*t.editor, all.front().id, true, false);
    EXPECT_EQ(t.editor->state.selection.emitters.size(), all.size() - 1);
    selectEmitter(*t.editor, all.front().id, false, false);
    EXPECT_EQ(t.editor->state.selection.emitters, std::vector<std::string>{all.front().id});
}

TEST(EmitterTable, kelvinKeepsTheBrightness) {
    Table t;
    const auto at = t.find(t.control("##kelvin"));
    ASSERT_TRUE(at);
    const float before = luminance(t.editor->emitter(t.id)->radiance);
    t.mouse(*at);
    t.press(true);
    for (int i = 1; i <= 8; ++i) t.mouse({at->x + 10.0f * float(i), at->y}), t.frames(1);
    t.press(false);
    const EmitterState& now = *t.editor->emitter(t.id);
    EXPECT_NEAR(luminance(now.radiance) / before, 1, 1e-3);
    EXPECT_GT(now.radiance.z / now.radiance.x, now.recoveredRadiance.z / now.recoveredRadiance.x);
}

TEST(EmitterControls, newLightsFaceWhatTheCameraLooksAt) {
    Panels p;
    p.openSolved();
    p.editor->state.viewport.camera.target = {0.1f, 0, 0.2f};
    const AddedEmitter added = newEmitter(*p.editor, AddedEmitter::Shape::rectangle);
    const Vec3 place(added.matrix[3]), facing = -Vec3(added.matrix[2]);
    EXPECT_GT(glm::dot(facing, glm::normalize(p.editor->state.viewport.camera.target - place)), 0.999f);
    EXPECT_NEAR(added.size.x, p.editor->state.document.scene->diagonal / 16, 1e-4);
    EXPECT_NEAR(luminance(added.radiance), referenceBrightness(*p.editor), 1e-4);
}

TEST(EmitterControls, powerFollowsTheAreaOfAFlatLight) {
    Panels p;
    p.openSolved();
    addNewEmitter(*p.editor, AddedEmitter::Shape::rectangle);
    const EmitterState before = p.editor->emitters().back();
    p.editor->edit("Scale", [&](Look& look) {
        Mat4 twice(2);
        twice[3] = Vec4(before.pivot - 2.0f * before.pivot, 1);
        moveEmitter(look, before.id, twice);
    });
    EXPECT_NEAR(powerOf(*p.editor, p.editor->emitters().back()) / powerOf(*p.editor, before), 4, 1e-2);
    EXPECT_NEAR(stopsOf(*p.editor, before), 0, 1e-4);
}

TEST(Inspector, positionRotationAndScaleComeBackFromAMatrix) {
    for (const Vec3& degrees : {Vec3(0), Vec3(10, 20, 30), Vec3(-120, 45, 170), Vec3(5, -80, 0), Vec3(0, 0, 90)}) {
        const Vec3 scale(0.5f, 1, 3);
        Mat3 m = rotationOf(degrees);
        for (int k = 0; k < 3; ++k) m[k] *= scale[k];
        const Placement back = placementOf(Mat4(m));
        EXPECT_LT(glm::distance(back.scale, scale), 1e-4f);
        const Mat3 again = rotationOf(back.degrees);
        for (int k = 0; k < 3; ++k)
            EXPECT_LT(glm::distance(again[k], m[k] / scale[k]), 1e-4f)
                << degrees.x << " " << degrees.y << " " << degrees.z;
    }
}

/// The inspector alone, 320 pixels wide, with the first emitter selected. Its id.
std::string inspectFirstEmitter(Panels& p) {
    p.openSolved();
    const std::string id = p.editor->emitters()[0].id;
    selectEmitter(*p.editor, id, false, false);
    p.windowSize(320, 690);
    p.frame([&p] { drawInspectorPanel(*p.editor); });
    return id;
}

TEST(Inspector, aTypedNameIsOneEntryAndIsShownEverywhere) {
    Panels p;
    const std::string id = inspectFirstEmitter(p);
    const size_t entries = p.editor->history().entries().size();
    runAction(*p.editor, "light.rename");
    p.frames(3);
    p.type("Key");
    p.key(keyEnter);
    p.frames(2);
    ASSERT_EQ(p.editor->history().entries().size(), entries + 1);
    EXPECT_EQ(p.editor->history().entries().back().label, "Rename " + id + " to Key");
    EXPECT_EQ(p.editor->emitter(id)->name, "Key");
    EXPECT_EQ(p.editor->namesOf({id}), "Key");
    // Escape leaves it as it is.
    runAction(*p.editor, "light.rename");
    p.frames(3);
    p.type("Other");
    p.key(keyEscape);
    p.frames(2);
    EXPECT_EQ(p.editor->history().entries().size(), entries + 1);
    EXPECT_EQ(p.editor->emitter(id)->name, "Key");
    p.editor->undo();
    EXPECT_EQ(p.editor->emitter(id)->name, id);
}

TEST(Inspector, draggingThePositionMovesTheLightAsOneEntry) {
    Panels p;
    const std::string id = inspectFirstEmitter(p);
    const Vec3 before = p.editor->emitter(id)->pivot;
    const size_t entries = p.editor->history().entries().size();
    const auto at = p.find(Panels::idOf("test", {"Position (m)", "##y"}));
    ASSERT_TRUE(at);
    p.mouse(*at);
    p.press(true);
    for (int i = 1; i <= 8; ++i) p.mouse({at->x + 10.0f * float(i), at->y}), p.frames(1);
    p.press(false);
    EXPECT_EQ(p.editor->history().entries().size(), entries + 1);
    const Vec3 now = p.editor->emitter(id)->pivot;
    EXPECT_NEAR(now.x, before.x, 1e-4);
    EXPECT_GT(now.y, before.y + 0.05f);
    p.editor->undo();
    EXPECT_LT(glm::distance(p.editor->emitter(id)->pivot, before), 1e-6f);
}

TEST(EnvironmentPanel, draggingThePanoramaTurnsItWithTheHand) {
    Panels p;
    p.openSolved();
    p.windowSize(300, 500);
    p.frame([&] { drawEnvironmentPanel(*p.editor); });
    const auto at = p.find(Panels::idOf("test", {"##recovered"}));
    ASSERT_TRUE(at);
    const size_t entries = p.editor->history().entries().size();
    p.mouse(*at);
    p.press(true);
    for (int i = 1; i <= 5; ++i) p.mouse({at->x + 8.0f * float(i), at->y}), p.frames(1);
    p.press(false);
    EXPECT_EQ(p.editor->history().entries().size(), entries + 1);
    // To the right runs from +Y to -Y: clockwise from above.
    EXPECT_LT(p.editor->look().environment.yawDegrees, -50);
    p.editor->undo();
    EXPECT_EQ(p.editor->look().environment.yawDegrees, 0);
}

TEST(EnvironmentPanel, noneAndBackAgain) {
    Panels p;
    p.openSolved();
    p.windowSize(300, 500);
    p.frame([&] { drawEnvironmentPanel(*p.editor); });
    const auto none = p.find(Panels::idOf("test", {"None"}));
    ASSERT_TRUE(none);
    p.click(*none);
    EXPECT_EQ(p.editor->look().environment.source, EnvironmentLook::Source::none);
    const auto back = p.find(Panels::idOf("test", {"Recovered"}));
    ASSERT_TRUE(back);
    p.click(*back);
    EXPECT_EQ(p.editor->look().environment.source, EnvironmentLook::Source::recovered);
}

TEST(BottomPanel, aClickOnATabShowsIt) {
    Panels p;
    p.openSolved();
    p.editor->state.panels.bottomTab = 0;
    p.windowSize(1000, 300);
    p.frame([&] { drawBottomPanel(*p.editor); });
    p.frames(3);
    for (const int wanted : {1, 3, 0, 2, 4}) {
        const char* const names[] = {"Timeline", "Lights", "Log", "History", "Plan"};
        const auto at = p.find(Panels::idOf("test", {"##bottom", names[wanted]}));
        ASSERT_TRUE(at) << names[wanted];
        p.click(*at);
        p.frames(3);
        EXPECT_EQ(p.editor->state.panels.bottomTab, wanted);
    }
}

TEST(Palette, aFewLettersAndEnterRunACommand) {
    Panels p;
    p.openSolved();
    p.editor->state.panels.palette = true;
    p.frame({});
    p.frames(3);
    p.type("neutral");
    p.key(keyEnter);
    p.frames(2);
    EXPECT_TRUE(p.editor->look().neutralMaterials);
    EXPECT_FALSE(p.editor->state.panels.palette);
    EXPECT_FALSE(dialogOpen(*p.editor));
}

TEST(Palette, arrowsChooseAndEscCloses) {
    Panels p;
    p.editor->state.panels.palette = true;
    p.frame({});
    p.frames(3);
    p.key(keyDown);
    p.key(keyEscape);
    p.frames(2);
    EXPECT_FALSE(p.editor->state.panels.palette);
}

TEST(Palette, startsOfWordsAndRunsCountMore) {
    EXPECT_LT(fuzzyScore("Open...", "xyz"), 0);
    EXPECT_GT(fuzzyScore("Save as...", "sa"), fuzzyScore("Neutral surfaces", "sa"));
    EXPECT_GT(fuzzyScore("Add rectangle", "rect"), fuzzyScore("Correction colours", "rect"));
    EXPECT_GT(fuzzyScore("Export frames...", "exp fr"), 0);
    EXPECT_GT(fuzzyScore("Open...", ""), -100);
}

TEST(Dialogs, noticesCloseOneByOneWithEnter) {
    Panels p;
    p.editor->fail("First", "This went wrong.", "Do that.");
    p.editor->fail("Second", "That too.");
    p.frame({});
    p.frames(3);
    EXPECT_TRUE(dialogOpen(*p.editor));
    p.key(keyEnter);
    p.frames(3);
    ASSERT_EQ(p.editor->state.notices.size(), 1u);
    EXPECT_EQ(p.editor->state.notices[0].title, "Second");
    p.key(keyEscape);
    p.frames(3);
    EXPECT_TRUE(p.editor->state.notices.empty());
    EXPECT_EQ(ImGui::GetCurrentContext()->OpenPopupStack.Size, 0);
}

TEST(Dialogs, aNoticeOverAnotherDialogGivesItBack) {
    Panels p;
    p.openSolved();
    p.editor->state.panels.exportFrames = true;
    p.frame({});
    p.frames(3);
    p.editor->fail("Trouble", "Something happened.");
    p.frames(3);
    p.key(keyEnter);
    p.frames(3);
    EXPECT_TRUE(p.editor->state.notices.empty());
    EXPECT_TRUE(p.editor->state.panels.exportFrames);
    EXPECT_TRUE(ImGui::IsPopupOpen("", ImGuiPopupFlags_AnyPopupId | ImGuiPopupFlags_AnyPopupLevel));
}

TEST(Dialogs, unsavedWorkIsAskedAboutAndCancelStays) {
    Panels p;
    p.openSolved();
    p.editor->edit("Neutral", [](Look& look) { look.neutralMaterials = true; });
    p.editor->requestQuit();
    p.frame({});
    p.frames(3);
    EXPECT_TRUE(dialogOpen(*p.editor));
    p.key(keyEscape);
    p.frames(3);
    EXPECT_FALSE(p.editor->quitting());
    EXPECT_FALSE(p.editor->state.unsaved);
}

TEST(PlanPanel, holdsWhatTheEstimateWasPlannedToBeAndWhatItTook) {
    Panels p;
    p.openSolved();
    const SolvePlan& plan = p.editor->state.plan;
    ASSERT_FALSE(plan.stages.empty());
    EXPECT_TRUE(std::any_of(plan.stages.begin(), plan.stages.end(),
                            [](const PlannedStage& s) { return s.predictedSeconds >= 0 && s.measuredSeconds >= 0; }));
    for (const float width : {900.0f, 300.0f}) {
        p.windowSize(width, 200);
        p.frame([&] { drawPlanPanel(*p.editor); });
    }
    p.openCapture();
    EXPECT_TRUE(p.editor->state.plan.stages.empty()) << "a capture that was not estimated has no plan";
}

TEST(HistoryPanel, aClickGoesThere) {
    Panels p;
    p.openSolved();
    const size_t start = p.editor->history().index();
    p.editor->edit("Neutral", [](Look& look) { look.neutralMaterials = true; });
    p.editor->edit("None", [](Look& look) { look.environment.source = EnvironmentLook::Source::none; });
    p.windowSize(400, 300);
    p.frame([&] { drawHistoryPanel(*p.editor); });
    p.frames(2);
    // Rows follow the line of buttons.
    const float line = ImGui::GetTextLineHeightWithSpacing(),
                top = ImGui::GetStyle().WindowPadding.y * 2 + ImGui::GetFrameHeightWithSpacing();
    p.click({60, top + line * (float(start) + 0.4f)});
    EXPECT_EQ(p.editor->history().index(), start);
    EXPECT_EQ(p.editor->history().entries().size(), start + 3);
}

TEST(ImportDoctor, drawsACaptureThatStandsOnItsSide) {
    Panels p;
    p.openCapture();
    p.editor->state.panels.doctor = true;
    p.frame({});
    p.frames(3);
    p.editor->fixCapture({"y", false});
    p.until([&] { return !p.editor->job(); });
    p.frames(3);
    EXPECT_EQ(p.editor->state.document.fix.up, "y");
    EXPECT_NE(p.editor->state.document.check->upGuess, p.editor->state.document.check->up);
}

TEST(ExportDialog, saysWhatIsWrongBeforeItStarts) {
    const TemporaryFolder folder;
    ExportRequest r;
    r.views = ExportRequest::Views::all;
    r.file = folder / "frame.exr";
    EXPECT_NE(checkExport(r, 6, 0).file.find("####"), std::string::npos);
    r.file = folder / "frame.####.exr";
    EXPECT_TRUE(checkExport(r, 6, 0).ok());
    EXPECT_EQ(checkExport(r, 6, 0).firstFile, "frame.0001.exr");
    EXPECT_EQ(checkExport(r, 6, 0).frames, 6u);
    r.file = folder / "frame.%03d.png";
    EXPECT_EQ(checkExport(r, 6, 0).firstFile, "frame.001.png");
    EXPECT_FALSE(checkExport(r, 6, 0).layers.empty());
    r.views = ExportRequest::Views::range;
    r.range = "2-4,9";
    EXPECT_EQ(checkExport(r, 6, 0).frames, 3u);
    for (const char* bad : {"", "x", "4-2", "1:0", "99"}) {
        r.range = bad;
        EXPECT_FALSE(checkExport(r, 6, 0).range.empty()) << bad;
    }
    r.views = ExportRequest::Views::present;
    r.file = folder / "nowhere" / "a.exr";
    EXPECT_NE(checkExport(r, 6, 0).file.find("does not exist"), std::string::npos);
    r.file = folder / "a.mov";
    EXPECT_FALSE(checkExport(r, 6, 0).ok());
    r.file = "";
    EXPECT_FALSE(checkExport(r, 6, 0).ok());
}

}  // namespace
}  // namespace relamp::ui::test
