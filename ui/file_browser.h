// The file browser inside the window: the same on every desktop, knows captures, shots and numbered sequences, and
// never runs in the way of the window: a folder is read once, in the background.
#pragma once
#include <cstdint>
#include <filesystem>
#include <memory>
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

bool isCaptureFolder(const std::filesystem::path& folder);  ///< holds transforms.json
bool isShotFolder(const std::filesystem::path& folder);     ///< holds shot.json
/// Folder of the captures that come with the program; empty when there is none.
std::filesystem::path demoCaptures();
/// The same for a program in another place: installed (PREFIX/bin beside PREFIX/share), or in a build folder of the
/// source tree.
std::filesystem::path demoCaptures(const std::filesystem::path& program);

struct BrowserRequest {
    enum class Mode { open, save, folder } mode = Mode::open;
    std::string title = "Open", confirm = "Open";
    std::filesystem::path start;          ///< folder to begin in; empty: the last one, or home
    std::string name;                     ///< save: the name to begin with
    std::vector<std::string> extensions;  ///< ".exr", ...: others are shown only on demand; empty: all. save: the first
                                          ///< is added when the name has none
    bool captures = false;                ///< open: folders that hold a capture or a shot can be chosen
    bool replacesShots = false;  ///< save: the result is a shot folder, which may replace a shot and nothing else
    std::string note;            ///< a sentence under the title
};

class FileBrowser {
public:
    FileBrowser();
    ~FileBrowser();
    void begin(const BrowserRequest& request);
    enum class Answer { none, chosen, cancelled };
    /// Draws into the present popup or window.
    Answer draw(const std::vector<std::filesystem::path>& recent);
    const std::filesystem::path& chosen() const;
    const BrowserRequest& request() const;
    /// What the list shows now (after sequences and filter); for tests.
    std::vector<std::string> names() const;
    const std::filesystem::path& folder() const;
    bool reading() const;

private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace relamp::ui
