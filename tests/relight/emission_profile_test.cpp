#include "relight/emission_profile.h"

#include <gtest/gtest.h>

#include <map>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "image/image_io.h"
#include "relight/frame.h"
#include "relight/live/live_scene.h"
#include "relight/look_track.h"
#include "support/estimates.h"
#include "support/temporary_folder.h"

namespace relamp {
namespace {

/// A light 2 m above the plane z = 0, facing down, `size` across.
Look lightAbove(const LightShaping& shaping, EmitterShape shape = EmitterShape::disk, float size = 0.05f,
                const Mat4& turn = Mat4(1)) {
    Look look;
    AddedEmitter light;
    light.shape = shape;
    light.id = "light";
    light.matrix = test::translation({0, 0, 2}) * turn;
    light.size = Vec2(size);
    light.radiance = Rgb(1000);
    light.shaping = shaping;
    look.added.push_back(light);
    return look;
}

/// Irradiance / pi at points of the plane z = 0, from a frame straight down: a pixel a point.
struct Plane {
    Scene scene = test::sceneOf(test::sheet({-2, -2, 0}, {4, 0, 0}, {0, 4, 0}, 40, 40));
    Estimate estimate = test::matteEstimate(scene, Rgb(1), Rgb(0));
    Frame frameOf(const Look& look, int samples = 16) const {
        const RelitScene relit = test::relitOf(scene, estimate, look);
        FrameOptions options;
        options.samplesPerPixel = samples;
        Progress progress;
        // From below the light, so that it does not stand in the way.
        return renderFrame(relit, test::cameraAt({0, 0, 1.5}, {0, 0, 0}, 24, 24, 12, {0, 1, 0}), options, progress);
    }
};

/// A small disk of area A and radiance L seen under the cosine c from distance d lights with L A c c / d^2 / pi.
double plainDisk(const Vec3& p) {
    const double d2 = double(glm::dot(p, p)) + 4, cosine = 2 / std::sqrt(d2), area = piD * 0.025 * 0.025;
    return 1000 * area * cosine * cosine / d2 / piD;
}

double degreesOf(const Vec3& p) { return std::atan2(std::hypot(p.x, p.y), 2) * 180 / piD; }

TEST(ShapedLight, ThatIsASpotLightsItsConeAndNothingElse) {
    const Plane plane;
    LightShaping spot;
    spot.coneDegrees = 25;
    const Frame frame = plane.frameOf(lightAbove(spot));
    int inside = 0, outside = 0;
    for (size_t p = 0; p < frame.beauty.size(); ++p) {
        const double angle = degreesOf(frame.position[p]);
        // The light is as wide as 1.5 degrees, a pixel as 4.
        if (angle < 21) {
            ++inside;
            EXPECT_NEAR(frame.beauty[p].y / plainDisk(frame.position[p]), 1, 0.02) << angle;
        } else if (angle > 29) {
            ++outside;
            EXPECT_EQ(frame.beauty[p].y, 0) << angle;
        }
    }
    EXPECT_GT(inside, 50);
    EXPECT_GT(outside, 100);
}

TEST(ShapedLight, FadesOverItsSoftEdgeAndWithItsFocus) {
    LightShaping soft;
    soft.coneDegrees = 40;
    soft.coneSoftness = 0.5f;
    soft.focus = 3;
    const ShapedEmission emission(soft, Mat4(1), Vec2(1), true);
    const auto at = [&](float degrees) {
        const float a = degrees * pi / 180;
        return emission.factor({std::sin(a), 0, -std::cos(a)}, Vec3(0)).x;
    };
    const auto focus = [](float degrees) { return std::pow(std::cos(degrees * pi / 180), 3.0f); };
    EXPECT_FLOAT_EQ(at(0), 1);
    EXPECT_NEAR(at(19.9f), focus(19.9f), 1e-5);
    EXPECT_NEAR(at(30), 0.5f * focus(30), 1e-5);
    EXPECT_NEAR(at(39.99f), 0, 1e-5);
    EXPECT_EQ(at(41), 0);
    EXPECT_EQ(at(180), 0);
}

TEST(ShapedLight, KeepsTheFractionOfItsPowerThatAClosedFormGives) {
    LightShaping cone;
    cone.coneDegrees = 30;
    // Of a flat light's cosine-weighted hemisphere the sine squared, of a ball's directions (1 - cosine) / 2.
    EXPECT_NEAR(ShapedEmission(cone, Mat4(1), Vec2(1), true).mean().y, 0.25, 0.003);
    EXPECT_NEAR(ShapedEmission(cone, Mat4(1), Vec2(1), false).mean().y, (1 - std::cos(pi / 6)) / 2, 0.001);
}

TEST(ShapedLight, TurnsWithItsMatrixWhateverItsScaleIs) {
    LightShaping cone;
    cone.coneDegrees = 20;
    Mat4 matrix(1);  // faces +X, wide in Y, mirrored
    matrix[0] = Vec4(0, 3, 0, 0);
    matrix[1] = Vec4(0, 0, -0.5f, 0);
    matrix[2] = Vec4(-2, 0, 0, 0);
    for (const float sign : {1.0f, -1.0f}) {
        Mat4 turned = matrix;
        turned[1] *= sign;
        const ShapedEmission emission(cone, turned, Vec2(1), true);
        EXPECT_LT(glm::distance(emission.axis(), Vec3(1, 0, 0)), 1e-6f);
        EXPECT_EQ(emission.factor({1, 0, 0}, Vec3(0)).x, 1);
        EXPECT_EQ(emission.factor(glm::normalize(Vec3(1, 0.3f, 0)), Vec3(0)).x, 1);
        EXPECT_EQ(emission.factor(glm::normalize(Vec3(1, 0.4f, 0)), Vec3(0)).x, 0);
        EXPECT_EQ(emission.factor({-1, 0, 0}, Vec3(0)).x, 0);
    }
}

TEST(ShapedLight, EndsAtItsBarnDoors) {
    const Plane plane;
    LightShaping ahead;
    ahead.rightDoor = 0;
    const Look look = lightAbove(ahead, EmitterShape::rectangle);
    const Frame frame = plane.frameOf(look, 64), open = plane.frameOf(lightAbove({}, EmitterShape::rectangle), 64);
    // A door as long as the light is wide hides, from where it is seen under the tangent t to that side, t of it.
    double left[2] = {}, expected = 0, right = 0;
    for (size_t p = 0; p < frame.beauty.size(); ++p) {
        const double tangent = double(frame.position[p].x) / 2;
        (tangent < 0 ? left[0] : right) += double(frame.beauty[p].y);
        if (tangent < 0) left[1] += double(open.beauty[p].y);
        else expected += std::max(0.0, 1 - tangent) * double(open.beauty[p].y);
    }
    EXPECT_NEAR(left[0] / left[1], 1, 0.01);
    EXPECT_NEAR(right / expected, 1, 0.01);
    // Half shut: from the middle nothing leaves to the right, from the left end what stays inside the door's end.
    ahead.rightDoor = -30;
    ahead.topDoor = 45;
    const ShapedEmission emission(ahead, Mat4(1), Vec2(2, 1), true);
    const auto passes = [&](const Vec3& away, const Vec3& from) {
        return emission.factor(glm::normalize(away), from).x > 0;
    };
    EXPECT_FALSE(passes({0.01f, 0, -1}, Vec3(0)));
    EXPECT_TRUE(passes({-0.01f, 0, -1}, Vec3(0)));
    EXPECT_TRUE(passes({0.57f, 0, -1}, {-1, 0, 0}));  // the end lies 1 to the right and 1.732 ahead
    EXPECT_FALSE(passes({0.59f, 0, -1}, {-1, 0, 0}));
    EXPECT_TRUE(passes({-0.01f, 1.70f, -1}, Vec3(0)));  // 0.5 + 0.707 up and 0.707 ahead
    EXPECT_FALSE(passes({-0.01f, 1.72f, -1}, Vec3(0)));
    EXPECT_TRUE(passes({-0.01f, -9, -1}, Vec3(0)));
    // Its power: 1 - sine of the edge's angle on one side, averaged over the light, in closed form.
    LightShaping both;
    both.leftDoor = both.rightDoor = 0;
    double power = 0;
    for (int i = 0; i < 1000; ++i) {
        const double t = (i + 0.5) / 1000;  // tangent of the right door's end, from right to left
        power += (t / std::sqrt(1 + t * t) + (1 - t) / std::sqrt(1 + (1 - t) * (1 - t))) / 2 / 1000;
    }
    EXPECT_NEAR(double(ShapedEmission(both, Mat4(1), Vec2(1), true).mean().x), power, 0.02);
}

class ShapedLightWithFiles : public ::testing::Test {
protected:
    test::TemporaryFolder folder;
    /// Red upper left, green upper right, blue lower left, black lower right.
    std::filesystem::path image() {
        Image quarters(64, 64);
        for (int y = 0; y < 64; ++y)
            for (int x = 0; x < 64; ++x)
                quarters.at(x, y) = y < 32 ? (x < 32 ? Rgb(1, 0, 0) : Rgb(0, 1, 0)) : x < 32 ? Rgb(0, 0, 1) : Rgb(0);
        writeImage(folder / "quarters.exr", quarters);
        return folder / "quarters.exr";
    }
    /// Twice the light at 45 degrees.
    std::filesystem::path ies() {
        folder.write("beam.ies", "TILT=NONE\n1 1000 1 3 1 1 2 0 0 0 1 1 1\n0 45 90\n0\n100 200 0");
        return folder / "beam.ies";
    }
};

TEST_F(ShapedLightWithFiles, HasTheIntensityOfItsPhotometricFile) {
    const Plane plane;
    LightShaping shaping;
    shaping.iesFile = ies();
    // A ball shows the same area to all sides: its intensity is the file's.
    const Frame frame = plane.frameOf(lightAbove(shaping, EmitterShape::sphere, 0.05f), 32);
    // One pixel is noisy, the mean of those between two angles is not.
    double ratio[6] = {}, count[6] = {};
    for (size_t p = 0; p < frame.beauty.size(); ++p) {
        const Vec3 at = frame.position[p];
        const double d2 = double(glm::dot(at, at)) + 4, cosine = 2 / std::sqrt(d2), degrees = degreesOf(at);
        const double profile = degrees < 45 ? 0.5 + 0.5 * degrees / 45 : 1 - (degrees - 45) / 45;
        const double expected = 1000 * piD * 0.025 * 0.025 * cosine / d2 / piD * profile;
        const size_t ring = std::min<size_t>(5, size_t(degrees / 10));
        ratio[ring] += frame.beauty[p].y / expected, ++count[ring];
    }
    for (size_t ring = 0; ring < 5; ++ring) EXPECT_NEAR(ratio[ring] / count[ring], 1, 0.01) << ring;
}

TEST_F(ShapedLightWithFiles, ThrowsItsGoboUprightSeenFromTheLight) {
    const Plane plane;
    LightShaping shaping;
    shaping.coneDegrees = 40;
    shaping.goboFile = image();
    const Frame frame = plane.frameOf(lightAbove(shaping));
    // From the light, which looks down with +Y up, +X lies to the right.
    for (size_t p = 0; p < frame.beauty.size(); ++p) {
        const Vec3 at = frame.position[p];
        if (degreesOf(at) > 35 || std::abs(at.x) < 0.15f || std::abs(at.y) < 0.15f) continue;
        const Rgb expected = at.y > 0 ? (at.x < 0 ? Rgb(1, 0, 0) : Rgb(0, 1, 0)) : at.x < 0 ? Rgb(0, 0, 1) : Rgb(0);
        for (int k = 0; k < 3; ++k) EXPECT_NEAR(double(frame.beauty[p][k]) / plainDisk(at), double(expected[k]), 0.02);
    }
}

TEST_F(ShapedLightWithFiles, ShowsItsSurfaceImageUprightFromItsFront) {
    LightShaping shaping;
    shaping.surfaceFile = image();
    const ShapedEmission emission(shaping, Mat4(1), Vec2(2, 1), true);
    // An eye in front of it, at -Z, sees +X to the left.
    EXPECT_EQ(emission.factor({0, 0, -1}, {0.5f, 0.25f, 0}), Rgb(1, 0, 0));
    EXPECT_EQ(emission.factor({0, 0, -1}, {-0.5f, 0.25f, 0}), Rgb(0, 1, 0));
    EXPECT_EQ(emission.factor({0, 0, -1}, {0.5f, -0.25f, 0}), Rgb(0, 0, 1));
    EXPECT_EQ(emission.factor({0, 0, -1}, {-0.5f, -0.25f, 0}), Rgb(0));
    EXPECT_LT(glm::distance(emission.mean(), Rgb(0.25f)), 1e-4f);
    EXPECT_LT(glm::distance(emission.shown({0, 0, -1}, Vec3(0)), Rgb(0.25f)), 1e-4f);
}

TEST_F(ShapedLightWithFiles, LightsTheViewportAsItLightsFrames) {
    const auto plane = std::make_shared<Plane>();
    const std::shared_ptr<const Scene> scene(plane, &plane->scene);
    const std::shared_ptr<const Estimate> estimate(plane, &plane->estimate);
    Progress progress;
    LiveScene live(scene, estimate, {}, progress);
    LightShaping cone, gobo, profile, surface, doors;
    doors.leftDoor = 20;
    doors.topDoor = -10;
    cone.coneDegrees = 30;
    cone.coneSoftness = 0.5f;
    gobo.coneDegrees = 40;
    gobo.goboFile = image();
    profile.iesFile = ies();
    surface.surfaceFile = image();
    const struct {
        LightShaping shaping;
        EmitterShape shape;
        float size;
        double within = 0.02;
    } cases[] = {{cone, EmitterShape::disk, 0.1f},
                 {gobo, EmitterShape::disk, 0.1f},
                 {profile, EmitterShape::sphere, 0.2f},
                 {surface, EmitterShape::rectangle, 1},
                 {doors, EmitterShape::rectangle, 0.4f, 0.05}};  // at the middles of its parts
    for (const auto& c : cases) {
        const Look look = lightAbove(c.shaping, c.shape, c.size);
        live.setLook(look);
        while (!live.refine(0.5, progress)) {}
        const auto shown = live.frame();
        const Frame frame = plane->frameOf(look, 32);
        // The vertices stand 10 cm apart, in rows.
        std::map<std::pair<int, int>, Rgb> at;
        for (size_t v = 0; v < scene->mesh.vertexCount(); ++v) {
            const Vec3 p = scene->mesh.positions[v];
            at[{int(std::lround(p.x * 10)), int(std::lround(p.y * 10))}] = shown->radiance[v];
        }
        Rgb fromFrame(0), fromView(0);
        for (size_t p = 0; p < frame.beauty.size(); ++p) {
            const float x = frame.position[p].x * 10, y = frame.position[p].y * 10;
            const int x0 = int(std::floor(x)), y0 = int(std::floor(y));
            const float fx = x - float(x0), fy = y - float(y0);
            fromFrame += frame.beauty[p];
            fromView += (1 - fy) * ((1 - fx) * at[{x0, y0}] + fx * at[{x0 + 1, y0}]) +
                        fy * ((1 - fx) * at[{x0, y0 + 1}] + fx * at[{x0 + 1, y0 + 1}]);
        }
        for (int k = 0; k < 3; ++k) EXPECT_NEAR(fromView[k] / fromFrame[k], 1, c.within) << int(c.shape) << " " << k;
    }
}

TEST_F(ShapedLightWithFiles, IsTakenAgainWhereItsShapingChangesInTheViewport) {
    const auto plane = std::make_shared<Plane>();
    Progress progress;
    LiveScene live(std::shared_ptr<const Scene>(plane, &plane->scene),
                   std::shared_ptr<const Estimate>(plane, &plane->estimate), {}, progress);
    const auto lit = [&](float cone) {
        LightShaping shaping;
        shaping.coneDegrees = cone;
        live.setLook(lightAbove(shaping));
        while (!live.refine(0.5, progress)) {}
        const auto frame = live.frame();
        return std::count_if(frame->radiance.begin(), frame->radiance.begin() + 41 * 41,
                             [](const Rgb& r) { return r.y > 0; });
    };
    const auto narrow = lit(20), wide = lit(40);
    // Discs of 0.73 and 1.68 m.
    EXPECT_NEAR(double(narrow), 0.728 * 0.728 * piD * 100, 12);
    EXPECT_NEAR(double(wide), 1.678 * 1.678 * piD * 100, 30);
    EXPECT_EQ(lit(20), narrow);
    EXPECT_EQ(lit(180), 41 * 41);
}

TEST_F(ShapedLightWithFiles, SurvivesItsDocumentAndBlendsBetweenKeys) {
    LightShaping shaping;
    shaping.coneDegrees = 35;
    shaping.coneSoftness = 0.25f;
    shaping.focus = 2;
    shaping.bottomDoor = 10;
    shaping.iesFile = ies();
    shaping.goboFile = image();
    const Look look = lightAbove(shaping, EmitterShape::spot);
    const auto document = lookToJson(look);
    const Look back = lookFromJson(document, "/elsewhere");
    EXPECT_EQ(back, look);
    EXPECT_EQ(filesOf(back), (std::vector<std::filesystem::path>{shaping.iesFile, shaping.goboFile}));
    Look other = look;
    other.added[0].shaping.coneDegrees = 15;
    other.added[0].shaping.focus = 0;
    other.added[0].shaping.bottomDoor = 90;
    LookPivots pivots;
    pivots.emitter = [](const std::string&) { return Vec3(0); };
    pivots.vertex = [](uint32_t) { return Vec3(0); };
    const Look between = blendLooks(look, other, 0.25f, pivots);
    EXPECT_FLOAT_EQ(between.added[0].shaping.coneDegrees, 30);
    EXPECT_FLOAT_EQ(between.added[0].shaping.focus, 1.5f);
    EXPECT_FLOAT_EQ(between.added[0].shaping.bottomDoor, 30);
    EXPECT_EQ(between.added[0].shaping.iesFile, shaping.iesFile);
}

TEST_F(ShapedLightWithFiles, SaysWhichFieldOfItsDocumentIsWrong) {
    const auto says = [&](const char* key, const nlohmann::json& value, const char* shape = "disk") {
        nlohmann::json document = lookToJson(lightAbove({}));
        document["added_emitters"][0]["shape"] = shape;
        document["added_emitters"][0]["seed_vertex"] = 0u;
        document["added_emitters"][0]["shaping"] = key[0] ? nlohmann::json{{key, value}} : value;
        try {
            lookFromJson(document, "");
        } catch (const Error& e) { return std::string(e.what()); }
        return std::string();
    };
    EXPECT_EQ(says("cone_degrees", 0), "added_emitters[0].shaping.cone_degrees: is 0, expected 0.1 to 180");
    EXPECT_EQ(says("cone_softness", 1.5), "added_emitters[0].shaping.cone_softness: is 1.5, expected 0 to 1");
    EXPECT_EQ(says("focus", -1), "added_emitters[0].shaping.focus: is -1, expected 0 to 1000");
    EXPECT_EQ(says("top_door_degrees", 91), "added_emitters[0].shaping.top_door_degrees: is 91, expected -60 to 90");
    EXPECT_NE(says("ies_file", 3).find("added_emitters[0].shaping.ies_file"), std::string::npos);
    EXPECT_NE(says("", 3).find("added_emitters[0].shaping: expected an object"), std::string::npos);
    nlohmann::json ball = lookToJson(lightAbove({}, EmitterShape::sphere));
    ball["added_emitters"][0]["shaping"] = {{"left_door_degrees", 0}, {"surface_file", "card.png"}, {"focus", 2}};
    LightShaping left;
    left.focus = 2;
    EXPECT_EQ(lookFromJson(ball, "").added[0].shaping, left) << "a ball has no face";
    EXPECT_EQ(says("focus", 1, "part"), "added_emitters[0].shaping: a part has none");
}

TEST_F(ShapedLightWithFiles, ThatIsMissingIsNamedWithItsLight) {
    const Plane plane;
    LightShaping shaping;
    shaping.iesFile = folder / "gone.ies";
    try {
        test::relitOf(plane.scene, plane.estimate, lightAbove(shaping));
        FAIL();
    } catch (const Error& e) {
        EXPECT_NE(std::string(e.what()).find("added_emitters: light"), std::string::npos) << e.what();
        EXPECT_NE(std::string(e.what()).find("gone.ies"), std::string::npos) << e.what();
    }
}

}  // namespace
}  // namespace relamp
