#include "window.h"

#include <epoxy/gl.h>
// after epoxy
#include <GLFW/glfw3.h>

#include <atomic>
#include <cstdlib>
#include <deque>
#include <utility>

#include "base/error.h"
#include "keys.h"

namespace relamp::ui {
namespace {

/// What the callbacks collect between frames. One window at a time.
struct Events {
    bool any = false, close = false;
    std::vector<std::filesystem::path> dropped;
    std::vector<KeyPress> keys;
    std::deque<RawKey> held;
    std::deque<RawButton> buttons;
};
Events events;
std::atomic<bool> woken{false};
std::string lastError;

void appendUtf8(std::string& text, unsigned c) {
    if (c < 0x80) {
        text += char(c);
    } else if (c < 0x800) {
        text += char(0xc0 | c >> 6);
        text += char(0x80 | (c & 0x3f));
    } else {
        text += char(0xe0 | (c >> 12 & 0xf));
        text += char(0x80 | (c >> 6 & 0x3f));
        text += char(0x80 | (c & 0x3f));
    }
}

void noteButton(GLFWwindow*, int button, int action, int) {
    events.any = true;
    if (button >= 0 && button < 5) events.buttons.push_back({button, action == GLFW_PRESS, glfwGetTime()});
}

void setCallbacks(GLFWwindow* window) {
    glfwSetKeyCallback(window, [](GLFWwindow*, int key, int, int action, int mods) {
        events.any = true;
        if (action == GLFW_RELEASE || key < 0) return;
        if (key >= GLFW_KEY_LEFT_SHIFT && key <= GLFW_KEY_RIGHT_SUPER) return;
        events.keys.push_back(
            {key, (mods & GLFW_MOD_CONTROL) != 0, (mods & GLFW_MOD_SHIFT) != 0, (mods & GLFW_MOD_ALT) != 0, {}});
    });
    glfwSetCharCallback(window, [](GLFWwindow*, unsigned c) {
        events.any = true;
        if (events.keys.empty()) events.keys.push_back({});
        appendUtf8(events.keys.back().text, c);
    });
    glfwSetCursorPosCallback(window, [](GLFWwindow*, double, double) { events.any = true; });
    glfwSetCursorEnterCallback(window, [](GLFWwindow*, int) { events.any = true; });
    glfwSetMouseButtonCallback(window, noteButton);
    glfwSetScrollCallback(window, [](GLFWwindow*, double, double) { events.any = true; });
    glfwSetWindowFocusCallback(window, [](GLFWwindow*, int) { events.any = true; });
    glfwSetWindowRefreshCallback(window, [](GLFWwindow*) { events.any = true; });
    glfwSetFramebufferSizeCallback(window, [](GLFWwindow*, int, int) { events.any = true; });
    glfwSetWindowContentScaleCallback(window, [](GLFWwindow*, float, float) { events.any = true; });
    glfwSetWindowIconifyCallback(window, [](GLFWwindow*, int) { events.any = true; });
    glfwSetWindowCloseCallback(window, [](GLFWwindow* w) {
        events.any = events.close = true;
        glfwSetWindowShouldClose(w, GLFW_FALSE);
    });
    glfwSetDropCallback(window, [](GLFWwindow*, int count, const char** paths) {
        events.any = true;
        for (int i = 0; i < count; ++i) events.dropped.emplace_back(paths[i]);
    });
}

}  // namespace

Window::Window(const std::string& title, int width, int height) {
    glfwSetErrorCallback([](int, const char* text) { lastError = text; });
    if (!glfwInit())
        throw Error("there is no display to open a window on ({}); the command line `relamp` works without one",
                    lastError);
    const int versions[][2] = {{4, 6}, {4, 3}, {3, 3}};
    for (const auto& version : versions) {
        glfwDefaultWindowHints();
        glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, version[0]);
        glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, version[1]);
        glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
        glfwWindowHint(GLFW_OPENGL_FORWARD_COMPAT, GLFW_TRUE);
        if (version[0] == 4) glfwWindowHint(GLFW_CONTEXT_ROBUSTNESS, GLFW_LOSE_CONTEXT_ON_RESET);
        glfwWindowHintString(GLFW_X11_CLASS_NAME, "relamp");
        glfwWindowHintString(GLFW_X11_INSTANCE_NAME, "relamp");
        window_ = glfwCreateWindow(width, height, title.c_str(), nullptr, nullptr);
        if (window_) break;
    }
    if (!window_) {
        glfwTerminate();
        throw Error(
            "no OpenGL window could be made ({}); relamp-editor needs OpenGL 4.3, the command line `relamp` needs none",
            lastError);
    }
    glfwSetWindowSizeLimits(window_, 640, 400, GLFW_DONT_CARE, GLFW_DONT_CARE);
    glfwMakeContextCurrent(window_);
    glfwSwapInterval(1);
    setCallbacks(window_);
}

