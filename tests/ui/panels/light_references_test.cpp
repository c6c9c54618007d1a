// A panorama beside a capture that is not estimated: what it is for is asked, and the estimate takes it.
#include "image/environment_map.h"
#include "image/image_io.h"
#include "panels/inspector.h"
#include "ui/panels/panel_harness.h"

namespace relamp::ui::test {
namespace {
namespace fs = std::filesystem;

/// The sky of the painted room, turned by 30 degrees and half as bright.
fs::path setPanorama(const TemporaryFolder& folder) {
    Image sky(128, 64);
    for (int y = 0; y < sky.height; ++y)
        for (int x = 0; x < sky.width; ++x)
            sky.at(x, y) = 0.5f * relamp::test::KnownWorld::sky(
                                      directionFromLatLong({(float(x) + 0.5f) / 128, (float(y) + 0.5f) / 64}));
    writeImage(folder / "set.exr", yawed(sky, -30));
    return folder / "set.exr";
}

void open(Panels& p, const fs::path& file) {
    p.editor->open(file);
    p.frames(3);
    ASSERT_TRUE(p.editor->state.panorama);
}

TEST(PanoramaQuestion, aPanoramaBesideAnUnestimatedCaptureCanBeOneAndTheEstimateSaysHowWellItAgreed) {
    Panels p;
    const fs::path file = setPanorama(p.folder);
    // Without a capture there is nothing that it could be the reference of.
    p.editor->open(file);
    ASSERT_EQ(p.editor->state.notices.size(), 1u);
    p.editor->state.notices.clear();
    p.openCapture();
    p.frame({});
    open(p, file);
    p.key(keyEscape);
    p.frames(2);
    EXPECT_FALSE(p.editor->state.panorama);
    EXPECT_TRUE(p.editor->state.solve.lightProbes.empty());

    open(p, file);
    const auto at =
        p.find(Panels::idOf("What is this panorama?###panorama", {"Use as light reference of this capture"}));
    ASSERT_TRUE(at);
    p.click(*at);
    p.until([&] { return !p.editor->job(); });
    EXPECT_EQ(p.editor->state.solve.lightProbes, std::vector<fs::path>{file});
    EXPECT_FALSE(p.editor->state.panorama);
    // Once more is not twice.
    p.editor->addLightProbe(file);
    p.until([&] { return !p.editor->job(); });
    EXPECT_EQ(p.editor->state.solve.lightProbes.size(), 1u);
    // A file that is no panorama is none, and says so.
    writeImage(p.folder / "square.exr", Image(8, 8));
    p.editor->addLightProbe(p.folder / "square.exr");
    p.until([&] { return !p.editor->job(); });
    EXPECT_EQ(p.editor->state.solve.lightProbes.size(), 1u);
    ASSERT_EQ(p.editor->state.notices.size(), 1u);
    EXPECT_NE(p.editor->state.notices[0].text.find("square.exr"), std::string::npos);
    p.editor->state.notices.clear();

    // Or it becomes the environment, with the first estimate; here it is both.
    open(p, file);
    p.editor->answerPanorama(PanoramaUse::environment);
    p.until([&] { return !p.editor->job(); });
    EXPECT_EQ(p.editor->state.environmentToCome, file);
    EXPECT_EQ(p.editor->look().environment.source, EnvironmentLook::Source::recovered);

    p.editor->solve(p.editor->state.solve);
    p.until([&] { return !p.editor->job(); });
    ASSERT_TRUE(p.editor->estimate());
    const Estimate& estimate = *p.editor->estimate();
    ASSERT_EQ(estimate.probes.size(), 1u);
    EXPECT_EQ(estimate.probes[0].name, "set.exr");
    EXPECT_EQ(estimate.probes[0].by, "background");
    EXPECT_NEAR(estimate.probes[0].yawDegrees, 30, 3);
    EXPECT_FALSE(p.editor->stale());
    EXPECT_EQ(p.editor->look().environment.source, EnvironmentLook::Source::file);
    EXPECT_EQ(p.editor->look().environment.file, file);
    EXPECT_TRUE(p.editor->state.environmentToCome.empty());
    p.windowSize(340, 690);
    p.frame([&] { inspectLightReferences(*p.editor->estimate()); });
    EXPECT_TRUE(p.find(Panels::idOf("test", {"Evidence"}))) << "it says how well they agree";
    // The next one can do without it.
    p.frame([&] { drawLightReferences(*p.editor); });
    p.editor->state.solve.lightProbes.clear();
    EXPECT_TRUE(p.editor->stale());
    // Another capture has none of it.
    p.editor->state.solve.lightProbes = {file};
    relamp::test::TemporaryFolder other;
    fs::copy(PaintedRoom::get().capture, other / "other", fs::copy_options::recursive);
    p.editor->openNow(other / "other");
    p.until([&] { return !p.editor->job(); });
    EXPECT_TRUE(p.editor->state.solve.lightProbes.empty());
}

}  // namespace
}  // namespace relamp::ui::test
