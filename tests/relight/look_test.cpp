#include "relight/look.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "base/error.h"
#include "relight/look_keys.h"
#include "support/temporary_folder.h"

namespace relamp {
namespace {

using nlohmann::json;

/// A document with every field.
json whole() {
    return json::parse(R"({"version": 1,
        "environment": {"source": "file", "file": "studio.exr", "yaw_degrees": 30, "exposure_stops": -1,
                        "tint": [1, 0.5, 0.25]},
        "emitters": [{"id": "emitter-1", "enabled": false, "power_scale": [2, 3, 4],
                      "matrix": [[1, 0, 0, 2], [0, 1, 0, 3], [0, 0, 1, 4], [0, 0, 0, 1]]}],
        "added_emitters": [{"id": "new-1", "shape": "disk", "size": [1, 2], "radiance": [5, 6, 7],
                            "matrix": [[0, -1, 0, 0], [1, 0, 0, 0], [0, 0, 1, 5], [0, 0, 0, 1]]}],
        "parts": [{"seed_vertex": 1234, "matrix": [[1, 0, 0, 1], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]}],
        "materials": {"neutral": true}})");
}

TEST(Look, ReadsEveryField) {
    const Look look = lookFromJson(whole(), "/somewhere");
    EXPECT_EQ(look.environment.source, EnvironmentLook::Source::file);
    EXPECT_EQ(look.environment.file, "/somewhere/studio.exr");
    EXPECT_EQ(look.environment.yawDegrees, 30);
    EXPECT_EQ(look.environment.exposureStops, -1);
    EXPECT_EQ(look.environment.tint, Rgb(1, 0.5f, 0.25f));
    ASSERT_EQ(look.emitters.size(), 1u);
    EXPECT_FALSE(look.emitters[0].enabled);
    EXPECT_EQ(look.emitters[0].powerScale, Rgb(2, 3, 4));
    // Row major: the translation is the last column.
    EXPECT_EQ(Vec3(look.emitters[0].matrix * Vec4(0, 0, 0, 1)), Vec3(2, 3, 4));
    ASSERT_EQ(look.added.size(), 1u);
    EXPECT_EQ(look.added[0].shape, EmitterShape::disk);
    EXPECT_EQ(Vec3(look.added[0].matrix * Vec4(1, 0, 0, 1)), Vec3(0, 1, 5));
    EXPECT_EQ(look.added[0].size, Vec2(1, 2));
    EXPECT_EQ(look.added[0].radiance, Rgb(5, 6, 7));
    ASSERT_EQ(look.parts.size(), 1u);
    EXPECT_EQ(look.parts[0].seedVertex, 1234u);
    EXPECT_TRUE(look.neutralMaterials);
}

TEST(Look, AnEmptyDocumentChangesNothing) {
    const Look look = lookFromJson(json::object(), "");
    EXPECT_EQ(look.environment.source, EnvironmentLook::Source::recovered);
    EXPECT_EQ(look.environment.tint, Rgb(1));
    EXPECT_TRUE(look.emitters.empty() && look.added.empty() && look.parts.empty());
    EXPECT_FALSE(look.neutralMaterials);
}

TEST(Look, SurvivesARoundTrip) {
    const Look look = lookFromJson(whole(), "/somewhere");
    EXPECT_EQ(lookToJson(lookFromJson(lookToJson(look), "/somewhere")), lookToJson(look));
    json withFile = whole();
    withFile["environment"]["file"] = "/somewhere/studio.exr";
    EXPECT_EQ(lookToJson(look), withFile);
}

TEST(Look, AnEnvironmentsFileIsMeantWithoutASourceToo) {
    json document = {{"environment", {{"file", "studio.exr"}}}};
    const Look look = lookFromJson(document, "/somewhere");
    EXPECT_EQ(look.environment.source, EnvironmentLook::Source::file);
    EXPECT_EQ(look.environment.file, "/somewhere/studio.exr");
    document["environment"]["source"] = "recovered";
    EXPECT_EQ(lookFromJson(document, "/somewhere").environment.source, EnvironmentLook::Source::recovered);
}

TEST(Look, NamesOfEmittersComeBackAndAreTidied) {
    json document = whole();
    document["emitters"][0]["name"] = "  Key light ";
    document["added_emitters"][0]["name"] = std::string(2 * longestName, 'x') + "\u00e9";
    const Look look = lookFromJson(document, "");
    EXPECT_EQ(look.emitters[0].name, "Key light");
    EXPECT_EQ(look.added[0].name, std::string(longestName, 'x'));
    EXPECT_EQ(lookFromJson(lookToJson(look), ""), look);
    // Cut between two characters, not inside one.
    EXPECT_EQ(tidyName(std::string(longestName - 1, 'x') + "\u00e9"), std::string(longestName - 1, 'x'));
    EXPECT_EQ(tidyName(std::string(longestName - 2, 'x') + "\u00e9"), std::string(longestName - 2, 'x') + "\u00e9");
    EXPECT_EQ(tidyName("   "), "");
    EXPECT_EQ(tidyName("Key\n\tlight\x7f"), "Keylight");
    document["emitters"][0]["name"] = "a\nb";
    EXPECT_THROW(lookFromJson(document, ""), Error);
}

TEST(Look, TwoEmittersThatAreCalledAlikeAreToldApart) {
    Look look;
    look.emitters.push_back({"emitter-2", true, Mat4(1), Rgb(1), "Key"});
    look.added.push_back({EmitterShape::disk, "disk-1"});
    look.added.push_back({EmitterShape::disk, "disk-2"});
    look.added.back().name = "Key";
    EXPECT_EQ(emitterNames({"emitter-1", "emitter-2"}, look),
              (std::vector<std::string>{"emitter-1", "Key", "disk-1", "Key (2)"}));
}

TEST(Look, NamesTheFieldThatIsBad) {
    const struct {
        const char* pointer;
        const char* value;
        const char* message;
    } cases[] = {
        {"/version", "2", "version: is 2"},
        {"/version", "\"1\"", "version: is \"1\""},
        {"/environment", "[]", "environment: expected an object"},
        {"/environment/source", "\"sun\"", "environment.source: is sun"},
        {"/environment/source", "7", "environment.source: expected a text"},
        {"/environment/file", "5", "environment.file: expected a text"},
        {"/environment/yaw_degrees", "\"north\"", "environment.yaw_degrees: expected a number"},
        {"/environment/yaw_degrees", "1e300", "environment.yaw_degrees: is 1e+300"},
        {"/environment/exposure_stops", "null", "environment.exposure_stops: expected a number"},
        {"/environment/exposure_stops", "1e30", "environment.exposure_stops: is 1e+30, expected -64 to 64 stops"},
        {"/environment/tint", "[1, 2]", "environment.tint: expected three numbers"},
        {"/environment/tint", "[1, 2, -3]", "environment.tint[2]: is -3"},
        {"/emitters", "{}", "emitters: expected a list"},
        {"/emitters/0", "5", "emitters[0]: expected an object"},
        {"/emitters/0/id", "5", "emitters[0].id: expected a text"},
        {"/emitters/0/enabled", "1", "emitters[0].enabled: expected true or false"},
        {"/emitters/0/matrix", "[1, 2, 3, 4]", "emitters[0].matrix[0]: expected four numbers"},
        {"/emitters/0/matrix", "[[1,0,0,0],[0,1,0,0],[0,0,1,0]]", "emitters[0].matrix: expected four rows"},
        {"/emitters/0/matrix/1", "[0, \"x\", 0, 0]", "emitters[0].matrix[1][1]: expected a number"},
        {"/emitters/0/matrix/1", "[1, 0, 0, 0]", "emitters[0].matrix: is singular"},
        {"/emitters/0/matrix/3", "[0, 0, 1, 1]", "emitters[0].matrix[3]: expected 0 0 0 1"},
        {"/emitters/0/power_scale", "3", "emitters[0].power_scale: expected three numbers"},
        {"/added_emitters", "\"none\"", "added_emitters: expected a list"},
        {"/added_emitters/0", "null", "added_emitters[0]: expected an object"},
        {"/added_emitters/0/id", "null", "added_emitters[0].id: expected a text"},
        {"/added_emitters/0/shape", "\"cone\"", "added_emitters[0].shape: is cone"},
        {"/added_emitters/0/size", "[]", "added_emitters[0].size: expected one or two numbers"},
        {"/added_emitters/0/size", "[1, 0]", "added_emitters[0].size: expected more than 0"},
        {"/added_emitters/0/size", "[\"a\"]", "added_emitters[0].size[0]: expected a number"},
        {"/added_emitters/0/radiance", "[1, 2, \"b\"]", "added_emitters[0].radiance[2]: expected a number"},
        {"/added_emitters/0/matrix", "0", "added_emitters[0].matrix: expected four rows"},
        {"/parts", "5", "parts: expected a list"},
        {"/parts/0", "[]", "parts[0].seed_vertex: expected a vertex number"},
        {"/parts/0/seed_vertex", "-1", "parts[0].seed_vertex: expected a vertex number"},
        {"/parts/0/seed_vertex", "99999999999", "parts[0].seed_vertex: 99999999999 does not exist"},
        {"/parts/0/matrix", "{}", "parts[0].matrix: expected four rows"},
        {"/materials", "true", "materials: expected an object"},
        {"/materials/neutral", "\"yes\"", "materials.neutral: expected true or false"},
    };
    for (const auto& c : cases) {
        json document = whole();
        document[json::json_pointer(c.pointer)] = json::parse(c.value);
        std::string message;
        try {
            lookFromJson(document, "");
        } catch (const Error& error) { message = error.what(); } catch (const std::exception& error) {
            message = std::string("not an Error: ") + error.what();
        }
        EXPECT_EQ(message.substr(0, std::strlen(c.message)), c.message) << c.pointer << " = " << c.value;
    }
    EXPECT_NE(test::messageOf([] { lookFromJson(json::array(), ""); }), "");
}

TEST(Look, MissingNeedsAreNamed) {
    for (const auto& [remove, message] :
         {std::pair{"/environment/file", "environment.file: expected a text"},
          std::pair{"/emitters/0/id", "emitters[0].id: expected a text"},
          std::pair{"/added_emitters/0/shape", "added_emitters[0].shape: expected a text"},
          std::pair{"/parts/0/seed_vertex", "parts[0].seed_vertex: expected a vertex number"}}) {
        json document = whole();
        const json::json_pointer pointer(remove);
        document[pointer.parent_pointer()].erase(pointer.back());
        EXPECT_EQ(test::messageOf([&] { lookFromJson(document, ""); }), message);
    }
}

/// A document with the added emitters that take their geometry from the scene, and a part that follows an emitter.
json fromScene() {
    return json::parse(R"({"added_emitters": [
            {"id": "glow", "shape": "part", "seed_vertex": 7, "radiance": [1, 2, 3]},
            {"id": "twin", "shape": "copy", "source": "emitter-1", "radiance": [4, 5, 6], "enabled": false}],
        "parts": [{"seed_vertex": 9, "attached_to": "emitter-1"}]})");
}

