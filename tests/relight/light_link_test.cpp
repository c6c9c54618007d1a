// Lights that fall on some objects alone.
#include "relight/light_link.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "base/error.h"
#include "edit/emitter_edits.h"
#include "edit/link_edits.h"
#include "relight/frame.h"
#include "relight/live/live_scene.h"
#include "support/estimates.h"

namespace relamp {
namespace {

using Json = nlohmann::json;

/// A floor, a raised glossy plate on it that covers a quarter of it, and an emitter above both.
struct LinkedTable {
    Scene scene;
    Estimate estimate;
    uint32_t plate = 0, end = 0;
    LinkedTable() {
        Mesh mesh = test::sheet({-2, -2, 0}, {4, 0, 0}, {0, 4, 0}, 40, 40);
        plate = uint32_t(mesh.vertexCount());
        test::append(mesh, test::sheet({0, 0, 0.2f}, {2, 0, 0}, {0, 2, 0}, 20, 20));
        end = uint32_t(mesh.vertexCount());
        const auto emitter = test::append(mesh, test::squareAbove(0.4f, 0, 0, 2, 2));
        scene = test::sceneOf(mesh);
        estimate = test::matteEstimate(scene, Rgb(0.5f), Rgb(0), test::emittersOf(scene, {emitter}, {Rgb(10)}));
        estimate.reflectance.basis = builtInBasis();
        auto& weight = estimate.reflectance.weight;
        weight.resize(estimate.reflectance.basis.lobes.size(), std::vector<Rgb>(scene.mesh.vertexCount(), Rgb(0)));
        for (uint32_t v = plate; v < end; ++v) weight[4][v] = Rgb(0.2f);
    }
};

const std::shared_ptr<const LinkedTable>& linkedTable() {
    static const auto one = std::make_shared<const LinkedTable>();
    return one;
}

Look lookWith(const LightLink& link) {
    Look look;
    setLink(look, "emitter-1", link);
    return look;
}

Frame frameOf(const Look& look) {
    FrameOptions options;
    options.samplesPerPixel = 4;
    Progress progress;
    const RelitScene relit = test::relitOf(linkedTable()->scene, linkedTable()->estimate, look);
    return renderFrame(relit, test::cameraAt({0, 0, 1.9}, {0, 0, 0}, 40, 40, 25, {0, 1, 0}), options, progress);
}

TEST(LightLink, KeepsAnObjectDarkInFramesAndLeavesTheOthersAlone) {
    const Frame all = frameOf({}), floor = frameOf(lookWith({false, {linkedTable()->plate}})),
                plate = frameOf(lookWith({true, {linkedTable()->plate + 7}}));
    size_t onPlate = 0, onFloor = 0;
    for (size_t p = 0; p < all.beauty.size(); ++p) {
        if (all.alpha[p] < 1 || !(maxChannel(all.beauty[p]) > 0)) continue;
        if (all.position[p].z > 0.15f) {
            ++onPlate;
            EXPECT_EQ(floor.beauty[p], Rgb(0));
            EXPECT_EQ(plate.beauty[p], all.beauty[p]);
        } else if (all.position[p].z < 0.001f) {
            ++onFloor;
            EXPECT_EQ(floor.beauty[p], all.beauty[p]) << "the plate keeps its shadow";
            EXPECT_EQ(plate.beauty[p], Rgb(0));
        }
    }
    EXPECT_GT(onPlate, 100u);
    EXPECT_GT(onFloor, 400u);
}

TEST(LightLink, DoesTheSameInTheViewportAlsoWhileTheLightMoves) {
    Progress progress;
    const auto& table = linkedTable();
    LiveScene live(std::shared_ptr<const Scene>(table, &table->scene),
                   std::shared_ptr<const Estimate>(table, &table->estimate), {}, progress);
    live.setEye({{0, -3, 3}, glm::normalize(Vec3(0, 1, -1))});
    const auto shown = [&](const Look& look) {
        live.setLook(look);
        live.refine(0, progress);
        const auto coarse = live.frame();
        while (!live.refine(0.5, progress)) {}
        return std::pair(coarse, live.frame());
    };
    const auto check = [&](const Look& open, const LightLink& link, bool floorLit) {
        const auto all = shown(open);
        Look look = open;
        setLink(look, "emitter-1", link);
        const auto linked = shown(look);
        for (const bool first : {true, false}) {
            const auto& with = first ? all.first->radiance : all.second->radiance;
            const auto& without = first ? linked.first->radiance : linked.second->radiance;
            for (uint32_t v = 0; v < table->end; ++v) {
                const bool lit = (v < table->plate) == floorLit;
                if (!lit) {
                    ASSERT_EQ(without[v], Rgb(0)) << v;
                } else if (!first) {
                    ASSERT_EQ(without[v], with[v]) << v;
                }
            }
        }
        EXPECT_EQ(linked.second->formFactor[0][floorLit ? table->plate + 3 : 3], 0);
    };
    check({}, {false, {table->plate}}, true);
    check({}, {true, {table->plate}}, false);
    Look moved;
    moveEmitter(moved, "emitter-1", test::translation({0.5f, 0.1f, 0}));
    check(moved, {false, {table->plate + 1}}, true);
    // The inspector's account of a point agrees.
    live.setLook(lookWith({false, {0}}));
    while (!live.refine(0.5, progress)) {}
    EXPECT_EQ(live.lightAt(0, Vec2(0.3f)).fromEmitter[0], Rgb(0));
    for (const Rgb& arriving : live.lightAt(0, Vec2(0.3f)).incident) EXPECT_EQ(arriving, Rgb(0));
}

TEST(LightLink, IsReadAndWrittenAndErrorsNameTheField) {
    Look look = lookWith({false, {4, 5}});
    look.added.push_back({EmitterShape::disk, "disk-1"});
    setLink(look, "disk-1", {true, {7}});
    EXPECT_EQ(lookFromJson(lookToJson(look), {}), look);
    EXPECT_EQ(lookToJson(look)["added_emitters"][0]["link"], (Json{{"only", {7}}}));
    resetEmitter(look, "emitter-1", EmitterValue::all);
    EXPECT_TRUE(look.emitters.empty());
    const auto why = [](const Json& link) {
        try {
            lookFromJson({{"emitters", {{{"id", "emitter-1"}, {"link", link}}}}}, {});
        } catch (const Error& error) { return std::string(error.what()); }
        return std::string();
    };
    EXPECT_EQ(why(3), "emitters[0].link: expected an object");
    EXPECT_EQ(why(Json::object()), "emitters[0].link: expected either except or only, a list of vertex numbers");
    EXPECT_EQ(why({{"only", Json::array()}}), "emitters[0].link.only: expected one vertex number or more");
    EXPECT_EQ(why({{"except", {1, -2}}}), "emitters[0].link.except[1]: expected a vertex number");
    try {
        test::relitOf(linkedTable()->scene, linkedTable()->estimate, lookWith({false, {99999}}));
        FAIL();
    } catch (const Error& error) {
        EXPECT_NE(std::string(error.what()).find("emitter-1.link: part 99999 does not exist"), std::string::npos)
            << error.what();
    }
}

TEST(LightLink, IsEditedObjectByObject) {
    const Scene& scene = linkedTable()->scene;
    const uint32_t plate = linkedTable()->plate;
    EXPECT_EQ(withoutPart({}, scene, plate), (LightLink{false, {plate}}));
    EXPECT_EQ(withoutPart({false, {plate}}, scene, plate + 5), (LightLink{false, {plate}})) << "the same object";
    EXPECT_EQ(onlyOnPart({false, {0}}, scene, plate), (LightLink{true, {plate}}));
    EXPECT_EQ(onlyOnPart({true, {0}}, scene, plate), (LightLink{true, {0, plate}}));
    EXPECT_EQ(withoutPart({true, {0, plate}}, scene, plate), (LightLink{true, {0}}));
    EXPECT_EQ(withoutPart({true, {plate}}, scene, plate), (LightLink{false, {plate}})) << "nothing would be left";
    EXPECT_EQ(withoutPart({true, {plate}}, scene, 0), (LightLink{true, {plate}})) << "it does not fall there as it is";
    EXPECT_TRUE(forgetPart({true, {plate}}, scene, plate + 1).everything());
    EXPECT_TRUE(linkThatFits({true, {plate}}, plate).everything());
    EXPECT_EQ(withoutPart({}, scene, 99999), LightLink{});
}

}  // namespace
}  // namespace relamp
