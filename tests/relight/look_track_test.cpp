#include "relight/look_track.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "support/estimates.h"
#include "support/temporary_folder.h"

namespace relamp {
namespace {

Mat4 turnedAbout(const Vec3& centre, float degrees, const Vec3& moved = Vec3(0)) {
    const float c = std::cos(degrees * pi / 180), s = std::sin(degrees * pi / 180);
    const Mat4 turn(Vec4(c, s, 0, 0), Vec4(-s, c, 0, 0), Vec4(0, 0, 1, 0), Vec4(0, 0, 0, 1));
    return test::translation(centre + moved) * turn * test::translation(-centre);
}

void expectSame(const Mat4& a, const Mat4& b, float within = 2e-5f) {
    for (int c = 0; c < 4; ++c)
        for (int r = 0; r < 4; ++r) EXPECT_NEAR(a[c][r], b[c][r], within) << c << " " << r;
}

LookPivots pivotsAt(const Vec3& emitter) {
    LookPivots pivots;
    pivots.emitter = [emitter](const std::string&) { return emitter; };
    return pivots;
}

Look withEmitter(const Mat4& matrix, const Rgb& power = Rgb(1), bool enabled = true) {
    Look look;
    look.emitters.push_back({"emitter-1", enabled, matrix, power});
    return look;
}

TEST(BlendLooks, MovesAnEmitterStraightWhileItTurns) {
    const Vec3 emitter(5, 4, 1);
    const Look a = withEmitter(Mat4(1)), b = withEmitter(turnedAbout(emitter, 120, {1, 0, 0.5f}));
    expectSame(blendLooks(a, b, 0.25f, pivotsAt(emitter)).emitters[0].matrix,
               turnedAbout(emitter, 30, {0.25f, 0, 0.125f}));
    EXPECT_EQ(blendLooks(a, b, 0, {}), a);
    EXPECT_EQ(blendLooks(a, b, 1, {}), b);
}

TEST(BlendLooks, TakesPowerInStopsAndFadesToOffLinearly) {
    const Look a = withEmitter(Mat4(1), Rgb(1, 4, 0)), b = withEmitter(Mat4(1), Rgb(16, 1, 2));
    const Rgb middle = blendLooks(a, b, 0.5f, {}).emitters[0].powerScale;
    EXPECT_NEAR(middle.x, 4, 1e-5);
    EXPECT_NEAR(middle.y, 2, 1e-5);
    EXPECT_NEAR(middle.z, 1, 1e-5);
    const Look off = withEmitter(Mat4(1), Rgb(3), false);
    const EmitterLook fading = blendLooks(a, off, 0.75f, {}).emitters[0];
    EXPECT_TRUE(fading.enabled);
    EXPECT_NEAR(fading.powerScale.y, 1, 1e-5);
}

TEST(BlendLooks, StartsUnnamedEmittersAsRecoveredAndTurnsTheEnvironment) {
    Look a, b = withEmitter(test::translation({0, 0, 2}), Rgb(4));
    a.environment.yawDegrees = -10;
    b.environment.yawDegrees = 350;
    b.environment.exposureStops = 2;
    const Look middle = blendLooks(a, b, 0.5f, {});
    expectSame(middle.emitters.at(0).matrix, test::translation({0, 0, 1}));
    EXPECT_NEAR(middle.emitters[0].powerScale.x, 2, 1e-5);
    EXPECT_EQ(middle.environment.yawDegrees, 170);
    EXPECT_EQ(middle.environment.exposureStops, 1);
}

TEST(BlendLooks, KeepsAShadeOnItsEmitter) {
    const Mat4 end = turnedAbout({5, 4, 1}, 90, {0, 1, 0});
    Look a, b = withEmitter(end);
    b.parts.push_back({77, end});
    const Look middle = blendLooks(a, b, 0.3f, pivotsAt({5, 4, 1}));
    expectSame(middle.parts.at(0).matrix, middle.emitters.at(0).matrix);
}

TEST(BlendLooks, BlendsStretchAndMirrorsWithoutCollapse) {
    Mat4 half(1), mirrored(1);
    half[0][0] = 3;
    mirrored[0][0] = -1;
    mirrored[1][1] = mirrored[2][2] = -1;
    Mat4 expected(1);
    expected[0][0] = 2;
    expectSame(blendLooks(withEmitter(Mat4(1)), withEmitter(half), 0.5f, {}).emitters[0].matrix, expected);
    expectSame(blendLooks(withEmitter(mirrored), withEmitter(mirrored), 0.5f, {}).emitters[0].matrix, mirrored);
}

TEST(LookTrack, HoldsItsEndsAndReadsWhatKeysShare) {
    const test::TemporaryFolder folder;
    const auto file = folder.write("keys.json", R"({"version": 1, "environment": {"source": "none"}, "keys": [
        {"frame": 20, "look": {"emitters": [{"id": "emitter-1", "power_scale": [4, 4, 4]}]}},
        {"frame": 10, "look": {}}]})");
    const LookTrack track = readLookTrack(file);
    EXPECT_TRUE(track.moves());
    EXPECT_TRUE(track.at(1, {}).emitters.empty());
    EXPECT_EQ(track.at(1, {}).environment.source, EnvironmentLook::Source::none);
    EXPECT_NEAR(track.at(15, {}).emitters.at(0).powerScale.x, 2, 1e-5);
    EXPECT_EQ(track.at(99, {}).emitters.at(0).powerScale, Rgb(4));
    EXPECT_FALSE(readLookTrack(folder.write("plain.json", "{}")).moves());
}