TEST(Look, ReadsPartsThatShineAndCopiesOfEmitters) {
    const Look look = lookFromJson(fromScene(), "");
    ASSERT_EQ(look.added.size(), 2u);
    EXPECT_EQ(look.added[0].shape, EmitterShape::part);
    EXPECT_EQ(look.added[0].seedVertex, 7u);
    EXPECT_TRUE(look.added[0].enabled);
    EXPECT_EQ(look.added[1].shape, EmitterShape::copy);
    EXPECT_EQ(look.added[1].source, "emitter-1");
    EXPECT_FALSE(look.added[1].enabled);
    EXPECT_EQ(look.parts.at(0).attachedTo, "emitter-1");
    EXPECT_EQ(lookFromJson(lookToJson(look), ""), look);
}

TEST(Look, WritesOnlyTheFieldsAShapeHas) {
    const json document = lookToJson(lookFromJson(fromScene(), ""));
    EXPECT_FALSE(document["added_emitters"][0].contains("enabled")) << "on is not written";
    EXPECT_FALSE(document["added_emitters"][0].contains("size"));
    EXPECT_FALSE(document["added_emitters"][1].contains("seed_vertex"));
    EXPECT_FALSE(lookToJson(lookFromJson(whole(), ""))["parts"][0].contains("attached_to"));
}

