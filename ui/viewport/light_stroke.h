// The tool that paints with light: a stroke over the image becomes powers and colours of lights when it ends.
#pragma once
#include <vector>

#include "viewport/overlays.h"

namespace relamp::ui {

class LightStroke {
public:
    void begin(const Vec2& mouse) { places_.assign(1, mouse); }
    void follow(const Canvas& canvas, const Vec2& mouse);
    /// Solves and makes one edit of it; says what came of it. `invert`: brighter becomes darker and the other way
    /// round.
    void end(const Canvas& canvas, bool invert);
    void abandon() { places_.clear(); }
    bool running() const { return !places_.empty(); }
    /// The brush under the mouse, and the stroke so far.
    void draw(const Canvas& canvas, const Vec2& mouse) const;

private:
    std::vector<Vec2> places_;  ///< screen

    std::vector<PaintedVertex> verticesUnder(const Canvas& canvas, const LiveFrame& frame) const;
};

/// Its settings, on top of the inspector while the tool is chosen.
void inspectLightBrush(Editor& editor);

}  // namespace relamp::ui
