// Whether a JPEG is whole: its decoder fills what is missing with grey and says nothing. Not a door.
#pragma once
#include <filesystem>

namespace relamp {

/// Throws Error when a JPEG's marker of the end is missing: the file was cut off, as by a copy that did not finish.
/// What is no JPEG passes. Cost: one reading of the file. What follows the end (previews, films) is not looked at.
void checkJpegEnd(const std::filesystem::path& file);

}  // namespace relamp
