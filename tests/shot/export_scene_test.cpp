#include "shot/export_scene.h"

#include <gtest/gtest.h>

#include <cstring>
#include <map>
#include <nlohmann/json.hpp>

#include "capture/transforms_json.h"
#include "image/environment_map.h"
#include "scene/mesh_io.h"
#include "support/estimates.h"
#include "support/temporary_folder.h"

namespace relamp {
namespace {

/// A floor and an emitter of 2 x 0.5 m that shines down from (1, 2, 3).
class ExportedShot : public testing::Test {
protected:
    void SetUp() override {
        const Scene scene = test::sceneOf(test::sheet({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, 2, 2));
        shot.estimate = test::matteEstimate(scene, Rgb(0.5f, 0.25f, 0.125f), Rgb(1, 2, 3));
        shot.capture.mesh = scene.mesh;
        View view;
        view.name = "images/0.exr";
        view.file = folder / "images/0.exr";
        view.camera = test::cameraAt({0, -2, 1.5}, {0, 0, 0}, 40, 30, 50);
        shot.capture.views.push_back(view);
        Look look;
        look.added.push_back(
            {EmitterShape::rectangle, "rectangle-1", test::translation({1, 2, 3}), Vec2(2, 0.5f), Rgb(40, 20, 10)});
        look.added.back().name = "light 1";
        relit = test::relitOf(scene, shot.estimate, look);
        exportScene(shot, relit, out(), false);
    }
    std::filesystem::path out() const { return folder / "out"; }
    nlohmann::json parsed(const char* name) const {
        return nlohmann::json::parse(test::TemporaryFolder::read(out() / name));
    }
    test::TemporaryFolder folder;
    Shot shot;
    RelitScene relit;
};

TEST_F(ExportedShot, HasLightsWithTheirPlaceAndRadianceAsJson) {
    const auto light = parsed("lights.json")["lights"].at(0);
    EXPECT_EQ(light["id"], "rectangle-1");
    EXPECT_EQ(light["name"], "light 1");
    EXPECT_EQ(light["radiance"], (nlohmann::json{40, 20, 10}));
    EXPECT_NEAR(light["area_m2"].get<double>(), 1, 1e-6);
    EXPECT_NEAR(light["flux"][0].get<double>(), 40 * piD, 1e-4);
    EXPECT_NEAR(light["centroid"][2].get<double>(), 3, 1e-6);
    EXPECT_NEAR(light["mean_normal"][2].get<double>(), -1, 1e-6);
    EXPECT_EQ(light["triangles"].size(), 2u);
    EXPECT_NEAR(light["positions"][0][0].get<double>(), 0, 1e-6);
}

TEST_F(ExportedShot, HasMeshLightsInGltf) {
    const auto gltf = parsed("lights.gltf");
    const auto& node = gltf["nodes"].at(1);
    EXPECT_EQ(node["name"], "light 1");
    EXPECT_EQ(node["translation"], (nlohmann::json{1, 2, 3}));
    EXPECT_EQ(gltf["nodes"][0]["children"].size(), 3u);  // emitter, surfaces, camera
    const auto& primitive = gltf["meshes"][node["mesh"].get<size_t>()]["primitives"][0];
    const auto& material = gltf["materials"][primitive["material"].get<size_t>()];
    EXPECT_EQ(material["emissiveFactor"], (nlohmann::json{1, 0.5, 0.25}));
    EXPECT_EQ(material["extensions"]["KHR_materials_emissive_strength"]["emissiveStrength"], 40);
    const std::string bytes = test::TemporaryFolder::read(out() / "lights.bin");
    EXPECT_EQ(gltf["buffers"][0]["byteLength"], bytes.size());
    const auto& accessor = gltf["accessors"][primitive["attributes"]["POSITION"].get<size_t>()];
    const auto& view = gltf["bufferViews"][accessor["bufferView"].get<size_t>()];
    float corner[3];
    std::memcpy(corner, bytes.data() + view["byteOffset"].get<size_t>(), sizeof corner);
    EXPECT_NEAR(std::abs(corner[0]), 1, 1e-6);
    EXPECT_NEAR(std::abs(corner[1]), 0.25, 1e-6);
    EXPECT_NEAR(accessor["max"][0].get<double>(), 1, 1e-6);
    for (const auto& v : gltf["bufferViews"]) EXPECT_EQ(v["byteOffset"].get<size_t>() % 4, 0u);
    EXPECT_NEAR(gltf["cameras"][0]["perspective"]["yfov"].get<double>(), 2 * std::atan(0.3), 1e-9);
}

TEST_F(ExportedShot, HasMeshLightsInUsd) {
    const std::string usd = test::TemporaryFolder::read(out() / "lights.usda");
    EXPECT_EQ(usd.substr(0, 9), "#usda 1.0");
    for (const char* text :
         {"def Mesh \"light_1\"", "\"MeshLightAPI\"", "string relamp:id = \"rectangle-1\"",
          "double3 xformOp:translate = (1, 2, 3)", "color3f inputs:color = (1, 0.5, 0.25)",
          "float inputs:intensity = 40", "color3f inputs:emissiveColor = (40, 20, 10)", "upAxis = \"Z\"",
          "def DomeLight", "def Camera \"view_images_0_exr\"", "@./environment.exr@"})
        EXPECT_NE(usd.find(text), std::string::npos) << text;
    EXPECT_EQ(std::count(usd.begin(), usd.end(), '{'), std::count(usd.begin(), usd.end(), '}'));
    EXPECT_EQ(std::count(usd.begin(), usd.end(), '('), std::count(usd.begin(), usd.end(), ')'));
}

TEST_F(ExportedShot, HasSunsAndShapedLightsAsUsdLuxHasThem) {
    const auto ies = folder.write("beam.ies", "TILT=NONE\n1 1000 1 3 1 1 2 0 0 0 1 1 1\n0 45 90\n0\n100 200 0");
    Look look;
    look.added.push_back({EmitterShape::sun, "sun-1", Mat4(1), Vec2(0.53f), Rgb(2)});
    look.added.push_back({EmitterShape::spot, "spot-1", test::translation({0, 0, 2}), Vec2(0.1f), Rgb(10)});
    look.added[0].shadows = false;
    look.added[1].shaping.coneDegrees = 30;
    look.added[1].shaping.iesFile = ies;
    look.added[1].shaping.topDoor = 60;
    const Scene scene = test::sceneOf(test::sheet({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, 2, 2));
    const RelitScene lit = test::relitOf(scene, shot.estimate, look);
    const std::vector<std::string> words = exportScene(shot, lit, folder / "lights", false);
    const std::string usd = test::TemporaryFolder::read(folder / "lights/lights.usda");
    for (const char* text : {"def DistantLight \"sun_1\"", "float inputs:angle = 0.53", "bool inputs:shadow:enable = 0",
                             "\"MeshLightAPI\", \"ShapingAPI\"", "inputs:shaping:cone:angle = 30", "beam.ies@",
                             "float inputs:intensity = 0.05"})
        EXPECT_NE(usd.find(text), std::string::npos) << text;
    const auto lights = nlohmann::json::parse(test::TemporaryFolder::read(folder / "lights/lights.json"))["lights"];
    ASSERT_EQ(lights.size(), 2u);
    EXPECT_EQ(lights[0]["type"], "sun");
    EXPECT_NEAR(lights[0]["irradiance"][0].get<double>(), 2 * piD, 1e-3);
    EXPECT_EQ(lights[0]["direction"], (nlohmann::json{0, 0, -1}));
    EXPECT_EQ(lights[1]["shaping"]["cone_degrees"], 30);
    EXPECT_LT(lights[1]["flux"][0].get<double>(), 10 * piD * piD * 0.0025 / 4);
    // The scene holds what its lights are made of, and says what formats leave out.
    EXPECT_EQ(lights[1]["shaping"]["ies_file"], "beam.ies");
    EXPECT_EQ(test::TemporaryFolder::read(folder / "lights/beam.ies"), test::TemporaryFolder::read(ies));
    EXPECT_NE(usd.find("@./beam.ies@"), std::string::npos);
    ASSERT_EQ(words.size(), 1u);
    EXPECT_NE(words[0].find("spot-1: lights.gltf"), std::string::npos) << words[0];
    EXPECT_NE(words[0].find("lights.usda leaves its barn doors out"), std::string::npos) << words[0];
    // A cone needs no photometric file.
    look.added[1].shaping.iesFile.clear();
    const std::string plain =
        usdaOf(exportedScene(test::relitOf(scene, shot.estimate, look), shot.capture), "environment.exr");
    EXPECT_NE(plain.find("inputs:shaping:cone:angle = 30"), std::string::npos);
    EXPECT_EQ(plain.find("ies:file"), std::string::npos);
}

TEST_F(ExportedShot, NamesTheSurfacesThatALightDoesNotFallOn) {
    Mesh mesh = test::sheet({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, 2, 2);
    const uint32_t second = uint32_t(mesh.vertexCount());
    test::append(mesh, test::sheet({-1, -1, 1}, {2, 0, 0}, {0, 2, 0}, 2, 2));
    const Scene scene = test::sceneOf(mesh);
    const Estimate estimate = test::matteEstimate(scene, Rgb(0.5f), Rgb(1));
    Look look;
    look.added.push_back({EmitterShape::disk, "disk-1", test::translation({0, 0, 2}), Vec2(1), Rgb(4)});
    look.added.push_back({EmitterShape::sun, "sun-1", Mat4(1), Vec2(0.53f), Rgb(2)});
    look.added[0].link = {false, {second}};
    look.added[1].link = {true, {second}};
    Shot linked;
    linked.estimate = estimate;
    linked.capture.mesh = scene.mesh;
    const std::vector<std::string> words =
        exportScene(linked, test::relitOf(scene, estimate, look), folder / "linked", false);
    ASSERT_EQ(words.size(), 2u);
    EXPECT_NE(words[0].find("disk-1: lights.gltf and surfaces.obj let it fall on all"), std::string::npos) << words[0];
    const auto lights = nlohmann::json::parse(test::TemporaryFolder::read(folder / "linked/lights.json"))["lights"];
    ASSERT_EQ(lights[0]["not_on"].size(), 1u);
    ASSERT_EQ(lights[1]["not_on"].size(), 1u);
    EXPECT_NE(lights[0]["not_on"][0], lights[1]["not_on"][0]);
    // The surface that is named is the one, and glTF's nodes and USD's prims are called alike.
    const auto gltf = nlohmann::json::parse(test::TemporaryFolder::read(folder / "linked/lights.gltf"));
    for (const auto& node : gltf["nodes"])
        if (node["name"] == lights[0]["not_on"][0]) {
            const auto position = gltf["meshes"][node["mesh"].get<size_t>()]["primitives"][0]["attributes"]["POSITION"];
            EXPECT_EQ(gltf["accessors"][position.get<size_t>()]["max"][2], 1);
        }
    const std::string usd = test::TemporaryFolder::read(folder / "linked/lights.usda");
    EXPECT_NE(usd.find("rel collection:lightLink:excludes = [</relamp/surfaces>]"), std::string::npos);
    EXPECT_NE(usd.find("rel collection:lightLink:excludes = [</relamp/surfaces_2>]"), std::string::npos);
}

TEST_F(ExportedShot, KeepsTheUnevenRadianceOfALight) {
    // From 0.5 at its left end (x = 0) to 1.5 at its right one.
    const std::vector<Vec3> ends{{0, 1.75f, 3}, {0, 2.25f, 3}, {2, 1.75f, 3}, {2, 2.25f, 3}};
    relit.emitters[0].emission.shaped = std::make_shared<const ShapedEmission>(
        std::make_shared<const EmissionPattern>(ends, std::vector<float>{0.5f, 0.5f, 1.5f, 1.5f}), Mat4(1));
    const std::vector<std::string> words = exportScene(shot, relit, folder / "uneven", false);
    ASSERT_EQ(words.size(), 1u);
    EXPECT_NE(words[0].find("mean"), std::string::npos) << words[0];
    const auto in = [&](const char* name) { return test::TemporaryFolder::read(folder / "uneven" / name); };
    const auto light = nlohmann::json::parse(in("lights.json"))["lights"].at(0);
    ASSERT_EQ(light["levels"].size(), light["positions"].size());
    for (size_t v = 0; v < light["levels"].size(); ++v)
        EXPECT_NEAR(light["levels"][v].get<double>(), 0.5 + light["positions"][v][0].get<double>() / 2, 0.01);
    // Every corner of a triangle reads its level from the texture.
    const auto gltf = nlohmann::json::parse(in("lights.gltf"));
    const auto& part = gltf["meshes"][0]["primitives"][0];
    const auto& material = gltf["materials"][part["material"].get<size_t>()];
    EXPECT_NEAR(material["extensions"]["KHR_materials_emissive_strength"]["emissiveStrength"].get<double>(), 60, 0.5);
    const auto& texture = gltf["textures"][material["emissiveTexture"]["index"].get<size_t>()];
    const Image levels = readImage(folder / "uneven" / gltf["images"][texture["source"].get<size_t>()]["uri"]);
    const std::string bytes = in("lights.bin");
    const auto read = [&](const char* name, int size, size_t i, float* out) {
        const auto& accessor = gltf["accessors"][part["attributes"][name].get<size_t>()];
        const auto& view = gltf["bufferViews"][accessor["bufferView"].get<size_t>()];
        std::memcpy(out, bytes.data() + view["byteOffset"].get<size_t>() + 4 * i * size_t(size), 4 * size_t(size));
    };
    for (size_t i = 0; i < 6; ++i) {
        float position[3], place[2];
        read("POSITION", 3, i, position);
        read("TEXCOORD_0", 2, i, place);
        const float level = levels.at(int(place[0] * float(levels.width)), int(place[1] * float(levels.height))).x;
        EXPECT_NEAR(1.5f * level, 1 + position[0] / 2, 0.02f);
    }
    const std::string usd = in("lights.usda"), materials = in("materials.mtlx");
    for (const char* text : {"color3f[] primvars:emission = [(", "\"materialGlowTintsLight\"",
                             "emissiveColor.connect = </relamp/Materials/light_1/glow.outputs:result>"})
        EXPECT_NE(usd.find(text), std::string::npos) << text;
    EXPECT_NE(materials.find("nodename=\"light_1_emission\""), std::string::npos);
}

TEST_F(ExportedShot, HasEnvironmentMaterialsAndCameras) {
    const Image environment = readEnvironment(out() / "environment.exr");
    EXPECT_NEAR(environment.at(100, 100).z, 3, 1e-3);
    const Mesh mesh = readMesh(out() / "materials.ply");
    EXPECT_EQ(mesh.vertexCount(), relit.scene.mesh.vertexCount());
    std::map<std::string, std::vector<float>> properties;
    for (VertexProperty& p : readVertexPly(out() / "materials.ply")) properties[p.name] = std::move(p.values);
    EXPECT_NEAR(properties.at("albedo_g")[0], 0.25, 1e-6);
    EXPECT_EQ(properties.at("emitter").back(), 0);
    const Transforms transforms =
        readTransforms(out() / "transforms.json", [](const std::string&) { return std::pair(0, 0); });
    EXPECT_EQ(transforms.frames.at(0).filePath, "../images/0.exr");
    EXPECT_LT(glm::distance(transforms.frames[0].camera.position(), DVec3(0, -2, 1.5)), 1e-9);
    EXPECT_EQ(transforms.frames[0].camera.focalX, 50);
    EXPECT_EQ(transforms.meshPath, "materials.ply");
}

TEST_F(ExportedShot, IsNotWrittenOverUnlessAsked) {
    EXPECT_NE(test::messageOf([&] { exportScene(shot, relit, out(), false); }).find("--overwrite"), std::string::npos);
    exportScene(shot, relit, out(), true);
}

/// The same with a texture on half of the floor.
class ExportedTexture : public ExportedShot {
protected:
    void SetUp() override {
        ExportedShot::SetUp();
        auto texture = std::make_shared<AlbedoTexture>();
        texture->width = texture->height = 16;
        for (int y = 0; y < 16; ++y)
            for (int x = 0; x < 16; ++x) texture->texels.push_back(Rgb(float(x) / 16, float(y) / 16, 0.5f));
        texture->corners.assign(relit.scene.mesh.triangles.size(), {Vec2(-1), Vec2(-1), Vec2(-1)});
        for (size_t t = 0; t < 4; ++t)
            for (size_t k = 0; k < 3; ++k) {
                const Vec3& p = relit.scene.mesh.positions[relit.scene.mesh.triangles[t][k]];
                texture->corners[t][k] = Vec2(4 + 3 * p.x, 12 - 3 * p.y);
            }
        relit.texture = texture;
        exportScene(shot, relit, out(), true);
    }
};

TEST_F(ExportedTexture, LiesOnItsTrianglesAndTheOthersKeepTheirColours) {
    const ExportedScene scene = exportedScene(relit, shot.capture);
    ASSERT_EQ(scene.components.size(), 3u);
    const ExportedComponent &textured = scene.components[1], &plain = scene.components[2];
    EXPECT_EQ(textured.triangles.size(), 4u);
    EXPECT_EQ(plain.triangles.size(), 4u);
    EXPECT_TRUE(plain.texcoords.empty());
    ASSERT_EQ(textured.texcoords.size(), textured.positions.size());
    for (size_t v = 0; v < textured.positions.size(); ++v) {
        const Vec3& p = textured.positions[v];
        EXPECT_NEAR(textured.texcoords[v].x * 16, 4 + 3 * p.x, 1e-4);
        EXPECT_NEAR((1 - textured.texcoords[v].y) * 16, 12 - 3 * p.y, 1e-4);
    }
}

/// Without a texture of ours the file's coordinates go out all the same, for what others paint or bake.
TEST_F(ExportedShot, KeepsTheTexcoordsOfTheFile) {
    std::vector<TexturedFace> faces;
    for (const Triangle& t : shot.capture.mesh.triangles) {
        TexturedFace face{t, {}};
        for (size_t k = 0; k < 3; ++k) face.texcoords[k] = 0.3f * Vec2(shot.capture.mesh.positions[t[k]]) + Vec2(0.5f);
        faces.push_back(face);
    }
    faces.pop_back();
    shot.capture.texcoords = std::make_shared<const std::vector<TexturedFace>>(faces);
    exportScene(shot, relit, out(), true);
    const auto gltf = parsed("lights.gltf");
    EXPECT_FALSE(gltf.contains("textures"));
    EXPECT_FALSE(gltf["meshes"][0]["primitives"][0]["attributes"].contains("TEXCOORD_0"));  // an added light
    const auto& attributes = gltf["meshes"][1]["primitives"][0]["attributes"];
    EXPECT_TRUE(attributes.contains("TEXCOORD_0") && attributes.contains("COLOR_0"));
    EXPECT_NE(test::TemporaryFolder::read(out() / "lights.usda").find("primvars:st"), std::string::npos);
    // Read again they lie where they lay, in both files; glTF's positions are turned to Y up.
    for (const char* name : {"surfaces.obj", "lights.gltf"}) {
        MeshReport report;
        std::vector<TexturedFace> found;
        const Mesh mesh = readMesh(out() / name, &report, {}, &found);
        ASSERT_EQ(found.size(), faces.size()) << name;
        for (const TexturedFace& face : found)
            for (size_t k = 0; k < 3; ++k) {
                const Vec3 p = mesh.positions[face.corners[k]] + Vec3(report.origin);
                const Vec2 across(p.x, report.yUp ? -p.z : p.y);
                EXPECT_LT(glm::distance(face.texcoords[k], 0.3f * across + Vec2(0.5f)), 1e-5f) << name;
            }
    }
}

TEST_F(ExportedTexture, IsNamedInGltfUsdAndObj) {
    const auto gltf = parsed("lights.gltf");
    EXPECT_EQ(gltf["images"][0]["uri"], "albedo.png");
    const auto& primitive = gltf["meshes"][1]["primitives"][0];
    EXPECT_TRUE(primitive["attributes"].contains("TEXCOORD_0"));
    EXPECT_EQ(
        gltf["materials"][primitive["material"].get<size_t>()]["pbrMetallicRoughness"]["baseColorTexture"]["index"], 0);
    EXPECT_FALSE(gltf["meshes"][2]["primitives"][0]["attributes"].contains("TEXCOORD_0"));
    const std::string usd = test::TemporaryFolder::read(out() / "lights.usda");
    EXPECT_NE(usd.find("@./albedo.exr@"), std::string::npos);
    EXPECT_NE(usd.find("primvars:st"), std::string::npos);
    EXPECT_NE(test::TemporaryFolder::read(out() / "surfaces.mtl").find("map_Kd albedo.png"), std::string::npos);
    MeshReport report;
    EXPECT_EQ(readMesh(out() / "surfaces.obj", &report).triangles.size(), 10u);  // floor and rectangle
    const Image linear = readImage(out() / "albedo.exr"), shown = readImage(out() / "albedo.png");
    EXPECT_NEAR(linear.at(8, 4).x, 0.5, 1e-3);
    EXPECT_NEAR(shown.at(8, 4).x, 0.5, 0.01);
}

}  // namespace
}  // namespace relamp
