// What a frame was made from, as one number in its header.
#pragma once
#include <filesystem>
#include <string>

namespace relamp {

/// Sixteen hexadecimal digits (FNV-1a, 64 bits) over shot.json, environment.exr, reflectance.ply and, where they
/// are there, added.ply, the texture and the backgrounds: equal shots, equal hash. Throws Error naming a file that
/// cannot be read.
std::string shotHash(const std::filesystem::path& folder);

}  // namespace relamp
