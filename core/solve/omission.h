// What an estimate or an image leaves out because the scene does not need it.
#pragma once
#include <nlohmann/json_fwd.hpp>
#include <string>

namespace relamp {

enum class Omission {
    // Effects.
    distantLight,
    nearFieldEmitters,
    interreflection,
    glossyLobes,
    finerDistantLight,
    triangles,
    unobservedLight,
    texture,
    ownTexcoords,
    // Parts of the work (pipeline/plan.h).
    fullInterreflection,
    unobservedVertices,
    agreeingRays,
    lobesOnMatte,
    lostLobes,
    mattePointsInDetail,
    emptyColumns,
    lastDigits,
    flatLevels,
    // Parts of the viewport's image (relight/live).
    bouncedLight,
    glossyPasses,
    environment,
    nearLight,
    movedVisibility,
    glossOutside,
    other  ///< of a file that another version wrote
};

/// The same for people and in files: "distant light".
const char* nameOf(Omission omission);
/// Its inverse; Omission::other for a name that is not known.
Omission omissionNamed(const std::string& name);
/// By name.
void to_json(nlohmann::json& json, Omission omission);

struct LeftOut {
    Omission what = Omission::other;
    std::string why;
    LeftOut() = default;
    LeftOut(Omission part, std::string because);
    /// As a file names it.
    LeftOut(const std::string& name, std::string because);
};

}  // namespace relamp
