// What an EXR's header claims, held against the size of the file before a library believes it.
#pragma once
#include <filesystem>

namespace relamp {

/// Walks the attributes of every part: names and types of at most 255 characters, sizes that the file can hold and that
/// their contents have (OpenEXR reads some types by their contents, and would then take what follows for the next
/// size); sides of at most 2^20 pixels, and at most 2^27 numbers in what is packed together, lines or a tile, because
/// OpenEXR asks memory for that at once. Files that do not begin as an EXR pass, and so does whatever else may be wrong
/// with one. Throws Error naming file and attribute. Cost: a few reads for each attribute.
void checkExrHeader(const std::filesystem::path& file);

}  // namespace relamp
