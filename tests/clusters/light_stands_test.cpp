// Posts that end before the ball of light that they hold.
#include "clusters/light_stands.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>

#include "support/estimates.h"

namespace relamp {
namespace {

const Vec3 ballCentre(0.1f, -0.2f, 0.5f);
constexpr float ballRadius = 0.03f;

std::vector<SurfacePatch> sleevesOf(const Mesh& mesh, const HeldLight& ball) {
    std::vector<SurfacePatch> sleeves;
    for (const LightStand& stand : lightStands(mesh, ball)) sleeves.push_back(sleeveOf(mesh, stand));
    return sleeves;
}

HeldLight oneBall() {
    ProxyLight ball;
    ball.centre = DVec3(ballCentre);
    ball.radius = ballRadius;
    return HeldLight::of(ball);
}

/// Rings of a radius per height below the ball's ballCentre, open at both ends, in the direction `down`.
Mesh rings(float from, float to, const Vec3& down, const std::function<float(float)>& radius) {
    constexpr int rows = 40, around = 24;
    Mesh mesh;
    const Mat3 frame = frameAround(down);
    for (int row = 0; row <= rows; ++row)
        for (int i = 0; i < around; ++i) {
            const float below = from + (to - from) * float(row) / rows, turn = 2 * pi * float(i) / around;
            mesh.positions.push_back(ballCentre + below * down +
                                     radius(below) * (std::cos(turn) * frame[0] + std::sin(turn) * frame[1]));
        }
    for (uint32_t row = 0; row < rows; ++row)
        for (uint32_t i = 0; i < around; ++i) {
            const uint32_t a = row * around + i, b = row * around + (i + 1) % around;
            mesh.triangles.push_back({a, b, a + around});
            mesh.triangles.push_back({b, b + around, a + around});
        }
    return mesh;
}

/// A post of 1 cm that ends 1 cm below the ball, thinner at its end.
Mesh postAt(const Vec3& down) {
    return rings(0.04f, 0.3f, down, [](float below) { return below < 0.05f ? 0.007f : 0.01f; });
}

TEST(LightStands, APostReachesTheBallWithItsWholeRadius) {
    for (const Vec3& down : {Vec3(0, 0, -1), Vec3(0, 0, 1), glm::normalize(Vec3(1, 1, -1))}) {
        const std::vector<SurfacePatch> sleeves = sleevesOf(postAt(down), oneBall());
        ASSERT_EQ(sleeves.size(), 1u);
        const SurfacePatch& sleeve = sleeves[0];
        float nearest = 1, farthest = 0;
        for (const Vec3& p : sleeve.positions) {
            const float below = glm::dot(p - ballCentre, down);
            EXPECT_NEAR(glm::length(p - ballCentre - below * down), 0.01f, 5e-4f);
            nearest = std::min(nearest, below);
            farthest = std::max(farthest, below);
        }
        EXPECT_LT(nearest, std::sqrt(ballRadius * ballRadius - 0.01f * 0.01f));
        EXPECT_GT(nearest, 0.8f * ballRadius);
        EXPECT_GT(farthest, 0.05f);
        EXPECT_LT(farthest, 0.07f);
        EXPECT_NEAR(sleeve.area, 2 * pi * 0.01f * (farthest - nearest), 0.05f * sleeve.area);
        for (const auto& [a, b, c] : sleeve.triangles) {
            const Vec3 normal = glm::cross(sleeve.positions[b] - sleeve.positions[a],
                                           sleeve.positions[c] - sleeve.positions[a]),
                       out = sleeve.positions[a] - ballCentre;
            EXPECT_GT(glm::dot(normal, out - glm::dot(out, down) * down), 0);
        }
    }
}

TEST(LightStands, TheNeckOfABagGoesAndIsNoPartOfThePost) {
    // Wider towards the ball, as a surface that wrapped both is; the ball took the rest of it.
    const Mesh mesh = rings(0.02f, 0.3f, Vec3(0, 0, -1),
                            [](float below) { return below < 0.045f ? 0.01f + 0.8f * (0.045f - below) : 0.01f; });
    const std::vector<SurfacePatch> sleeves = sleevesOf(mesh, oneBall());
    ASSERT_EQ(sleeves.size(), 1u);
    for (const Vec3& p : sleeves[0].positions) EXPECT_NEAR(glm::length(Vec2(p - ballCentre)), 0.01f, 5e-4f);
    float wrapped = 0, below = 0;
    std::vector<uint8_t> gone(mesh.triangles.size(), 0);
    for (const uint32_t t : sleeves[0].replaced) gone[t] = 1;
    for (size_t t = 0; t < gone.size(); ++t)
        for (const uint32_t v : mesh.triangles[t]) {
            const float distance = glm::length(mesh.positions[v] - ballCentre);
            if (!gone[t] && distance < 1.45f * ballRadius) ++wrapped;
            if (gone[t] && distance > 2 * ballRadius) ++below;
        }
    EXPECT_EQ(wrapped, 0) << "light to the ground passes";
    EXPECT_EQ(below, 0) << "the post stays";
    float reaches = 0;
    for (const Vec3& p : sleeves[0].positions) reaches = std::max(reaches, ballCentre.z - p.z);
    EXPECT_GT(reaches, 1.5f * ballRadius) << "no gap is left";
}

TEST(LightStands, APostOfWhichTheMeshLacksASideIsStillOne) {
    // Short as far as it is looked at, and uneven: the longest spread of its points is not along it.
    Mesh mesh = rings(0.04f, 0.075f, Vec3(0, 0, -1), [](float) { return 0.02f; });
    std::erase_if(mesh.triangles, [&](const Triangle& t) { return mesh.positions[t[0]].x > ballCentre.x + 0.012f; });
    const std::vector<LightStand> stands = lightStands(mesh, oneBall());
    ASSERT_EQ(stands.size(), 1u);
    EXPECT_TRUE(stands[0].around);
    EXPECT_NEAR(stands[0].tube.radius, 0.02, 0.001);
    EXPECT_LT(stands[0].tube.axes[0].z, -0.99);
    EXPECT_LT(stands[0].tube.off(DVec3(ballCentre)), 0.005);
}

TEST(LightStands, APostOfWhichTheMeshHasOneSideIsForPhotographsToSay) {
    Mesh mesh = postAt(Vec3(0, 0, -1));
    std::erase_if(mesh.triangles, [&](const Triangle& t) { return mesh.positions[t[0]].x > ballCentre.x - 0.004f; });
    const std::vector<LightStand> stands = lightStands(mesh, oneBall());
    ASSERT_EQ(stands.size(), 1u);
    EXPECT_FALSE(stands[0].around);
    EXPECT_NEAR(stands[0].tube.radius, 0.01, 0.002);
}

TEST(LightStands, AWholeStandTakesThePlaceOfTheMeshsDownToTheFloor) {
    Mesh mesh = postAt(Vec3(0, 0, -1));
    const auto own = mesh.triangles.size();
    test::append(mesh, test::sheet(ballCentre + Vec3(-0.1f, -0.1f, -0.3f), {0.2f, 0, 0}, {0, 0.2f, 0}, 40, 40));
    const std::vector<LightStand> stands = lightStands(mesh, oneBall());
    ASSERT_EQ(stands.size(), 1u);
    StraightTube measured = stands[0].tube;
    measured.radius = 0.009;
    measured.through.x += 0.004;
    EXPECT_NEAR(tubeEnd(mesh, measured), measured.at(DVec3(ballCentre)) + 0.3, 2 * measured.radius);
    const SurfacePatch stand = wholeStandOf(mesh, stands[0], measured);
    float lowest = 1, highest = -1;
    for (const Vec3& p : stand.positions) {
        EXPECT_NEAR(measured.off(DVec3(p)), 0.009, 1e-6);
        lowest = std::min(lowest, p.z - ballCentre.z);
        highest = std::max(highest, p.z - ballCentre.z);
    }
    EXPECT_GT(highest, -ballRadius) << "it reaches into the ball";
    EXPECT_LT(lowest, -0.29f) << "and down to the floor";
    EXPECT_TRUE(std::is_sorted(stand.replaced.begin(), stand.replaced.end()));
    const auto ofFloor = stand.replaced.end() - std::lower_bound(stand.replaced.begin(), stand.replaced.end(), own);
    EXPECT_EQ(ofFloor, 0);
    EXPECT_GT(stand.replaced.size(), own * 9 / 10);
}

/// Half of 10 x 4 x 1 cm, its underside at the ball's centre.
HeldLight panelAbove() {
    EmitterBody panel;
    panel.half = {0.1, 0.04, 0.005};
    panel.centre = DVec3(ballCentre) + DVec3(0, 0, 0.005);
    return HeldLight::of(panel);
}

TEST(LightStands, APostThatTheMeshPinchesOffHoldsAPanelAndReachesTheGround) {
    // Closed below the panel, and 2 cm above the ground.
    const auto width = [](float below) { return below < 0.008f || below > 0.175f ? 0.001f : 0.008f; };
    const Mesh mesh = rings(0.005f, 0.18f, Vec3(0, 0, -1), width);
    const std::vector<LightStand> stands = lightStands(mesh, panelAbove());
    ASSERT_EQ(stands.size(), 1u);
    EXPECT_NEAR(stands[0].tube.radius, 0.008, 1e-4);
    const StraightTube& tube = stands[0].tube;
    const SurfacePatch stand = wholeStandOf(mesh, stands[0], tube, tube.at(DVec3(ballCentre) - DVec3(0, 0, 0.2)));
    EXPECT_EQ(stand.replaced.size(), mesh.triangles.size());
    float lowest = 1, highest = -1;
    for (const Vec3& p : stand.positions) {
        lowest = std::min(lowest, p.z - ballCentre.z);
        highest = std::max(highest, p.z - ballCentre.z);
    }
    EXPECT_NEAR(lowest, -0.204f, 1e-3f);
    EXPECT_GT(highest, 0) << "it reaches into the panel";
    EXPECT_LT(highest, 0.001f);
}

TEST(LightStands, AShortPostOnAFootIsFound) {
    Mesh mesh = rings(0.005f, 0.1f, Vec3(0, 0, -1), [](float below) { return below < 0.09f ? 0.008f : 0.04f; });
    test::append(mesh, test::sheet(ballCentre + Vec3(-0.2f, -0.2f, -0.1f), {0.4f, 0, 0}, {0, 0.4f, 0}, 40, 40));
    HeldLight shade = panelAbove();
    shade.body->round = true;
    shade.body->half = {0.06, 0.06, 0.06};
    shade.body->axes = glm::dmat3(DVec3(0, 0, 1), DVec3(1, 0, 0), DVec3(0, 1, 0));
    shade.body->centre = DVec3(ballCentre) + DVec3(0, 0, 0.06);
    const std::vector<LightStand> stands = lightStands(mesh, HeldLight::of(*shade.body));
    ASSERT_EQ(stands.size(), 1u);
    EXPECT_NEAR(stands[0].tube.radius, 0.008, 1e-4);
    EXPECT_LT(stands[0].tube.axes[0].z, -0.999);
}

TEST(LightStands, WhatIsNoPostStaysAsItIs) {
    const Vec3 down(0, 0, -1);
    // A shade about the ball, a post that ends far below it, and one beside it.
    EXPECT_TRUE(
        lightStands(rings(-0.02f, 0.06f, down, [](float below) { return 0.05f + 0.5f * below; }), oneBall()).empty());
    EXPECT_TRUE(lightStands(rings(0.08f, 0.3f, down, [](float) { return 0.01f; }), oneBall()).empty());
    Mesh beside = rings(0.04f, 0.3f, down, [](float) { return 0.01f; });
    for (Vec3& p : beside.positions) p.x += 0.03f;
    EXPECT_TRUE(lightStands(beside, oneBall()).empty());
    // A floor on which the ball lies, with a hole below it.
    Mesh floor = test::sheet(ballCentre + Vec3(-0.3f, -0.3f, -0.03f), {0.6f, 0, 0}, {0, 0.6f, 0}, 100, 100);
    std::erase_if(floor.triangles,
                  [&](const Triangle& t) { return glm::length(floor.positions[t[0]] - ballCentre) < 0.035f; });
    EXPECT_TRUE(lightStands(floor, oneBall()).empty());
}

}  // namespace
}  // namespace relamp
