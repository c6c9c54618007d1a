#include "relight/value_keys.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "relight/look_track.h"
#include "relight/placement.h"
#include "support/estimates.h"
#include "support/temporary_folder.h"

namespace relamp {
namespace {

LookPivots lampAt(const Vec3& place) {
    LookPivots pivots;
    pivots.emitter = [place](const std::string&) { return place; };
    return pivots;
}

Vec3 placeOf(const Mat4& matrix, const Vec3& pivot) { return Vec3(matrix * Vec4(pivot, 1)); }

TEST(ValueKeys, EachValueGoesItsOwnWayAndTheRestStays) {
    Look look;
    look.environment.exposureStops = 1.5f;
    look.curves = {
        {{KeyedValue::powerScale, "emitter-1"}, {{10, Vec3(1)}, {20, Vec3(16), KeyEase::hold}, {30, Vec3(4)}}},
        {{KeyedValue::yaw, {}}, {{0, {0, 0, 0}, KeyEase::smooth}, {10, {400, 0, 0}}}}};
    const LookTrack track(look);
    EXPECT_TRUE(track.moves());
    EXPECT_NEAR(track.at(15, {}).emitters.at(0).powerScale.x, 4, 1e-5) << "even steps of stops";
    EXPECT_EQ(track.at(29, {}).emitters.at(0).powerScale, Rgb(16)) << "holds";
    EXPECT_EQ(track.at(99, {}).emitters.at(0).powerScale, Rgb(4));
    EXPECT_EQ(track.at(5, {}).environment.yawDegrees, 200);
    EXPECT_NEAR(track.at(2, {}).environment.yawDegrees, 400 * 0.104f, 1e-3);
    EXPECT_EQ(track.at(10, {}).environment.yawDegrees, 400) << "more than a whole turn";
    EXPECT_EQ(track.at(7, {}).environment.exposureStops, 1.5f);
    EXPECT_TRUE(track.at(7, {}).curves.empty());
}

TEST(ValueKeys, HaveTheLastWordOverKeysOfTheLook) {
    const test::TemporaryFolder folder;
    const LookTrack track = readLookTrack(folder.write("k.json", R"({"keys": [
            {"frame": 1, "look": {"emitters": [{"id": "a", "power_scale": [1, 1, 1], "enabled": false}]}},
            {"frame": 9, "look": {"environment": {"yaw_degrees": 80}}}],
        "value_keys": [{"light": "a", "value": "power_scale", "keys": [{"frame": 5, "value": [2, 3, 4]}]},
                       {"light": "a", "value": "enabled", "keys": [
                           {"frame": 1, "value": true}, {"frame": 6, "value": false}]}]})"));
    EXPECT_EQ(track.at(5, {}).environment.yawDegrees, 40);
    EXPECT_EQ(track.at(5, {}).emitters.at(0).powerScale, Rgb(2, 3, 4));
    EXPECT_TRUE(track.at(5, {}).emitters[0].enabled) << "a flag holds until its next key";
    EXPECT_FALSE(track.at(6, {}).emitters[0].enabled);
}

TEST(ValueKeys, ALightTurnsWhereItsPositionPutsItAndTakesItsShadeAlong) {
    const Vec3 lamp(5, 4, 1);
    Look look;
    look.parts.push_back({77, Mat4(1), "emitter-1"});
    look.curves = {{{KeyedValue::position, "emitter-1"}, {{0, Vec3(0)}, {10, {2, 0, 1}}}},
                   {{KeyedValue::rotation, "emitter-1"}, {{0, Vec3(0)}, {10, {0, 0, 720}}}},
                   {{KeyedValue::scale, "emitter-1"}, {{0, Vec3(1)}, {10, Vec3(3, 1, 1)}}}};
    const LookTrack track(look);
    for (const int frame : {0, 3, 5, 10}) {
        const Look now = track.at(frame, lampAt(lamp));
        const Mat4& m = now.emitters.at(0).matrix;
        const float t = float(frame) / 10;
        EXPECT_NEAR(glm::distance(placeOf(m, lamp), lamp + t * Vec3(2, 0, 1)), 0, 2e-5) << frame;
        EXPECT_NEAR(glm::length(Vec3(m[0])), 1 + 2 * t, 1e-5) << frame;
        const float angle = std::remainder(720 * t, 360.0f);
        EXPECT_NEAR(std::remainder(placementOf(m).degrees.z - angle, 360.0f), 0, 1e-2) << frame;
        EXPECT_EQ(now.parts.at(0).matrix, m) << frame;
        EXPECT_NEAR(glm::distance(*valueOf(now, look.curves[0].what, lampAt(lamp)), t * Vec3(2, 0, 1)), 0, 2e-5);
    }
}

TEST(ValueKeys, AnglesAreTheNearestOnes) {
    EXPECT_NEAR(glm::distance(anglesNear({0, 0, -10}, {0, 0, 340}), Vec3(0, 0, 350)), 0, 1e-3);
    const Vec3 other = anglesNear({170, 80, 175}, {-12, 98, -3});
    EXPECT_NEAR(glm::distance(other, Vec3(-10, 100, -5)), 0, 1e-3);
    const Mat3 a = rotationOf(other), b = rotationOf({170, 80, 175});
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(glm::distance(a[c], b[c]), 0, 1e-5);
}

TEST(ValueKeys, EveryValueSurvivesItsFile) {
    Look look;
    AddedEmitter spot;
    spot.shape = EmitterShape::spot;
    spot.id = "spot-1";
    look.added.push_back(spot);
    look.groups.push_back({"Desk", {"spot-1"}});
    for (const KeyedValueInfo& info : keyedValues()) {
        using Owner = KeyedValueInfo::Owner;
        ValueCurve curve;
        curve.what = {info.value, info.owner == Owner::recovered ? "emitter-1"
                                  : info.owner == Owner::group   ? "Desk"
                                  : info.owner == Owner::look    ? ""
                                                                 : "spot-1"};
        Vec3 value(0);
        const float own = 0.5f + 0.02f * float(look.curves.size());  // none stands in for another
        for (int k = 0; k < info.components; ++k) value[k] = info.kind == KeyedValueInfo::Kind::flag ? 1 : own;
        curve.keys = {{3, value, KeyEase::hold}, {8, value, KeyEase::smooth}};
        look.curves.push_back(curve);
    }
    EXPECT_EQ(lookFromJson(lookToJson(look), {}), look);
    // Positions in the world count from 0 in files, those of recovered lights from where they were captured.
    const DVec3 origin(4e6, 5e5, 100);
    const nlohmann::json document = lookToJson(look, origin);
    EXPECT_EQ(document["value_keys"][0]["keys"][0]["value"][0].get<double>(), 4e6 + 0.5);
    EXPECT_EQ(lookFromJson(document, {}, origin), look);
    // What is keyed is what the look shows.
    const Look shown = LookTrack(look).at(3, {});
    for (const ValueCurve& curve : look.curves)
        EXPECT_NEAR(glm::distance(valueOf(shown, curve.what, {}).value(), curve.keys[0].value), 0, 1e-4)
            << infoOf(curve.what.value).name;
}

TEST(ValueKeys, BadOnesAreNamed) {
    const test::TemporaryFolder folder;
    const auto messageFor = [&](const std::string& list) {
        const auto file = folder.write("k.json", R"({"added_emitters": [{"id": "sun-1", "shape": "sun"}, {"id": "b",
            "shape": "part", "seed_vertex": 0}], "value_keys": )" +
                                                     list + "}");
        return test::messageOf([&] { readLookTrack(file); });
    };
    const std::string keys = R"("keys": [{"frame": 1, "value": 1}])";
    const std::vector<std::pair<std::string, std::string>> wrong{
        {"3", "value_keys: expected a list"},
        {"[3]", "value_keys[0]: expected an object"},
        {"[{" + keys + "}]", "value_keys[0].value: "},
        {R"([{"value": "yaw", )" + keys + "}]", "value_keys[0].value: is yaw, expected of no light environment.yaw"},
        {R"([{"value": "power_scale", "light": "sun-1", )" + keys + "}]",
         "value_keys[0].value: power_scale is a value of recovered"},
        {R"([{"value": "radiance", "light": "emitter-1", )" + keys + "}]",
         "value_keys[0].value: radiance is a value of added"},
        {R"([{"value": "size", "light": "b", )" + keys + "}]", "value_keys[0].value: a part has no size"},
        {R"([{"value": "shaping.focus", "light": "sun-1", )" + keys + "}]", "value_keys[0].value: a sun has no"},
        {R"([{"value": "enabled", "group": "Desk", )" + keys + "}]", "value_keys[0].group: Desk is no group"},
        {R"([{"value": "enabled", "group": "Desk", "light": "b"}])", "value_keys[0]: names a light and a group"},
        {R"([{"value": "environment.yaw_degrees"}])", "value_keys[0].keys: expected a list of keys"},
        {R"([{"value": "environment.yaw_degrees", "keys": []}])", "value_keys[0].keys: expected a list of keys"},
        {R"([{"value": "environment.yaw_degrees", "keys": [{"value": 1}]}])", "value_keys[0].keys[0].frame: "},
        {R"([{"value": "environment.yaw_degrees", "keys": [{"frame": 1}]}])",
         "value_keys[0].keys[0].value: is missing"},
        {R"([{"value": "environment.exposure_stops", "keys": [{"frame": 1, "value": 65}]}])",
         "value_keys[0].keys[0].value: is 65"},
        {R"([{"value": "environment.tint", "keys": [{"frame": 1, "value": [1, -1, 1]}]}])",
         "value_keys[0].keys[0].value[1]: is -1"},
        {R"([{"value": "materials.neutral", )" + keys + "}]", "value_keys[0].keys[0].value: "},
        {R"([{"value": "environment.yaw_degrees", "keys": [{"frame": 1, "value": 1}, {"frame": 1, "value": 2}]}])",
         "frame 1 has two values"},
        {R"([{"value": "environment.yaw_degrees", "keys": [{"frame": 1, "value": 1, "ease": "bouncy"}]}])",
         "value_keys[0].keys[0].ease"},
        {R"([{"value": "environment.yaw_degrees", )" + keys + R"(}, {"value": "environment.yaw_degrees", )" + keys +
             "}]",
         "value_keys[1]: this value has keys already"}};
    for (const auto& [list, message] : wrong)
        EXPECT_NE(messageFor(list).find(message), std::string::npos) << list << "\n" << messageFor(list);
    EXPECT_NE(test::messageOf([&] {
                  readLook(folder.write("k.json", R"({"keys": [{"frame": 1, "look": {"value_keys": []}}]})"));
              }).find("keys[0].look.value_keys"),
              std::string::npos);
}

TEST(ValueKeys, AChangeForEveryKeyReachesThemToo) {
    Look look;
    look.curves = {{{KeyedValue::yaw, {}}, {{0, {10, 0, 0}}, {10, {30, 0, 0}}}}};
    LookTrack track(look);
    track.apply([](Look& one) { one.environment.yawDegrees += 5; });
    EXPECT_EQ(track.at(5, {}).environment.yawDegrees, 25);
}

}  // namespace
}  // namespace relamp
