// Groups of lights: made, changed, kept in files, and what they do to the light.
#include "edit/group_edits.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "edit/emitter_edits.h"
#include "edit/look_keys.h"
#include "relight/look_track.h"
#include "support/estimates.h"

namespace relamp {
namespace {

using Ids = std::vector<std::string>;

/// A floor and two square lights of radiance (4, 2, 1) above it.
struct GroupRoom {
    Scene scene;
    Estimate estimate;
    GroupRoom() {
        Mesh mesh = test::sheet({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, 4, 4);
        const auto first = test::append(mesh, test::squareAbove(0.2f, 0, 0, 1, 2));
        const auto second = test::append(mesh, test::squareAbove(0.2f, 0.5f, 0, 1, 2));
        scene = test::sceneOf(mesh);
        estimate = test::matteEstimate(scene, Rgb(0.5f), Rgb(0.1f),
                                       test::emittersOf(scene, {first, second}, {Rgb(4, 2, 1), Rgb(4, 2, 1)}));
    }
    Rgb sentBy(const Look& look, size_t emitter) const {
        return test::relitOf(scene, estimate, look).emitters.at(emitter).emission.level;
    }
};

TEST(LightGroups, MultiplyTheLightOfTheirMembersAlone) {
    const GroupRoom room;
    Look look;
    setRadiance(look, room.estimate, "emitter-2", Rgb(8, 4, 2));
    AddedEmitter ball;
    ball.shape = EmitterShape::sphere;
    ball.radiance = Rgb(3);
    const std::string added = addEmitter(look, room.estimate, ball);
    const std::string name = groupLights(look, {"emitter-2", added});
    changeGroup(look, name, [](LightGroup& g) { g.powerScale = Rgb(0.5f, 1, 2); });
    EXPECT_EQ(room.sentBy(look, 0), Rgb(4, 2, 1));
    EXPECT_EQ(room.sentBy(look, 1), Rgb(4, 4, 4));
    EXPECT_EQ(room.sentBy(look, 2), Rgb(1.5f, 3, 6));
    changeGroup(look, name, [](LightGroup& g) { g.enabled = false; });
    EXPECT_EQ(room.sentBy(look, 0), Rgb(4, 2, 1));
    EXPECT_EQ(room.sentBy(look, 1), Rgb(0));
    EXPECT_EQ(room.sentBy(look, 2), Rgb(0));
    const auto state = findEmitter(room.scene, room.estimate, look, "emitter-2");
    EXPECT_TRUE(state->enabled && !state->shines());
    EXPECT_EQ(state->radiance, Rgb(8, 4, 2)) << "its own light stays";
    dissolveGroup(look, name);
    EXPECT_EQ(room.sentBy(look, 1), Rgb(8, 4, 2));
    look.groups = {{"Key", {"emitter-9"}}};
    EXPECT_THROW(room.sentBy(look, 0), Error);
}

TEST(LightGroups, ALightIsInOneGroupAndLeavesWithItsLast) {
    const GroupRoom room;
    Look look;
    EXPECT_EQ(groupLights(look, {"emitter-1", "emitter-2"}), "Group 1");
    EXPECT_EQ(groupLights(look, {"emitter-2"}), "Group 2");
    EXPECT_EQ(look.groups.at(0).members, Ids{"emitter-1"});
    EXPECT_EQ(renameGroup(look, "Group 2", " Group 1"), "Group 1 (2)");
    EXPECT_EQ(renameGroup(look, "Group 1", ""), "Group 1");
    const std::string copy = duplicateEmitter(look, room.estimate, "emitter-1", Vec3(0.1f));
    EXPECT_EQ(look.groups.at(0).members, (Ids{"emitter-1", copy}));
    removeEmitter(look, copy);
    EXPECT_EQ(look.groups.at(0).members, Ids{"emitter-1"}) << "a recovered light stays in it";
    EXPECT_EQ(groupLights(look, {"emitter-1", "emitter-2"}, "All"), "All");
    EXPECT_EQ(look.groups.size(), 1u) << "groups without lights go";
}

TEST(LightGroups, ComeBackFromTheirFileAndTheBadFieldIsNamed) {
    Look look;
    groupLights(look, {"emitter-1"}, "Key");
    changeGroup(look, "Key", [](LightGroup& g) { g.enabled = false, g.powerScale = Rgb(2, 1, 0.5f); });
    EXPECT_EQ(lookFromJson(lookToJson(look), {}), look);
    const auto says = [](const char* groups, const std::string& words) {
        try {
            lookFromJson(nlohmann::json::parse(groups), {});
            ADD_FAILURE() << groups;
        } catch (const Error& error) {
            EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
        }
    };
    says(R"({"groups": 5})", "groups");
    says(R"({"groups": [{"members": []}]})", "groups[0].name");
    says(R"({"groups": [{"name": " ", "members": []}]})", "groups[0].name: is empty");
    says(R"({"groups": [{"name": "A"}]})", "groups[0].members");
    says(R"({"groups": [{"name": "A", "members": [1]}]})", "groups[0].members[0]");
    says(R"({"groups": [{"name": "A", "members": ["x", "x"]}]})", "groups[0].members[1]: x is in a group already");
    says(R"({"groups": [{"name": "A", "members": []}, {"name": "A", "members": []}]})", "groups[1].name");
    says(R"({"groups": [{"name": "A", "members": [], "enabled": 1}]})", "groups[0].enabled");
    says(R"({"groups": [{"name": "A", "members": [], "power_scale": [1, -1, 1]}]})", "groups[0].power_scale[1]");
}

/// As the window edits a look with keys.
void editAtKey(Look& look, int frame, const std::function<void(Look&)>& change) {
    Look before = look.keys.at(size_t(keyAt(look, frame))).look;
    before.keys = look.keys;
    look = before;
    change(look);
    keyEdit(before, look, frame);
}

TEST(LightGroups, FadeBetweenKeysAndAreTheSameInAllOfThem) {
    Look look;
    groupLights(look, {"emitter-1"}, "Key");
    setKey(look, 1);
    changeGroup(look, "Key", [](LightGroup& g) { g.powerScale = Rgb(4); });
    setKey(look, 11);
    EXPECT_NEAR(LookTrack(look).at(6, {}).groups.at(0).powerScale.x, 2, 1e-5) << "in stops";
    // A new name in one key is the name in all; each keeps its own light.
    editAtKey(look, 11, [](Look& now) { renameGroup(now, "Key", "Window"); });
    ASSERT_EQ(look.keys[0].look.groups.size(), 1u);
    EXPECT_EQ(look.keys[0].look.groups[0].name, "Window");
    EXPECT_EQ(look.keys[0].look.groups[0].powerScale, Rgb(1));
    EXPECT_EQ(look.keys[1].look.groups[0].powerScale, Rgb(4));
    editAtKey(look, 1, [](Look& now) { dissolveGroup(now, "Window"); });
    EXPECT_TRUE(look.keys[1].look.groups.empty());
}

}  // namespace
}  // namespace relamp
