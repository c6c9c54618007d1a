// Which dialog is open. One at a time, the most urgent first; the others wait and come back.
#include "panels/dialogs.h"

#include <imgui_internal.h>

#include <map>
#include <utility>

#include "browser/listing.h"
#include "capture/capture_formats.h"
#include "keys.h"
#include "look_files.h"
#include "panels/panels.h"
#include "widgets.h"

namespace relamp::ui {
namespace {
namespace fs = std::filesystem;

/// A browser that a panel asked for, and what to do with the answer.
struct Browsing {
    bool open = false;
    Editor* editor = nullptr;
    FileBrowser browser;
    std::function<void(Editor&, const fs::path&)> chosen;
    /// Where the browser of each purpose stood last, and what was open then.
    std::map<std::string, std::pair<fs::path, fs::path>> stood;
};

fs::path openPath(const Document& document) {
    return document.shotFolder.empty() ? document.captureFolder : document.shotFolder;
}

Browsing& browsing() {
    static Browsing one;
    return one;
}

bool drawBrowser(Editor& editor) {
    Browsing& b = browsing();
    const FileBrowser::Answer answer = b.browser.draw(editor.state.recent);
    if (answer == FileBrowser::Answer::none) return false;
    b.open = false;
    b.stood[b.browser.request().title] = {openPath(editor.state.document), b.browser.folder()};
    const auto chosen = std::move(b.chosen);
    b.chosen = {};
    if (answer == FileBrowser::Answer::chosen && chosen) chosen(editor, b.browser.chosen());
    return true;
}

/// Browsers that the state asks for.
void takeBrowserFlags(Editor& editor) {
    PanelState& panels = editor.state.panels;
    const Document& document = editor.state.document;
    if (std::exchange(panels.openBrowser, false)) {
        BrowserRequest request;
        request.title = "Open a capture or a shot";
        request.captures = true;
        request.extensions = {".json", ".exr", ".hdr", ".xml", ".sfm", ".csv", ".out", ".nvm", ".npy"};
        request.note = fmt::format(
            "A capture is a folder with {}, photographs and a mesh; a shot is what relamp has saved.", captureMarks());
        // Beside what is open; where it stood last, once it was moved away from there.
        const auto stood = browsing().stood.find(request.title);
        if (stood != browsing().stood.end() && stood->second.first == openPath(document))
            request.start = stood->second.second;
        else if (!openPath(document).empty()) request.start = openPath(document).parent_path();
        else if (!editor.state.recent.empty()) request.start = editor.state.recent.front().parent_path();
        else request.start = demoCaptures();
        browse(request, [](Editor& e, const fs::path& path) { e.open(captureFolderOf(path)); });
    }
    if (std::exchange(panels.saveBrowser, false)) {
        BrowserRequest request;
        request.mode = BrowserRequest::Mode::save;
        request.title = "Save the shot";
        request.confirm = "Save";
        request.replacesShots = true;
        request.extensions = {".relamp"};
        request.start =
            !document.shotFolder.empty() ? document.shotFolder.parent_path() : document.captureFolder.parent_path();
        request.name = nameToSave(document);
        request.note =
            "A shot is a folder that holds the recovered light, the surfaces and your edits in open formats.";
        browse(request, [](Editor& e, const fs::path& path) { e.saveAs(path); });
    }
    if (std::exchange(panels.environmentBrowser, false)) {
        BrowserRequest request;
        request.title = "Choose an environment";
        request.confirm = "Use";
        request.extensions = {".exr", ".hdr"};
        request.note = "A latitude-longitude panorama, twice as wide as high (EXR or HDR).";
        if (!editor.look().environment.file.empty()) request.start = editor.look().environment.file.parent_path();
        browse(request, [](Editor& e, const fs::path& path) { e.openEnvironment(path); });
    }
}

/// Where looks lie: beside the last one, else beside the shot.
fs::path folderOfLooks(const Editor& editor) {
    const Document& document = editor.state.document;
    if (!editor.state.recentLooks.empty()) return editor.state.recentLooks.front().parent_path();
    return document.shotFolder.empty() ? document.captureFolder.parent_path() : document.shotFolder.parent_path();
}

void beginLookBrowsers(Editor& editor) {
    PanelState& panels = editor.state.panels;
    if (std::exchange(panels.saveLookBrowser, false)) {
        BrowserRequest request;
        request.mode = BrowserRequest::Mode::save;
        request.title = "Save the look";
        request.confirm = "Save";
        request.extensions = {".json"};
        request.start = folderOfLooks(editor);
        request.name = fs::path(nameToSave(editor.state.document)).stem().string() + " look.json";
        request.note =
            "Lights, environment and keys as they are now. Other shots load it, and so does relamp render --edits.";
        browse(request, saveLook);
    }
    if (std::exchange(panels.loadLookBrowser, false)) {
        BrowserRequest request;
        request.title = "Load a look";
        request.confirm = "Load";
        request.extensions = {".json"};
        request.start = folderOfLooks(editor);
        request.note = "It takes the place of the present look; what this shot lacks of it is named.";
        browse(request, loadLook);
    }
}

/// What a browser asks for to answer a MissingQuestion.
BrowserRequest requestFor(const MissingQuestion& question) {
    using What = MissingQuestion::What;
    BrowserRequest request;
    request.start = question.shot.parent_path();
    if (question.what == What::capture) {
        request.title = "Locate the capture";
        request.captures = true;
        request.note =
            fmt::format("It was {}: a folder with {}, photographs and a mesh.", shown(question.path), captureMarks());
    } else if (question.what == What::environment) {
        request.title = "Locate the environment";
        request.extensions = {".exr", ".hdr"};
        request.note = fmt::format("It was {}.", shown(question.path));
    } else {
        request.title = "Locate the measured materials";
        request.mode = BrowserRequest::Mode::folder;
        request.note = fmt::format("The folder that holds {}.", shown(question.path.filename()));
    }
    request.confirm = "Use";
    return request;
}

struct Dialog {
    const char* title;    ///< with a fixed id after ###
    float width, height;  ///< in font sizes; height 0: as high as its contents
    bool modal;
    bool (*draw)(Editor&);
};

const Dialog recoveryDialog{"Work from before a crash###recovery", 30, 0, true, drawRecoveryOffer};
const Dialog lockedDialog{"Open elsewhere###locked", 32, 0, true, drawLockedQuestion};
const Dialog missingDialog{"Something is missing###missing", 32, 0, true, drawMissingQuestion};
const Dialog panoramaDialog{"What is this panorama?###panorama", 34, 0, true, drawPanoramaQuestion};
const Dialog referenceDialog{"Mark a light reference###reference", 56, 40, true, drawReferenceDialog};
const Dialog plateDialog{"Import plate###plate", 34, 0, true, drawPlateDialog};
const Dialog unsavedDialog{"###unsaved", 28, 0, true, drawUnsavedQuestion};
const Dialog noticeDialog{"###notice", 32, 0, true, drawNotice};
const Dialog browserDialog{"###browser", 58, 36, true, drawBrowser};
const Dialog exportDialog{"Export frames###export", 34, 0, true, drawExportDialog};
const Dialog keysDialog{"Keys###keys", 40, 34, true, drawKeysDialog};
const Dialog aboutDialog{"About relamp###about", 30, 0, true, drawAboutDialog};
const Dialog paletteDialog{"###palette", 34, 22, false, drawCommandPalette};

/// A dialog stands in the middle of the window, whatever becomes of its size and the window's, until it is dragged by
/// its title.
struct Place {
    const Dialog* of = nullptr;
    ImVec2 screen{0, 0};
    bool dragged = false;
} place;

bool movedByHand(const ImVec2& screen, const Dialog* dialog) {
    if (place.of != dialog || place.screen.x != screen.x || place.screen.y != screen.y) place = {dialog, screen, false};
    return place.dragged;
}

void rememberPlace() {
    const ImVec2 at = ImGui::GetWindowPos();
    const ImRect title(at, {at.x + ImGui::GetWindowWidth(), at.y + ImGui::GetFrameHeight()});
    if (ImGui::IsMouseDragging(ImGuiMouseButton_Left) && title.Contains(ImGui::GetIO().MouseClickedPos[0]))
        place.dragged = true;
}

/// A window as high as its contents has no use for a scrollbar, which fractions of a pixel would bring up, unless the
/// screen is too short for it.
bool fitsScreen(const char* title) {
    const ImGuiWindow* window = ImGui::FindWindowByName(title);
    return !window || window->ContentSizeIdeal.y + ImGui::GetFrameHeight() + 2 * ImGui::GetStyle().WindowPadding.y <
                          ImGui::GetIO().DisplaySize.y - em(1);
}

const Dialog* mostUrgent(const Editor& editor) {
    const EditorState& state = editor.state;
    if (state.recovery) return &recoveryDialog;
    if (!state.notices.empty()) return &noticeDialog;
    if (browsing().open && browsing().editor == &editor) return &browserDialog;
    if (state.unsaved) return &unsavedDialog;
    if (state.locked) return &lockedDialog;
    if (state.missing) return &missingDialog;
    if (state.panorama) return &panoramaDialog;
    if (state.marking) return &referenceDialog;
    if (state.plateImport) return &plateDialog;
    if (state.panels.palette) return &paletteDialog;
    if (state.panels.exportFrames) return &exportDialog;
    if (state.panels.keys) return &keysDialog;
    if (state.panels.about) return &aboutDialog;
    return nullptr;
}

}  // namespace

void browse(const BrowserRequest& request, std::function<void(Editor&, const fs::path&)> chosen) {
    Browsing& b = browsing();
    b.browser.begin(request);
    b.chosen = std::move(chosen);
    b.open = true;
    b.editor = nullptr;  // the next drawDialogs takes it
}

bool enterConfirms() {
    const ImGuiContext& context = *ImGui::GetCurrentContext();
    return enterPressed() && !ImGui::IsWindowAppearing() && context.ActiveId == 0 &&
           context.ActiveIdPreviousFrame == 0 && ImGui::IsWindowFocused(ImGuiFocusedFlags_RootAndChildWindows);
}

const fs::path& browserFolder() { return browsing().browser.folder(); }

bool dialogOpen(const Editor& editor) {
    return mostUrgent(editor) != nullptr || editor.state.panels.openBrowser || editor.state.panels.saveBrowser ||
           editor.state.panels.environmentBrowser || editor.state.panels.saveLookBrowser ||
           editor.state.panels.loadLookBrowser;
}

namespace {
/// Menus, combos and other small windows: Esc closes the innermost, and nothing else.
void closeMenuOnEscape(const Editor& editor) {
    const ImVector<ImGuiPopupData>& open = ImGui::GetCurrentContext()->OpenPopupStack;
    if (open.empty() || editor.state.panels.palette || editor.inGesture() || ImGui::IsAnyItemActive()) return;
    const ImGuiWindow* top = open.back().Window;
    if (!top || (top->Flags & ImGuiWindowFlags_Modal) || !escapePressed()) return;
    takeEscape();
    ImGui::ClosePopupToLevel(open.Size - 1, true);
}
}  // namespace

void drawDialogs(Editor& editor) {
    static const Dialog* drawn = nullptr;
    closeMenuOnEscape(editor);
    takeBrowserFlags(editor);
    beginLookBrowsers(editor);
    if (browsing().open && !browsing().editor) browsing().editor = &editor;
    drawImportDoctor(editor);
    const Dialog* dialog = mostUrgent(editor);
    if (drawn && drawn != dialog && ImGui::IsPopupOpen(drawn->title)) {
        // Its reason has gone, or something more urgent came.
        if (drawn->modal ? ImGui::BeginPopupModal(drawn->title, nullptr, ImGuiWindowFlags_NoSavedSettings)
                         : ImGui::BeginPopup(drawn->title)) {
            ImGui::CloseCurrentPopup();
            ImGui::EndPopup();
        }
    }
    drawn = dialog;
    if (dialog) {
        if (!ImGui::IsPopupOpen(dialog->title)) ImGui::OpenPopup(dialog->title);
        const ImVec2 screen = ImGui::GetIO().DisplaySize;
        const float width = std::min(em(dialog->width), screen.x - em(1)),
                    height = dialog->height > 0 ? std::min(em(dialog->height), screen.y - em(2)) : 0;
        ImGui::SetNextWindowSize({width, height}, height > 0 && dialog->modal ? ImGuiCond_Appearing : ImGuiCond_Always);
        const bool moved = dialog->modal && movedByHand(screen, dialog);
        ImGui::SetNextWindowPos({screen.x / 2, dialog->modal ? screen.y / 2 : em(4)},
                                moved ? ImGuiCond_Appearing : ImGuiCond_Always, {0.5f, dialog->modal ? 0.5f : 0.0f});
        ImGui::SetNextWindowSizeConstraints({std::min(width, em(18)), std::min(em(6), screen.y)},
                                            {screen.x, screen.y - em(1)});
        std::string title = dialog->title;
        if (dialog == &browserDialog) title = browsing().browser.request().title + title;
        if (dialog == &unsavedDialog)
            title = (editor.state.unsaved->edits                                ? "Save first?"
                     : editor.state.unsaved->estimating                         ? "Stop the estimate?"
                     : editor.state.unsaved->running == JobStatus::Kind::search ? "Stop the search?"
                                                                                : "Stop the export?") +
                    title;
        if (dialog == &noticeDialog) title = shown(editor.state.notices.front().title) + title;
        ImGuiWindowFlags flags = ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoCollapse;
        if (height == 0) flags |= ImGuiWindowFlags_NoResize;
        if (height == 0 && fitsScreen(dialog->title)) flags |= ImGuiWindowFlags_NoScrollbar;
        const bool visible = dialog->modal ? ImGui::BeginPopupModal(title.c_str(), nullptr, flags)
                                           : ImGui::BeginPopup(title.c_str(), flags);
        if (visible) {
            if (dialog->modal) rememberPlace();
            if (dialog->draw(editor)) ImGui::CloseCurrentPopup();
            ImGui::EndPopup();
        } else if (!dialog->modal) {
            editor.state.panels.palette = false;  // a click beside it
        }
    }
    settleGestures(editor);
}

std::string nameToSave(const Document& document) {
    fs::path name = document.name();
    while (name.extension() == ".relamp") name = name.stem();
    return name.string() + ".relamp";
}

// ---- the small ones

bool drawNotice(Editor& editor) {
    auto& notices = editor.state.notices;
    if (notices.empty()) return true;
    const Notice notice = notices.front();
    wrapped(shown(notice.text));
    if (!notice.advice.empty()) {
        ImGui::Spacing();
        dimWrapped(shown(notice.advice));
    }
    ImGui::Spacing();
    const bool ok = primaryButton("OK", "Closes this message", em(7));
    bool undo = false;
    if (notice.ofAnEdit && editor.history().canUndo()) {
        ImGui::SameLine();
        undo = button("Undo", "Takes the edit back (Ctrl+Z)", em(7)) || (input().control && input().pressed == 'Z');
    }
    if (notices.size() > 1) {
        ImGui::SameLine();
        dimText(fmt::format("{} more", notices.size() - 1));
    }
    if (!ok && !undo && !(enterPressed() && !ImGui::IsWindowAppearing()) && !escapePressed()) return false;
    if (undo) editor.undo();
    notices.erase(notices.begin());
    return true;
}

bool drawUnsavedQuestion(Editor& editor) {
    if (!editor.state.unsaved) return true;
    if (editor.state.unsaved->estimating && !editor.job()) {
        // It has come to its end while this was asked: its answer is not saved.
        editor.state.unsaved->estimating = false;
        editor.state.unsaved->edits = editor.unsavedChanges();
    }
    if (!editor.job()) editor.state.unsaved->running.reset();
    if (!editor.state.unsaved->estimating && !editor.state.unsaved->running && !editor.state.unsaved->edits) {
        editor.answerUnsaved(false, true);  // nothing is left to be lost
        return true;
    }
    const UnsavedQuestion question = *editor.state.unsaved;
    const char* then = question.then == UnsavedQuestion::Then::open   ? "before opening something else"
                       : question.then == UnsavedQuestion::Then::quit ? "before you leave"
                                                                      : "before closing";
    if (question.estimating)
        wrapped(
            "An estimate is running. Leaving ends it; how far it came is kept, and relamp offers to go on with it next "
            "time.");
    if (question.running == JobStatus::Kind::exportFrames)
        wrapped("Frames are being exported. Leaving ends it; frames that are finished stay.");
    if (question.running == JobStatus::Kind::search)
        wrapped("A search for an off-camera light is running. Leaving ends it.");
    if (question.edits)
        wrapped(
            fmt::format("{} has edits that are not saved. Save them {}?", shown(editor.state.document.name()), then));
    ImGui::Spacing();
    const auto answer = [&](bool save, bool proceed) {
        editor.answerUnsaved(save, proceed);
        return true;
    };
    const bool enter = enterPressed() && !ImGui::IsWindowAppearing();
    if (question.edits) {
        if (primaryButton("Save", "Saves the shot, then goes on", em(7)) || enter) return answer(true, true);
        sameLineIfFits(em(8));
        if (button("Don't save", "Goes on; the edits are lost", em(8))) return answer(false, true);
        sameLineIfFits(em(7));
    } else {
        if (primaryButton("Leave", "Ends what is running and closes the window", em(7)) || enter)
            return answer(false, true);
        sameLineIfFits(em(10));
    }
    if (button(question.edits        ? "Cancel"
               : question.estimating ? "Keep estimating"
                                     : "Stay",
               "Stays here (Esc)", question.edits ? em(7) : em(10)) ||
        escapePressed())
        return answer(false, false);
    return false;
}

bool drawLockedQuestion(Editor& editor) {
    if (!editor.state.locked) return true;
    const LockedQuestion question = *editor.state.locked;
    wrapped("This shot is open already. If both save, one loses what the other did.");
    ImGui::Spacing();
    fact("Shot", shown(question.path.string()));
    fact("Open by", shown(question.owner));
    ImGui::Spacing();
    const auto answer = [&](LockedAnswer given) {
        editor.answerLocked(given);
        return true;
    };
    if (primaryButton("Open read-only", "Shows it; saving asks for another place", em(9)) ||
        (enterPressed() && !ImGui::IsWindowAppearing()))
        return answer(LockedAnswer::readOnly);
    sameLineIfFits(em(9));
    if (button("Open a copy", "Saves a copy beside it and opens that", em(9))) return answer(LockedAnswer::copy);
    sameLineIfFits(em(7));
    if (button("Cancel", "Opens nothing (Esc)", em(7)) || escapePressed()) return answer(LockedAnswer::cancel);
    return false;
}

bool drawMissingQuestion(Editor& editor) {
    if (!editor.state.missing) return true;
    const MissingQuestion question = *editor.state.missing;
    using What = MissingQuestion::What;
    const char* const what = question.what == What::capture       ? "capture"
                             : question.what == What::environment ? "environment image"
                                                                  : "measured material";
    wrapped(
        fmt::format("The {} of this shot is not where it was. The shot or the {} may have been moved.", what, what));
    ImGui::Spacing();
    fact("Shot", shown(question.shot));
    fact("Looked for", shown(question.path));
    ImGui::Spacing();
    const std::string locate = question.what == What::capture ? "Locate capture..." : "Locate...";
    if (primaryButton(locate.c_str(), "Shows where it is now, then opens the shot", em(10)) ||
        (enterPressed() && !ImGui::IsWindowAppearing())) {
        browse(requestFor(question),
               [](Editor& e, const fs::path& path) { e.answerMissing(MissingAnswer::located, path); });
        return true;
    }
    if (question.what != What::measured) {
        const bool capture = question.what == What::capture;
        sameLineIfFits(em(13));
        if (button(capture ? "Open without photographs" : "Use the recovered one",
                   capture ? "The shot can be relit and exported; estimating again needs its capture"
                           : "Opens the shot under the environment that was recovered",
                   em(13))) {
            editor.answerMissing(MissingAnswer::without);
            return true;
        }
    }
    sameLineIfFits(em(7));
    if (button("Cancel", "Opens nothing (Esc)", em(7)) || escapePressed()) {
        editor.answerMissing(MissingAnswer::cancel);
        return true;
    }
    return false;
}

bool drawRecoveryOffer(Editor& editor) {
    if (!editor.state.recovery) return true;
    const RecoveryOffer offer = *editor.state.recovery;
    wrapped("relamp ended without being closed. Your work was kept:");
    ImGui::Spacing();
    fact("Project", shown(offer.project));
    if (!offer.time.empty()) fact("Last kept", shown(offer.time));
    if (!offer.stage.empty()) fact("Was running", shown(offer.stage), "What was being calculated when it ended");
    ImGui::Spacing();
    static bool sure = false;
    if (ImGui::IsWindowAppearing()) sure = false;
    if (sure) warningText("Discarded work cannot be brought back.");
    if (primaryButton("Restore", "Opens the project with the edits that were kept", em(8)) ||
        (enterPressed() && !ImGui::IsWindowAppearing())) {
        editor.answerRecovery(true);
        return true;
    }
    ImGui::SameLine();
    if (button(sure ? "Discard it###discard" : "Discard...###discard",
               "Throws the kept edits away; files on disk stay as they are", em(8)) &&
        std::exchange(sure, !sure)) {
        editor.answerRecovery(false);
        return true;
    }
    return false;
}

}  // namespace relamp::ui
