// Whether a file can be found. The library's own functions throw for folders that may not be entered, circles of links
// and names that are too long.
#pragma once
#include <filesystem>

namespace relamp {

/// What cannot be looked at counts as not there.
inline bool isThere(const std::filesystem::path& path) noexcept {
    std::error_code ignored;
    return std::filesystem::exists(path, ignored);
}

/// False for folders, for what is not there and for what cannot be looked at.
inline bool isFile(const std::filesystem::path& path) noexcept {
    std::error_code ignored;
    return std::filesystem::is_regular_file(path, ignored);
}

}  // namespace relamp
