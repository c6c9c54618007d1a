// Which dialog is open. One at a time, the most urgent first; the others wait and come back.
#include "panels/dialogs.h"

#include <utility>

#include "actions.h"
#include "browser/listing.h"
#include "capture/capture_formats.h"
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
};
Browsing& browsing() {
    static Browsing one;
    return one;
}

bool drawBrowser(Editor& editor) {
    Browsing& b = browsing();
    const FileBrowser::Answer answer = b.browser.draw(editor.state.recent);
    if (answer == FileBrowser::Answer::none) return false;
    b.open = false;
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
        request.extensions = {".json", ".exr", ".hdr"};
        request.note = fmt::format(
            "A capture is a folder with {}, photographs and a mesh; a shot is what relamp has saved.", captureMarks());
        if (!document.captureFolder.empty()) request.start = document.captureFolder.parent_path();
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
        request.name = document.name() + ".relamp";
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
        browse(request, [](Editor& e, const fs::path& path) { e.open(path); });
    }
}

struct Dialog {
    const char* title;    ///< with a fixed id after ###
    float width, height;  ///< in font sizes; height 0: as high as its contents
    bool modal;
    bool (*draw)(Editor&);
};

const Dialog recoveryDialog{"Work from before a crash###recovery", 30, 0, true, drawRecoveryOffer};
const Dialog lockedDialog{"Open elsewhere###locked", 32, 0, true, drawLockedQuestion};
const Dialog unsavedDialog{"Save first?###unsaved", 28, 0, true, drawUnsavedQuestion};
const Dialog noticeDialog{"###notice", 32, 0, true, drawNotice};
const Dialog browserDialog{"###browser", 58, 36, true, drawBrowser};
const Dialog exportDialog{"Export frames###export", 34, 0, true, drawExportDialog};
const Dialog keysDialog{"Keys###keys", 40, 34, true, drawKeysDialog};
const Dialog aboutDialog{"About relamp###about", 30, 0, true, drawAboutDialog};
const Dialog paletteDialog{"###palette", 34, 22, false, drawCommandPalette};

const Dialog* mostUrgent(const Editor& editor) {
    const EditorState& state = editor.state;
    if (state.recovery) return &recoveryDialog;
    if (!state.notices.empty()) return &noticeDialog;
    if (browsing().open && browsing().editor == &editor) return &browserDialog;
    if (state.unsaved) return &unsavedDialog;
    if (state.locked) return &lockedDialog;
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

bool dialogOpen(const Editor& editor) {
    return mostUrgent(editor) != nullptr || editor.state.panels.openBrowser || editor.state.panels.saveBrowser ||
           editor.state.panels.environmentBrowser;
}

void drawDialogs(Editor& editor) {
    static const Dialog* drawn = nullptr;
    takeBrowserFlags(editor);
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
        ImGui::SetNextWindowPos({screen.x / 2, dialog->modal ? screen.y / 2 : em(4)},
                                dialog->modal ? ImGuiCond_Appearing : ImGuiCond_Always,
                                {0.5f, dialog->modal ? 0.5f : 0.0f});
        ImGui::SetNextWindowSizeConstraints({std::min(width, em(18)), std::min(em(6), screen.y)},
                                            {screen.x, screen.y - em(1)});
        std::string title = dialog->title;
        if (dialog == &browserDialog) title = browsing().browser.request().title + title;
        if (dialog == &noticeDialog) title = shown(editor.state.notices.front().title) + title;
        const ImGuiWindowFlags flags = ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoCollapse |
                                       (height > 0 ? 0 : ImGuiWindowFlags_NoResize);
        const bool visible = dialog->modal ? ImGui::BeginPopupModal(title.c_str(), nullptr, flags)
                                           : ImGui::BeginPopup(title.c_str(), flags);
        if (visible) {
            if (dialog->draw(editor)) ImGui::CloseCurrentPopup();
            ImGui::EndPopup();
        } else if (!dialog->modal) {
            editor.state.panels.palette = false;  // a click beside it
        }
    }
    settleGestures(editor);
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
    if (notices.size() > 1) {
        ImGui::SameLine();
        dimText(fmt::format("{} more", notices.size() - 1));
    }
    if (!ok && !(enterPressed() && !ImGui::IsWindowAppearing()) && !escapePressed()) return false;
    notices.erase(notices.begin());
    return true;
}