TEST(Look, NamesTheBadFieldOfPartsAndCopies) {
    const struct {
        const char* pointer;
        const char* value;
        const char* message;
    } cases[] = {
        {"/added_emitters/0/seed_vertex", "1.5", "added_emitters[0].seed_vertex: expected a vertex number"},
        {"/added_emitters/0/seed_vertex", "99999999999", "added_emitters[0].seed_vertex: 99999999999 does not exist"},
        {"/added_emitters/1/source", "3", "added_emitters[1].source: expected a text"},
        {"/added_emitters/1/enabled", "0", "added_emitters[1].enabled: expected true or false"},
        {"/parts/0/attached_to", "[]", "parts[0].attached_to: expected a text"},
    };
    for (const auto& c : cases) {
        json document = fromScene();
        document[json::json_pointer(c.pointer)] = json::parse(c.value);
        EXPECT_EQ(test::messageOf([&] { lookFromJson(document, ""); }), c.message);
    }
}

TEST(Look, HoldsAPlateWithItsSettingsThatNoKeyHas) {
    json document = whole();
    document["plate"] = {{"files", "plate.####.exr"},
                         {"camera", "/tracks/a.usda#cam"},
                         {"matte", "m.##.png"},
                         {"camera_offset", -3},
                         {"rotation", "XYZ"},
                         {"curve", "srgb"},
                         {"match", "off"},
                         {"matte_light", "relight"}};
    document["keys"] = {{{"frame", 1}, {"look", {{"materials", {{"neutral", false}}}}}}};
    const Look look = lookFromJson(document, "/somewhere");
    PlateLook expected{
        "/somewhere/plate.####.exr", "/tracks/a.usda#cam", {}, "/somewhere/m.##.png", -3, "XYZ", "srgb", "off", true};
    ASSERT_TRUE(look.plate);
    EXPECT_EQ(*look.plate, expected);
    EXPECT_FALSE(look.keys.at(0).look.plate);
    EXPECT_EQ(lookFromJson(lookToJson(look), "/elsewhere"), look);
    EXPECT_EQ(unknownLookKeys(lookToJson(look)), std::vector<std::string>{});
    expected = {"p.exr", "c.chan"};
    EXPECT_EQ(plateLookToJson(expected).size(), 2u) << "what is usual is not written";
    for (const auto& [key, bad] : std::vector<std::pair<std::string, json>>{
             {"files", ""}, {"camera", nullptr}, {"camera_offset", 0.5}, {"curve", 7}, {"matte_light", "dim"}}) {
        json broken = document;
        broken["plate"][key] = bad;
        try {
            lookFromJson(broken, "/somewhere");
            ADD_FAILURE() << key;
        } catch (const Error& error) {
            EXPECT_TRUE(std::string(error.what()).starts_with("plate." + key)) << error.what();
        }
    }
    document["keys"][0]["look"]["plate"] = document["plate"];
    EXPECT_THROW(lookFromJson(document, "/somewhere"), Error);
}

