#include "relight/camera_bookmark.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <numbers>

#include "base/json_fields.h"
#include "relight/look.h"

namespace relamp {
namespace {

constexpr double radian = 180 / std::numbers::pi;

/// A number of the document that must lie between two others.
float between(const JsonFields& fields, const char* key, double low, double high) {
    const double value = fields.get<double>(key);
    if (!(value >= low && value <= high))
        throw Error("{}: is {}, expected {} to {}", fields.name(key), value, low, high);
    return float(value);
}

}  // namespace

std::vector<CameraBookmark> bookmarksFromJson(const Json& document, const DVec3& origin) {
    std::vector<CameraBookmark> bookmarks;
    for (const JsonFields& fields : JsonFields(document).list("bookmarks")) {
        CameraBookmark one;
        one.name = tidyName(fields.get<std::string>("name"));
        if (one.name.empty()) throw Error("{}: is empty", fields.name("name"));
        for (const CameraBookmark& other : bookmarks)
            if (other.name == one.name)
                throw Error("{}: {} is the name of two bookmarks", fields.name("name"), one.name);
        one.target = Vec3(pointOf(fields.need("target"), fields.name("target")) - origin);
        one.distance = between(fields, "distance", 1e-6, 1e9);
        one.azimuth = float(between(fields, "azimuth_degrees", -36000, 36000) / radian);
        one.elevation = float(between(fields, "elevation_degrees", -90, 90) / radian);
        one.verticalFov = float(between(fields, "vertical_fov_degrees", 0.1, 179) / radian);
        one.orthographic = fields.get("orthographic", false);
        bookmarks.push_back(std::move(one));
    }
    return bookmarks;
}

Json bookmarksToJson(const std::vector<CameraBookmark>& bookmarks, const DVec3& origin) {
    Json list = Json::array();
    for (const CameraBookmark& one : bookmarks) {
        const DVec3 target = DVec3(one.target) + origin;
        list.push_back({{"name", one.name},
                        {"target", {target.x, target.y, target.z}},
                        {"distance", one.distance},
                        {"azimuth_degrees", one.azimuth * radian},
                        {"elevation_degrees", one.elevation * radian},
                        {"vertical_fov_degrees", one.verticalFov * radian}});
        if (one.orthographic) list.back()["orthographic"] = true;
    }
    return list;
}

}  // namespace relamp
