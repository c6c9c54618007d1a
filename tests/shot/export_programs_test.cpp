// The exported scene in other programs' own languages: Nuke's scripts, MaterialX, glTF's and USD's materials.
#include <gtest/gtest.h>

#include <map>
#include <nlohmann/json.hpp>
#include <regex>
#include <sstream>

#include "brdf/basis.h"
#include "shot/export_frame.h"
#include "shot/export_scene.h"
#include "shot/scene_materials.h"
#include "support/estimates.h"
#include "support/temporary_folder.h"

namespace relamp {
namespace {

/// A floor of two boards, the second one coated, and two lights.
class ExportedPrograms : public testing::Test {
protected:
    void SetUp() override {
        Mesh mesh = test::sheet({-1, -1, 0}, {1, 0, 0}, {0, 2, 0}, 1, 1);
        test::append(mesh, test::sheet({0.1f, -1, 0}, {1, 0, 0}, {0, 2, 0}, 1, 1));
        const Scene scene = test::sceneOf(mesh);
        shot.estimate = test::matteEstimate(scene, Rgb(0.5f, 0.25f, 0.125f), Rgb(1, 2, 3));
        shot.estimate.reflectance.basis = builtInBasis();
        auto& weight = shot.estimate.reflectance.weight;
        weight.resize(shot.estimate.reflectance.basis.lobes.size(), std::vector<Rgb>(mesh.vertexCount(), Rgb(0)));
        coat = 0;
        while (shot.estimate.reflectance.basis.lobes[coat].kind != Lobe::Kind::ggxDielectric) ++coat;
        for (size_t v = 0; v < mesh.vertexCount(); ++v)
            if (mesh.positions[v].x > 0.05f) weight[coat][v] = Rgb(0.8f, 0.4f, 0.4f);
        shot.capture.mesh = scene.mesh;
        View view;
        view.name = "view";
        view.camera = test::cameraAt({0, -2, 1.5}, {0, 0, 0}, 24, 18, 20);
        shot.capture.views.push_back(view);
        Look look;
        look.added.push_back({EmitterShape::rectangle, "rectangle-1", test::translation({0.4f, 0, 1}), Vec2(0.5f, 0.5f),
                              Rgb(40, 20, 10)});
        look.added.push_back({EmitterShape::rectangle, "rectangle-2", test::translation({-0.4f, 0, 1}),
                              Vec2(0.2f, 0.2f), Rgb(5, 20, 30)});
        look.added[1].name = "key light";
        relit = test::relitOf(scene, shot.estimate, look);
    }
    test::TemporaryFolder folder;
    size_t coat = 0;
    Shot shot;
    RelitScene relit;
};

/// What Nuke would make of the script: its nodes on a stack, of the kinds that it uses.
Image nukeOutput(const std::string& script, const std::map<std::string, Image>& layers,
                 const std::map<std::string, float>& multiply) {
    std::vector<Image> stack;
    Image frame;
    std::istringstream lines(script);
    for (std::string line; std::getline(lines, line);) {
        if (line == "push $frame") stack.push_back(frame);
        if (line == "set frame [stack 0]") frame = stack.back();
        if (line.empty() || line.back() != '{' || line[0] == '#') continue;
        const std::string kind = line.substr(0, line.find(' '));
        std::map<std::string, std::string> knobs;
        while (std::getline(lines, line) && line != "}") {
            const size_t space = line.find(' ', 1);
            knobs[line.substr(1, space - 1)] = line.substr(space + 1);
        }
        if (kind == "Read") {
            EXPECT_EQ(knobs["raw"], "true");
            stack.push_back(layers.at(""));
        } else if (kind == "Shuffle") {
            stack.back() = layers.at(knobs["in"]);
        } else if (kind == "Grade") {
            const auto set = multiply.find(knobs["name"]);
            for (Rgb& p : stack.back().pixels) p *= set == multiply.end() ? std::stof(knobs["multiply"]) : set->second;
        } else if (kind == "Merge2") {
            EXPECT_EQ(knobs["operation"], "plus");
            const Image top = stack.back();
            stack.pop_back();
            for (size_t i = 0; i < top.pixels.size(); ++i) stack.back().pixels[i] += top.pixels[i];
        } else if (kind == "Copy") {
            stack.pop_back();  // what the alpha is copied from
        } else {
            ADD_FAILURE() << kind;
        }
    }
    EXPECT_EQ(stack.size(), 1u);
    return stack.at(0);
}

TEST_F(ExportedPrograms, NukeAddsTheGroupsUpToTheBeautyAndGradesALight) {
    exportScene(shot, relit, folder / "out", false);
    const std::string script = test::TemporaryFolder::read(folder / "out/relight.nk");
    FrameOptions options;
    options.samplesPerPixel = 1;
    Progress progress;
    FrameStrip strip;
    strip.frame = renderFrame(relit, shot.capture.views[0].camera, options, progress);
    closeGroups(strip, false);
    std::vector<std::vector<Rgb>> groups{strip.frame.world};
    groups.insert(groups.end(), strip.frame.byEmitter.begin(), strip.frame.byEmitter.end());
    groups.push_back(strip.rest);
    const auto imageOf = [](const std::vector<Rgb>& pixels) {
        Image image(24, 18);
        image.pixels = pixels;
        return image;
    };
    // As the frame's file calls them.
    const auto parts =
        FrameLayers(layerRequest("groups"), LayerNaming::blender, {"rectangle_1", "key_light"}).parts(true);
    ASSERT_EQ(parts.size(), groups.size() + 1);
    std::map<std::string, Image> layers{{"", imageOf(strip.frame.beauty)}};
    for (size_t i = 0; i < groups.size(); ++i) {
        EXPECT_NE(script.find("add_layer {" + parts[i + 1].name + " "), std::string::npos) << parts[i + 1].name;
        layers[parts[i + 1].name] = imageOf(groups[i]);
    }
    ASSERT_EQ(layers.size(), 5u);  // the frame, world, two lights, rest
    ASSERT_TRUE(layers.contains("Combined_key_light"));
    const Image whole = nukeOutput(script, layers, {});
    const Image without = nukeOutput(script, layers, {{"light_Combined_key_light", 0.0f}});
    double lit = 0;
    for (size_t i = 0; i < whole.pixels.size(); ++i) {
        const Rgb beauty = layers[""].pixels[i], key = layers["Combined_key_light"].pixels[i];
        for (int c = 0; c < 3; ++c) {
            EXPECT_NEAR(whole.pixels[i][c], beauty[c], 1e-5f * beauty[c] + 1e-6f);
            EXPECT_NEAR(without.pixels[i][c], beauty[c] - key[c], 1e-5f * beauty[c] + 1e-6f);
        }
        lit += key.z;
    }
    EXPECT_GT(lit, 1);
}

TEST_F(ExportedPrograms, SurfacesAreApartByTheirLobes) {
    const ExportedScene scene = exportedScene(relit, shot.capture);
    ASSERT_EQ(scene.components.size(), 4u);
    EXPECT_EQ(scene.components[2].name, "surfaces");
    EXPECT_TRUE(scene.components[2].lobes.empty());
    EXPECT_EQ(scene.components[3].name, "surfaces 2");
    ASSERT_EQ(scene.components[3].lobes.size(), 1u);
    EXPECT_EQ(scene.components[3].triangles.size(), 2u);
    EXPECT_TRUE(surfaceMaterialOf(scene.components[2]).plain());
    const SurfaceMaterial coated = surfaceMaterialOf(scene.components[3]);
    EXPECT_NEAR(coated.specular, 0.8f, 1e-6);
    EXPECT_NEAR(coated.specularColour.y, 0.5f, 1e-6);
    EXPECT_NEAR(coated.roughness, std::sqrt(shot.estimate.reflectance.basis.lobes[coat].alpha), 1e-6);
    EXPECT_EQ(coated.metallic, 0);
}

TEST(SurfaceMaterials, BareLobesAreMetal) {
    ExportedComponent component;
    component.albedo = {Rgb(0.1f)};
    component.lobes = {{{Lobe::Kind::ggx, 0.25f, "ggx"}, Rgb(0.3f)}};
    const SurfaceMaterial metal = surfaceMaterialOf(component);
    EXPECT_NEAR(metal.metallic, 0.75f, 1e-6);
    EXPECT_NEAR(metal.roughness, 0.5f, 1e-6);
    EXPECT_EQ(metal.specular, 0);
}

TEST_F(ExportedPrograms, GltfHasTheLobesAsAMaterialAndInFull) {
    const auto gltf = nlohmann::json::parse(gltfOf(exportedScene(relit, shot.capture), "lights.bin").json);
    const auto& matte = gltf["materials"][2];
    EXPECT_EQ(matte["extensions"]["KHR_materials_specular"]["specularFactor"], 0);
    EXPECT_EQ(matte["extensions"]["KHR_materials_specular"]["specularColorFactor"], nlohmann::json::array({0, 0, 0}));
    EXPECT_EQ(matte["pbrMetallicRoughness"]["roughnessFactor"], 0.5);
    EXPECT_FALSE(matte.contains("extras"));
    const auto& coated = gltf["materials"][3];
    EXPECT_NEAR(coated["extensions"]["KHR_materials_specular"]["specularFactor"].get<double>(), 0.8, 1e-6);
    EXPECT_EQ(coated["extras"]["relamp_lobes"][0]["kind"], "ggx_dielectric");
    EXPECT_NEAR(coated["extras"]["relamp_lobes"][0]["weight"][1].get<double>(), 0.4, 1e-6);
}

TEST_F(ExportedPrograms, MaterialXAndUsdNameOneMaterialAPrim) {
    const ExportedScene scene = exportedScene(relit, shot.capture);
    const std::string mtlx = materialXOf(scene), usd = usdaOf(scene, "environment.exr");
    const std::regex assigned("material=\"(\\w+)\" geom=\"/relamp/(\\w+)\"");
    size_t count = 0;
    for (std::sregex_iterator at(mtlx.begin(), mtlx.end(), assigned), end; at != end; ++at, ++count) {
        const std::string prim = (*at)[2];
        EXPECT_NE(usd.find("def Mesh \"" + prim + "\""), std::string::npos) << prim;
        EXPECT_NE(usd.find("def Material \"" + prim + "\""), std::string::npos) << prim;
        EXPECT_NE(mtlx.find("<surfacematerial name=\"" + prim + "\""), std::string::npos) << prim;
    }
    EXPECT_EQ(count, 4u);
    for (const char* text :
         {"<surface_unlit name=\"key_light_shader\"", "<input name=\"emission\" type=\"float\" value=\"30\" />",
          "<input name=\"specular_weight\" type=\"float\" value=\"0.8\" />", "value=\"displayColor\""})
        EXPECT_NE(mtlx.find(text), std::string::npos) << text;
    // At right angles 0.8 x 4 % of light comes back.
    EXPECT_NE(usd.find("float inputs:ior = 1.4357"), std::string::npos);
    // Every element that is opened is closed.
    size_t open = 0;
    const std::regex tag("<(/?)[a-z_]+[^>]*?(/?)>");
    for (std::sregex_iterator at(mtlx.begin(), mtlx.end(), tag), end; at != end; ++at)
        if ((*at)[2].length() == 0) open += (*at)[1].length() ? size_t(-1) : 1;
    EXPECT_EQ(open, 0u);
}

}  // namespace
}  // namespace relamp
