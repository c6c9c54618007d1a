// Dear ImGui without a window, with a mouse and keys that tests move, and an editor with a small solved scene behind
// it.
#pragma once
#include <gtest/gtest.h>

#include <imgui.h>
#include <imgui_internal.h>

#include <chrono>
#include <functional>
#include <initializer_list>
#include <optional>
#include <thread>

#include "gui.h"
#include "keys.h"
#include "panels/panels.h"
#include "support/known_world.h"
#include "support/temporary_folder.h"
#include "widgets.h"

namespace relamp::ui::test {

using relamp::test::TemporaryFolder;

/// One small capture for all tests of this program run, and its draft estimate as a shot.
struct PaintedRoom {
    TemporaryFolder folder;
    std::filesystem::path capture, shot;
    PaintedRoom() : capture(folder / "room"), shot(folder / "room.relamp") { relamp::test::paintSmallWorld(capture); }
    static PaintedRoom& get() {
        static PaintedRoom room;
        return room;
    }
};

/// Keys that ImGui reads by itself, by their code.
inline const std::vector<std::pair<ImGuiKey, int>>& imguiKeys() {
    static const std::vector<std::pair<ImGuiKey, int>> keys{
        {ImGuiKey_Escape, int(keyEscape)},       {ImGuiKey_Enter, int(keyEnter)},
        {ImGuiKey_UpArrow, int(keyUp)},          {ImGuiKey_DownArrow, int(keyDown)},
        {ImGuiKey_Backspace, int(keyBackspace)}, {ImGuiKey_LeftArrow, int(keyLeft)},
        {ImGuiKey_RightArrow, int(keyRight)},    {ImGuiKey_Space, int(keySpace)}};
    return keys;
}
#if IMGUI_VERSION_NUM >= 18700
inline ImGuiKey imguiKey(int code) {
    for (const auto& [name, key] : imguiKeys())
        if (key == code) return name;
    return ImGuiKey_F12;  // no panel asks ImGui for the others
}
#endif

class Panels {
public:
    TemporaryFolder folder;
    std::unique_ptr<Editor> editor;

    explicit Panels(float width = 1000, float height = 700) {
        createHeadlessGui(width, height);
        ImGuiIO& io = ImGui::GetIO();
        io.DeltaTime = 1.0f / 60;
#if IMGUI_VERSION_NUM < 18700
        for (const auto& [name, key] : imguiKeys()) io.KeyMap[name] = key;
#else
        io.ConfigInputTrickleEventQueue = false;
#endif
        EditorOptions options;
        options.configFolder = folder / "config";
        options.stateFolder = folder / "state";
        options.autosaveSeconds = 1e6;
        editor = std::make_unique<Editor>(options);
        editor->state.solve.quality = "draft";
        mouse({-1000, -1000});
    }
    ~Panels() {
        editor.reset();
        input() = {};
        destroyHeadlessGui();
    }

    void until(const std::function<bool()>& done) {
        const auto start = std::chrono::steady_clock::now();
        while (!done()) {
            editor->poll();
            ASSERT_LT(std::chrono::steady_clock::now() - start, std::chrono::minutes(30)) << "waited too long";
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
        }
    }
    void openCapture() {
        editor->openNow(PaintedRoom::get().capture);
        until([&] { return !editor->job(); });
    }
    /// The solved scene; solved once and then read back.
    void openSolved() {
        PaintedRoom& room = PaintedRoom::get();
        if (!std::filesystem::exists(room.shot)) {
            openCapture();
            editor->solve(editor->state.solve);
            until([&] { return !editor->job() && editor->estimate(); });
            editor->saveAs(room.shot);
            until([&] { return !editor->unsavedChanges(); });
        } else {
            editor->openNow(room.shot);
            until([&] { return !editor->job() && editor->estimate(); });
        }
        ASSERT_FALSE(editor->emitters().empty());
    }

    /// One frame: `draw` inside a plain window, then the dialogs.
    void frame(const std::function<void()>& draw) {
        last_ = draw;
        if (beginGuiFrame(!editor->state.panels.palette)) input().pressed = 0;
        beginPanelFrame();
        ImGui::SetNextWindowPos({0, 0});
        ImGui::SetNextWindowSize(size_.x > 0 ? size_ : ImGui::GetIO().DisplaySize);
        ImGui::Begin("test", nullptr,
                     ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings |
                         ImGuiWindowFlags_NoBringToFrontOnFocus);
        window_ = ImGui::GetCurrentWindow();
        if (draw) draw();
        ImGui::End();
        drawDialogs(*editor);
        ImGui::Render();
        input().pressed = 0;
    }
    /// One frame of it; what it writes.
    std::string wordsOf(const std::function<void()>& draw) {
        std::string words;
        frame([&] {
            ImGui::LogToBuffer();
            draw();
            words = ImGui::GetCurrentContext()->LogBuffer.c_str();
            ImGui::LogFinish();
        });
        last_ = draw;
        return words;
    }
    void frames(int count = 3) {
        for (int i = 0; i < count; ++i) frame(last_);
    }
    /// Size of the plain window; 0: the whole screen.
    void windowSize(float width, float height) { size_ = {width, height}; }

    void mouse(const ImVec2& at) { ImGui::GetIO().MousePos = at; }
    void press(bool down, int which = 0) {
        ImGui::GetIO().MouseDown[which] = down;
        frame(last_);
    }
    void click(const ImVec2& at) {
        mouse(at);
        frames(2);
        press(true);
        press(false);
        frames(2);
    }
    void key(int code) {
        input().pressed = code;
#if IMGUI_VERSION_NUM < 18700
        ImGui::GetIO().KeysDown[code] = true;
        frame(last_);
        ImGui::GetIO().KeysDown[code] = false;
#else
        ImGui::GetIO().AddKeyEvent(imguiKey(code), true);
        frame(last_);
        ImGui::GetIO().AddKeyEvent(imguiKey(code), false);
#endif
        frame(last_);
    }
    void shift(bool down) {
#if IMGUI_VERSION_NUM < 18700
        ImGui::GetIO().KeyShift = down;
#else
        ImGui::GetIO().AddKeyEvent(ImGuiMod_Shift, down);
#endif
    }
    void type(const std::string& words) {
        ImGui::GetIO().AddInputCharactersUTF8(words.c_str());
        frames(2);
    }

    /// Id of a control by the names on the way to it, from the window with this name.
    static ImGuiID idOf(const char* window, std::initializer_list<const char*> path) {
        ImGuiID id = ImHashStr(window, 0);
        for (const char* name : path) id = ImHashStr(name, 0, id);
        return id;
    }
    /// Where the control is: the pointer is moved over the window until it answers.
    std::optional<ImVec2> find(ImGuiID id, float step = 5) {
        const ImVec2 screen = ImGui::GetIO().DisplaySize;
        for (float y = step / 2; y < screen.y; y += step)
            for (float x = step / 2; x < screen.x; x += 2 * step) {
                mouse({x, y});
                frame(last_);
                if (ImGui::GetCurrentContext()->HoveredId == id) return ImVec2(x + 3, y + 3);
            }
        return {};
    }

private:
    std::function<void()> last_;
    ImVec2 size_{0, 0};
    ImGuiWindow* window_ = nullptr;
};

}  // namespace relamp::ui::test
