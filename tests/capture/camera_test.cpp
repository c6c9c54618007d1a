#include "capture/camera.h"

#include <gtest/gtest.h>

#include <glm/gtc/matrix_transform.hpp>

namespace relamp {
namespace {

Camera cameraOf(LensModel model, std::array<double, 8> distortion) {
    Camera camera;
    camera.width = 640, camera.height = 480;
    camera.focalX = 500, camera.focalY = 510, camera.centreX = 322, camera.centreY = 237;
    camera.model = model;
    camera.distortion = distortion;
    return camera;
}

TEST(Camera, NamesOfLensModelsGoThereAndBack) {
    for (const char* name :
         {"SIMPLE_PINHOLE", "PINHOLE", "SIMPLE_RADIAL", "RADIAL", "OPENCV", "OPENCV_FISHEYE", "FULL_OPENCV", "FOV",
          "SIMPLE_RADIAL_FISHEYE", "RADIAL_FISHEYE", "THIN_PRISM_FISHEYE", "BROWN"}) {
        const auto model = lensModelFromName(name);
        ASSERT_TRUE(model) << name;
        EXPECT_EQ(lensModelName(*model), name);
    }
    EXPECT_FALSE(lensModelFromName("opencv"));
    EXPECT_FALSE(lensModelFromName(""));
}

TEST(Camera, PinholeHasYDownAndLooksAlongMinusZ) {
    const Camera camera = cameraOf(LensModel::pinhole, {});
    const auto pixel = camera.project({0.2, 0.1, -2});
    ASSERT_TRUE(pixel);
    EXPECT_NEAR(pixel->x, 322 + 500 * 0.1, 1e-4);
    EXPECT_NEAR(pixel->y, 237 - 510 * 0.05, 1e-4);
    EXPECT_FALSE(camera.project({0, 0, 1}));
    EXPECT_FALSE(camera.project({0, 0, 0}));
    EXPECT_NEAR(camera.depthOf({0.2, 0.1, -2}), 2, 1e-12);
    EXPECT_NEAR(camera.forward().z, -1, 1e-12);
}

TEST(Camera, PoseMovesAndTurnsTheCamera) {
    // At (1, 2, 3), looking along world +X with +Z up.
    Camera camera = cameraOf(LensModel::pinhole, {});
    camera.worldFromCamera = DMat4(0, -1, 0, 0, 0, 0, 1, 0, -1, 0, 0, 0, 1, 2, 3, 1);
    EXPECT_NEAR(glm::distance(camera.forward(), DVec3(1, 0, 0)), 0, 1e-12);
    EXPECT_NEAR(camera.depthOf({5, 0, 0}), 4, 1e-12);
    const auto pixel = camera.project({3, 1, 4});  // one to the right (-Y), one up, two ahead
    ASSERT_TRUE(pixel);
    EXPECT_NEAR(pixel->x, 322 + 250, 1e-3);
    EXPECT_NEAR(pixel->y, 237 - 255, 1e-3);
    const Vec3 ray = camera.rayDirection(*pixel);
    EXPECT_NEAR(glm::distance(ray, glm::normalize(Vec3(2, -1, 1))), 0, 1e-6);
}

TEST(Camera, OpenCvGivesTheValueWorkedOutByHand) {
    Camera camera = cameraOf(LensModel::openCv, {0.1, -0.02, 0.01, -0.03});
    camera.focalX = 100, camera.focalY = 200, camera.centreX = 50, camera.centreY = 60;
    const auto pixel = camera.project({0.5, -0.25, -1});
    ASSERT_TRUE(pixel);
    // r^2 = 0.3125, radial = 1.029296875; x' = 0.4927734375, y' = 0.25419921875
    EXPECT_NEAR(pixel->x, 99.27734375, 1e-4);
    EXPECT_NEAR(pixel->y, 110.83984375, 1e-4);
}

TEST(Camera, OpenCvFisheyeGivesTheValueWorkedOutByHand) {
    Camera camera = cameraOf(LensModel::openCvFisheye, {0.1, 0.01, -0.02, 0.005});
    camera.focalX = 300, camera.centreX = 320, camera.centreY = 240;
    const auto pixel = camera.project({1, 0, -1});
    ASSERT_TRUE(pixel);
    // theta = pi / 4, theta_d = theta x 1.0615197 = 0.8337156
    EXPECT_NEAR(pixel->x, 320 + 300 * 0.83371563, 1e-3);
    EXPECT_NEAR(pixel->y, 240, 1e-4);
}

TEST(Camera, SimpleRadialGivesTheValueWorkedOutByHand) {
    const Camera camera = cameraOf(LensModel::simpleRadial, {-0.1});
    const auto pixel = camera.project({0.6, 0, -1});
    ASSERT_TRUE(pixel);
    EXPECT_NEAR(pixel->x, 322 + 500 * 0.6 * (1 - 0.1 * 0.36), 1e-3);
}

TEST(Camera, FullOpenCvDividesByTheSecondPolynomial) {
    const Camera camera = cameraOf(LensModel::fullOpenCv, {0.1, 0, 0, 0, 0, 0.2, 0, 0});
    const auto pixel = camera.project({0.5, 0, -1});
    ASSERT_TRUE(pixel);
    EXPECT_NEAR(pixel->x, 322 + 500 * 0.5 * 1.025 / 1.05, 1e-3);
}

TEST(Camera, FovGivesTheValueWorkedOutByHand) {
    const Camera camera = cameraOf(LensModel::fov, {0.8});
    const auto pixel = camera.project({0.6, 0, -1});
    ASSERT_TRUE(pixel);
    // atan(2 x 0.6 tan 0.4) / 0.8 = atan(0.50735186) / 0.8 = 0.58686283
    EXPECT_NEAR(pixel->x, 322 + 500 * std::atan(1.2 * std::tan(0.4)) / 0.8, 1e-3);
    EXPECT_NEAR(pixel->x, 322 + 500 * 0.5869, 0.05);
    // Far off the axis a point still lands short of omega's edge, pi / 2 / omega.
    EXPECT_LT(camera.project({1e6, 0, -1})->x, 322 + 500 * 0.5 * pi / 0.8f);
}

TEST(Camera, TheFormulaAloneFoldsBackWhereProjectionRefuses) {
    const Camera camera = cameraOf(LensModel::simpleRadial, {-0.3});
    EXPECT_FALSE(camera.project({1.5, 0, -1}));
    EXPECT_NEAR(camera.projectByFormula({1.5, 0, -1})->x, 322 + 500 * 1.5 * (1 - 0.3 * 2.25), 1e-9);
    EXPECT_FALSE(camera.projectByFormula({0, 0, 1}));
}

TEST(Camera, ProjectingARayGivesItsPixelBackForEveryLensModel) {
    const struct {
        LensModel model;
        std::array<double, 8> distortion;
    } lenses[] = {{LensModel::simplePinhole, {}},
                  {LensModel::pinhole, {}},
                  {LensModel::simpleRadial, {-0.15}},
                  {LensModel::simpleRadial, {0.3}},
                  {LensModel::radial, {-0.2, 0.05}},
                  {LensModel::openCv, {-0.25, 0.08, 0.002, -0.003}},
                  {LensModel::openCvFisheye, {0.03, -0.01, 0.004, -0.001}},
                  {LensModel::fullOpenCv, {0.5, 0.1, 0.001, -0.002, 0.01, 0.7, 0.2, 0.03}},
                  {LensModel::fov, {0.7}},
                  {LensModel::fov, {1e-6}},
                  {LensModel::simpleRadialFisheye, {-0.05}},
                  {LensModel::radialFisheye, {0.04, -0.02}},
                  {LensModel::brown, {-0.25, 0.08, 0.002, -0.003, -0.02, 0.004, 0.0015}},
                  {LensModel::thinPrismFisheye, {0.02, -0.01, 0.001, 0.002, 0.001, -0.0005, 0.002, -0.001}}};
    for (const auto& lens : lenses) {
        Camera camera = cameraOf(lens.model, lens.distortion);
        camera.worldFromCamera = glm::rotate(glm::translate(DMat4(1.0), DVec3(3, -2, 1)), 0.7, DVec3(1, 2, -0.5));
        for (int y = 0; y <= 480; y += 60)
            for (int x = 0; x <= 640; x += 64) {
                const Vec2 pixel{float(x), float(y)};
                const Vec3 ray = camera.rayDirection(pixel);
                EXPECT_NEAR(glm::length(ray), 1, 1e-5);
                const auto back = camera.project(camera.position() + 100.0 * DVec3(ray));
                ASSERT_TRUE(back) << lensModelName(lens.model) << " " << x << " " << y;
                EXPECT_NEAR(glm::distance(*back, pixel), 0, 2e-3) << lensModelName(lens.model) << " " << x << " " << y;
            }
    }
}

TEST(Camera, PointsBeyondTheFieldWhereTheDistortionGrowsDoNotProject) {
    // r (1 - 0.3 r^2) turns back at r = 1.054.
    const Camera camera = cameraOf(LensModel::simpleRadial, {-0.3});
    EXPECT_TRUE(camera.project({1.0, 0, -1}));
    EXPECT_FALSE(camera.project({1.1, 0, -1}));
    EXPECT_FALSE(camera.project({30, 0, -1}));
    // Grows again far out: still outside.
    const Camera wavy = cameraOf(LensModel::radial, {-0.5, 0.1});
    EXPECT_FALSE(wavy.project({3, 0, -1}));
}

TEST(Camera, RaysOfPixelsThatNoPointReachesAreStillUnitAndFinite) {
    const Camera camera = cameraOf(LensModel::simpleRadial, {-0.3});
    const Vec3 ray = camera.rayDirection({5000, 4000});
    EXPECT_TRUE(isFinite(ray));
    EXPECT_NEAR(glm::length(ray), 1, 1e-5);
    EXPECT_GT(ray.x, 0);
    EXPECT_LT(ray.y, 0);
}

TEST(Camera, PointsThatAreNotFiniteDoNotProject) {
    const Camera camera = cameraOf(LensModel::openCv, {0.1, 0, 0, 0});
    EXPECT_FALSE(camera.project({std::nan(""), 0, -1}));
    EXPECT_FALSE(camera.project({0, 0, std::nan("")}));
}

}  // namespace
}  // namespace relamp
