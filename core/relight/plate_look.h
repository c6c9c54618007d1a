// The plate of a look: files of a shot that was filmed in the captured set, as `relamp render --plate` names them.
#pragma once
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>

namespace relamp {

struct PlateLook {
    std::filesystem::path files;    ///< plate.####.exr, or one image
    std::filesystem::path cameras;  ///< its tracked camera; FILE#NAME for one of several in a USD file
    std::filesystem::path lens{};   ///< empty: the track's
    std::filesystem::path matte{};  ///< matte.####.exr, white where the plate is held out; empty: nowhere
    int offset = 0;                 ///< the track's frame N is the plate's N + offset
    std::string rotation = "ZXY", curve = "auto", match = "auto";  ///< --plate-rotation, --plate-curve, --plate-match
    bool relightMatte = false;                                     ///< --matte-light relight
    bool operator==(const PlateLook&) const = default;
};

/// `plate` of the edits document (docs/interface.md 3). Relative file names are taken from `folder`. Throws Error
/// naming the field.
PlateLook plateLookFromJson(const nlohmann::json& plate, const std::filesystem::path& folder);
nlohmann::json plateLookToJson(const PlateLook& plate);

/// The keys of plateLookToJson that name files; those a shot holds twice, relative and with "_absolute".
inline constexpr const char* plateFileKeys[] = {"files", "camera", "lens", "matte"};

}  // namespace relamp
