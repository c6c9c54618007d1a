// Where a file browser stands and what it shows: folders, filters, the answer. Draws nothing.
#pragma once
#include <atomic>
#include <unordered_map>

#include "browser/file_browser.h"
#include "browser/listing.h"

namespace relamp::ui {

/// "~" and "~/..." begin at the home folder.
std::filesystem::path withHome(const std::string& typed);

struct FileBrowser::State {
    BrowserRequest request;
    std::filesystem::path folder, chosen;
    std::vector<std::filesystem::path> past;  ///< folders to go back to
    std::string pathField, nameField, filter;
    bool everything = false, hidden = false, separate = false;
    bool askReplace = false, focusName = false, scrollToRow = false;
    bool typingPath = false;  ///< what is typed goes into pathField, though the field is not active
    std::string problem;      ///< shown beside the buttons

    /// Filled by a thread of its own, which outlives the browser when a file server hangs.
    struct Reading {
        std::atomic<bool> done{false};
        FolderListing listing;
        std::vector<FileEntry> collapsed;
    };
    std::shared_ptr<Reading> reading;
    std::string error;
    std::vector<FileEntry> plain, collapsed;
    std::vector<const FileEntry*> rows;  ///< after sequences, extensions and filter
    size_t hiddenByExtension = 0;
    int selected = -1;
    std::unordered_map<std::string, FileDetail> details;
    std::string newFolder;

    void go(const std::filesystem::path& target, bool remember = true);
    void read();
    void take();
    void choose();
    const FileDetail& detail(const FileEntry& entry);
    bool choosable(const FileEntry& entry);
    /// The row was confirmed: into a folder, or done.
    bool enter(const FileEntry& entry);
    std::filesystem::path target() const;
    bool confirm();
};

}  // namespace relamp::ui
