#include "shot/other_photographs.h"

#include <gtest/gtest.h>

#include "base/parallel.h"
#include "shot/ratio_frame.h"
#include "support/estimates.h"

namespace relamp {
namespace {

/// A grey sheet under an even sky, photographed with a print on it that the model does not know, and a camera between
/// the photographs. A board hangs over one corner of it.
struct UnknownPrint {
    Scene scene;
    Estimate estimate;
    RelitScene relit;
    Camera camera = test::cameraAt({0.15, -0.2, 2.2}, {0, 0, 0}, 60, 60, 70);

    static Mesh meshOf() {
        Mesh mesh = test::sheet({-1, -1, 0}, {2, 0, 0}, {0, 2, 0});
        test::append(mesh, test::sheet({0.2f, 0.2f, 0.25f}, {0.8f, 0, 0}, {0, 0.8f, 0}));
        return mesh;
    }
    UnknownPrint()
        : scene(test::sceneOf(meshOf())),
          estimate(test::matteEstimate(scene, Rgb(0.5f), Rgb(1))),
          relit(test::relitOf(scene, estimate)) {}

    static Rgb print(const Vec3& p) {
        return Rgb(0.4f) + 0.15f * Rgb(std::sin(9 * p.x) * std::cos(8 * p.y), std::sin(7 * p.y), 0);
    }
    View view(const DVec3& eye) const {
        return test::photographOf(scene, test::cameraAt(eye, {0, 0, 0}, 128, 128, 160),
                                  [&](const Hit& hit) { return hit ? print(scene.pointOf(hit)) : Rgb(0); });
    }
    OtherPhotographs photographs() const {
        OtherPhotographs others(relit);
        Progress progress;
        for (const DVec3& eye : {DVec3(-0.8, -0.6, 2), DVec3(0.9, -0.5, 2), DVec3(-0.3, -0.9, 2)})
            others.add(view(eye), progress);
        return others;
    }
    Frame model() const {
        Progress progress;
        FrameOptions options;
        return renderFrame(relit, camera, options, progress);
    }
    Image rows(const OtherPhotographs& others, const Frame& old, int first = 0) const {
        Progress progress;
        FrameOptions options;
        const FrameRenderer renderer(relit, camera, options);
        return others.rows(camera, first, old, renderer, progress);
    }
};

TEST(OtherPhotographs, ShowAPrintThatTheModelDoesNotKnow) {
    const UnknownPrint sheet;
    const OtherPhotographs others = sheet.photographs();
    const Frame model = sheet.model();
    const Image seen = sheet.rows(others, model);
    double error = 0, modelError = 0;
    size_t count = 0;
    for (size_t p = 0; p < seen.pixels.size(); ++p) {
        const Vec3 at = model.position[p];
        if (model.alpha[p] < 1 || std::abs(at.z) > 1e-3f || std::max(at.x, at.y) > 0.1f || std::min(at.x, at.y) < -0.5f)
            continue;
        ASSERT_TRUE(seen.usable[p]);
        const Rgb truth = UnknownPrint::print(at);
        error += double(glm::dot(seen.pixels[p] - truth, seen.pixels[p] - truth));
        modelError += double(glm::dot(model.beauty[p] - truth, model.beauty[p] - truth));
        ++count;
    }
    EXPECT_GT(count, 300u);
    EXPECT_LT(std::sqrt(error), 0.1 * std::sqrt(modelError));
}

TEST(OtherPhotographs, LeaveTheModelWhereNoneShowsTheSurface) {
    UnknownPrint sheet;
    // From below the board: the sheet under it, which the photographs from above do not show.
    sheet.camera = test::cameraAt({0.6, -0.9, 0.12}, {0.6, 0.6, 0.02}, 60, 40, 60);
    const Frame model = sheet.model();
    const Image seen = sheet.rows(sheet.photographs(), model);
    size_t hidden = 0, shown = 0;
    for (size_t p = 0; p < seen.pixels.size(); ++p) {
        const Vec3 at = model.position[p];
        if (model.alpha[p] < 1 || std::abs(at.z) > 1e-3f) continue;
        if (at.x > 0.5f && at.x < 0.7f && at.y > 0.5f && at.y < 0.7f) {
            EXPECT_FALSE(seen.usable[p]);
            ++hidden;
        }
        if (std::abs(at.x) < 0.9f && at.y < 0 && at.y > -0.6f && seen.usable[p]) ++shown;
    }
    EXPECT_GT(hidden, 5u);
    EXPECT_GT(shown, 50u);
}

TEST(OtherPhotographs, HighlightsOfPhotographsStayBehind) {
    UnknownPrint sheet;
    // The photographs are the model's own images; the lamp's reflection lies elsewhere in each.
    sheet.estimate.reflectance.basis.lobes.push_back({Lobe::Kind::ggx, 0.2f, "ggx"});
    sheet.estimate.reflectance.weight.push_back(std::vector<Rgb>(sheet.scene.mesh.vertexCount(), Rgb(0.3f)));
    Look lamp;
    lamp.added.push_back({EmitterShape::sphere, "bulb", test::translation({-0.3f, -0.2f, 1.2f}), Vec2(0.1f), Rgb(60)});
    sheet.relit = test::relitOf(sheet.scene, sheet.estimate, lamp);
    OtherPhotographs others(sheet.relit);
    Progress progress;
    for (const DVec3& eye : {DVec3(-0.8, -0.6, 2), DVec3(0.9, -0.5, 2)}) {
        View view;
        view.camera = test::cameraAt(eye, {0, 0, 0}, 128, 128, 160);
        const Frame frame = renderFrame(sheet.relit, view.camera, {}, progress);
        view.image = Image(128, 128);
        view.image.pixels = frame.beauty;
        others.add(view, progress);
    }
    const Frame model = sheet.model();
    const Image seen = sheet.rows(others, model);
    size_t count = 0;
    for (size_t p = 0; p < seen.pixels.size(); ++p) {
        if (!seen.usable[p] || model.position[p].z > 0.01f) continue;
        EXPECT_NEAR(seen.pixels[p].y / model.beauty[p].y, 1, 1e-3);
        ++count;
    }
    EXPECT_GT(count, 300u);
}

TEST(OtherPhotographs, SameBitsOnAnyNumberOfThreadsAndInAnyRows) {
    const UnknownPrint sheet;
    const OtherPhotographs others = sheet.photographs();
    const Frame model = sheet.model();
    Image one;
    {
        const ThreadLimit limit(1);
        one = sheet.rows(others, model);
    }
    const ThreadLimit limit(3);
    EXPECT_EQ(sheet.rows(others, model).pixels, one.pixels);
    const Image some = sheet.rows(others, model.rows(20, 10), 20);
    for (size_t p = 0; p < some.pixels.size(); ++p) ASSERT_EQ(some.pixels[p], one.pixels[20 * 60 + p]);
}

}  // namespace
}  // namespace relamp
