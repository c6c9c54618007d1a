// Do photographs agree on a mesh? On a world whose light stands still, and with one thing after the other put wrong.
#include "radiance/agreement.h"

#include <gtest/gtest.h>

#include "capture/load_capture.h"
#include "radiance/gather.h"
#include "support/known_world.h"

namespace relamp {
namespace {

struct Photographed {
    Capture capture;
    Scene scene;
    RadianceSamples samples;

    Photographed() {
        const test::TemporaryFolder folder;
        test::paintKnownWorld(folder.path(), true, 6, 12);
        Progress progress;
        capture = loadCapture(folder.path(), {}, progress);
        scene = buildScene(capture.mesh, progress);
        gather();
    }
    void gather() {
        Progress progress;
        samples = gatherRadiance(capture, scene, {}, progress);
    }
    PhotographAgreement agreement() const {
        Progress progress;
        return photographAgreement(capture, scene, samples, progress);
    }
};

const Photographed& photographed() {
    static const Photographed one;
    return one;
}

TEST(Agreement, PhotographsOfOneWorldAgree) {
    const PhotographAgreement a = photographed().agreement();
    ASSERT_EQ(a.views.size(), 6u);
    for (const ViewAgreement& v : a.views) {
        EXPECT_GT(v.vertices, 100u);
        EXPECT_GT(v.correlation, 0.9f);
        EXPECT_LT(std::abs(v.gain), 0.02f);
        EXPECT_LT(v.spread, 0.06f);
    }
    EXPECT_FALSE(a.movingLight.found());
}

TEST(Agreement, TheExposureOfAViewIsItsGain) {
    Photographed p = photographed();
    for (RadianceSample& s : p.samples.samples)
        if (s.view == 2) s.radiance *= 1.5f;
    const PhotographAgreement a = p.agreement();
    EXPECT_NEAR(a.views[2].gain, std::log(1.5f), 0.03f);
    EXPECT_NEAR(a.views[0].gain, 0, 0.1f);
    EXPECT_GT(a.views[2].correlation, 0.9f);
}

TEST(Agreement, ShuffledCamerasShowOtherThings) {
    Photographed p = photographed();
    std::vector<Camera> cameras;
    for (const View& v : p.capture.views) cameras.push_back(v.camera);
    for (size_t i = 0; i < cameras.size(); ++i) p.capture.views[i].camera = cameras[(i + 1) % cameras.size()];
    p.gather();
    std::vector<float> correlations;
    for (const ViewAgreement& v : p.agreement().views) correlations.push_back(v.correlation);
    std::sort(correlations.begin(), correlations.end());
    EXPECT_LT(correlations[correlations.size() / 2], 0.4f);
}

TEST(Agreement, LightThatTurnsWithTheCameraIsFoundWithItsDirection) {
    Photographed p = photographed();
    const Vec3 light = glm::normalize(Vec3(0.5f, 0.3f, 0.8f));  // camera axes
    // The box and the ball alone: to cameras of one height a floor always looks alike.
    const uint32_t floor = uint32_t(test::sheet({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, 12, 12).vertexCount());
    const uint32_t first = p.samples.start[floor];
    p.samples.samples.erase(p.samples.samples.begin(), p.samples.samples.begin() + first);
    for (uint32_t& start : p.samples.start) start -= std::min(start, first);
    for (uint32_t v = 0; v < p.scene.mesh.vertexCount(); ++v)
        for (uint32_t s = p.samples.start[v]; s < p.samples.start[v + 1]; ++s) {
            RadianceSample& r = p.samples.samples[s];
            const Vec3 inWorld = Mat3(glm::dmat3(p.capture.views[r.view].camera.worldFromCamera)) * light;
            r.radiance = test::KnownWorld::albedoAt(p.scene.mesh.positions[v]) *
                         (0.1f + std::max(0.0f, glm::dot(inWorld, p.scene.mesh.normals[v])));
        }
    const MovingLight found = p.agreement().movingLight;
    EXPECT_TRUE(found.found()) << found.spreadStatic << " " << found.spreadMoving;
    EXPECT_GT(glm::dot(found.direction, light), std::cos(20 * pi / 180));
}

TEST(Agreement, TheMedianLeavesOutClippedOnesAndTheViewNamed) {
    RadianceSamples samples;
    samples.start = {0, 4};
    samples.samples = {
        {0, Rgb(1, 4, 2), 1, false}, {1, Rgb(2, 3, 2), 1, false}, {2, Rgb(9, 1, 2), 1, false}, {3, Rgb(100), 1, true}};
    EXPECT_EQ(medianObservation(samples, 0), Rgb(2, 3, 2));
    EXPECT_EQ(medianObservation(samples, 0, 2), Rgb(1.5f, 3.5f, 2));
    samples.samples.resize(1);
    samples.start = {0, 1};
    EXPECT_FALSE(medianObservation(samples, 0, 0).has_value());
}

}  // namespace
}  // namespace relamp
