// Dear ImGui's context, fonts and drawing. The only place that knows its backends and its font calls.
#pragma once
#include <cstdint>
#include <memory>
#include <string>

namespace relamp::ui {

class Window;
struct KeptInterface;

/// Two presses of a button make a double click by when they happened, not by when a slow frame came to see them.
class DoubleClicks {
public:
    /// This press, `seconds` after any start, is the second one of a pair.
    bool second(int button, double seconds) {
        double& before = pressedAt_[button];
        const bool pair = seconds - before < 0.4;
        before = pair ? -1e6 : seconds;  // a third press begins another pair
        return pair;
    }

private:
    double pressedAt_[5] = {-1e6, -1e6, -1e6, -1e6, -1e6};
};

class Gui {
public:
    /// The window's context must be current and its callbacks set: ImGui's chain behind them.
    explicit Gui(Window& window);
    ~Gui();
    Gui(const Gui&) = delete;
    Gui& operator=(const Gui&) = delete;

    /// Loads fonts for this scale and density when they changed. `density` = framebuffer pixels per screen unit.
    void setScale(float scale, float density);
    /// `menuKeys`: as for beginGuiFrame().
    void beginFrame(bool menuKeys);
    /// Draws everything over a clear background. With `changing`, the texture of an image that is new in each frame,
    /// what looks as in the frame before is not drawn again.
    void endFrame(int framebufferWidth, int framebufferHeight, uint64_t changing = 0);
    /// Ends a frame of which nothing is drawn.
    void skipFrame();
    /// A text field has the keyboard.
    bool typing() const;
    /// A menu, a dialog or a combo is open.
    bool popupOpen() const;
    /// Esc closed a menu in this frame: the key is used up.
    bool escapeUsed() const { return escapeUsed_; }

private:
    Window& window_;
    std::unique_ptr<KeptInterface> kept_;
    void drawChanged(int width, int height, uint64_t changing);
    float scale_ = 0, density_ = 0;
    bool escapeUsed_ = false;
    bool down_[5] = {};  ///< buttons of the mouse
    DoubleClicks clicks_;
};

/// Begins a frame of Dear ImGui. While a menu or a combo is open, the arrow keys go through it, Enter chooses and Esc
/// closes it; elsewhere keys are commands. `menuKeys` false: what is open has keys of its own. True: Esc closed a menu.
bool beginGuiFrame(bool menuKeys);

/// For tests without a window: a context with its font atlas built.
void createHeadlessGui(float width, float height);
void destroyHeadlessGui();

}  // namespace relamp::ui
