#include "file_browser.h"

#include <imgui.h>

#include <atomic>
#include <chrono>
#include <cstdlib>
#include <ctime>
#include <map>
#include <thread>
#include <unordered_map>

#include "widgets.h"

namespace relamp::ui {
namespace {
namespace fs = std::filesystem;

bool isDigit(char c) { return c >= '0' && c <= '9'; }
char lower(char c) { return c >= 'A' && c <= 'Z' ? char(c - 'A' + 'a') : c; }

std::string lowered(std::string s) {
    for (char& c : s) c = lower(c);
    return s;
}

bool containsFolded(const std::string& name, const std::string& part) {
    return lowered(name).find(lowered(part)) != std::string::npos;
}

/// The last number before the extension.
struct Numbered {
    std::string before, after;
    std::string digits;
};
bool findNumber(const std::string& name, Numbered& out) {
    const size_t dot = name.rfind('.');
    size_t end = dot == std::string::npos || dot == 0 ? name.size() : dot;
    while (end > 0 && !isDigit(name[end - 1])) --end;
    size_t begin = end;
    while (begin > 0 && isDigit(name[begin - 1])) --begin;
    if (begin == end || end - begin > 9) return false;
    out = {name.substr(0, begin), name.substr(end), name.substr(begin, end - begin)};
    return true;
}

/// What the file system says of the visible rows only.
struct Detail {
    bool capture = false, shot = false;
    std::string size, time;
};

Detail detailOf(const FileEntry& entry) {
    Detail detail;
    std::error_code failed;
    if (entry.kind == FileEntry::Kind::folder) {
        detail.capture = isCaptureFolder(entry.path);
        detail.shot = isShotFolder(entry.path);
    } else if (const auto bytes = fs::file_size(entry.path, failed); !failed) {
        const double b = double(bytes);
        detail.size = b < 1024         ? fmt::format("{} B", bytes)
                      : b < 1048576    ? fmt::format("{:.0f} KiB", b / 1024)
                      : b < 1073741824 ? fmt::format("{:.1f} MiB", b / 1048576)
                                       : fmt::format("{:.2f} GiB", b / 1073741824);
    }
    if (const auto written = fs::last_write_time(entry.path, failed); !failed) {
        const auto since = std::chrono::duration_cast<std::chrono::seconds>(written - fs::file_time_type::clock::now());
        const std::time_t when = std::time(nullptr) + std::time_t(since.count());
        std::tm local{};
        char words[32] = "";
        if (localtime_r(&when, &local)) std::strftime(words, sizeof words, "%Y-%m-%d %H:%M", &local);
        detail.time = words;
    }
    return detail;
}

bool hasExtension(const fs::path& path, const std::vector<std::string>& extensions) {
    if (extensions.empty()) return true;
    const std::string own = lowered(path.extension().string());
    return std::find(extensions.begin(), extensions.end(), own) != extensions.end();
}

std::string listed(const std::vector<std::string>& extensions) {
    std::string out;
    for (const std::string& e : extensions) out += (out.empty() ? "" : " ") + e;
    return out;
}

fs::path homeFolder() {
    const char* home = std::getenv("HOME");
    return home && *home ? fs::path(home) : fs::path("/");
}

/// Where the last browser stood, for the next one.
fs::path& lastFolder() {
    static fs::path folder;
    return folder;
}

}  // namespace

bool naturalLess(const std::string& a, const std::string& b) {
    size_t i = 0, j = 0;
    while (i < a.size() && j < b.size()) {
        if (isDigit(a[i]) && isDigit(b[j])) {
            while (i < a.size() && a[i] == '0') ++i;
            while (j < b.size() && b[j] == '0') ++j;
            size_t ie = i, je = j;
            while (ie < a.size() && isDigit(a[ie])) ++ie;
            while (je < b.size() && isDigit(b[je])) ++je;
            if (ie - i != je - j) return ie - i < je - j;
            if (const int order = a.compare(i, ie - i, b, j, je - j)) return order < 0;
            i = ie, j = je;
            continue;
        }
        const unsigned char x = static_cast<unsigned char>(lower(a[i])), y = static_cast<unsigned char>(lower(b[j]));
        if (x != y) return x < y;
        ++i, ++j;
    }
    if (a.size() - i != b.size() - j) return a.size() - i < b.size() - j;
    return a < b;
}

std::vector<FileEntry> collapseSequences(std::vector<FileEntry> entries) {
    struct Group {
        std::vector<size_t> members;
        bool padded = false;
    };
    // Groups by what stands around the number; padded ones are told apart by their width in a second pass.
    std::unordered_map<std::string, Group> groups;
    std::vector<Numbered> numbers(entries.size());
    for (size_t i = 0; i < entries.size(); ++i) {
        if (entries[i].kind != FileEntry::Kind::file || !findNumber(entries[i].path.filename().string(), numbers[i]))
            continue;
        Group& group = groups[numbers[i].before + '/' + numbers[i].after];
        group.members.push_back(i);
        group.padded |= numbers[i].digits.size() > 1 && numbers[i].digits[0] == '0';
    }
    std::vector<uint8_t> gone(entries.size(), 0);
    std::vector<FileEntry> out;
    for (auto& [around, group] : groups) {
        std::map<size_t, std::vector<size_t>> byWidth;
        for (const size_t i : group.members) byWidth[group.padded ? numbers[i].digits.size() : 0].push_back(i);
        for (auto& [width, members] : byWidth) {
            if (members.size() < 3) continue;
            const auto value = [&](size_t i) { return std::stol(numbers[i].digits); };
            const auto [low, high] = std::minmax_element(members.begin(), members.end(),
                                                         [&](size_t a, size_t b) { return value(a) < value(b); });
            FileEntry run{
                FileEntry::Kind::sequence,
                entries[*low].path,
                shown(numbers[*low].before + numbers[*low].digits + "-" + numbers[*high].digits + numbers[*low].after),
                value(*low),
                value(*high),
                members.size()};
            for (const size_t i : members) gone[i] = 1;
            out.push_back(std::move(run));
        }
    }
    for (size_t i = 0; i < entries.size(); ++i)
        if (!gone[i]) out.push_back(std::move(entries[i]));
    std::sort(out.begin(), out.end(), [](const FileEntry& a, const FileEntry& b) {
        const bool af = a.kind == FileEntry::Kind::folder, bf = b.kind == FileEntry::Kind::folder;
        return af != bf ? af : naturalLess(a.name, b.name);
    });
    return out;
}

FolderListing listFolder(const fs::path& folder, bool hidden) {
    FolderListing listing{folder, {}, {}};
    std::error_code failed;
    fs::directory_iterator at(folder, failed);
    if (failed) {
        listing.error = failed == std::errc::permission_denied
                            ? "You may not read this folder. Ask its owner for permission, or choose another."
                        : failed == std::errc::no_such_file_or_directory ? "This folder does not exist."
                        : failed == std::errc::not_a_directory           ? "This is a file, not a folder."
                                                               : "This folder cannot be read: " + failed.message();
        return listing;
    }
    for (; at != fs::directory_iterator(); at.increment(failed)) {
        const std::string name = at->path().filename().string();
        if (!hidden && !name.empty() && name[0] == '.') continue;
        std::error_code ignored;
        const bool directory = at->is_directory(ignored);
        listing.entries.push_back(
            {directory ? FileEntry::Kind::folder : FileEntry::Kind::file, at->path(), shown(name), 0, 0, 1});
        if (failed) break;
    }
    if (failed) listing.error = "Only a part of this folder could be read: " + failed.message();
    std::sort(listing.entries.begin(), listing.entries.end(), [](const FileEntry& a, const FileEntry& b) {
        const bool af = a.kind == FileEntry::Kind::folder, bf = b.kind == FileEntry::Kind::folder;
        return af != bf ? af : naturalLess(a.name, b.name);
    });
    return listing;
}

bool isCaptureFolder(const fs::path& folder) {
    std::error_code ignored;
    return fs::exists(folder / "transforms.json", ignored);
}

bool isShotFolder(const fs::path& folder) {
    std::error_code ignored;
    return fs::exists(folder / "shot.json", ignored);
}

fs::path demoCaptures() {
    std::error_code failed;
    const fs::path program = fs::read_symlink("/proc/self/exe", failed);
    return failed ? fs::path() : demoCaptures(program);
}

fs::path demoCaptures(const fs::path& program) {
    fs::path at = program.parent_path();
    for (int up = 0; up < 4 && !at.empty(); ++up, at = at.parent_path())
        for (const char* place : {"share/relamp/captures", "assets/captures"})
            if (std::error_code ignored; fs::is_directory(at / place, ignored)) return at / place;
    return {};
}

struct FileBrowser::State {
    BrowserRequest request;
    fs::path folder, chosen;
    std::vector<fs::path> past;  ///< folders to go back to
    std::string pathField, nameField, filter;
    bool everything = false, hidden = false, separate = false;
    bool askReplace = false, focusName = false, scrollToRow = false;
    std::string problem;  ///< shown beside the buttons

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
    std::unordered_map<std::string, Detail> details;
    std::string newFolder;

