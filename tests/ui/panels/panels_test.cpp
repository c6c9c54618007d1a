// Every panel and dialog, drawn without a window in every state of the document.
#include "panels/panels.h"

#include <fstream>
#include <nlohmann/json.hpp>

#include "actions.h"
#include "panels/dialogs.h"
#include "panels/emitter_controls.h"
#include "panels/export_dialog.h"
#include "panels/images.h"
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

TEST(ViewsPanel, captionsOfNumberedPhotographsStayDifferentInLittleRoom) {
    Panels p;
    p.frame([] {
        const float whole = ImGui::CalcTextSize("0011.exr").x, stem = ImGui::CalcTextSize("0011").x;
        EXPECT_EQ(captionOf("images/0011.exr", whole), "0011.exr");
        EXPECT_EQ(captionOf("images/0011.exr", whole - 1), "0011");
        const float room = ImGui::CalcTextSize("...0011").x;
        EXPECT_EQ(captionOf("images/DSC_0011.exr", std::max(room, stem)), "...0011");
    });
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
    addNewEmitter(editor, EmitterShape::sphere);
    addNewEmitter(editor, EmitterShape::rectangle);
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
    editor.edit("Rename", [&](Look& look) { look.added[0].name = "Key"; });
    EXPECT_EQ(nameOfPart(editor, editor.emitters().size() - 2), "Key") << "not its id";
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
    // Drawing does not poll: the job is there, however quick the estimate was.
    const auto at = p.find(stop, 8);
    ASSERT_TRUE(at);
    p.click(*at);
    ASSERT_TRUE(p.editor->job());
    EXPECT_TRUE(p.editor->job()->stopping);
    p.until([&] { return !p.editor->job(); });
}

TEST(StatusBar, saysThatAShotIsReadOnly) {
    Panels p;
    p.openSolved();
    const auto bar = [&] { drawStatusBar(*p.editor); };
    EXPECT_EQ(p.wordsOf(bar).find("read-only"), std::string::npos);
    p.editor->state.document.readOnly = true;
    EXPECT_NE(p.wordsOf(bar).find("read-only"), std::string::npos);
    p.windowSize(400, 60);
    EXPECT_NE(p.wordsOf(bar).find("read-only"), std::string::npos) << "also where there is little room";
}

TEST(BottomPanel, aClickOnATabShowsIt) {
    Panels p;
    p.openSolved();
    p.editor->state.panels.bottomTab = 0;
    p.editor->state.panels.bottomFolded = false;
    p.windowSize(1000, 300);
    p.frame([&] { drawBottomPanel(*p.editor); });
    p.frames(3);
    for (const int wanted : {1, 3, 5, 0, 2, 4}) {
        const char* const names[] = {"Progress", "Lights", "Log", "History", "Solve details", "Scope"};
        const auto at = p.find(Panels::idOf("test", {"##bottom", names[wanted]}));
        ASSERT_TRUE(at) << names[wanted];
        p.click(*at);
        p.frames(3);
        EXPECT_EQ(p.editor->state.panels.bottomTab, wanted);
        EXPECT_EQ(p.editor->state.panels.scopeShown(), wanted == scopeTab);
    }
}

TEST(ScopePanel, drawsWhatTheImageHolds) {
    Panels p;
    std::vector<uint8_t> pixels(size_t(4) * 64 * 64, 128);
    p.windowSize(800, 200);
    p.frame([&] { drawScopePanel(*p.editor); });
    const int before = ImGui::GetDrawData()->TotalVtxCount;
    p.editor->state.scope = std::make_shared<const Scope>(scopeOf(pixels, 64, 64));
    p.frames(2);
    // A rectangle for each column at least.
    EXPECT_GT(ImGui::GetDrawData()->TotalVtxCount, before + 4 * 64);
    for (const float width : {60.0f, 200.0f}) {
        p.windowSize(width, 60);
        p.frames(2);
    }
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

TEST(Panels, sayWhatIsBeingOpenedAndWhatAShotWasMadeOf) {
    { Panels().openSolved(); }
    Panels p;
    Editor& editor = *p.editor;
    std::string words;
    const auto panels = [&] {
        ImGui::LogToBuffer();
        drawViewsPanel(editor);
        drawInspectorPanel(editor);
        words = ImGui::GetCurrentContext()->LogBuffer.c_str();
        ImGui::LogFinish();
    };
    p.frame(panels);
    EXPECT_NE(words.find("Nothing is open."), std::string::npos) << words;
    editor.openNow(PaintedRoom::get().shot);
    p.frames(2);
    EXPECT_NE(words.find("Opening room.relamp"), std::string::npos) << words;
    EXPECT_EQ(words.find("Nothing is open."), std::string::npos) << words;
    EXPECT_EQ(words.find("Drop a capture"), std::string::npos) << words;
    p.until([&] { return !editor.job(); });
    p.frames(2);
    EXPECT_NE(words.find("Capture room\n"), std::string::npos) << words;
    EXPECT_NE(words.find("Shot room.relamp\n"), std::string::npos) << words;
}

TEST(ImportDoctor, drawsACaptureThatStandsOnItsSide) {
    Panels p;
    p.openCapture();
    p.editor->state.panels.doctor = true;
    p.frame({});
    p.frames(3);
    p.editor->fixCapture({.up = "y"});
    p.until([&] { return !p.editor->job(); });
    p.frames(3);
    EXPECT_EQ(p.editor->state.document.fix.up, "y");
    EXPECT_NE(p.editor->state.document.check->upGuess, p.editor->state.document.check->up);
}

TEST(ImportDoctor, aMeshInAnotherUnitIsSetRightByOneButton) {
    Panels p;
    p.openCapture();
    p.editor->state.panels.doctor = true;
    p.editor->fixCapture({.meshScale = 100});
    p.until([&] { return !p.editor->job(); });
    ASSERT_TRUE(p.editor->state.document.check->advice);
    EXPECT_EQ(p.editor->state.document.check->advice->option, "--mesh-scale 1");
    p.frame({});
    p.frames(3);
    ImGuiID id = 0;
    for (ImGuiWindow* window : ImGui::GetCurrentContext()->Windows)
        if (id == 0 && std::string_view(window->Name).find("doctor/##content") != std::string_view::npos)
            id = window->GetID(p.editor->state.document.check->advice->button.c_str());
    ASSERT_NE(id, 0u);
    const auto button = p.find(id);
    ASSERT_TRUE(button);
    p.click(*button);
    p.until([&] { return !p.editor->job(); });
    EXPECT_NEAR(p.editor->state.document.fix.meshScale, 1, 1e-9);
    EXPECT_FALSE(p.editor->state.document.check->advice);
}

}  // namespace
}  // namespace relamp::ui::test
