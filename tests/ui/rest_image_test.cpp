// The per-pixel image that the viewport shows at rest.
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

}  // namespace
}  // namespace relamp::ui::test
