// The desktop window: GLFW, named only in window.cpp, with an OpenGL context. Events come through here.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "base/math.h"

struct GLFWwindow;

namespace relamp::ui {

/// A key that went down, with the text it typed.
struct KeyPress {
    int key = 0;  ///< keys.h
    bool control = false, shift = false, alt = false;
    std::string text;
};

/// A key or character event as GLFW told it.
struct RawKey {
    int key = 0, scancode = 0, action = 0, modifiers = 0;
    unsigned character = 0;                            ///< of a character event; then the others mean nothing
    bool control = false, shift = false, alt = false;  ///< down once the event has happened
};

/// A button of the mouse that went down or up.
struct RawButton {
    int button = 0;
    bool down = false;
    double seconds = 0;  ///< glfwGetTime() then
};

class Window {
public:
    /// Throws Error when there is no display or no OpenGL at all. Asks for OpenGL 4.3 core and takes 3.3 when there is
    /// no newer one, so that the reason can be shown in the window.
    Window(const std::string& title, int width, int height);
    ~Window();
    Window(const Window&) = delete;
    Window& operator=(const Window&) = delete;

    /// Sleeps until something happens, or `seconds` have passed (negative: endless). True when there was an event or a
    /// wake().
    bool wait(double seconds);
    /// From any thread: ends wait().
    static void wake();
    void swap();
    bool closeRequested();  ///< since the last call
    std::vector<std::filesystem::path> takeDropped();
    std::vector<KeyPress> takeKeys();
    /// From now on key events wait for takeRawKeys(), and those of buttons for takeButtons(), instead of going to the
    /// callbacks set before. Called once ImGui has set its own.
    void holdKeys();
    /// The events of one frame: once a key went down nothing is let up in the same frame, neither that key nor the Ctrl
    /// held with it, because ImGui 1.86 would miss it.
    std::vector<RawKey> takeRawKeys();
    bool keysWaiting() const;
    void readModifiers();  ///< into input()
    void setTitle(const std::string& title);
    /// Over the whole monitor it stands on, or back to where it was.
    void setFullScreen(bool on);
    /// Presses and releases of the mouse's buttons for one frame: at most one of each button, so that a click which
    /// began and ended between two frames is seen. Empty: nothing new.
    std::vector<RawButton> takeButtons();
    bool buttonsWaiting() const;
    Vec2 size() const;             ///< screen units
    Vec2 framebufferSize() const;  ///< pixels
    float contentScale() const;    ///< of the monitor: 2 on a HiDPI one
    std::string glVersion() const;
    std::string renderer() const;
    /// The driver has lost everything that was on the GPU; the window must be made anew.
    bool contextLost() const;
    bool minimised() const;
    GLFWwindow* handle() const { return window_; }

private:
    GLFWwindow* window_ = nullptr;
    bool fullScreen_ = false;
    int before_[4] = {0, 0, 0, 0};  ///< place and size outside full screen
};

}  // namespace relamp::ui
