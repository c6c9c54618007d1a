// shot.json as a document: what a shot puts into it, and what a document says of a shot. Files are shot_file.h's.
#pragma once
#include <filesystem>
#include <vector>

#include "base/json_fields.h"
#include "shot/shot_file.h"

namespace relamp {

/// The whole of shot.json for a shot that is to lie in `folder`, to which its paths are relative.
Json shotDocument(const Shot& shot, const std::filesystem::path& folder);

/// Fills what a document of version 2 or 3 says into `shot`; centroids of its emitters still count from the world's
/// origin, and the capture is not read. Throws Error naming the field.
void readShotDocument(const Json& document, const std::filesystem::path& folder, Shot& shot,
                      std::vector<DVec3>& centroids);

/// What files of an estimate's environment are called: of the main one "environment", of others "environment-2", ...
std::string environmentStem(int environment);
/// What follows the stem: radiance, its standard deviation, and what is seen of it behind the scene.
inline constexpr std::array<const char*, 3> environmentEnds{".exr", "_sigma.exr", "_background.exr"};

/// Version 1 had other names for some keys (docs/interface.md 2): gives such a document those of version 2.
void upgradeShotDocument(Json& document);

/// Puts the keys of version 1 beside those of version 2, for scripts that read `info --json`.
void addKeysOfVersion1(Json& document);

}  // namespace relamp
