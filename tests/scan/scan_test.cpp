// Scans of a made scene whose every point is known.
#include "scan/scan.h"

#include <gtest/gtest.h>

#include "base/parallel.h"
#include "base/statistics.h"
#include "scan/painted_scan.h"
#include "support/stopping.h"

namespace relamp {
namespace {

using test::PaintedScan;

std::vector<double> offSurface(const PaintedScan& scene, const Mesh& mesh) {
    std::vector<double> off;
    for (const Vec3& p : mesh.positions) off.push_back(scene.offSurface(DVec3(p)));
    return off;
}

TEST(Scan, PointsLieOnTheSurfaceAndTheProjectorIsFound) {
    const PaintedScan scene;
    Progress progress;
    const ScanResult result = scanSurface(scene.calibration, scene.input(), {}, progress);
    const std::vector<double> off = offSurface(scene, result.mesh.mesh);
    EXPECT_LT(meanMedianOf(off), 0.0008);
    EXPECT_LT(quantileOf(off, 0.95), 0.004);
    for (const ScanCameraFigures& camera : result.cameras) {
        EXPECT_GT(double(camera.points), 0.75 * double(camera.lit)) << camera.name;
        EXPECT_GT(camera.matched, 2000u) << camera.name;
    }
    ASSERT_EQ(result.projectorFrom, ProjectorFrom::resection);
    EXPECT_LT(glm::distance(result.projector->position(), scene.projector.position()), 0.02);
    EXPECT_LT(result.resection.median, 0.3);
    // Every face is turned towards the cameras.
    size_t away = 0;
    for (size_t t = 0; t < result.mesh.mesh.triangles.size(); ++t) away += result.mesh.mesh.faceNormal(t).z < -0.2f;
    EXPECT_EQ(away, 0u);
}

TEST(Scan, PlacesOnTheProjectorAreFinerThanItsPixels) {
    const PaintedScan scene;
    Progress progress;
    const DecodedView view = decodePatterns(scene.input()[0], {}, progress);
    const std::vector<Vec2> truth = scene.litFrom(0);
    std::vector<float> off;
    for (size_t i = 0; i < view.places.size(); ++i)
        if (view.at(i) && !std::isnan(truth[9 * i + 4].x))
            off.push_back(glm::distance(view.places[i], truth[9 * i + 4]));
    EXPECT_GT(off.size(), 8000u);
    EXPECT_LT(meanMedianOf(off), 0.15f);
    EXPECT_LT(quantileOf(off, 0.95), 0.6f);
    EXPECT_NEAR(view.global, 0.11f, 0.08f);
}

TEST(Scan, OneCameraWithACalibratedProjectorIsEnough) {
    PaintedScan scene;
    scene.calibration.cameras.pop_back();
    Progress progress;
    EXPECT_NE(test::messageOf([&] { scanSurface(scene.calibration, scene.input(), {}, progress); }).find("projector"),
              std::string::npos);
    scene.calibration.projector = scene.projector;
    const ScanResult result = scanSurface(scene.calibration, scene.input(), {}, progress);
    EXPECT_LT(meanMedianOf(offSurface(scene, result.mesh.mesh)), 0.0008);
}

TEST(Scan, MissingPhotographsMakeCodesCoarserAndAreNamed) {
    PaintedScan scene;
    const size_t finest = patternPlace(scene.bits, 1, 5), secondFinest = patternPlace(scene.bits, 1, 4);
    scene.absent = {finest, secondFinest, secondFinest + 1};
    Progress progress;
    const ScanResult result = scanSurface(scene.calibration, scene.input(), {}, progress);
    EXPECT_EQ(result.cameras[0].lost.absent.size(), 0u);
    EXPECT_EQ(result.cameras[1].lost.absent.size(), 3u);
    EXPECT_EQ(result.cameras[1].lost.exactness, (std::array<int, 2>{1, 4}));
    ASSERT_GE(result.notes.size(), 2u);
    EXPECT_NE(result.notes[0].find("second axis, bit 5 of 6, inverse"), std::string::npos) << result.notes[0];
    EXPECT_NE(result.notes[1].find("4 pixels"), std::string::npos) << result.notes[1];
    EXPECT_GT(double(result.cameras[1].points), 0.6 * double(result.cameras[1].lit));
    EXPECT_LT(meanMedianOf(offSurface(scene, result.mesh.mesh)), 0.001);
}

TEST(Scan, PhotographsOutOfOrderAreRefused) {
    const PaintedScan scene;
    Progress progress;
    ScanInput swapped = scene.input();
    for (PatternStack& stack : swapped)
        stack.read = [read = stack.read](size_t place) { return read(place < 2 ? 1 - place : place); };
    const std::string message = test::messageOf([&] { scanSurface(scene.calibration, swapped, {}, progress); });
    EXPECT_NE(message.find("left: the first photograph is not brighter"), std::string::npos) << message;
}

TEST(Scan, CamerasOfDifferentScansHaveNoMatches) {
    PaintedScan scene;
    Progress progress;
    // The second camera stands behind the first, so that its rays meet none of the others'.
    scene.calibration.cameras[1].camera.worldFromCamera[2] *= -1.0;
    scene.calibration.cameras[1].camera.worldFromCamera[0] *= -1.0;
    ScanInput input = PaintedScan().input();
    const std::string message = test::messageOf([&] { scanSurface(scene.calibration, input, {}, progress); });
    EXPECT_NE(message.find("of one scan"), std::string::npos) << message;
}

TEST(Scan, PhotographsOfAnotherSizeAreNamed) {
    const PaintedScan scene;
    Progress progress;
    ScanInput input = scene.input();
    input[1].read = [read = input[1].read](size_t place) {
        GreyImage image = read(place);
        if (place == 5) {
            image.values.resize(size_t(image.width));
            image.height = 1;
        }
        return image;
    };
    const std::string message = test::messageOf([&] { scanSurface(scene.calibration, input, {}, progress); });
    EXPECT_NE(message.find("right: first axis, bit 2 of 7, inverse: is 160 x 1"), std::string::npos) << message;
}

TEST(Scan, ThreadsDoNotChangeABitAndAStopEndsIt) {
    const PaintedScan scene;
    const ScanInput input = scene.input();
    std::vector<Vec3> positions[2];
    for (int several : {0, 1}) {
        const ThreadLimit limit(several ? 3 : 1);
        Progress progress;
        positions[several] = scanSurface(scene.calibration, input, {}, progress).mesh.mesh.positions;
    }
    EXPECT_EQ(positions[0], positions[1]);
    Progress stopped;
    stopped.requestStop();
    EXPECT_THROW(scanSurface(scene.calibration, input, {}, stopped), Cancelled);
}

}  // namespace
}  // namespace relamp
