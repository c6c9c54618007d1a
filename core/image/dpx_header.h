// What a DPX's header claims, held against the size of the file before a library believes it.
#pragma once
#include <filesystem>

namespace relamp {

/// The user data that the header announces must fit into the file [SMPTE 268M]. Files that do not begin as a DPX pass,
/// and so does whatever else may be wrong with one. Throws Error naming file and field.
void checkDpxHeader(const std::filesystem::path& file);

}  // namespace relamp
