// Looks that change over the frames of a sequence: an edits document with `keys`, and what lies between two of them.
#pragma once
#include <filesystem>
#include <functional>
#include <vector>

#include "relight/look.h"

namespace relamp {

/// Where a thing of a look stands as captured: its movement is taken apart about this point, so that an emitter that
/// turns where it stands does not swing through the room.
struct LookPivots {
    std::function<Vec3(const std::string& id)> emitter = [](const std::string&) {
        return Vec3(0);
    };  ///< centroid of a recovered emitter
    std::function<Vec3(uint32_t vertex)> vertex = [](uint32_t) { return Vec3(0); };  ///< a vertex of the capture's mesh
};

/// The look between two, t in [0, 1]; 0 and 1 give the ends themselves. Matrices: the pivot's way is straight, the
/// rotation takes the short way at even speed, stretch is linear. Power, radiance, tint: even steps in stops where both
/// are above 0, else linear; off counts as 0. Yaw, exposure, size: linear. An emitter that only one look names stands
/// as recovered in the other. What cannot be blended (source of the environment, shapes, neutral materials, emitters
/// added in one look only) is the first look's until t is 1.
Look blendLooks(const Look& a, const Look& b, float t, const LookPivots& pivots);

/// Even steps in stops where both are above 0, else linear.
Rgb blendLight(const Rgb& a, const Rgb& b, float t);

class LookTrack {
public:
    /// The look's keys, of whole looks and of single values; without any, one look for every frame.
    explicit LookTrack(Look look);
    /// Sorted by frame; throws Error when there are none or two have the same frame.
    explicit LookTrack(std::vector<LookKey> keys);
    /// Before the first key its look, after the last one that one's; then the values that have keys of their own.
    Look at(int frame, const LookPivots& pivots) const;
    bool moves() const;

    /// Changes that hold for every key, of looks and of values.
    void apply(const std::function<void(Look&)>& change);

private:
    Look betweenKeys(int frame, const LookPivots& pivots) const;
    std::vector<LookKey> keys_;
    std::vector<ValueCurve> curves_;
};

/// The edits document of docs/interface.md 3, with or without `keys`. Throws Error naming file and field.
LookTrack readLookTrack(const std::filesystem::path& file, const DVec3& origin = DVec3(0));

}  // namespace relamp
