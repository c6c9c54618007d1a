// What is seen behind a scene, as a latitude-longitude image: one writer for shots and exports.
#pragma once
#include <filesystem>
#include <functional>

#include "base/math.h"

namespace relamp {

/// Writes an EXR of half floats, twice as wide as high, strip by strip: nothing is lit by it. `texel(x, y)`: radiance,
/// y from the top; what exceeds a half float becomes the largest one. Whole or not at all; errors as writeChannelRows.
void writeBackgroundFile(const std::filesystem::path& file, int width, const std::function<Rgb(int, int)>& texel);

}  // namespace relamp
