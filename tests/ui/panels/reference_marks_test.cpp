// Light references marked in photographs: real mouse in the dialog, and the estimate takes them.
#include "panels/reference_marks.h"
#include "interrupted.h"
#include "panels/dialogs.h"
#include "panels/inspector.h"
#include "ui/panels/panel_harness.h"

namespace relamp::ui::test {
namespace {

using Kind = MarkedReference::Kind;
constexpr const char* dialog = "Mark a light reference###reference";

/// Presses one of the buttons that begin a mark.
void begin(Panels& p, const char* name) {
    p.windowSize(340, 690);
    p.frame([&] { drawLightReferences(*p.editor); });
    const auto at = p.find(Panels::idOf("test", {name}));
    ASSERT_TRUE(at) << name;
    p.click(*at);
    p.frames(4);
    ASSERT_TRUE(p.editor->state.marking);
}

/// The dialog's photograph: what a pixel of it is on the screen, while all of it is seen.
class Canvas {
public:
    explicit Canvas(Panels& p) : panels_(p) {
        const ImGuiWindow* window = ImGui::FindWindowByName(dialog);
        const ImGuiID id = ImHashStr("##photograph", 0, window->ID);
        const ImVec2 screen = ImGui::GetIO().DisplaySize;
        // Its borders, to a pixel.
        for (float y = 2; y < screen.y; y += 12)
            for (float x = 2; x < screen.x; x += 12)
                if (over(id, {x, y})) {
                    low_ = {std::min(low_.x, x), std::min(low_.y, y)};
                    high_ = {std::max(high_.x, x), std::max(high_.y, y)};
                }
        while (over(id, {low_.x - 1, low_.y})) --low_.x;
        while (over(id, {low_.x, low_.y - 1})) --low_.y;
        while (over(id, {high_.x + 1, high_.y})) ++high_.x;
        while (over(id, {high_.x, high_.y + 1})) ++high_.y;
        ++high_.x, ++high_.y;
        const Camera& camera = p.editor->state.document.capture->views[0].camera;
        scale_ = std::min((high_.x - low_.x) / float(camera.width), (high_.y - low_.y) / float(camera.height));
        middle_ = 0.5f * Vec2(float(camera.width), float(camera.height));
    }
    ImVec2 at(const Vec2& pixel) const {
        const Vec2 s = 0.5f * (low_ + high_) + scale_ * (pixel - middle_);
        return {s.x, s.y};
    }
    void drag(const Vec2& from, const Vec2& to) const {
        panels_.mouse(at(from));
        panels_.frames(2);
        panels_.press(true);
        panels_.mouse(at(to));
        panels_.frames(2);
        panels_.press(false);
        panels_.frames(2);
    }

private:
    Panels& panels_;
    Vec2 low_{1e9f}, high_{0}, middle_{0};
    float scale_ = 1;

