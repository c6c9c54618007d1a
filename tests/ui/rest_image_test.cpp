// The per-pixel image that the viewport shows at rest.
#include "actions.h"
#include "image/image_io.h"
#include "ui/panels/panel_harness.h"
#include "viewport/picking.h"

namespace relamp::ui::test {
namespace {

void untilIdle(Panels& p) {
    p.editor->poll();  // what was asked for just now is under way
    p.until([&] { return !p.editor->job() && !p.editor->busy(); });
}

/// Root mean square of what an image is off by, over the surfaces that are no light; a few bright pixels do not decide.
double errorOf(const std::vector<Rgb>& image, const Frame& truth) {
    double sum = 0;
    for (size_t i = 0; i < image.size(); ++i) {
        if (truth.alpha[i] < 0.99f || truth.emittersSeen[i][0].fraction > 0) continue;
        const Rgb off = (image[i] - truth.beauty[i]) / (truth.beauty[i] + Rgb(0.05f));
        sum += glm::dot(off, off);
    }
    return std::sqrt(sum / double(image.size()));
}

TEST(RestImage, isNeverCoarserOrWorseThanTheImageBeforeIt) {
    Panels p;
    p.openSolved();
    Editor& editor = *p.editor;
    const Camera eye = relamp::test::cameraAt({2, -1.5, 1.5}, {0, 0, 0.2}, 80, 60, 80);
    editor.setEye(eye, false);
    untilIdle(p);
    const std::string id = editor.emitters()[0].id;
    editor.beginGesture("Move");
    Mat4 by(1);
    by[3] = Vec4(0.15f, 0.1f, 0, 1);
    editor.preview([&](Look& look) { moveEmitter(look, id, by); });
    editor.requestImage();
    p.until([&] { return !editor.imageOwed(); });
    editor.commitGesture();
    const auto dragged = editor.liveFrame();

    Progress progress;
    const RelitScene relit = applyLook(*editor.state.document.scene, *editor.estimate(), editor.look(), progress);
    FrameOptions options;
    options.samplesPerPixel = 32;
    options.background = false;
    const Frame truth = renderFrame(relit, eye, options, progress);
    const auto shown = [&](const LiveFrame& live) {
        std::vector<Rgb> image;
        for (int y = 0; y < eye.height; ++y)
            for (int x = 0; x < eye.width; ++x)
                image.push_back(
                    radianceAlong(live, {Vec3(eye.position()), eye.rayDirection({x + 0.5, y + 0.5})}).value_or(Rgb(0)));
        return image;
    };
    double error = errorOf(shown(*dragged), truth);
    size_t images = 0;
    std::shared_ptr<const Frame> last;
    p.until([&] {
        if (const auto rest = editor.restFrame(); rest && rest != last) {
            EXPECT_EQ(rest->width, 80);
            EXPECT_EQ(rest->height, 60);
            const double now = errorOf(rest->beauty, truth);
            EXPECT_LE(now, error) << "image " << images;
            error = now;
            last = rest;
            ++images;
        }
        return !editor.busy() && images > 0;
    });
    EXPECT_GT(images, 0u);
    // A question about a point, a look at another mode or the palette never bring a coarser one back.
    editor.pick(PickedPoint{0, Vec2(0.3f), {}, {0, 0, 1}, 0});
    p.until([&] {
        EXPECT_EQ(editor.restFrame(), last);
        return editor.state.pointLight.has_value();
    });
    editor.state.viewport.mode = ViewMode::albedo;
    untilIdle(p);
    editor.state.viewport.mode = ViewMode::relit;
    untilIdle(p);
    EXPECT_EQ(editor.restFrame(), last);
}

TEST(RenderRegion, aloneIsRenderedAtRestAndExported) {
    Panels p;
    p.openSolved();
    Editor& editor = *p.editor;
    editor.setEye(relamp::test::cameraAt({2, -1.5, 1.5}, {0, 0, 0.2}, 80, 60, 80), false);
    untilIdle(p);
    const auto sizeAtRest = [&] {
        untilIdle(p);
        p.until([&] { return editor.restFrame() != nullptr; });
        return std::pair(editor.restFrame()->width, editor.restFrame()->height);
    };
    EXPECT_EQ(sizeAtRest(), std::pair(80, 60));
    const auto live = editor.liveFrame();
    // The first one arms the pointer, again it disarms.
    EXPECT_TRUE(runAction(editor, "view.region"));
    EXPECT_EQ(editor.state.viewport.clickTask, ClickTask::region);
    EXPECT_TRUE(runAction(editor, "view.region"));
    EXPECT_EQ(editor.state.viewport.clickTask, ClickTask::none);
    editor.state.viewport.region = relamp::ImageRegion{{0.25f, 0.5f}, {0.5f, 1}};
    editor.poll();
    EXPECT_FALSE(editor.imageOwed()) << "the light per vertex is the same";
    EXPECT_EQ(sizeAtRest(), std::pair(20, 30));
    EXPECT_EQ(editor.liveFrame(), live);

    ExportRequest request;
    request.file = p.folder / "part.png";
    request.samples = 1;
    request.layers = "";
    const auto exported = [&] {
        editor.exportFrames(request);
        p.until([&] { return !editor.job(); });
        return readImageSize(request.file);
    };
    EXPECT_EQ(exported(), std::pair(20, 30));
    // A region too is written as the viewport shows it.
    const Image bright = readImage(request.file);
    editor.state.viewport.exposureStops = -20;
    EXPECT_EQ(exported(), std::pair(20, 30));
    EXPECT_NE(readImage(request.file).pixels, bright.pixels);
    editor.state.viewport.exposureStops = 0;
    // A wider frame has more at its sides, and the region stays on what it shows.
    request.width = 160, request.height = 60;
    EXPECT_EQ(exported(), std::pair(20, 30));
    request.regionOnly = false;
    EXPECT_EQ(exported(), std::pair(160, 60));
    request.regionOnly = true;
    request.views = ExportRequest::Views::capture;
    EXPECT_EQ(exported(), std::pair(160, 60)) << "photographs have no region";
    EXPECT_TRUE(runAction(editor, "view.region"));
    EXPECT_FALSE(editor.state.viewport.region);
    EXPECT_EQ(sizeAtRest(), std::pair(80, 60));
}

}  // namespace
}  // namespace relamp::ui::test
