// Whether a file can be found. The library's own functions throw for folders that may not be entered, circles of links
// and names that are too long.
#pragma once
#include <filesystem>
#include <string>

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

/// Why isFile() is false, for a sentence: "does not exist", "is a folder", "is no regular file", or the system's
/// reason.
inline std::string whyNoFile(const std::filesystem::path& path) {
    std::error_code failed;
    const std::filesystem::file_status found = std::filesystem::status(path, failed);
    if (found.type() == std::filesystem::file_type::not_found) return "does not exist";
    if (failed) return "cannot be reached (" + failed.message() + ")";
    return found.type() == std::filesystem::file_type::directory ? "is a folder, expected a file"
                                                                 : "is no regular file";
}

}  // namespace relamp
