// Lights whose light passes through everything.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "edit/emitter_edits.h"
#include "relight/frame.h"
#include "relight/live/live_scene.h"
#include "support/estimates.h"

namespace relamp {
namespace {

/// A plane, a square above it, and an emitter above that, which the square hides from the plane's middle.
struct Table {
    Scene scene;
    Estimate estimate;
    size_t plane = 0;
    Table() {
        Mesh mesh = test::sheet({-2, -2, 0}, {4, 0, 0}, {0, 4, 0}, 40, 40);
        plane = mesh.vertexCount();
        test::append(mesh, test::squareAbove(0.8f, 0, 0, 1, 2));
        const auto emitter = test::append(mesh, test::squareAbove(0.4f, 0, 0, 2, 2));
        scene = test::sceneOf(mesh);
        estimate = test::matteEstimate(scene, Rgb(1), Rgb(0), test::emittersOf(scene, {emitter}, {Rgb(10)}));
    }
};

/// Form factor of a square of side 0.4 at height 2, from a point of the plane.
double openFactor(const Vec3& p) { return test::rectangleFormFactor(-0.2 - p.x, 0.2 - p.x, -0.2 - p.y, 0.2 - p.y, 2); }

TEST(ShadowlessLight, LightsWhatItCannotSeeInFramesAndInTheViewport) {
    const auto table = std::make_shared<Table>();
    Look look;
    setShadows(look, "emitter-1", false);
    FrameOptions options;
    options.samplesPerPixel = 32;
    Progress progress;
    const RelitScene relit = test::relitOf(table->scene, table->estimate, look);
    const Frame frame =
        renderFrame(relit, test::cameraAt({0, 0, 0.9}, {0, 0, 0}, 16, 16, 12, {0, 1, 0}), options, progress);
    for (size_t p = 0; p < frame.beauty.size(); ++p)
        EXPECT_NEAR(frame.beauty[p].y / (10 * openFactor(frame.position[p])), 1, 0.03);

    const std::shared_ptr<const Scene> scene(table, &table->scene);
    LiveScene live(scene, std::shared_ptr<const Estimate>(table, &table->estimate), {}, progress);
    const auto shown = [&](const Look& l) {
        live.setLook(l);
        while (!live.refine(0.5, progress)) {}
        return live.frame();
    };
    const auto with = shown({}), without = shown(look), back = shown({});
    for (size_t v = 0; v < table->plane; ++v)
        EXPECT_NEAR(without->radiance[v].y / (10 * openFactor(scene->mesh.positions[v])), 1, 0.01);
    EXPECT_EQ(with->radiance, back->radiance);
    float hidden = 0;
    for (size_t v = 0; v < table->plane; ++v)
        if (glm::length(scene->mesh.positions[v]) < 0.2f) hidden += with->radiance[v].y;
    EXPECT_EQ(hidden, 0);
}

TEST(ShadowlessLight, IsAnEditThatIsKeptAndGoesBack) {
    const Table table;
    Look look;
    setShadows(look, "emitter-1", false);
    EXPECT_TRUE(findEmitter(table.scene, table.estimate, look, "emitter-1")->changed);
    EXPECT_EQ(lookFromJson(lookToJson(look), {}), look);
    resetEmitter(look, "emitter-1", EmitterValue::all);
    EXPECT_EQ(look, Look{});
    look.added.push_back({EmitterShape::disk, "disk-1"});
    setShadows(look, "disk-1", false);
    EXPECT_FALSE(look.added[0].shadows);
    EXPECT_EQ(lookFromJson(lookToJson(look), {}), look);
}

}  // namespace
}  // namespace relamp
