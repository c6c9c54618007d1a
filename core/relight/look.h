// What the artist has edited: emitters moved, scaled, recoloured, off or added; the environment replaced or turned. A
// small value.
#pragma once
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "base/math.h"
#include "relight/camera_bookmark.h"
#include "relight/emitter_shape.h"
#include "relight/environment_sides.h"
#include "relight/light_group.h"
#include "relight/light_link.h"
#include "relight/light_shaping.h"
#include "relight/plate_look.h"
#include "relight/value_keys.h"

namespace relamp {

struct EnvironmentLook {
    enum class Source { recovered, none, file } source = Source::recovered;
    std::filesystem::path file;  ///< latitude-longitude image, when source is file
    /// When source is recovered: the lighting state whose environment it is; empty: the estimate's own. Of a mix the
    /// state it goes to, and how much of that it has, 0 to 1.
    std::string state{}, mixState{};
    float mix = 0;
    float yawDegrees = 0;  ///< about +Z, counter-clockwise from above
    float exposureStops = 0;
    Rgb tint{1};
    EnvironmentSides sides = evenSides;  ///< of the world: a yaw does not turn them
    bool operator==(const EnvironmentLook&) const = default;
};

struct EmitterLook {
    std::string id;
    bool enabled = true;
    Mat4 matrix{1};       ///< applied to the emitter's world positions
    Rgb powerScale{1};    ///< multiplies its radiance; its power also changes with its area
    std::string name{};   ///< what the artist calls it; empty: its id
    bool shadows = true;  ///< false: its light passes through everything
    LightLink link{};     ///< which objects it falls on
    bool operator==(const EmitterLook&) const = default;
};

struct AddedEmitter {
    EmitterShape shape = EmitterShape::rectangle;
    std::string id;
    Mat4 matrix{1};  ///< shapes of their own lie about the origin, facing -Z; part and copy: applied to world positions
    Vec2 size{1};    ///< metres: width and height, or diameter; shapes of their own
    Rgb radiance{1};
    bool enabled = true;      ///< off: radiance 0, its part stays
    uint32_t seedVertex = 0;  ///< part
    std::string source{};     ///< copy: id of a recovered emitter
    std::string name{};       ///< what the artist calls it; empty: its id
    LightShaping shaping{};   ///< shapes of their own
    bool shadows = true;      ///< as in EmitterLook
    LightLink link{};         ///< as in EmitterLook
    bool operator==(const AddedEmitter&) const = default;
};

/// The connected component of mesh that holds the vertex moves too: an emitter's shade and stand.
struct PartLook {
    uint32_t seedVertex = 0;
    Mat4 matrix{1};
    std::string
        attachedTo{};  ///< id of the emitter it follows in the window; empty: none. `matrix` alone says where it is
    bool operator==(const PartLook&) const = default;
};

struct LookKey;

struct Look {
    EnvironmentLook environment;
    std::vector<EmitterLook> emitters;  ///< those not named stay as recovered
    std::vector<AddedEmitter> added;
    std::vector<PartLook> parts;
    std::vector<LightGroup> groups;
    bool neutralMaterials = false;  ///< every surface at its own brightness without colour
    /// Looks at frames, by frame, none twice; what lies between follows from them (look_track.h). Empty: the look is
    /// the same in every frame.
    std::vector<LookKey> keys;
    /// Keys of single values, each value once; in every frame they have the last word. No key has any.
    std::vector<ValueCurve> curves;
    /// A shot filmed in the set that is relit; changes no light, and no key has one.
    std::optional<PlateLook> plate;
    /// Views that were kept, in the order of the list; they change no light, and no key has any.
    std::vector<CameraBookmark> bookmarks;
    bool operator==(const Look& other) const;
};

struct LookKey {
    int frame = 1;
    Look look;  ///< without keys of its own
    KeyEase ease = KeyEase::linear;
    bool operator==(const LookKey&) const = default;
};

inline bool Look::operator==(const Look& other) const {
    return environment == other.environment && emitters == other.emitters && added == other.added &&
           parts == other.parts && groups == other.groups && neutralMaterials == other.neutralMaterials &&
           keys == other.keys && curves == other.curves && plate == other.plate && bookmarks == other.bookmarks;
}

/// Calls `change` with a look and with those of its keys.
template <class AnyLook, class Change>
void eachLook(AnyLook& look, Change&& change) {
    change(look);
    for (auto& key : look.keys) change(key.look);
}

/// A name as it is kept: without control characters and spaces around it, cut to `longestName` bytes between two
/// characters.
inline constexpr size_t longestName = 120;
std::string tidyName(const std::string& name);
/// What the emitters are called: recovered ones by these ids, in order, then added ones. Two that are called alike are
/// told apart by " (2)".
std::vector<std::string> emitterNames(const std::vector<std::string>& recoveredIds, const Look& look);

/// The files that a look and its keys read: environment, photometric files and images of its lights; each once.
std::vector<std::filesystem::path> filesOf(const Look& look);

/// The edits document of docs/interface.md 3. Relative file names are taken from `folder`. Throws Error naming the
/// field
/// ("emitters[2].matrix: is singular"). `origin`: what a Look's matrices count from (Capture::origin), metres; a
/// document's count from 0.
Look lookFromJson(const nlohmann::json& document, const std::filesystem::path& folder, const DVec3& origin = DVec3(0));
Look readLook(const std::filesystem::path& file, const DVec3& origin = DVec3(0));
nlohmann::json lookToJson(const Look& look, const DVec3& origin = DVec3(0));

}  // namespace relamp