    void go(const fs::path& target, bool remember = true) {
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
        askReplace = false;
        read();
    }

    void read() {
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

    void take() {
        if (!reading || !reading->done) return;
        plain = std::move(reading->listing.entries);
        collapsed = std::move(reading->collapsed);
        error = std::move(reading->listing.error);
        reading.reset();
        details.clear();
        selected = -1;
        choose();
    }

    void choose() {
        const fs::path before =
            selected >= 0 && size_t(selected) < rows.size() ? rows[size_t(selected)]->path : fs::path();
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

    const Detail& detail(const FileEntry& entry) {
        const auto [at, fresh] = details.try_emplace(entry.path.string());
        if (fresh) at->second = detailOf(entry);
        return at->second;
    }

    bool choosable(const FileEntry& entry) {
        if (entry.kind != FileEntry::Kind::folder) return request.mode != BrowserRequest::Mode::folder;
        if (request.mode == BrowserRequest::Mode::open && request.captures)
            return detail(entry).capture || detail(entry).shot;
        return request.mode == BrowserRequest::Mode::save && request.replacesShots && detail(entry).shot;
    }

    /// The row was confirmed: into a folder, or done.
    bool enter(const FileEntry& entry) {
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

    fs::path target() const {
        fs::path name = nameField;
        if (!request.extensions.empty() && !name.empty() && !hasExtension(name, request.extensions))
            name += request.extensions.front();
        return name.is_absolute() ? name : folder / name;
    }

    bool confirm() {
        problem.clear();
        const FileEntry* row = selected >= 0 && size_t(selected) < rows.size() ? rows[size_t(selected)] : nullptr;
        if (request.mode == BrowserRequest::Mode::folder) {
            chosen = row ? row->path : folder;
            return true;
        }
        if (request.mode == BrowserRequest::Mode::open) {
            if (row) return enter(*row);
            if (request.captures && (isCaptureFolder(folder) || isShotFolder(folder))) {
                chosen = folder;
                return true;
            }
            problem = request.captures ? "Choose a capture (a folder with transforms.json), a shot, or a file."
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
};

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

namespace {

/// Buttons for the folders on the way, the last ones first when there is no room for all.
fs::path drawBreadcrumbs(const fs::path& folder) {
    std::vector<fs::path> steps;
    for (fs::path at = folder; !at.empty(); at = at.parent_path()) {
        steps.insert(steps.begin(), at);
        if (at == at.parent_path()) break;
    }
    float room = ImGui::GetContentRegionAvail().x - em(2);
    size_t first = steps.size();
    const auto nameOf = [](const fs::path& p) {
        return p.filename().empty() ? std::string("/") : elided(shown(p.filename()), em(14));
    };
    while (first > 0) {
        const float width = buttonWidth(nameOf(steps[first - 1])) + em(0.3f);
        if (width > room && first < steps.size()) break;
        room -= width;
        --first;
    }
    fs::path pressed;
    ImGui::PushStyleColor(ImGuiCol_Button, {0, 0, 0, 0});
    if (first > 0) dimText("..."), ImGui::SameLine(0, em(0.2f));
    for (size_t i = first; i < steps.size(); ++i) {
        ImGui::PushID(int(i));
        if (ImGui::Button(nameOf(steps[i]).c_str())) pressed = steps[i];
        tooltip("Go to " + shown(steps[i]));
        ImGui::PopID();
        if (i + 1 < steps.size()) ImGui::SameLine(0, em(0.1f));
    }
    ImGui::PopStyleColor();
    return pressed;
}

}  // namespace

FileBrowser::Answer FileBrowser::draw(const std::vector<fs::path>& recent) {
    State& s = *state_;
    s.take();
    if (s.reading) stayAwake();
    Answer answer = Answer::none;
    fs::path next;
    bool enterUsed = false;
    const auto done = [&](bool yes) {
        if (yes) answer = Answer::chosen;
    };
    if (!s.request.note.empty()) dimWrapped(s.request.note);

    // Where we are.
    ImGui::BeginDisabled(s.past.empty());
    if (iconButton("##back", Icon::back, "Back to the folder before")) {
        const fs::path back = s.past.back();
        s.past.pop_back();
        s.go(back, false);
    }
    ImGui::EndDisabled();
    ImGui::SameLine();
    if (iconButton("##up", Icon::up, "To the folder around this one (Backspace)")) next = s.folder.parent_path();
    ImGui::SameLine();
    ImGui::SetNextItemWidth(-FLT_MIN);
    if (inputText("##path", s.pathField, "Path of a folder or file",
                  ImGuiInputTextFlags_EnterReturnsTrue | ImGuiInputTextFlags_AutoSelectAll)) {
        fs::path typed = s.pathField;
        enterUsed = true;
        if (s.pathField.starts_with("~"))
            typed = homeFolder() / fs::path(s.pathField.size() > 2 ? s.pathField.substr(2) : "");
        std::error_code failed;
        if (fs::is_directory(typed, failed)) next = typed;
        else if (s.request.mode == BrowserRequest::Mode::save) {
            s.nameField = typed.filename().string();
            next = typed.parent_path();
        } else if (fs::exists(typed, failed)) {
            s.chosen = typed;
            answer = Answer::chosen;
        } else s.problem = fmt::format("{} does not exist.", s.pathField);
    }
    tooltip("Type or paste a path and press Enter; ~ is your home folder");
    const bool pathActive = ImGui::IsItemActive();
    if (const fs::path step = drawBreadcrumbs(s.folder); !step.empty()) next = step;

    // Filter and switches.
    const float filterWidth = std::min(em(14), ImGui::GetContentRegionAvail().x * 0.5f);
    iconText(Icon::search, dimColour);
    ImGui::SameLine(0, em(0.3f));
    ImGui::SetNextItemWidth(filterWidth);
    if (inputText("##filter", s.filter, "Filter")) s.choose();
    tooltip("Shows only names that contain these letters. Just begin to type.");
    const bool filterActive = ImGui::IsItemActive();
    if (!s.request.extensions.empty() && s.request.mode != BrowserRequest::Mode::folder) {
        sameLineIfFits(buttonWidth("All files") + em(1.6f));
        if (checkbox("All files", s.everything, "Also shows files that are not " + listed(s.request.extensions)))
            s.choose();
    }
    if (s.request.mode != BrowserRequest::Mode::folder) {
        sameLineIfFits(buttonWidth("Frames") + em(1.6f));
        if (checkbox("Frames", s.separate, "Shows each frame of a numbered sequence in a row of its own")) s.choose();
    }
    sameLineIfFits(buttonWidth("Hidden") + em(1.6f));
    if (checkbox("Hidden", s.hidden, "Also shows names that begin with a dot")) s.read();
    if (s.request.mode != BrowserRequest::Mode::open) {
        sameLineIfFits(buttonWidth("New folder...") + em(1));
        if (button("New folder...", "Makes a folder here")) ImGui::OpenPopup("##new"), s.newFolder = "New folder";
        if (ImGui::BeginPopup("##new")) {
            ImGui::SetNextItemWidth(em(14));
            const bool enter = inputText("##name", s.newFolder, "Name", ImGuiInputTextFlags_EnterReturnsTrue);
            ImGui::SameLine();
            if ((button("Make", "Makes the folder and goes into it") || enter) && !s.newFolder.empty()) {
                std::error_code failed;
                const fs::path made = s.folder / s.newFolder;
                if (fs::create_directory(made, failed); failed)
                    s.problem = fmt::format("{} cannot be made: {}", s.newFolder, failed.message());
                else next = made;
                ImGui::CloseCurrentPopup();
            }
            ImGui::EndPopup();
        }
    }

    // Places and the list.
    const bool saving = s.request.mode == BrowserRequest::Mode::save;
    const float below = ImGui::GetFrameHeightWithSpacing() * (saving ? 2 : 1) +
                        ImGui::GetTextLineHeightWithSpacing() * (s.problem.empty() && !s.askReplace ? 0.4f : 2.4f);
    const float height = std::max(em(6), ImGui::GetContentRegionAvail().y - below);
    if (ImGui::GetContentRegionAvail().x > em(34)) {
        if (beginChild("##places", {em(11), height}, true)) {
            const auto place = [&](const std::string& name, const fs::path& path, Icon icon) {
                if (path.empty()) return;
                ImGui::PushID(path.c_str());
                iconText(icon, dimColour);
                ImGui::SameLine(0, em(0.4f));
                if (ImGui::Selectable(elided(name, ImGui::GetContentRegionAvail().x).c_str(), path == s.folder))
                    next = path;
                tooltip(shown(path));
                ImGui::PopID();
            };
            heading("Places");
            place("Home", homeFolder(), Icon::home);
            place("Whole disk", "/", Icon::folder);
            place("Demo captures", demoCaptures(), Icon::capture);
            if (!recent.empty()) heading("Recent");
            int index = 0;
            for (const fs::path& path : recent) {
                ImGui::PushID(index++);
                iconText(path.extension() == ".relamp" ? Icon::shot : Icon::capture, dimColour);
                ImGui::SameLine(0, em(0.4f));
                const fs::path tidy = path.has_filename() ? path : path.parent_path();
                if (ImGui::Selectable(elided(shown(tidy.filename()), ImGui::GetContentRegionAvail().x).c_str())) {
                    if (s.request.captures && s.request.mode == BrowserRequest::Mode::open)
                        s.chosen = path, answer = Answer::chosen;
                    else next = path.parent_path();
                }
                tooltip(shown(path));
                ImGui::PopID();
            }
        }
        ImGui::EndChild();
        ImGui::SameLine();
    }
    if (beginChild("##list", {0, height}, true)) {
        if (!s.error.empty()) warningText(s.error);
        if (s.reading) dimText("Reading the folder...");
        else if (s.rows.empty() && s.error.empty())
            dimWrapped(
                !s.filter.empty() ? "No name here contains these letters."
                : s.hiddenByExtension
                    ? fmt::format(
                          "Nothing of the kind looked for; {} other files are here. Tick \"All files\" to see them.",
                          s.hiddenByExtension)
                    : "This folder is empty.");
        const bool wide = ImGui::GetContentRegionAvail().x > em(26), widest = ImGui::GetContentRegionAvail().x > em(34);
        if (!s.rows.empty() &&
            ImGui::BeginTable("##files", 1 + wide + widest, ImGuiTableFlags_RowBg | ImGuiTableFlags_PadOuterX)) {
            ImGui::TableSetupColumn("Name", ImGuiTableColumnFlags_WidthStretch);
            if (wide) ImGui::TableSetupColumn("Kind", ImGuiTableColumnFlags_WidthFixed, em(6.5f));
            if (widest) ImGui::TableSetupColumn("Changed", ImGuiTableColumnFlags_WidthFixed, em(8.5f));
            ImGuiListClipper clipper;
            clipper.Begin(int(s.rows.size()));
            if (s.scrollToRow && s.selected >= 0) {
                const float row = ImGui::GetTextLineHeight() + 2 * ImGui::GetStyle().CellPadding.y,
                            y = float(s.selected) * row;
                if (y < ImGui::GetScrollY() || y + 2 * row > ImGui::GetScrollY() + height)
                    ImGui::SetScrollY(std::max(0.0f, y - height / 2));
                s.scrollToRow = false;
            }
            const FileEntry* entered = nullptr;
            while (clipper.Step())
                for (int i = clipper.DisplayStart; i < clipper.DisplayEnd; ++i) {
                    const FileEntry& entry = *s.rows[size_t(i)];
                    const Detail& detail = s.detail(entry);
                    ImGui::TableNextRow();
                    ImGui::TableNextColumn();
                    ImGui::PushID(i);
                    const Icon icon =
                        detail.shot                               ? Icon::shot
                        : detail.capture                          ? Icon::capture
                        : entry.kind == FileEntry::Kind::folder   ? Icon::folder
                        : entry.kind == FileEntry::Kind::sequence ? Icon::film
                        : hasExtension(entry.path, {".exr", ".hdr", ".png", ".jpg", ".jpeg", ".tif", ".tiff", ".dpx"})
                            ? Icon::image
                            : Icon::file;
                    iconText(icon, detail.capture || detail.shot ? accentColour : dimColour);
                    ImGui::SameLine(0, em(0.4f));
                    const std::string words = entry.kind == FileEntry::Kind::sequence && !wide
                                                  ? fmt::format("{} ({})", entry.name, entry.members)
                                                  : entry.name;
                    const std::string row = elided(words, ImGui::GetContentRegionAvail().x) + "##row";
                    if (ImGui::Selectable(row.c_str(), i == s.selected,
                                          ImGuiSelectableFlags_SpanAllColumns | ImGuiSelectableFlags_AllowDoubleClick |
                                              ImGuiSelectableFlags_DontClosePopups)) {
                        s.selected = i;
                        s.askReplace = false;
                        if (saving && entry.kind != FileEntry::Kind::folder) s.nameField = shown(entry.path.filename());
                        if (ImGui::IsMouseDoubleClicked(ImGuiMouseButton_Left)) entered = &entry;
                    }
                    tooltip(entry.name + (detail.capture ? "\nA capture: photographs with cameras and a mesh"
                                          : detail.shot  ? "\nA shot: an estimate with its look"
                                                         : ""));
                    if (wide) {
                        ImGui::TableNextColumn();
                        const std::string gaps =
                            entry.last - entry.first + 1 == long(entry.members)
                                ? fmt::format("{} frames", entry.members)
                                : fmt::format("{} of {} fr.", entry.members, entry.last - entry.first + 1);
                        dimText(detail.shot                               ? "shot"
                                : detail.capture                          ? "capture"
                                : entry.kind == FileEntry::Kind::folder   ? ""
                                : entry.kind == FileEntry::Kind::sequence ? gaps
                                                                          : detail.size);
                    }
                    if (widest) {
                        ImGui::TableNextColumn();
                        dimText(detail.time);
                    }
                    ImGui::PopID();
                }
            ImGui::EndTable();
            if (entered) done(s.enter(*entered));
        }
    }
    ImGui::EndChild();

    // The name, what is wrong, and the buttons.
    bool nameActive = false;
    if (saving) {
        dimText("Name");
        ImGui::SameLine();
        ImGui::SetNextItemWidth(-FLT_MIN);
        if (s.focusName) ImGui::SetKeyboardFocusHere(), s.focusName = false;
        if (inputText("##save name", s.nameField, "Name of the file", ImGuiInputTextFlags_EnterReturnsTrue))
            enterUsed = true, done(s.confirm());
        if (ImGui::IsItemEdited()) s.askReplace = false, s.problem.clear();
        nameActive = ImGui::IsItemActive();
    }
    if (!s.problem.empty()) warningText(s.problem);
    else if (s.askReplace) warningText(fmt::format("{} exists already. Replace it?", shown(s.target().filename())));
    const std::string confirmWord = s.askReplace ? "Replace" : s.request.confirm;
    const float buttons = buttonWidth("Cancel") + buttonWidth(confirmWord) + em(2) + ImGui::GetStyle().ItemSpacing.x;
    ImGui::SetCursorPosX(
        std::max(ImGui::GetCursorPosX(), ImGui::GetCursorPosX() + ImGui::GetContentRegionAvail().x - buttons));
    if (button("Cancel", "Closes this without choosing (Esc)", buttonWidth("Cancel") + em(1)))
        answer = Answer::cancelled;
    ImGui::SameLine();
    if (primaryButton(confirmWord.c_str(), s.askReplace ? "Overwrites what is there" : "Takes what is selected (Enter)",
                      buttonWidth(confirmWord) + em(1)))
        done(s.confirm());

    // Keys.
    if (!pathActive && !nameActive && !ImGui::IsPopupOpen("##new")) {
        const int rows = int(s.rows.size()),
                  page = std::max(1, int(height / ImGui::GetTextLineHeightWithSpacing()) - 2);
        const auto move = [&](int by) {
            if (rows) s.selected = std::clamp(s.selected + by, 0, rows - 1), s.scrollToRow = true, s.askReplace = false;
        };
        if (keyPressed(ImGuiKey_DownArrow, true)) move(1);
        if (keyPressed(ImGuiKey_UpArrow, true)) move(s.selected < 0 ? rows : -1);
        if (keyPressed(ImGuiKey_PageDown, true)) move(page);
        if (keyPressed(ImGuiKey_PageUp, true)) move(-page);
        if (answer == Answer::none && next.empty() && !enterUsed && enterPressed())
            done(s.selected >= 0 ? s.enter(*s.rows[size_t(s.selected)]) : s.confirm());
        if (!filterActive && !ImGui::IsAnyItemActive()) {
            if (keyPressed(ImGuiKey_Home)) move(-rows);
            if (keyPressed(ImGuiKey_End)) move(rows);
            if (keyPressed(ImGuiKey_Backspace, true)) {
                if (s.filter.empty()) next = s.folder.parent_path();
                else {
                    while (!s.filter.empty() && (static_cast<unsigned char>(s.filter.back()) & 0xC0) == 0x80)
                        s.filter.pop_back();
                    if (!s.filter.empty()) s.filter.pop_back();
                    s.choose();
                }
            }
            bool typed = false;
            for (const ImWchar c : ImGui::GetIO().InputQueueCharacters)
                if (c > 32 && c < 127 && c != '/') s.filter += char(c), typed = true;
            if (typed) s.choose();
        }
    }
    if (answer == Answer::none && escapePressed() && !ImGui::IsPopupOpen("##new")) {
        if (s.askReplace) s.askReplace = false;
        else answer = Answer::cancelled;
    }
    if (!next.empty() && answer == Answer::none) s.go(next);
    return answer;
}

}  // namespace relamp::ui