TEST(LookTrack, CallsAnEmitterTheSameInEveryFrame) {
    Look first = withEmitter(Mat4(1)), last;
    first.emitters[0].name = "Key";
    last.emitters.push_back({"emitter-2", true, Mat4(1), Rgb(2), "Fill"});
    for (Look* look : {&first, &last}) look->added.push_back({EmitterShape::disk, "disk-1"});
    last.added[0].name = "Rim";
    const LookTrack track({{1, first}, {10, last}});
    for (const int frame : {1, 5, 10})
        EXPECT_EQ(emitterNames({"emitter-1", "emitter-2"}, track.at(frame, {})),
                  (std::vector<std::string>{"Key", "Fill", "Rim"}))
            << frame;
}

TEST(LookTrack, GoesOverAsTheKeySays) {
    const test::TemporaryFolder folder;
    const auto yawAt = [&](const char* ease, int frame) {
        const std::string keys = std::string(R"({"keys": [{"frame": 0, "look": {}, "ease": ")") + ease +
                                 R"("}, {"frame": 10, "look": {"environment": {"yaw_degrees": 100}}}]})";
        return readLookTrack(folder.write("k.json", keys)).at(frame, {}).environment.yawDegrees;
    };
    EXPECT_NEAR(yawAt("linear", 2), 20, 1e-4);
    EXPECT_NEAR(yawAt("smooth", 2), 100 * 0.104, 1e-4);
    EXPECT_NEAR(yawAt("smooth", 5), 50, 1e-4);
    EXPECT_EQ(yawAt("hold", 9), 0);
    for (const char* ease : {"linear", "smooth", "hold"}) EXPECT_EQ(yawAt(ease, 10), 100);
    EXPECT_NE(test::messageOf([&] { yawAt("bouncy", 1); }).find("keys[0].ease"), std::string::npos);
}

TEST(LookTrack, KeysSurviveTheirFile) {
    Look look = withEmitter(Mat4(1));
    look.keys.push_back({3, withEmitter(Mat4(1)), KeyEase::hold});
    look.keys.push_back({8, Look{}, KeyEase::linear});
    look.keys[1].look.environment.yawDegrees = 12;
    EXPECT_EQ(lookFromJson(lookToJson(look), {}), look);
    const test::TemporaryFolder folder;
    EXPECT_NE(test::messageOf([&] {
                  readLook(folder.write("k.json", R"({"keys": [{"frame": 1, "look": {"keys": []}}]})"));
              }).find("keys[0].look.keys"),
              std::string::npos);
}

TEST(LookTrack, NamesTheKeyThatIsWrong) {
    const test::TemporaryFolder folder;
    const auto messageFor = [&](const std::string& keys) {
        const auto file = folder.write("k.json", "{\"keys\": " + keys + "}");
        return test::messageOf([&] { readLookTrack(file); });
    };
    const std::vector<std::pair<std::string, std::string>> wrong{
        {"3", "k.json: keys: "},
        {"[]", "k.json: keys: is empty"},
        {"[1]", "k.json: keys[0]: "},
        {R"([{"look": {}}])", "k.json: keys[0].frame: "},
        {R"([{"frame": 1.5, "look": {}}])", "k.json: keys[0].frame: "},
        {R"([{"frame": 1}])", "k.json: keys[0].look: "},
        {R"([{"frame": 1, "look": {}}, {"frame": 1, "look": {}}])", "k.json: keys: frame 1 has two"},
        {R"([{"frame": 1, "look": {"emitters": [{"id": 3}]}}])", "k.json: keys[0].look: emitters[0].id"}};
    for (const auto& [keys, message] : wrong)
        EXPECT_NE(messageFor(keys).find("/" + message), std::string::npos) << keys << "\n" << messageFor(keys);
}

}  // namespace
}  // namespace relamp
