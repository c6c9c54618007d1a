// A view of the scene that the artist keeps under a name: where from, where to, and how wide.
#pragma once
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "base/math.h"

namespace relamp {

/// A camera that turns about a point, Z up.
struct CameraBookmark {
    std::string name;          ///< not empty, one of a kind in its look
    Vec3 target{0};            ///< metres
    float distance = 1;        ///< metres from the target, more than 0
    float azimuth = 0;         ///< radians about +Z, 0 looks along -X
    float elevation = 0;       ///< radians above the horizon
    float verticalFov = 0.7f;  ///< radians
    bool orthographic = false;
    bool operator==(const CameraBookmark&) const = default;
};

/// `bookmarks` of the edits document (docs/interface.md 3); none where there is no such key. Throws Error naming the
/// field. `origin`: what targets count from (Capture::origin), metres; a document's count from 0.
std::vector<CameraBookmark> bookmarksFromJson(const nlohmann::json& document, const DVec3& origin);
nlohmann::json bookmarksToJson(const std::vector<CameraBookmark>& bookmarks, const DVec3& origin);

}  // namespace relamp
