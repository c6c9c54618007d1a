// Views that are kept: how files hold them.
#include "relight/camera_bookmark.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "base/error.h"
#include "relight/look_keys.h"
#include "relight/look_track.h"

namespace relamp {
namespace {

using nlohmann::json;

json documentWithBookmark() {
    return {{"version", 1},
            {"bookmarks",
             {{{"name", "Door"},
               {"target", {10.0, 20.0, 30.0}},
               {"distance", 2.5},
               {"azimuth_degrees", 90},
               {"elevation_degrees", -30},
               {"vertical_fov_degrees", 45}}}}};
}

TEST(CameraBookmarks, AreKeptInFilesThatCountFromTheWorldsOrigin) {
    const DVec3 origin(9, 18, 27);
    const Look look = lookFromJson(documentWithBookmark(), "/", origin);
    ASSERT_EQ(look.bookmarks.size(), 1u);
    const CameraBookmark& door = look.bookmarks[0];
    EXPECT_EQ(door.target, Vec3(1, 2, 3));
    EXPECT_FLOAT_EQ(door.azimuth, pi / 2);
    EXPECT_FLOAT_EQ(door.elevation, -pi / 6);
    EXPECT_FLOAT_EQ(door.verticalFov, pi / 4);
    EXPECT_FALSE(door.orthographic);
    const json written = lookToJson(look, origin);
    EXPECT_EQ(unknownLookKeys(written), std::vector<std::string>{});
    EXPECT_EQ(lookFromJson(written, "/", origin), look);
    EXPECT_FALSE(lookToJson(Look{}).contains("bookmarks")) << "files without them are as they were";
}

TEST(CameraBookmarks, BelongToTheWholeLookAndChangeNoLight) {
    json document = documentWithBookmark();
    document["keys"] = {{{"frame", 3}, {"look", json::object()}}};
    const Look look = lookFromJson(document, "/");
    EXPECT_TRUE(look.keys.at(0).look.bookmarks.empty());
    Look still = look;
    still.keys.clear();
    EXPECT_EQ(LookTrack(still).at(1, {}), Look{});
    document["keys"][0]["look"]["bookmarks"] = document["bookmarks"];
    EXPECT_THROW(lookFromJson(document, "/"), Error);
}

TEST(CameraBookmarks, ErrorsNameTheField) {
    for (const auto& [key, bad] : std::vector<std::pair<std::string, json>>{{"name", " "},
                                                                            {"target", {1, 2}},
                                                                            {"distance", 0},
                                                                            {"elevation_degrees", 91},
                                                                            {"azimuth_degrees", "east"},
                                                                            {"vertical_fov_degrees", 180}}) {
        json document = documentWithBookmark();
        document["bookmarks"][0][key] = bad;
        try {
            lookFromJson(document, "/");
            ADD_FAILURE() << key;
        } catch (const Error& error) {
            EXPECT_TRUE(std::string(error.what()).starts_with("bookmarks[0]." + key)) << error.what();
        }
    }
    json twice = documentWithBookmark();
    twice["bookmarks"].push_back(twice["bookmarks"][0]);
    EXPECT_THROW(lookFromJson(twice, "/"), Error);
}

}  // namespace
}  // namespace relamp
