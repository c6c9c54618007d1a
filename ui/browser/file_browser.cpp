// How the file browser looks: the path, the switches, the places, the list, the name, the buttons and the keys.
#include "browser/file_browser.h"

#include <imgui.h>

#include "browser/browser_state.h"
#include "capture/capture_formats.h"
#include "widgets.h"

namespace relamp::ui {
namespace fs = std::filesystem;
namespace {

std::string listed(const std::vector<std::string>& extensions) {
    std::string out;
    for (const std::string& e : extensions) out += (out.empty() ? "" : " ") + e;
    return out;
}

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

/// One frame of a browser.
class FileBrowser::Drawing {
public:
    explicit Drawing(State& state) : s_(state), saving_(state.request.mode == BrowserRequest::Mode::save) {}
    FileBrowser::Answer draw(const std::vector<fs::path>& recent);

private:
    State& s_;
    bool saving_;
    FileBrowser::Answer answer_ = FileBrowser::Answer::none;
    fs::path next_;  ///< folder to go to after this frame
    float height_ = 0;
    bool enterUsed_ = false, pathActive_ = false, filterActive_ = false, nameActive_ = false;

    void done(bool yes) {
        if (yes) answer_ = FileBrowser::Answer::chosen;
    }
    void path();
    void takePath();
    void switches();
    void newFolder();
    void places(const std::vector<fs::path>& recent);
    void list();
    void row(int i, bool wide, bool widest, const FileEntry*& entered);
    void name();
    void buttons();
    void keys();
};

FileBrowser::Answer FileBrowser::Drawing::draw(const std::vector<fs::path>& recent) {
    s_.take();
    if (s_.reading) stayAwake();
    if (!s_.request.note.empty()) dimWrapped(s_.request.note);
    path();
    switches();
    newFolder();
    const float words =
        s_.problem.empty()
            ? (s_.askReplace ? 2 * ImGui::GetTextLineHeightWithSpacing() : 0)
            : ImGui::CalcTextSize(s_.problem.c_str(), nullptr, false, ImGui::GetContentRegionAvail().x - em(2)).y +
                  ImGui::GetStyle().ItemSpacing.y;
    const float below =
        ImGui::GetFrameHeightWithSpacing() * (saving_ ? 2 : 1) + ImGui::GetTextLineHeightWithSpacing() * 0.4f + words;
    height_ = std::max(em(6), ImGui::GetContentRegionAvail().y - below);
    places(recent);
    list();
    name();
    buttons();
    keys();
    if (answer_ == FileBrowser::Answer::none && escapePressed() && !ImGui::IsPopupOpen("##new")) {
        if (s_.askReplace) s_.askReplace = false;
        else answer_ = FileBrowser::Answer::cancelled;
    }
    if (!next_.empty() && answer_ == FileBrowser::Answer::none) s_.go(next_);
    return answer_;
}

/// Where we are.
void FileBrowser::Drawing::path() {
    ImGui::BeginDisabled(s_.past.empty());
    if (iconButton("##back", Icon::back, "Back to the folder before")) {
        const fs::path back = s_.past.back();
        s_.past.pop_back();
        s_.go(back, false);
    }
    ImGui::EndDisabled();
    ImGui::SameLine();
    if (iconButton("##up", Icon::up, "To the folder around this one (Backspace)")) next_ = s_.folder.parent_path();
    ImGui::SameLine();
    ImGui::SetNextItemWidth(-FLT_MIN);
    if (inputText("##path", s_.pathField, "Path of a folder or file",
                  ImGuiInputTextFlags_EnterReturnsTrue | ImGuiInputTextFlags_AutoSelectAll)) {
        enterUsed_ = true;
        takePath();
        if (!s_.problem.empty()) ImGui::SetKeyboardFocusHere(-1);  // to be mended where it was typed
    }
    tooltip("Type or paste a path and press Enter; ~ is your home folder");
    pathActive_ = ImGui::IsItemActive();
    if (pathActive_) s_.typingPath = false;
    if (const fs::path step = drawBreadcrumbs(s_.folder); !step.empty()) next_ = step;
}

/// Chooses or goes to what the path names.
void FileBrowser::Drawing::takePath() {
    const fs::path typed = s_.folder / withHome(s_.pathField);
    s_.problem.clear();
    std::error_code failed;
    const bool saved = saving_ && s_.request.replacesShots && isShotFolder(typed);  // a name, not a place
    if (fs::is_directory(typed, failed) && !saved) {
        const bool whole = s_.request.mode == BrowserRequest::Mode::open && s_.request.captures &&
                           (isShotFolder(typed) || findCapture(typed));
        if (whole) s_.chosen = typed, answer_ = FileBrowser::Answer::chosen;
        else next_ = typed;
    } else if (s_.request.mode == BrowserRequest::Mode::save) {
        s_.nameField = typed.filename().string();
        next_ = typed.parent_path();
    } else if (fs::exists(typed, failed)) {
        s_.chosen = typed;
        answer_ = FileBrowser::Answer::chosen;
    } else s_.problem = fmt::format("{} does not exist.", shown(s_.pathField));
}

void FileBrowser::Drawing::switches() {
    const float filterWidth = std::min(em(14), ImGui::GetContentRegionAvail().x * 0.5f);
    iconText(Icon::search, dimColour);
    ImGui::SameLine(0, em(0.3f));
    ImGui::SetNextItemWidth(filterWidth);
    if (inputText("##filter", s_.filter, "Filter")) s_.choose();
    tooltip("Shows only names that contain these letters. Just begin to type; a path begins with / or ~.");
    filterActive_ = ImGui::IsItemActive();
    if (!s_.request.extensions.empty() && s_.request.mode != BrowserRequest::Mode::folder) {
        sameLineIfFits(buttonWidth("All files") + em(1.6f));
        if (checkbox("All files", s_.everything, "Also shows files that are not " + listed(s_.request.extensions)))
            s_.choose();
    }
    if (s_.request.mode != BrowserRequest::Mode::folder) {
        sameLineIfFits(buttonWidth("Expand sequences") + em(1.6f));
        if (checkbox("Expand sequences", s_.separate, "Shows each frame of a numbered sequence in a row of its own"))
            s_.choose();
    }
    sameLineIfFits(buttonWidth("Hidden") + em(1.6f));
    if (checkbox("Hidden", s_.hidden, "Also shows names that begin with a dot")) s_.read();
}

void FileBrowser::Drawing::newFolder() {
    if (s_.request.mode != BrowserRequest::Mode::open) {
        sameLineIfFits(buttonWidth("New folder...") + em(1));
        if (button("New folder...", "Makes a folder here")) ImGui::OpenPopup("##new"), s_.newFolder = "New folder";
        if (ImGui::BeginPopup("##new")) {
            ImGui::SetNextItemWidth(em(14));
            const bool enter = inputText("##name", s_.newFolder, "Name", ImGuiInputTextFlags_EnterReturnsTrue);
            ImGui::SameLine();
            if ((button("Make", "Makes the folder and goes into it") || enter) && !s_.newFolder.empty()) {
                std::error_code failed;
                const fs::path made = s_.folder / s_.newFolder;
                if (fs::create_directory(made, failed); failed)
                    s_.problem = fmt::format("{} cannot be made: {}", s_.newFolder, failed.message());
                else next_ = made;
                ImGui::CloseCurrentPopup();
            }
            ImGui::EndPopup();
        }
    }
}

void FileBrowser::Drawing::places(const std::vector<fs::path>& recent) {
    if (ImGui::GetContentRegionAvail().x > em(34)) {
        if (beginChild("##places", {em(11), height_}, true)) {
            const auto place = [&](const std::string& name, const fs::path& path, Icon icon) {
                if (path.empty()) return;
                ImGui::PushID(path.c_str());
                iconText(icon, dimColour);
                ImGui::SameLine(0, em(0.4f));
                if (ImGui::Selectable(elided(name, ImGui::GetContentRegionAvail().x).c_str(), path == s_.folder))
                    next_ = path;
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
                    if (s_.request.captures && s_.request.mode == BrowserRequest::Mode::open)
                        s_.chosen = path, answer_ = FileBrowser::Answer::chosen;
                    else next_ = path.parent_path();
                }
                tooltip(shown(path));
                ImGui::PopID();
            }
        }
        ImGui::EndChild();
        ImGui::SameLine();
    }
}

void FileBrowser::Drawing::list() {
    if (beginChild("##list", {0, height_}, true)) {
        if (!s_.error.empty()) warningText(s_.error);
        if (s_.reading) dimText("Reading the folder...");
        else if (s_.rows.empty() && s_.error.empty())
            dimWrapped(
                !s_.filter.empty() ? "No name here contains these letters."
                : s_.hiddenByExtension
                    ? fmt::format(
                          "Nothing of the kind looked for; {} other files are here. Tick \"All files\" to see them.",
                          s_.hiddenByExtension)
                    : "This folder is empty.");
        const bool wide = ImGui::GetContentRegionAvail().x > em(26), widest = ImGui::GetContentRegionAvail().x > em(34);
        if (!s_.rows.empty() &&
            ImGui::BeginTable("##files", 1 + wide + widest, ImGuiTableFlags_RowBg | ImGuiTableFlags_PadOuterX)) {
            ImGui::TableSetupColumn("Name", ImGuiTableColumnFlags_WidthStretch);
            if (wide) ImGui::TableSetupColumn("Kind", ImGuiTableColumnFlags_WidthFixed, em(6.5f));
            if (widest) ImGui::TableSetupColumn("Changed", ImGuiTableColumnFlags_WidthFixed, em(8.5f));
            ImGuiListClipper clipper;
            clipper.Begin(int(s_.rows.size()));
            if (s_.scrollToRow && s_.selected >= 0) {
                const float row = ImGui::GetTextLineHeight() + 2 * ImGui::GetStyle().CellPadding.y,
                            y = float(s_.selected) * row;
                if (y < ImGui::GetScrollY() || y + 2 * row > ImGui::GetScrollY() + height_)
                    ImGui::SetScrollY(std::max(0.0f, y - height_ / 2));
                s_.scrollToRow = false;
            }
            const FileEntry* entered = nullptr;
            while (clipper.Step())
                for (int i = clipper.DisplayStart; i < clipper.DisplayEnd; ++i) row(i, wide, widest, entered);
            ImGui::EndTable();
            if (entered) done(s_.enter(*entered));
        }
    }
    ImGui::EndChild();
}

void FileBrowser::Drawing::row(int i, bool wide, bool widest, const FileEntry*& entered) {
    const FileEntry& entry = *s_.rows[size_t(i)];
    const FileDetail& detail = s_.detail(entry);
    ImGui::TableNextRow();
    ImGui::TableNextColumn();
    ImGui::PushID(i);
    const Icon icon = detail.shot                               ? Icon::shot
                      : !detail.capture.empty()                 ? Icon::capture
                      : entry.kind == FileEntry::Kind::folder   ? Icon::folder
                      : entry.kind == FileEntry::Kind::sequence ? Icon::film
                      : hasExtension(entry.path, {".exr", ".hdr", ".png", ".jpg", ".jpeg", ".tif", ".tiff", ".dpx"})
                          ? Icon::image
                          : Icon::file;
    iconText(icon, !detail.capture.empty() || detail.shot ? accentColour : dimColour);
    ImGui::SameLine(0, em(0.4f));
    const std::string words = entry.kind == FileEntry::Kind::sequence && !wide
                                  ? fmt::format("{} ({})", entry.name, entry.members)
                                  : entry.name;
    const std::string row = elided(words, ImGui::GetContentRegionAvail().x) + "##row";
    if (ImGui::Selectable(row.c_str(), i == s_.selected,
                          ImGuiSelectableFlags_SpanAllColumns | ImGuiSelectableFlags_AllowDoubleClick |
                              ImGuiSelectableFlags_DontClosePopups)) {
        s_.selected = i;
        s_.askReplace = false;
        s_.typingPath = false, s_.pathField = shown(s_.folder);
        if (saving_ && entry.kind != FileEntry::Kind::folder) s_.nameField = shown(entry.path.filename());
        if (ImGui::IsMouseDoubleClicked(ImGuiMouseButton_Left)) entered = &entry;
    }
    tooltip(entry.name + (!detail.capture.empty()
                              ? fmt::format("\nA capture ({}): photographs with cameras and a mesh", detail.capture)
                          : detail.shot ? "\nA shot: an estimate with its look"
                                        : ""));
    if (wide) {
        ImGui::TableNextColumn();
        const std::string gaps = entry.last - entry.first + 1 == long(entry.members)
                                     ? fmt::format("{} frames", entry.members)
                                     : fmt::format("{} of {} fr.", entry.members, entry.last - entry.first + 1);
        dimText(detail.shot                               ? "shot"
                : !detail.capture.empty()                 ? "capture"
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

/// Of the file to save.
void FileBrowser::Drawing::name() {
    if (saving_) {
        dimText("Name");
        ImGui::SameLine();
        ImGui::SetNextItemWidth(-FLT_MIN);
        if (s_.focusName) ImGui::SetKeyboardFocusHere(), s_.focusName = false;
        if (inputText("##save name", s_.nameField, "Name of the file", ImGuiInputTextFlags_EnterReturnsTrue))
            enterUsed_ = true, done(s_.confirm());
        if (ImGui::IsItemEdited()) s_.askReplace = false, s_.problem.clear();
        nameActive_ = ImGui::IsItemActive();
    }
}

/// What is wrong, and the buttons.
void FileBrowser::Drawing::buttons() {
    if (!s_.problem.empty()) warningText(s_.problem);
    else if (s_.askReplace) warningText(fmt::format("{} exists already. Replace it?", shown(s_.target().filename())));
    const std::string confirmWord = s_.askReplace ? "Replace" : s_.request.confirm;
    const float buttons = buttonWidth("Cancel") + buttonWidth(confirmWord) + em(2) + ImGui::GetStyle().ItemSpacing.x;
    ImGui::SetCursorPosX(
        std::max(ImGui::GetCursorPosX(), ImGui::GetCursorPosX() + ImGui::GetContentRegionAvail().x - buttons));
    if (button("Cancel", "Closes this without choosing (Esc)", buttonWidth("Cancel") + em(1)))
        answer_ = FileBrowser::Answer::cancelled;
    ImGui::SameLine();
    if (primaryButton(confirmWord.c_str(),
                      s_.askReplace ? "Overwrites what is there"
                      : saving_     ? "Saves under this name (Enter)"
                                    : "Open selected (Enter)",
                      buttonWidth(confirmWord) + em(1))) {
        // A path that was typed, and not yet gone to with Enter, is what is meant.
        if (!saving_ && s_.pathField != shown(s_.folder)) takePath();
        else done(s_.confirm());
    }
}

void FileBrowser::Drawing::keys() {
    if (!pathActive_ && !nameActive_ && !ImGui::IsPopupOpen("##new")) {
        const int rows = int(s_.rows.size()),
                  page = std::max(1, int(height_ / ImGui::GetTextLineHeightWithSpacing()) - 2);
        const auto move = [&](int by) {
            s_.typingPath = false, s_.pathField = shown(s_.folder);
            if (rows)
                s_.selected = std::clamp(s_.selected + by, 0, rows - 1), s_.scrollToRow = true, s_.askReplace = false;
        };
        if (keyPressed(ImGuiKey_DownArrow, true)) move(1);
        if (keyPressed(ImGuiKey_UpArrow, true)) move(s_.selected < 0 ? rows : -1);
        if (keyPressed(ImGuiKey_PageDown, true)) move(page);
        if (keyPressed(ImGuiKey_PageUp, true)) move(-page);
        if (answer_ == FileBrowser::Answer::none && next_.empty() && !enterUsed_ && enterPressed()) {
            if (s_.typingPath) takePath();
            else done(s_.selected >= 0 ? s_.enter(*s_.rows[size_t(s_.selected)]) : s_.confirm());
        }
        if (!filterActive_ && !ImGui::IsAnyItemActive()) {
            if (keyPressed(ImGuiKey_Home)) move(-rows);
            if (keyPressed(ImGuiKey_End)) move(rows);
            if (keyPressed(ImGuiKey_Backspace, true)) {
                std::string& typed = s_.typingPath ? s_.pathField : s_.filter;
                if (typed.empty()) next_ = s_.folder.parent_path();
                else {
                    while (!typed.empty() && (static_cast<unsigned char>(typed.back()) & 0xC0) == 0x80)
                        typed.pop_back();
                    if (!typed.empty()) typed.pop_back();
                    if (!s_.typingPath) s_.choose();
                }
            }
            bool typed = false;
            for (const ImWchar c : ImGui::GetIO().InputQueueCharacters) {
                // A path begins with / or ~, and goes where paths stand.
                if (!s_.typingPath && s_.filter.empty() && (c == '/' || c == '~'))
                    s_.typingPath = true, s_.pathField.clear(), s_.problem.clear();
                if (s_.typingPath && c >= 32 && c < 127) s_.pathField += char(c);
                else if (c > 32 && c < 127 && c != '/') s_.filter += char(c), typed = true;
            }
            if (typed) s_.choose();
        }
    }
}

FileBrowser::Answer FileBrowser::draw(const std::vector<fs::path>& recent) { return Drawing(*state_).draw(recent); }

}  // namespace relamp::ui