bool drawUnsavedQuestion(Editor& editor) {
    if (!editor.state.unsaved) return true;
    const UnsavedQuestion question = *editor.state.unsaved;
    const char* then = question.then == UnsavedQuestion::Then::open   ? "before opening something else"
                       : question.then == UnsavedQuestion::Then::quit ? "before you leave"
                                                                      : "before closing";
    wrapped(fmt::format("{} has edits that are not saved. Save them {}?", shown(editor.state.document.name()), then));
    ImGui::Spacing();
    const auto answer = [&](bool save, bool proceed) {
        editor.answerUnsaved(save, proceed);
        return true;
    };
    if (primaryButton("Save", "Saves the shot, then goes on", em(7))) return answer(true, true);
    sameLineIfFits(em(8));
    if (button("Don't save", "Goes on; the edits are lost", em(8))) return answer(false, true);
    sameLineIfFits(em(7));
    if (button("Cancel", "Stays here (Esc)", em(7)) || escapePressed()) return answer(false, false);
    if (enterPressed() && !ImGui::IsWindowAppearing()) return answer(true, true);
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

bool drawRecoveryOffer(Editor& editor) {
    if (!editor.state.recovery) return true;
    const RecoveryOffer offer = *editor.state.recovery;
    wrapped("relamp ended without being closed. Your work was kept:");
    ImGui::Spacing();
    fact("Project", shown(offer.project));
    if (!offer.time.empty()) fact("Last kept", shown(offer.time));
    if (!offer.stage.empty()) fact("Was running", shown(offer.stage), "What was being calculated when it ended");
    ImGui::Spacing();
    if (primaryButton("Restore", "Opens the project with the edits that were kept", em(8)) ||
        (enterPressed() && !ImGui::IsWindowAppearing())) {
        editor.answerRecovery(true);
        return true;
    }
    ImGui::SameLine();
    if (button("Discard", "Throws the kept edits away; files on disk stay as they are", em(8))) {
        editor.answerRecovery(false);
        return true;
    }
    return false;
}

bool drawKeysDialog(Editor& editor) {
    static std::string filter;
    ImGui::SetNextItemWidth(-FLT_MIN);
    inputText("##filter", filter, "Filter");
    tooltip("Shows only commands and keys that contain this");
    const float below = ImGui::GetFrameHeightWithSpacing();
    if (beginChild("##keys", {0, -below})) {
        std::string menu;
        const auto matches = [&](const std::string& a, const std::string& b) {
            return filter.empty() || fuzzyScore(a, filter) > 0 || fuzzyScore(b, filter) > 0;
        };
        const auto keysOf = [](const Action& action) {
            std::string keys;
            for (const KeyChord& chord : action.keys) keys += (keys.empty() ? "" : ", ") + chord.text();
            return keys;
        };
        float column = em(10);
        for (const Action& action : actions())
            column = std::max(column, ImGui::CalcTextSize(keysOf(action).c_str()).x + em(1.5f));
        const auto row = [&](const std::string& keys, const std::string& label, const std::string& explanation) {
            const float left = ImGui::GetCursorPosX();
            text(keys);
            ImGui::SameLine(left + column);
            wrapped(label);
            tooltip(explanation);
        };
        for (const Action& action : actions()) {
            const std::string keys = keysOf(action);
            if (keys.empty() || !matches(action.label, keys)) continue;
            if (action.menu != menu) heading((menu = action.menu).empty() ? "Other" : menu);
            row(keys, action.label, action.explanation);
        }
        const struct {
            const char* keys;
            const char* label;
        } hands[] = {{"G, R, S", "Move, turn or scale the selected lights with the hand"},
                     {"X, Y, Z", "while moving: along this axis only"},
                     {"0-9", "while moving: type the amount"},
                     {"Ctrl", "while moving: snap"},
                     {"Shift", "while moving: fine"},
                     {"Esc", "while dragging anything: take it back"},
                     {"Middle drag", "Rotate the view (or Alt and left)"},
                     {"Shift+Middle", "Shift the view"},
                     {"Wheel", "Nearer or farther"}};
        heading("In the viewport");
        for (const auto& hand : hands)
            if (matches(hand.label, hand.keys)) row(hand.keys, hand.label, "");
    }
    ImGui::EndChild();
    const bool close = button("Close", "Closes this page (Esc)", em(7));
    if (!close && !escapePressed()) return false;
    editor.state.panels.keys = false;
    filter.clear();
    return true;
}

#ifndef RELAMP_VERSION
#define RELAMP_VERSION "0.1"
#endif

bool drawAboutDialog(Editor& editor) {
    text("relamp " RELAMP_VERSION);
    dimWrapped("To relamp is to change the lights of a fixture; here, of a captured scene.");
    ImGui::Spacing();
    wrapped(
        "It separates photographs of a scene into the light, near and far, and the reflectance of the surfaces, and "
        "lets you light the scene anew.");
    ImGui::Spacing();
    dimWrapped(
        "After J. Put, N. Michiels, P. Bekaert: Using near-field light sources to separate illumination from BRDF, "
        "BMVC 2015. The full bibliography is in core/README.md.");
    if (!editor.state.gpu.empty()) fact("Graphics", shown(editor.state.gpu));
    fact("Dear ImGui", ImGui::GetVersion());
    ImGui::Spacing();
    if (!button("Close", "Closes this page (Esc)", em(7)) && !escapePressed()) return false;
    editor.state.panels.about = false;
    return true;
}

}  // namespace relamp::ui