    bool over(ImGuiID id, const Vec2& at) const {
        panels_.mouse({at.x, at.y});
        panels_.frames(1);
        return ImGui::GetCurrentContext()->HoveredId == id;
    }
};

/// A pixel of view 0 that shows the floor, as all around it do.
Vec2 floorPixel(const Editor& editor) {
    const Document& document = editor.state.document;
    const Camera& camera = document.capture->views[0].camera;
    for (int y = 8; y < camera.height - 8; y += 2)
        for (int x = 8; x < camera.width - 8; x += 2) {
            bool floor = true;
            for (const Vec2 off : {Vec2(0, 0), Vec2(-6, 0), Vec2(6, 0), Vec2(0, -6), Vec2(0, 6)}) {
                const Ray ray{Vec3(camera.position()), camera.rayDirection(Vec2(x, y) + off)};
                const Hit hit = document.scene->tracer->closest(ray);
                floor &= bool(hit) && std::abs(ray.origin.z + hit.distance * ray.direction.z) < 1e-3f;
            }
            if (floor) return {float(x), float(y)};
        }
    return {0, 0};
}

Rgb albedoSeenAt(const Editor& editor, const Vec2& pixel) {
    const Document& document = editor.state.document;
    const Camera& camera = document.capture->views[0].camera;
    const Ray ray{Vec3(camera.position()), camera.rayDirection(pixel)};
    const Hit hit = document.scene->tracer->closest(ray);
    return relamp::test::KnownWorld::albedoAt(ray.origin + hit.distance * ray.direction);
}

void use(Panels& p) {
    const auto at = p.find(Panels::idOf(dialog, {"Use"}));
    ASSERT_TRUE(at);
    p.click(*at);
    p.frames(3);
}

TEST(ReferenceMarks, aGreyCardDrawnInAPhotographIsAMeasurementOfTheEstimate) {
    Panels p;
    p.openCapture();
    begin(p, "Grey card...");
    ASSERT_FALSE(HasFatalFailure());
    use(p);
    EXPECT_TRUE(p.editor->state.marking) << "nothing is marked yet";
    const Vec2 pixel = floorPixel(*p.editor);
    ASSERT_GT(pixel.x, 0);
    const Canvas canvas(p);
    canvas.drag(pixel, pixel + Vec2(3, 0));
    ASSERT_TRUE(p.editor->state.marking);
    MarkedReference& mark = p.editor->state.marking->mark;
    ASSERT_EQ(mark.points.size(), 1u);
    EXPECT_NEAR(mark.points[0].x, pixel.x, 0.3);
    EXPECT_NEAR(mark.points[0].y, pixel.y, 0.3);
    EXPECT_NEAR(mark.radius, 3, 0.3);
    // Inside it, a drag moves it; at its rim, it changes its size.
    canvas.drag(pixel, pixel + Vec2(1, 1));
    EXPECT_NEAR(mark.points[0].y, pixel.y + 1, 0.3);
    EXPECT_NEAR(mark.radius, 3, 0.3);
    canvas.drag(pixel + Vec2(1, 4), pixel + Vec2(1, 3));
    EXPECT_NEAR(mark.radius, 2, 0.3);
    mark.albedo = albedoSeenAt(*p.editor, mark.points[0]);
    const MarkedReference told = mark;
    use(p);
    EXPECT_FALSE(p.editor->state.marking);
    ASSERT_EQ(p.editor->state.solve.marks.size(), 1u);
    EXPECT_TRUE(p.editor->state.solve.marks[0] == told);

    p.editor->solve(p.editor->state.solve);
    p.until([&] { return !p.editor->job(); });
    ASSERT_TRUE(p.editor->estimate());
    const std::vector<PatchFit>& fits = p.editor->estimate()->patches;
    ASSERT_EQ(fits.size(), 1u);
    EXPECT_EQ(fits[0].name, nameOf(told));
    EXPECT_NEAR(luminance(fits[0].found) / luminance(told.albedo), 1, 0.1);
    EXPECT_FALSE(p.editor->stale());
    p.windowSize(340, 690);
    p.frame([&] { inspectLightReferences(*p.editor->estimate()); });
    EXPECT_TRUE(p.find(Panels::idOf("test", {"Evidence"})));

    // A click on its row opens it again; Esc changes nothing.
    p.frame([&] { drawLightReferences(*p.editor); });
    p.editor->state.marking = ReferenceMarking{told, 0};
    p.frames(3);
    canvas.drag(told.points[0], told.points[0] + Vec2(8, 0));
    p.key(keyEscape);
    p.frames(2);
    EXPECT_FALSE(p.editor->state.marking);
    EXPECT_TRUE(p.editor->state.solve.marks[0] == told);
    // Its bin takes it away, and the estimate is no longer of these settings.
    const auto bin = p.find([] {
        const ImGuiID row = [] {
            const int first = 0;
            return ImHashData(&first, sizeof first, ImHashStr("test", 0));
        }();
        return ImHashStr("##remove reference", 0, row);
    }());
    ASSERT_TRUE(bin);
    p.click(*bin);
    EXPECT_TRUE(p.editor->state.solve.marks.empty());
    EXPECT_TRUE(p.editor->stale());
}

TEST(ReferenceMarks, aChartIsFourClicksAndABallWithoutARimIsNotTaken) {
    Panels p;
    p.openCapture();
    begin(p, "Colour chart...");
    ASSERT_FALSE(HasFatalFailure());
    const Canvas canvas(p);
    const Vec2 corners[] = {{20, 20}, {50, 22}, {50, 20}, {19, 41}};
    for (const Vec2& corner : corners) canvas.drag(corner, corner);
    MarkedReference& mark = p.editor->state.marking->mark;
    ASSERT_EQ(mark.points.size(), 4u);
    // Three of them nearly on a line: it can be mended by a drag.
    canvas.drag({19, 41}, {49, 26});
    use(p);
    EXPECT_TRUE(p.editor->state.marking) << "no convex shape";
    canvas.drag({49, 26}, {19, 41});
    canvas.drag({50, 20}, {48, 40});
    EXPECT_NEAR(mark.points[2].x, 48, 0.5);
    EXPECT_NEAR(mark.points[2].y, 40, 0.5);
    use(p);
    EXPECT_FALSE(p.editor->state.marking);
    ASSERT_EQ(p.editor->state.solve.marks.size(), 1u);
    EXPECT_EQ(pipelineOptionsOf(p.editor->state.solve).solve.patches.size(), 24u);

    begin(p, "Mirror ball...");
    ASSERT_FALSE(HasFatalFailure());
    const Vec2 floor = floorPixel(*p.editor);
    canvas.drag(floor, floor + Vec2(5, 0));
    ASSERT_EQ(p.editor->state.marking->mark.points.size(), 1u);
    for (int i = 0; i < 400; ++i) {
        p.frames(1);
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    use(p);
    EXPECT_TRUE(p.editor->state.marking) << "there is no ball on the plain floor";
    p.key(keyEscape);
    p.frames(2);
    EXPECT_EQ(p.editor->state.solve.marks.size(), 1u);
}

TEST(ReferenceMarks, anInterruptedEstimateKeepsThem) {
    TemporaryFolder folder;
    InterruptedEstimate what;
    what.record = folder / "estimates" / "x.estimate.json";
    what.project = folder.path();
    MarkedReference ball;
    ball.kind = Kind::mirrorBall;
    ball.view = 3;
    ball.points = {{412.5f, 300}};
    ball.radius = 90;
    ball.photograph = folder / "ball.exr";
    MarkedReference grey;
    grey.points = {{10, 20}};
    grey.albedo = {0.5f, 0.4f, 0.3f};
    what.request.marks = {ball, grey};
    SolveCheckpoint checkpoint;
    {
        EstimateKeeper keeper(what, 7, 0);
        keeper.take(checkpoint);
        keeper.stopped();
    }
    const auto found = readInterrupted(what.record);
    ASSERT_TRUE(found);
    EXPECT_EQ(found->request.marks, what.request.marks);
    EXPECT_EQ(toText(ball), (folder / "ball.exr").string() + "@3:412.5,300,90");
    EXPECT_EQ(toText(grey), "0:10,20,0=0.5,0.4,0.3");
}

}  // namespace
}  // namespace relamp::ui::test