TEST(Look, KeysThatNoLookHasAreNamed) {
    json document = whole();
    document["keys"] = {{{"frame", 1}, {"ease", "hold"}, {"look", whole()}}};
    EXPECT_EQ(unknownLookKeys(document), std::vector<std::string>{});
    document["emiters"] = document["emitters"];
    document["emitters"][0]["radiance"] = {1, 1, 1};
    document["keys"][0]["look"]["environment"]["yaw"] = 3;
    document["added_emitters"][0]["shaping"] = {{"cone", 30}};
    const std::vector<std::string> found = unknownLookKeys(document);
    ASSERT_EQ(found.size(), 4u);
    for (const char* key : {"emiters: is no key here (there are version, environment, ", "emitters[0].radiance: ",
                            "keys[0].look.environment.yaw: ", "added_emitters[0].shaping.cone: "})
        EXPECT_TRUE(std::any_of(found.begin(), found.end(), [&](const auto& f) { return f.starts_with(key); })) << key;
    // What is written is known.
    Look look = lookFromJson(whole(), "/somewhere");
    look.emitters[0].name = look.added[0].name = "key";
    look.emitters[0].shadows = look.added[0].shadows = look.added[0].enabled = false;
    look.parts[0].attachedTo = "emitter-1";
    look.added[0].shaping = {30, 0.5f, 2, "a.ies", "b.png", "c.exr"};
    look.keys = {{5, look, KeyEase::smooth}};
    EXPECT_EQ(unknownLookKeys(lookToJson(look)), std::vector<std::string>{});
}

TEST(Look, FilesAreNamedInErrors) {
    const test::TemporaryFolder folder;
    const auto file = folder.write("edits.json", "{\"version\": 1,");
    EXPECT_NE(
        test::messageOf([&] { readLook(file); }).find(file.string() + ": is not valid JSON (parse error at line "),
        std::string::npos);
    folder.write("edits.json", R"({"emitters": [{"id": 3}]})");
    EXPECT_EQ(test::messageOf([&] { readLook(file); }), file.string() + ": emitters[0].id: expected a text");
    EXPECT_NE(test::messageOf([&] { readLook(folder / "absent.json"); }).find("absent.json"), std::string::npos);
}

}  // namespace
}  // namespace relamp