Window::~Window() {
    glfwDestroyWindow(window_);
    glfwTerminate();
}

bool Window::wait(double seconds) {
    events.any = false;
    const bool before = woken.exchange(false);  // since the last wait: counts as much as what comes in this one
    if (before) glfwPollEvents();
    else if (seconds < 0) glfwWaitEvents();
    else if (seconds == 0) glfwPollEvents();
    else glfwWaitEventsTimeout(seconds);
    return woken.exchange(false) || before || events.any;
}

void Window::wake() {
    woken = true;
    glfwPostEmptyEvent();
}

void Window::swap() { glfwSwapBuffers(window_); }

bool Window::closeRequested() { return std::exchange(events.close, false); }
std::vector<std::filesystem::path> Window::takeDropped() { return std::exchange(events.dropped, {}); }
std::vector<KeyPress> Window::takeKeys() { return std::exchange(events.keys, {}); }

void Window::holdKeys() {
    glfwSetKeyCallback(window_, [](GLFWwindow*, int key, int scancode, int action, int modifiers) {
        events.any = true;
        // What is down once this event has happened.
        const auto down = [&](int left, int right, int bit) {
            return key == left || key == right ? action != GLFW_RELEASE : (modifiers & bit) != 0;
        };
        events.held.push_back({key, scancode, action, modifiers, 0,
                               down(GLFW_KEY_LEFT_CONTROL, GLFW_KEY_RIGHT_CONTROL, GLFW_MOD_CONTROL),
                               down(GLFW_KEY_LEFT_SHIFT, GLFW_KEY_RIGHT_SHIFT, GLFW_MOD_SHIFT),
                               down(GLFW_KEY_LEFT_ALT, GLFW_KEY_RIGHT_ALT, GLFW_MOD_ALT)});
    });
    glfwSetCharCallback(window_, [](GLFWwindow*, unsigned c) {
        events.any = true;
        events.held.push_back({.character = c});
    });
    glfwSetMouseButtonCallback(window_, noteButton);
}

std::vector<RawKey> Window::takeRawKeys() {
    // Letters go through as they come: a text field reads their characters. Keys that do something are held for one
    // frame.
    const auto acts = [](const RawKey& k) {
        return !k.character && (k.key < GLFW_KEY_SPACE || k.key > GLFW_KEY_GRAVE_ACCENT ||
                                (k.modifiers & (GLFW_MOD_CONTROL | GLFW_MOD_ALT | GLFW_MOD_SUPER)));
    };
    const auto shift = [](const RawKey& k) { return k.key == GLFW_KEY_LEFT_SHIFT || k.key == GLFW_KEY_RIGHT_SHIFT; };
    std::vector<RawKey> now;
    bool typed = false, wentDown = false;
    while (!events.held.empty()) {
        const RawKey& next = events.held.front();
        const bool down = next.action != GLFW_RELEASE;
        if (acts(next) && !shift(next) && ((!down && wentDown) || (down && typed))) break;
        if (next.character && wentDown) break;
        typed |= next.character != 0;
        wentDown |= acts(next) && !shift(next) && down;
        now.push_back(next);
        events.held.pop_front();
    }
    return now;
}

