#include "panels/reference_marks.h"

namespace relamp::ui {
namespace {

using Kind = MarkedReference::Kind;
constexpr float clicked = 3;      ///< points: a shorter drag was a click
constexpr float clickRadius = 6;  ///< points, of a grey that was clicked
constexpr size_t corners = 4;     ///< of a chart

}  // namespace

void MarkingGesture::press(MarkedReference& mark, const PhotographPlace& place, const Vec2& at, float grab) {
    const Vec2 pixel = place.toPixel(at);
    if (mark.kind == Kind::chart) {
        what_ = What::corner;
        for (corner_ = 0; corner_ < mark.points.size(); ++corner_)
            if (glm::distance(place.toScreen(mark.points[corner_]), at) < grab) return;
        if (mark.points.size() < corners) mark.points.push_back(pixel);
        else what_ = What::nothing;
        return;
    }
    if (!mark.points.empty()) {
        const Vec2 from = pixel - mark.points[0];
        const float distance = place.scale * glm::length(from), radius = place.scale * mark.radius;
        held_ = from;
        if (std::abs(distance - radius) < grab && radius > grab) what_ = What::resize;
        else if (distance < std::max(radius, grab)) what_ = What::move;
        else what_ = What::draw;
    } else {
        what_ = What::draw;
    }
    if (what_ != What::draw) return;
    mark.points = {pixel};
    mark.radius = 0;
}

void MarkingGesture::drag(MarkedReference& mark, const PhotographPlace& place, const Vec2& at) {
    const Vec2 pixel = place.toPixel(at);
    switch (what_) {
        case What::nothing: break;
        case What::draw:
        case What::resize: mark.radius = glm::distance(mark.points[0], pixel); break;
        case What::move: mark.points[0] = pixel - held_; break;
        case What::corner: mark.points[corner_] = pixel; break;
    }
}

void MarkingGesture::release(MarkedReference& mark, const PhotographPlace& place) {
    if (what_ == What::draw && place.scale * mark.radius < clicked) {
        if (mark.kind == Kind::grey) mark.radius = clickRadius / place.scale;
        else mark.points.clear();
    }
    what_ = What::nothing;
}

bool isComplete(const MarkedReference& mark) {
    return mark.kind == Kind::chart ? mark.points.size() == corners : mark.points.size() == 1 && mark.radius > 0;
}

std::string nextStepOf(const MarkedReference& mark) {
    if (mark.kind == Kind::mirrorBall)
        return isComplete(mark) ? "Drag the circle or its rim until it lies on the ball's."
                                : "Drag from the ball's middle to its rim.";
    if (mark.kind == Kind::grey)
        return isComplete(mark) ? "Drag the disc or its rim; it must not reach past the card."
                                : "Drag a disc inside the grey card or ball. It has to be part of the mesh.";
    const char* const patches[] = {"dark skin, the brown one at the end of a row of colours",
                                   "bluish green, at the other end of that row", "black, the darkest of the greys",
                                   "white, the brightest of the greys"};
    if (mark.points.size() < corners) return std::string("Click the middle of ") + patches[mark.points.size()] + ".";
    return "Drag the corners until each circle lies inside its patch.";
}

const char* wordOf(Kind kind) {
    return kind == Kind::mirrorBall ? "Mirror ball" : kind == Kind::grey ? "Grey card" : "Colour chart";
}

}  // namespace relamp::ui
