// The image of the triangles that an eye sees against that of all of them. Needs OpenGL 4.3 without a window, llvmpipe
// too; without EGL it says so.
#include "viewport/seen_triangles.h"

#include <gtest/gtest.h>

#include "support/estimates.h"
#include "support/shapes.h"
#include "viewport/gpu_context.h"

namespace relamp::ui {
namespace {

std::shared_ptr<const Mesh> ballOverGround(const Vec3& centre, size_t& ofTheGround) {
    Mesh mesh = test::sheet({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, 20, 20);
    ofTheGround = mesh.vertexCount();
    test::append(mesh, test::ball(centre, 0.3f, 12, 24));
    return std::make_shared<const Mesh>(std::move(mesh));
}

TEST(SeenTriangles, giveTheImageOfAllAlsoWhereSomeMove) {
    std::string why;
    const auto context = openGpuContext(true, &why);
    if (why.find("EGL is not installed") != std::string::npos || why == "EGL offers no display") GTEST_SKIP() << why;
    ASSERT_TRUE(context) << why;
    context->makeCurrent();
    {
        Renderer renderer;
        GpuMesh mesh;
        SeenTriangles seen;
        size_t ofTheGround = 0;
        const EyeView eye = eyeOf(test::cameraAt({2, -1.5f, 1.5f}, {0, 0, 0.2f}, 160, 120, 160), {0, 0}, {160, 120},
                                  {1, 1}, {0, 0, 0}, 4);
        GlBuffer colours;
        const auto imageOf = [&](bool some) {
            ImageJob job;
            job.eye = eye;
            SceneLayer layer;
            layer.mesh = &mesh, layer.colours = &colours;
            if (some) layer.some = &seen.indices(), layer.someTriangles = seen.count();
            job.layers = {layer};
            renderer.draw(job, 0);
            int width = 0, height = 0;
            return renderer.readBack(width, height);
        };
        for (int step = 0; step < 4; ++step) {
            const auto now = ballOverGround({0.1f * float(step), 0, 0.5f}, ofTheGround);
            mesh.upload(now, {}, 1);
            std::vector<Rgb> paint(now->vertexCount());
            for (size_t v = 0; v < paint.size(); ++v) paint[v] = glm::abs(now->positions[v]);
            colours.upload(GL_ARRAY_BUFFER, paint);
            ASSERT_EQ(seen.follow(renderer, eye, mesh, {}, 1), step > 0);
            if (step == 0) continue;
            const size_t ball = now->triangles.size() - 2 * 20 * 20;
            EXPECT_LT(seen.count(), now->triangles.size());
            EXPECT_GT(seen.count(), ball) << "what moves is drawn whole";
            EXPECT_EQ(imageOf(true), imageOf(false)) << step;
        }
        // Another eye begins anew.
        EyeView other = eye;
        other.clipFromWorld[3][0] += 0.1f;
        EXPECT_FALSE(seen.follow(renderer, other, mesh, {}, 1));
    }
    context->release();
}

}  // namespace
}  // namespace relamp::ui