std::vector<RawButton> Window::takeButtons() {
    std::vector<RawButton> now;
    bool used[5] = {};
    while (!events.buttons.empty() && !used[events.buttons.front().button]) {
        used[events.buttons.front().button] = true;
        now.push_back(events.buttons.front());
        events.buttons.pop_front();
    }
    return now;
}

bool Window::buttonsWaiting() const { return !events.buttons.empty(); }

bool Window::keysWaiting() const { return !events.held.empty(); }

void Window::readModifiers() {
    const auto down = [&](int left, int right) {
        return glfwGetKey(window_, left) == GLFW_PRESS || glfwGetKey(window_, right) == GLFW_PRESS;
    };
    Input& in = input();
    in.control = down(GLFW_KEY_LEFT_CONTROL, GLFW_KEY_RIGHT_CONTROL);
    in.shift = down(GLFW_KEY_LEFT_SHIFT, GLFW_KEY_RIGHT_SHIFT);
    in.alt = down(GLFW_KEY_LEFT_ALT, GLFW_KEY_RIGHT_ALT);
}

void Window::setTitle(const std::string& title) { glfwSetWindowTitle(window_, title.c_str()); }

void Window::setFullScreen(bool on) {
    if (on == fullScreen_) return;
    fullScreen_ = on;
    if (!on) {
        glfwSetWindowMonitor(window_, nullptr, before_[0], before_[1], before_[2], before_[3], GLFW_DONT_CARE);
        return;
    }
    glfwGetWindowPos(window_, &before_[0], &before_[1]);
    glfwGetWindowSize(window_, &before_[2], &before_[3]);
    // The monitor that holds the window's middle.
    const int x = before_[0] + before_[2] / 2, y = before_[1] + before_[3] / 2;
    int count = 0;
    GLFWmonitor** monitors = glfwGetMonitors(&count);
    GLFWmonitor* chosen = glfwGetPrimaryMonitor();
    for (int i = 0; i < count; ++i) {
        int left = 0, top = 0;
        glfwGetMonitorPos(monitors[i], &left, &top);
        const GLFWvidmode* mode = glfwGetVideoMode(monitors[i]);
        if (mode && x >= left && y >= top && x < left + mode->width && y < top + mode->height) chosen = monitors[i];
    }
    const GLFWvidmode* mode = chosen ? glfwGetVideoMode(chosen) : nullptr;
    if (!mode) {
        fullScreen_ = false;
        return;
    }
    glfwSetWindowMonitor(window_, chosen, 0, 0, mode->width, mode->height, mode->refreshRate);
}

Vec2 Window::size() const {
    int w = 0, h = 0;
    glfwGetWindowSize(window_, &w, &h);
    return Vec2(w, h);
}

Vec2 Window::framebufferSize() const {
    int w = 0, h = 0;
    glfwGetFramebufferSize(window_, &w, &h);
    return Vec2(w, h);
}

float Window::contentScale() const {
    float x = 1, y = 1;
    glfwGetWindowContentScale(window_, &x, &y);
    return std::clamp(x, 0.75f, 3.0f);
}

std::string Window::glVersion() const {
    const GLubyte* text = glGetString(GL_VERSION);
    return text ? reinterpret_cast<const char*>(text) : "";
}

std::string Window::renderer() const {
    const GLubyte* text = glGetString(GL_RENDERER);
    return text ? reinterpret_cast<const char*>(text) : "";
}

bool Window::contextLost() const {
    // So that a test can lose a context where no driver ever does.
    static int framesLeft = [] {
        const char* text = std::getenv("RELAMP_TEST_LOSE_CONTEXT");
        return text ? std::atoi(text) : 0;
    }();
    if (framesLeft > 0 && --framesLeft == 0) return true;
    return epoxy_gl_version() >= 45 && glGetGraphicsResetStatus() != GL_NO_ERROR;
}

bool Window::minimised() const { return glfwGetWindowAttrib(window_, GLFW_ICONIFIED) != 0; }

}  // namespace relamp::ui
