#include "browser/browser_state.h"

#include <chrono>
#include <thread>

#include "capture/capture_formats.h"
#include "widgets.h"

namespace relamp::ui {
namespace fs = std::filesystem;
namespace {

/// Where the last browser stood, for the next one.
fs::path& lastFolder() {
    static fs::path folder;
    return folder;
}

}  // namespace

fs::path withHome(const std::string& typed) {
    if (typed != "~" && !typed.starts_with("~/")) return typed;
    return homeFolder() / fs::path(typed.size() > 2 ? typed.substr(2) : "");
}

void FileBrowser::State::go(const fs::path& target, bool remember) {
    std::error_code failed;
    fs::path next = fs::absolute(target, failed).lexically_normal();
    if (failed) next = target;
    if (next.has_parent_path() && next.filename().empty()) next = next.parent_path();
    if (remember && !folder.empty() && next != folder) past.push_back(folder);
    folder = next;
    lastFolder() = next;
    pathField = shown(next);
    filter.clear();
    problem.clear();
    askReplace = typingPath = false;
    read();
}

void FileBrowser::State::read() {
    auto now = std::make_shared<Reading>();
    reading = now;
    rows.clear();
    selected = -1;
    std::thread([now, where = folder, all = hidden] {
        now->listing = listFolder(where, all);
        now->collapsed = collapseSequences(now->listing.entries);
        now->done = true;
    }).detach();
    // Nearly every folder is read within a frame; then nothing flickers.
    for (int i = 0; i < 40 && !now->done; ++i) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    take();
}

void FileBrowser::State::take() {
    if (!reading || !reading->done) return;
    plain = std::move(reading->listing.entries);
    collapsed = std::move(reading->collapsed);
    error = std::move(reading->listing.error);
    reading.reset();
    details.clear();
    selected = -1;
    choose();
}

void FileBrowser::State::choose() {
    const fs::path before = selected >= 0 && size_t(selected) < rows.size() ? rows[size_t(selected)]->path : fs::path();
    rows.clear();
    hiddenByExtension = 0;
    selected = -1;
    for (const FileEntry& entry : separate ? plain : collapsed) {
        const bool folderRow = entry.kind == FileEntry::Kind::folder;
        if (!folderRow && request.mode == BrowserRequest::Mode::folder) continue;
        if (!folderRow && !everything && !hasExtension(entry.path, request.extensions)) {
            ++hiddenByExtension;
            continue;
        }
        if (!filter.empty() && !containsFolded(entry.name, filter)) continue;
        if (!before.empty() && entry.path == before) selected = int(rows.size());
        rows.push_back(&entry);
    }
    if (selected < 0 && !filter.empty() && !rows.empty()) selected = 0;
}

const FileDetail& FileBrowser::State::detail(const FileEntry& entry) {
    const auto [at, fresh] = details.try_emplace(entry.path.string());
    if (fresh) at->second = detailOf(entry);
    return at->second;
}

bool FileBrowser::State::choosable(const FileEntry& entry) {
    if (entry.kind != FileEntry::Kind::folder) return request.mode != BrowserRequest::Mode::folder;
    if (request.mode == BrowserRequest::Mode::open && request.captures)
        return !detail(entry).capture.empty() || detail(entry).shot;
    return request.mode == BrowserRequest::Mode::save && request.replacesShots && detail(entry).shot;
}

bool FileBrowser::State::enter(const FileEntry& entry) {
    if (!choosable(entry)) {
        if (entry.kind == FileEntry::Kind::folder) go(fs::path(entry.path));
        return false;
    }
    if (request.mode == BrowserRequest::Mode::save) {
        nameField = shown(entry.path.filename());
        return confirm();
    }
    chosen = entry.path;
    return true;
}

fs::path FileBrowser::State::target() const {
    fs::path name = withHome(nameField);
    if (!request.extensions.empty() && !name.empty() && !hasExtension(name, request.extensions))
        name += request.extensions.front();
    return name.is_absolute() ? name : folder / name;
}

bool FileBrowser::State::confirm() {
    problem.clear();
    const FileEntry* row = selected >= 0 && size_t(selected) < rows.size() ? rows[size_t(selected)] : nullptr;
    if (request.mode == BrowserRequest::Mode::folder) {
        chosen = row ? row->path : folder;
        return true;
    }
    if (request.mode == BrowserRequest::Mode::open) {
        if (row) return enter(*row);
        if (request.captures && (findCapture(folder) || isShotFolder(folder))) {
            chosen = folder;
            return true;
        }
        problem = request.captures
                      ? fmt::format("Choose a capture (a folder with {}), a shot, or a file.", captureMarks())
                      : "Choose a file.";
        return false;
    }
    if (nameField.empty() || nameField.find('\0') != std::string::npos || fs::path(nameField).filename() == "." ||
        fs::path(nameField).filename() == "..") {
        problem = "Type a name.";
        return false;
    }
    const fs::path wanted = target();
    std::error_code failed;
    const fs::path parent = wanted.parent_path();
    if (!fs::is_directory(parent, failed)) {
        problem = fmt::format("The folder {} does not exist.", shown(parent));
        return false;
    }
    if (fs::exists(fs::symlink_status(wanted, failed))) {
        const bool directory = fs::is_directory(wanted, failed);
        if (directory != request.replacesShots ||
            (directory && !isShotFolder(wanted) && !fs::is_empty(wanted, failed))) {
            problem = fmt::format("{} is {}; choose another name.", shown(wanted.filename()),
                                  directory ? "a folder with other things in it" : "a file");
            return false;
        }
        if (!askReplace) {
            askReplace = true;
            return false;
        }
    }
    chosen = wanted;
    return true;
}

FileBrowser::FileBrowser() : state_(std::make_unique<State>()) {}
FileBrowser::~FileBrowser() = default;
const fs::path& FileBrowser::chosen() const { return state_->chosen; }
const BrowserRequest& FileBrowser::request() const { return state_->request; }
const fs::path& FileBrowser::folder() const { return state_->folder; }
bool FileBrowser::reading() const { return state_->reading != nullptr; }

std::vector<std::string> FileBrowser::names() const {
    std::vector<std::string> out;
    for (const FileEntry* row : state_->rows) out.push_back(row->name);
    return out;
}

void FileBrowser::begin(const BrowserRequest& request) {
    State& s = *state_;
    const bool hidden = s.hidden;
    s = State();
    s.hidden = hidden;
    s.request = request;
    s.nameField = request.name;
    s.focusName = request.mode == BrowserRequest::Mode::save;
    std::error_code failed;
    fs::path start = request.start;
    if (start.empty() || !fs::is_directory(start, failed)) start = lastFolder();
    if (start.empty() || !fs::is_directory(start, failed)) start = homeFolder();
    s.go(start, false);
}

}  // namespace relamp::ui
