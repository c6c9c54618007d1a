// What the file browser lists: folders, files and numbered sequences, in the order of people, with what each is.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

namespace relamp::ui {

struct FileEntry {
    enum class Kind { folder, file, sequence } kind = Kind::file;
    std::filesystem::path path;  ///< of a sequence: its first member
    std::string name;            ///< for the screen, valid UTF-8; "frame.0001-0120.exr"
    long first = 0, last = 0;    ///< numbers of a sequence
    size_t members = 1;
};

/// Three or more files that differ only in their last number before the extension become one entry. Numbers with
/// leading zeros belong together when they have the same width. Other entries stay; order: folders first, then by name,
/// numbers by value.
std::vector<FileEntry> collapseSequences(std::vector<FileEntry> entries);
/// As a person would sort: capitals do not matter, "take 9" stands before "take 10".
bool naturalLess(const std::string& a, const std::string& b);

struct FolderListing {
    std::filesystem::path folder;
    std::vector<FileEntry> entries;  ///< sorted, not collapsed
    std::string error;               ///< why it could not be read; empty: it could
};
/// Never throws. Hidden entries (names that begin with a dot) on demand. Cost: one pass over the names, no look at the
/// files.
FolderListing listFolder(const std::filesystem::path& folder, bool hidden);

/// What the file system says of one entry; asked for the rows on screen alone.
struct FileDetail {
    std::string capture;  ///< name of its capture format; empty: no capture
    bool shot = false;
    std::string size, time;
};
FileDetail detailOf(const FileEntry& entry);
bool isShotFolder(const std::filesystem::path& folder);  ///< holds shot.json
/// Small letters in `extensions`; an empty list means every file.
bool hasExtension(const std::filesystem::path& path, const std::vector<std::string>& extensions);
/// Whether `part` is in `name`; capitals do not matter.
bool containsFolded(const std::string& name, const std::string& part);
std::filesystem::path homeFolder();
/// Folder of the captures that come with the program; empty when there is none.
std::filesystem::path demoCaptures();
/// The same for a program in another place: installed (PREFIX/bin beside PREFIX/share), or in a build folder of the
/// source tree.
std::filesystem::path demoCaptures(const std::filesystem::path& program);

}  // namespace relamp::ui
