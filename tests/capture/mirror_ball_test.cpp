#include "capture/mirror_ball.h"

#include <gtest/gtest.h>

#include "base/error.h"
#include "base/random.h"
#include "image/environment_map.h"

namespace relamp {
namespace {

Rgb mirroredSky(const Vec3& d) {
    const float window = std::exp(8 * (glm::dot(d, glm::normalize(Vec3(0.4f, -0.8f, 0.5f))) - 1));
    return Rgb(0.3f, 0.35f, 0.45f) + 0.15f * d.z + Rgb(1.5f, 1.4f, 1.2f) * window +
           Rgb(0.1f, 0.05f, 0) * (std::sin(6 * d.x) * std::cos(5 * d.y));
}

/// A ball of radius 0.1 m a metre or two before a camera that looks at it askew, by the law of reflection.
struct BallPhotograph {
    Camera camera;
    Image image;
    Vec3 axis{0};
    float halfAngle = 0;

    explicit BallPhotograph(int side = 240, float noise = 0, float exposure = 0.8f) {
        camera.width = camera.height = side;
        camera.focalX = camera.focalY = 1.6 * side;
        camera.centreX = camera.centreY = 0.5 * side;
        const DVec3 eye(0.5, -1.2, 0.9), target(0.03, 0.02, 0.05);
        const DVec3 back = glm::normalize(eye - target), right = glm::normalize(glm::cross(DVec3(0, 0, 1), back)),
                    up = glm::cross(back, right);
        camera.worldFromCamera =
            DMat4(glm::dvec4(right, 0), glm::dvec4(up, 0), glm::dvec4(back, 0), glm::dvec4(eye, 1));
        const double radius = 0.22;
        const DVec3 centre(0, 0, 0);
        axis = Vec3(glm::normalize(centre - eye));
        halfAngle = float(std::asin(radius / glm::length(centre - eye)));
        image = Image(side, side);
        for (int y = 0; y < side; ++y)
            for (int x = 0; x < side; ++x) {
                Rgb sum(0);
                for (int k = 0; k < 9; ++k) {
                    const DVec3 d(camera.rayDirection(
                        Vec2(float(x) + (float(k % 3) + 0.5f) / 3, float(y) + (float(k / 3) + 0.5f) / 3)));
                    const double along = glm::dot(centre - eye, d),
                                 across2 = glm::dot(centre - eye, centre - eye) - along * along;
                    if (across2 >= radius * radius) {
                        // A wall behind with stripes, so that the ball's rim is not the only edge.
                        sum += std::sin(25 * d.x) > 0.3 ? Rgb(0.5f) : Rgb(0.12f, 0.11f, 0.1f);
                        continue;
                    }
                    const DVec3 hit = eye + (along - std::sqrt(radius * radius - across2)) * d,
                                normal = (hit - centre) / radius;
                    sum += exposure * mirroredSky(Vec3(d - 2 * glm::dot(d, normal) * normal));
                }
                const float wobble =
                    1 + noise * (unitFloat(mixBits(uint64_t(y) * 7919 + uint64_t(x))) - 0.5f) * 2 * std::sqrt(3.0f);
                image.at(x, y) = sum / 9.0f * wobble;
            }
    }
};

TEST(MirrorBall, ItsRimIsFoundAmongOtherEdges) {
    for (const float noise : {0.0f, 0.03f}) {
        const BallPhotograph ball(240, noise);
        const BallRim rim = findBallRim(ball.image, ball.camera, {});
        const float pixel = float(1 / ball.camera.focalX);
        EXPECT_LT(glm::distance(rim.axis, ball.axis), 0.4f * pixel);
        EXPECT_NEAR(rim.halfAngle, ball.halfAngle, 0.4f * pixel);
        EXPECT_GT(rim.support, 0.6f);
    }
}

TEST(MirrorBall, AHintNeedsToBeOnlyAboutRight) {
    const BallPhotograph ball;
    const auto centre = ball.camera.project(ball.camera.position() + DVec3(ball.axis));
    ASSERT_TRUE(centre);
    const float radius = std::tan(ball.halfAngle) * float(ball.camera.focalX);
    const BallRim rim = findBallRim(ball.image, ball.camera, BallHint{*centre + Vec2(3, -2), 1.05f * radius});
    EXPECT_LT(glm::distance(rim.axis, ball.axis), 0.4f / float(ball.camera.focalX));
}

TEST(MirrorBall, UnwrappedIsTheSkyThatItMirrors) {
    const BallPhotograph ball;
    const Image sky = unwrapMirrorBall(ball.image, ball.camera, {ball.axis, ball.halfAngle, 1, 0}, 0);
    ASSERT_EQ(sky.width, 2 * sky.height);
    double off = 0;
    size_t held = 0;
    for (int y = 0; y < sky.height; ++y)
        for (int x = 0; x < sky.width; ++x) {
            if (!sky.usableAt(x, y)) continue;
            const Vec3 d =
                directionFromLatLong({(float(x) + 0.5f) / float(sky.width), (float(y) + 0.5f) / float(sky.height)});
            // Behind the ball nothing is mirrored.
            EXPECT_LT(glm::dot(d, ball.axis), std::cos(ball.halfAngle) + 1e-3f);
            off += double(maxChannel(glm::abs(sky.at(x, y) / (0.8f * mirroredSky(d)) - 1.0f)));
            ++held;
        }
    EXPECT_GT(held, size_t(0.7 * double(sky.pixels.size())));
    EXPECT_LT(off / double(held), 0.01);
}

TEST(MirrorBall, ClippedAndMaskedPixelsAreNotHeld) {
    BallPhotograph ball;
    const BallRim rim{ball.axis, ball.halfAngle, 1, 0};
    const auto heldOf = [&](float clip) {
        const Image sky = unwrapMirrorBall(ball.image, ball.camera, rim, clip);
        return std::count(sky.usable.begin(), sky.usable.end(), 1);
    };
    const auto all = heldOf(0);
    EXPECT_LT(heldOf(0.5f), all);
    maskBall(ball.camera, rim, ball.image);
    EXPECT_EQ(heldOf(0), 0);
    const auto masked = std::count(ball.image.usable.begin(), ball.image.usable.end(), 0);
    const double radius = std::tan(double(ball.halfAngle)) * ball.camera.focalX;
    EXPECT_NEAR(double(masked), piD * (radius + 3) * (radius + 3), 0.06 * double(masked));
}

TEST(MirrorBall, WhereThereIsNoneIsAnError) {
    const BallPhotograph ball(160);
    Image plain(160, 160, Rgb(0.4f));
    EXPECT_THROW(findBallRim(plain, ball.camera, {}), Error);
    for (int i = 0; i < 160 * 160; ++i) plain.pixels[size_t(i)] = Rgb(i % 160 / 13 % 2 ? 0.7f : 0.2f);
    EXPECT_THROW(findBallRim(plain, ball.camera, {}), Error);
    EXPECT_THROW(findBallRim(plain, ball.camera, BallHint{Vec2(-500, 80), 20}), Error);
    EXPECT_THROW(findBallRim(plain, ball.camera, BallHint{Vec2(80, 80), 0.5f}), Error);
}

}  // namespace
}  // namespace relamp
