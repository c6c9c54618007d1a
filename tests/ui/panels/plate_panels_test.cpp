// A plate in the panels: its dialog, its entry among the views, its frames in the export.
#include "panels/export_dialog.h"
#include "panels/panels.h"
#include "ui/panels/panel_harness.h"

namespace relamp::ui::test {
namespace {
namespace fs = std::filesystem;

/// The capture's photographs and cameras, taken for a plate.
PlateLook capturePlate() {
    const fs::path capture = PaintedRoom::get().capture;
    PlateLook plate{capture / "images/##.exr", capture / "transforms.json"};
    plate.match = "off";
    return plate;
}

TEST(PlatePanels, theDialogImportsAndTheEntryLooksThroughAndRemoves) {
    Panels p(420, 700);
    p.openSolved();
    const auto views = [&] { drawViewsPanel(*p.editor); };
    p.editor->state.plateImport = PlateLook{};
    p.frame(views);
    p.frames(3);
    EXPECT_TRUE(dialogOpen(*p.editor));
    const auto import = p.find(Panels::idOf("Import plate###plate", {"Import"}));
    ASSERT_TRUE(import);
    p.click(*import);
    EXPECT_TRUE(p.editor->state.plateImport && !p.editor->job()) << "without files there is nothing to import";
    p.editor->state.plateImport = capturePlate();
    p.frames(2);
    const auto ready = p.find(Panels::idOf("Import plate###plate", {"Import"}));
    ASSERT_TRUE(ready);
    p.click(*ready);
    p.until([&] { return !p.editor->job() && p.editor->plate(); });
    p.frames(3);
    EXPECT_FALSE(dialogOpen(*p.editor)) << "nothing was lacking";
    EXPECT_TRUE(p.editor->plateCamera());
    const auto entry = p.find(Panels::idOf("test", {"###plate"}));
    ASSERT_TRUE(entry);
    p.click(*entry);
    EXPECT_FALSE(p.editor->plateCamera());
    p.click(*entry);
    EXPECT_TRUE(p.editor->plateCamera());
    const auto removal = p.find(Panels::idOf("test", {"##remove plate"}));
    ASSERT_TRUE(removal);
    p.click(*removal);
    EXPECT_FALSE(p.editor->look().plate);
    p.editor->undo();
    EXPECT_TRUE(p.editor->plate());
    // Esc leaves the dialog without a change.
    p.editor->state.plateImport = PlateLook{};
    p.frames(3);
    p.key(keyEscape);
    p.frames(3);
    EXPECT_FALSE(p.editor->state.plateImport);
    EXPECT_TRUE(p.editor->plate());
}

TEST(PlatePanels, theExportOffersItsFramesAndSaysWhatCannotBe) {
    Panels p;
    p.openSolved();
    p.editor->importPlate(capturePlate());
    p.until([&] { return !p.editor->job() && p.editor->plate(); });
    p.editor->state.panels.exportFrames = true;
    p.frame({});
    p.frames(3);
    const auto radio = p.find(Panels::idOf("Export frames###export", {"Frames of the plate:"}));
    ASSERT_TRUE(radio);
    p.click(*radio);
    ExportRequest r = p.editor->state.exportFrames;
    EXPECT_EQ(r.views, ExportRequest::Views::plate);
    EXPECT_EQ(r.range, "0-5");
    p.frames(2);
    const auto unsure = p.find(Panels::idOf("Export frames###export", {"Smooth where unsure"}));
    ASSERT_TRUE(unsure);
    p.click(*unsure);
    EXPECT_EQ(p.editor->state.exportFrames.unsure, PlateUnsure::smooth);
    const OpenPlate& plate = *p.editor->plate();
    r.file = p.folder / "relit.####.exr";
    EXPECT_TRUE(checkExport(r, 6, 0, &plate).ok());
    EXPECT_EQ(checkExport(r, 6, 0, &plate).firstFile, "relit.0000.exr");
    r.range = "4-9";
    EXPECT_EQ(checkExport(r, 6, 0, &plate).frames, 2u);
    r.range = "70";
    EXPECT_NE(checkExport(r, 6, 0, &plate).range.find("0 to 5"), std::string::npos);
    EXPECT_FALSE(checkExport(r, 6, 0).ok()) << "no plate is open";
    r.range = "";
    EXPECT_EQ(checkExport(r, 6, 0, &plate).frames, 6u);
    r.layers = "residual";
    EXPECT_FALSE(checkExport(r, 6, 0, &plate).layers.empty());
    r.layers = "groups,cryptomatte";
    r.exr.compression = "dwaa";
    EXPECT_NE(checkExport(r, 6, 0, &plate).layers.find("Cryptomatte"), std::string::npos);
    r.exr.compression = "piz";
    EXPECT_TRUE(checkExport(r, 6, 0, &plate).ok());
    r.views = ExportRequest::Views::all;
    r.ratio = Ratio::difference;
    EXPECT_TRUE(checkExport(r, 6, 0).ok());
    r.ratio = Ratio::none;
    r.layers = "";
    r.views = ExportRequest::Views::turntable;
    r.moveFrames = 12;
    EXPECT_EQ(checkExport(r, 6, 0).frames, 12u);
    r.views = ExportRequest::Views::path;
    for (const auto& [range, good] : {std::pair("3,1,6", true), {"2", false}, {"1,7", false}, {"0-2", false}}) {
        r.range = range;
        EXPECT_EQ(checkExport(r, 6, 0).ok(), good) << range;
    }
    r.views = ExportRequest::Views::bookmarks;
    for (const auto& [range, good] : {std::pair("2,1", true), {"1", false}, {"1-3", false}}) {
        r.range = range;
        EXPECT_EQ(checkExport(r, 6, 0, nullptr, 2).ok(), good) << range;
    }
    r.views = ExportRequest::Views::all;
    r.ratio = Ratio::difference;
    r.width = 10, r.height = 10;
    EXPECT_FALSE(checkExport(r, 6, 0).ok()) << "the photographs have another size";
}

TEST(ExportDialog, itsButtonsStayInSightInAShortWindow) {
    Panels p(800, 300);
    p.openSolved();
    p.editor->state.panels.exportFrames = true;
    p.frame({});
    p.frames(4);
    const auto close = p.find(Panels::idOf("Export frames###export", {"Close"}));
    ASSERT_TRUE(close);
    EXPECT_LT(close->y, 300);
    const ImGuiWindow* dialog = ImGui::FindWindowByName("Export frames###export");
    ASSERT_TRUE(dialog);
    EXPECT_EQ(dialog->ScrollMax.y, 0) << "one scrollbar, of what is asked";
    p.click(*close);
    EXPECT_FALSE(p.editor->state.panels.exportFrames);
}

}  // namespace
}  // namespace relamp::ui::test
