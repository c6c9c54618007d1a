// Dear ImGui's context, fonts and drawing. The only place that knows its backends and its font calls.
#pragma once
#include <string>

namespace relamp::ui {

class Window;

class Gui {
public:
    /// The window's context must be current and its callbacks set: ImGui's chain behind them.
    explicit Gui(Window& window);
    ~Gui();
    Gui(const Gui&) = delete;
    Gui& operator=(const Gui&) = delete;

    /// Loads fonts for this scale and density when they changed. `density` = framebuffer pixels per screen unit.
    void setScale(float scale, float density);
    void beginFrame();
    /// Draws everything over a clear background.
    void endFrame(int framebufferWidth, int framebufferHeight);
    /// Ends a frame of which nothing is drawn.
    void skipFrame();
    /// A text field has the keyboard.
    bool typing() const;
    /// A menu, a dialog or a combo is open.
    bool popupOpen() const;

private:
    Window& window_;
    float scale_ = 0, density_ = 0;
    bool down_[5] = {};                                     ///< buttons of the mouse
    double pressedAt_[5] = {-1e6, -1e6, -1e6, -1e6, -1e6};  ///< glfwGetTime() of the first click of a pair
};

/// For tests without a window: a context with its font atlas built.
void createHeadlessGui(float width, float height);
void destroyHeadlessGui();

}  // namespace relamp::ui
