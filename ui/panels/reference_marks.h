// What the mouse does to a light reference that is being marked in a photograph. Knows no ImGui.
#pragma once
#include <string>

#include "editor_state.h"

namespace relamp::ui {

/// A photograph in an area of the screen.
struct PhotographPlace {
    Vec2 low{0}, size{1};  ///< of the area
    Vec2 middle{0};        ///< pixel of the photograph in the middle of it
    float scale = 1;       ///< points a pixel
    Vec2 toScreen(const Vec2& pixel) const { return low + 0.5f * size + scale * (pixel - middle); }
    Vec2 toPixel(const Vec2& at) const { return middle + (at - low - 0.5f * size) / scale; }
};

/// One press of the mouse until its release.
class MarkingGesture {
public:
    /// `grab`: points within which a handle or a rim is taken hold of.
    void press(MarkedReference& mark, const PhotographPlace& place, const Vec2& at, float grab);
    void drag(MarkedReference& mark, const PhotographPlace& place, const Vec2& at);
    /// A grey that was clicked, not drawn, gets a small radius.
    void release(MarkedReference& mark, const PhotographPlace& place);
    bool active() const { return what_ != What::nothing; }

private:
    enum class What { nothing, draw, move, resize, corner } what_ = What::nothing;
    size_t corner_ = 0;
    Vec2 held_{0};  // pixel, from the centre
};

/// All that has to be marked is.
bool isComplete(const MarkedReference& mark);
/// What to do next.
std::string nextStepOf(const MarkedReference& mark);
/// "Grey card", "Mirror ball", "Colour chart".
const char* wordOf(MarkedReference::Kind kind);

}  // namespace relamp::ui
