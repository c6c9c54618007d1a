// What a shot names outside its own folder: its capture, an environment image, measured materials. When a shot was
// moved or copied some of it is no longer there, and whoever opens it can say where it is.
#pragma once
#include <filesystem>
#include <nlohmann/json_fwd.hpp>

namespace relamp {

/// Where things are that are not where shot.json says. Empty: as it says.
struct ShotPlaces {
    std::filesystem::path capture;      ///< folder
    std::filesystem::path environment;  ///< image
    std::filesystem::path measured;     ///< folder with the .binary files of measured materials
    bool withoutCapture = false;        ///< the mesh comes from reflectance.ply; there are no views
    bool withoutEnvironment = false;    ///< the recovered environment stands in for the image
};

/// What is named and not there; empty: it is there, or nothing is named.
struct MissingPlaces {
    std::filesystem::path capture, environment, measured;
};

/// Puts `places` into a shot's document. A capture that is not at its relative path is taken from its absolute one,
/// where there is one.
void placeShot(nlohmann::json& document, const std::filesystem::path& folder, const ShotPlaces& places);

/// Reads shot.json in `folder` and looks for what it names. Throws Error when it cannot be read. Cost: the document and
/// one look at the file system for each name.
MissingPlaces missingPlaces(const std::filesystem::path& folder, const ShotPlaces& places);

}  // namespace relamp
