// Small controls that every panel uses, and the one place where versions of Dear ImGui differ. Sizes are multiples of
// the font size, so that they follow the scale of the screen.
#pragma once
#include <imgui.h>

#include <filesystem>
#include <functional>
#include <string>

#include "editor.h"
#include "icons.h"
#include "theme.h"

namespace relamp::ui {

// ---- what changed between versions of Dear ImGui
bool beginChild(const char* id, const ImVec2& size, bool border = false, ImGuiWindowFlags flags = 0);
ImTextureID textureId(uint64_t texture);
/// One of ImGui's own named keys.
bool keyPressed(ImGuiKey key, bool repeat = false);
/// Esc in this frame, from ImGui's keys or the window's.
bool escapePressed();
/// Nothing else in this frame takes it for its own.
void takeEscape();
/// A menu took it before the frame began.
void menuTookEscape();
bool enterPressed();
bool inputText(const char* label, std::string& text, const char* hint = "", ImGuiInputTextFlags flags = 0);

// ---- text
/// Multiples of the font size.
float em(float n);
/// A name that may not be UTF-8, fit for the screen: bytes that are not become '?'.
std::string shown(const std::string& bytes);
std::string shown(const std::filesystem::path& path);
/// Cut to `width` pixels with "..." in the middle (or at the end).
std::string elided(const std::string& text, float width, bool middle = true);
void text(const std::string& text);
void dimText(const std::string& text);
void wrapped(const std::string& text);
void dimWrapped(const std::string& text);
void warningText(const std::string& text);  ///< wrapped, with a triangle
/// "Name   value", the value wrapped in the rest of the line.
void fact(const std::string& name, const std::string& value, const std::string& explanation = {});
/// Explains the item drawn last when the pointer rests on it; works on disabled items too.
void tooltip(const std::string& text);
/// "1 min 5 s", "0.4 s", "2 h 3 min".
std::string duration(double seconds);
/// "12.5 MiB", "1.2 GiB".
std::string mebibytes(double mib);
/// "12 345".
std::string count(size_t n);
std::string percent(double fraction);
/// "+1.5", "0.0".
std::string signedStops(float stops);
/// Three digits, never "-0".
std::string number(double value);

// ---- layout
/// A foldable section; true when open.
bool section(const char* title, const std::string& explanation, bool open = true);
void heading(const std::string& title);
/// Puts the next item on the same line when `width` pixels are still free there.
void sameLineIfFits(float width);
float buttonWidth(const std::string& label);
/// A handle between two areas, `length` pixels long; changes `value` (pixels at scale 1) within the limits while
/// dragged.
bool splitter(const char* id, bool vertical, float length, float& value, float least, float most, float direction,
              float scale);

// ---- controls
bool button(const char* label, const std::string& explanation, float width = 0);
/// The one button of a panel that matters most.
bool primaryButton(const char* label, const std::string& explanation, float width = 0);
bool iconButton(const char* id, Icon icon, const std::string& explanation, bool on = false, float size = 0);
/// Icon with a word.
bool iconTextButton(const char* label, Icon icon, const std::string& explanation, bool on = false, float width = 0);
bool checkbox(const char* label, bool& value, const std::string& explanation);
bool radio(const char* label, bool on, const std::string& explanation);
/// Icon at the cursor, as large as a line of text.
void iconText(Icon icon, const ImVec4& colour);
/// A small rounded label.
void badge(const std::string& label, const ImVec4& colour, const std::string& explanation);
/// A bar of `fraction` of the width with text over it; `fraction` < 0: it runs, nobody knows how far it is.
void bar(double fraction, const ImVec4& colour, const std::string& label, float width = -1);
inline const ImVec4 progressColour{0.28f, 0.42f, 0.58f, 1};
/// "about 40 s left", "stopping...", "paused", "finishing", or how long it has run.
std::string timeLeftWords(const JobStatus& job);
/// A filled square; true when clicked.
bool swatch(const char* id, const ImVec4& colour, float size, const std::string& explanation);
/// An image of `width` by `height` pixels, or a grey box with `missing` where there is no texture. True when clicked.
bool image(const char* id, uint64_t texture, float width, float height, const std::string& missing,
           bool selected = false);

// ---- colours
ImVec4 toScreen(const Rgb& display, float alpha = 1);  ///< display values as they are
/// What a light of this radiance looks like at full brightness: its largest channel becomes 1, then the sRGB curve.
ImVec4 lightColour(const Rgb& radiance);
/// Hue around, saturation outwards, white in the middle. `light` keeps its luminance. True while it changes.
bool chromaticityDisc(const char* id, Rgb& light, float diameter);

// ---- controls bound to the look: a drag previews, the release makes one entry, Esc takes everything back
/// Follows the item drawn last. `changed`: it has a new value in this frame. `change` is applied to the look as it was
/// when the drag began. True when the look was changed.
bool followGesture(Editor& editor, const std::string& label, bool changed, const std::function<void(Look&)>& change);
/// Closes a gesture whose control has disappeared; called once a frame, after all panels.
void settleGestures(Editor& editor);

struct DragRange {
    float speed = 0.01f;        ///< a pixel
    float least = 0, most = 0;  ///< both 0: none
    const char* format = "%.3f";
    bool logarithmic = false;
    double offset = 0;  ///< added to what is shown, and taken off what is typed
    double unit = 1;    ///< one of what is shown, in the unit of the value; speed, least and most are the value's
};
/// A number to drag or to type (double click). `label` names the history entry; `id` is ImGui's.
bool dragLook(Editor& editor, const char* id, const std::string& label, float value, const DragRange& range,
              const std::string& explanation, const std::function<void(Look&, float)>& apply);
/// Temperature of a light's colour in kelvin; `apply` gets the tint of luminance 1.
bool kelvinLook(Editor& editor, const char* id, const std::string& label, const Rgb& colour,
                const std::string& explanation, const std::function<void(Look&, const Rgb&)>& apply);
/// Green against magenta, apart from the temperature; `apply` as above.
bool tintLook(Editor& editor, const char* id, const std::string& label, const Rgb& colour,
              const std::string& explanation, const std::function<void(Look&, const Rgb&)>& apply);
/// A swatch that opens a disc of colours and a temperature. `apply` gets the new colour, as bright as `light`;
/// `fromImage`, where there is one, lets the user take it from the image.
bool colourLook(Editor& editor, const char* id, const std::string& label, const Rgb& light, float size,
                const std::string& explanation, const std::function<void(Look&, const Rgb&)>& apply,
                const std::function<void()>& fromImage = {});

/// While it lives Shift makes a drag of a number finer, as in the viewport, and nothing else changes its speed.
class FineDrag {
public:
    explicit FineDrag(float& speed);
    ~FineDrag();
    FineDrag(const FineDrag&) = delete;
    FineDrag& operator=(const FineDrag&) = delete;

private:
    bool shift_, alt_;
};

/// Something in a panel (a pending tooltip, a folder being read) wants another frame though no input came.
bool panelsBusy();
/// Marks the present frame as busy.
void stayAwake();
void beginPanelFrame();  ///< once a frame, before the panels

}  // namespace relamp::ui
