// Files are written whole or not at all: a temporary file beside the target, fsync, rename.
#pragma once
#include <filesystem>
#include <functional>
#include <string>

namespace relamp {

/// What `path` names once symbolic links at its end are followed, whether or not anything is there. Throws Error for a
/// circle of links.
std::filesystem::path followLinks(const std::filesystem::path& path);

/// The absolute place of a folder that is or will be there: links followed, no slash at the end. Throws Error as above,
/// and for an empty name.
std::filesystem::path folderPlace(const std::filesystem::path& folder);

/// Lets `write` fill a temporary file in the target's folder (same extension), then flushes it to disk and renames it
/// over `target`. Links are followed: the file they lead to is replaced. On any failure the target is as it was and the
/// temporary file is gone. Throws Error naming the file, also where something stands there that is no file; a full disk
/// throws OutOfResources.
void writeFileAtomically(const std::filesystem::path& target,
                         const std::function<void(const std::filesystem::path&)>& write);

/// Throws for a write to `file` that failed with `reason` (an errno): OutOfResources when the disk, the quota or the
/// allowed file size is at its end, else Error.
[[noreturn]] void throwWriteFailure(const std::filesystem::path& file, int reason,
                                    const char* what = "cannot be written");

/// Makes names that were changed in a folder last through a power cut; where that is not possible, nothing happens.
void flushFolder(const std::filesystem::path& folder);

/// writeFileAtomically for text or bytes in memory.
void writeBytesAtomically(const std::filesystem::path& target, const std::string& bytes);

/// Whole file as bytes; throws Error when it cannot be read or is larger than `maxBytes`.
std::string readBytes(const std::filesystem::path& file, size_t maxBytes = size_t(1) << 32);

}  // namespace relamp
