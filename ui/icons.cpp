#include "icons.h"

#include <algorithm>
#include <cmath>

namespace relamp::ui {
namespace {

/// A pen on the unit square, y down.
struct Pen {
    ImDrawList* list;
    ImVec2 at;
    float size;
    ImU32 colour;
    float width() const { return std::max(1.0f, size / 12); }
    ImVec2 point(float x, float y) const { return {at.x + x * size, at.y + y * size}; }
    void line(float x0, float y0, float x1, float y1) const {
        list->AddLine(point(x0, y0), point(x1, y1), colour, width());
    }
    void box(float x0, float y0, float x1, float y1, bool filled = false) const {
        if (filled) list->AddRectFilled(point(x0, y0), point(x1, y1), colour, size * 0.06f);
        else list->AddRect(point(x0, y0), point(x1, y1), colour, size * 0.06f, 0, width());
    }
    void ring(float x, float y, float r, bool filled = false) const {
        if (filled) list->AddCircleFilled(point(x, y), r * size, colour, 20);
        else list->AddCircle(point(x, y), r * size, colour, 20, width());
    }
    void triangle(float x0, float y0, float x1, float y1, float x2, float y2, bool filled = true) const {
        if (filled) list->AddTriangleFilled(point(x0, y0), point(x1, y1), point(x2, y2), colour);
        else list->AddTriangle(point(x0, y0), point(x1, y1), point(x2, y2), colour, width());
    }
    /// Degrees, clockwise from the right.
    void arc(float x, float y, float r, float from, float to) const {
        constexpr float radians = 0.01745329f;
        list->PathClear();
        list->PathArcTo(point(x, y), r * size, from * radians, to * radians, 16);
        list->PathStroke(colour, 0, width());
    }
    void curve(float x0, float y0, float x1, float y1, float x2, float y2) const {
        list->AddBezierQuadratic(point(x0, y0), point(x1, y1), point(x2, y2), colour, width(), 12);
    }
};

}  // namespace

Icon iconNamed(const std::string& name) {
    static const std::pair<const char*, Icon> named[] = {
        {"rectangle", Icon::rectangle}, {"disk", Icon::disk}, {"sphere", Icon::sphere}, {"mesh", Icon::mesh},
        {"copy", Icon::copy},           {"spot", Icon::spot}, {"sun", Icon::sun}};
    for (const auto& [word, icon] : named)
        if (name == word) return icon;
    return Icon::emitter;
}

void drawIcon(ImDrawList* list, Icon icon, const ImVec2& at, float size, ImU32 colour) {
    const Pen pen{list, at, size, colour};
    switch (icon) {
        case Icon::none: break;
        case Icon::eyeOpen:
            pen.curve(0.08f, 0.5f, 0.5f, 0.02f, 0.92f, 0.5f), pen.curve(0.08f, 0.5f, 0.5f, 0.98f, 0.92f, 0.5f);
            pen.ring(0.5f, 0.5f, 0.13f, true);
            break;
        case Icon::eyeShut:
            pen.curve(0.08f, 0.42f, 0.5f, 0.95f, 0.92f, 0.42f);
            pen.line(0.5f, 0.69f, 0.5f, 0.86f), pen.line(0.25f, 0.6f, 0.15f, 0.76f),
                pen.line(0.75f, 0.6f, 0.85f, 0.76f);
            break;
        case Icon::solo: pen.ring(0.5f, 0.5f, 0.36f), pen.ring(0.5f, 0.5f, 0.16f, true); break;
        case Icon::reset:
            pen.arc(0.5f, 0.54f, 0.3f, -130, 160);
            pen.triangle(0.14f, 0.40f, 0.46f, 0.40f, 0.24f, 0.12f);
            break;
        case Icon::plus: pen.line(0.5f, 0.18f, 0.5f, 0.82f), pen.line(0.18f, 0.5f, 0.82f, 0.5f); break;
        case Icon::minus: pen.line(0.18f, 0.5f, 0.82f, 0.5f); break;
        case Icon::trash:
            pen.line(0.18f, 0.26f, 0.82f, 0.26f), pen.box(0.27f, 0.26f, 0.73f, 0.88f),
                pen.line(0.4f, 0.15f, 0.6f, 0.15f);
            pen.line(0.42f, 0.4f, 0.42f, 0.75f), pen.line(0.58f, 0.4f, 0.58f, 0.75f);
            break;
        case Icon::copy: pen.box(0.15f, 0.15f, 0.65f, 0.65f), pen.box(0.35f, 0.35f, 0.85f, 0.85f); break;
        case Icon::folder:
            pen.box(0.1f, 0.3f, 0.9f, 0.82f), pen.line(0.12f, 0.2f, 0.42f, 0.2f), pen.line(0.42f, 0.2f, 0.5f, 0.3f),
                pen.line(0.12f, 0.2f, 0.12f, 0.32f);
            break;
        case Icon::file:
            pen.box(0.22f, 0.1f, 0.78f, 0.9f), pen.line(0.35f, 0.35f, 0.65f, 0.35f),
                pen.line(0.35f, 0.52f, 0.65f, 0.52f), pen.line(0.35f, 0.69f, 0.55f, 0.69f);
            break;
        case Icon::image:
            pen.box(0.1f, 0.18f, 0.9f, 0.82f), pen.triangle(0.2f, 0.74f, 0.42f, 0.42f, 0.62f, 0.74f),
                pen.ring(0.7f, 0.36f, 0.07f, true);
            break;
        case Icon::film:
            pen.box(0.1f, 0.2f, 0.9f, 0.8f);
            for (const float x : {0.2f, 0.4f, 0.6f, 0.8f}) pen.line(x, 0.2f, x, 0.32f), pen.line(x, 0.68f, x, 0.8f);
            break;
        case Icon::capture:
            pen.box(0.08f, 0.3f, 0.92f, 0.82f), pen.ring(0.5f, 0.56f, 0.17f), pen.line(0.32f, 0.2f, 0.5f, 0.2f),
                pen.line(0.32f, 0.2f, 0.28f, 0.3f), pen.line(0.5f, 0.2f, 0.54f, 0.3f);
            break;
        case Icon::shot:
        case Icon::emitter:
            pen.triangle(0.28f, 0.5f, 0.72f, 0.5f, 0.5f, 0.1f, false);
            pen.ring(0.5f, 0.56f, 0.08f, true), pen.line(0.3f, 0.68f, 0.2f, 0.88f), pen.line(0.5f, 0.72f, 0.5f, 0.92f),
                pen.line(0.7f, 0.68f, 0.8f, 0.88f);
            break;
        case Icon::up:
            pen.line(0.5f, 0.85f, 0.5f, 0.2f), pen.line(0.5f, 0.2f, 0.25f, 0.45f), pen.line(0.5f, 0.2f, 0.75f, 0.45f);
            break;
        case Icon::home:
            pen.line(0.1f, 0.5f, 0.5f, 0.14f), pen.line(0.5f, 0.14f, 0.9f, 0.5f), pen.line(0.22f, 0.42f, 0.22f, 0.86f),
                pen.line(0.78f, 0.42f, 0.78f, 0.86f), pen.line(0.22f, 0.86f, 0.78f, 0.86f);
            break;
        case Icon::back:
            pen.line(0.85f, 0.5f, 0.2f, 0.5f), pen.line(0.2f, 0.5f, 0.45f, 0.25f), pen.line(0.2f, 0.5f, 0.45f, 0.75f);
            break;
        case Icon::warning:
            pen.triangle(0.5f, 0.12f, 0.94f, 0.88f, 0.06f, 0.88f, false), pen.line(0.5f, 0.38f, 0.5f, 0.64f),
                pen.ring(0.5f, 0.76f, 0.05f, true);
            break;
        case Icon::play: pen.triangle(0.25f, 0.15f, 0.85f, 0.5f, 0.25f, 0.85f); break;
        case Icon::pause: pen.box(0.24f, 0.18f, 0.42f, 0.82f, true), pen.box(0.58f, 0.18f, 0.76f, 0.82f, true); break;
        case Icon::stop: pen.box(0.22f, 0.22f, 0.78f, 0.78f, true); break;
        case Icon::aim:
            pen.ring(0.5f, 0.5f, 0.28f), pen.line(0.5f, 0.06f, 0.5f, 0.36f), pen.line(0.5f, 0.64f, 0.5f, 0.94f),
                pen.line(0.06f, 0.5f, 0.36f, 0.5f), pen.line(0.64f, 0.5f, 0.94f, 0.5f);
            break;
        case Icon::mirror:
            pen.line(0.08f, 0.84f, 0.92f, 0.84f), pen.line(0.14f, 0.2f, 0.5f, 0.8f), pen.line(0.5f, 0.8f, 0.86f, 0.2f),
                pen.triangle(0.86f, 0.2f, 0.7f, 0.32f, 0.86f, 0.42f);
            break;
        case Icon::spot:
            pen.line(0.08f, 0.84f, 0.92f, 0.84f), pen.line(0.5f, 0.34f, 0.5f, 0.78f),
                pen.triangle(0.5f, 0.78f, 0.4f, 0.62f, 0.6f, 0.62f), pen.ring(0.5f, 0.2f, 0.12f);
            break;
        case Icon::link: pen.ring(0.34f, 0.5f, 0.22f), pen.ring(0.66f, 0.5f, 0.22f); break;
        case Icon::search: pen.ring(0.43f, 0.43f, 0.27f), pen.line(0.62f, 0.62f, 0.88f, 0.88f); break;
        case Icon::dots:
            for (const float x : {0.2f, 0.5f, 0.8f}) pen.ring(x, 0.5f, 0.08f, true);
            break;
        case Icon::rectangle: pen.box(0.12f, 0.26f, 0.88f, 0.74f); break;
        case Icon::disk: pen.ring(0.5f, 0.5f, 0.36f); break;
        case Icon::sphere: pen.ring(0.5f, 0.5f, 0.36f), pen.curve(0.14f, 0.5f, 0.5f, 0.76f, 0.86f, 0.5f); break;
        case Icon::mesh:
            pen.triangle(0.5f, 0.1f, 0.92f, 0.85f, 0.08f, 0.85f, false),
                pen.triangle(0.5f, 0.85f, 0.29f, 0.475f, 0.71f, 0.475f, false);
            break;
        case Icon::sun:
            pen.ring(0.5f, 0.5f, 0.18f);
            for (int i = 0; i < 8; ++i) {
                const float a = float(i) * 0.785398f, c = std::cos(a), s = std::sin(a);
                pen.line(0.5f + 0.28f * c, 0.5f + 0.28f * s, 0.5f + 0.42f * c, 0.5f + 0.42f * s);
            }
            break;
        case Icon::dropper:
            pen.line(0.15f, 0.85f, 0.6f, 0.4f), pen.line(0.5f, 0.3f, 0.7f, 0.5f), pen.ring(0.74f, 0.26f, 0.12f, true);
            break;
        case Icon::check: pen.line(0.18f, 0.52f, 0.42f, 0.78f), pen.line(0.42f, 0.78f, 0.84f, 0.24f); break;
        case Icon::cross: pen.line(0.24f, 0.24f, 0.76f, 0.76f), pen.line(0.76f, 0.24f, 0.24f, 0.76f); break;
        case Icon::pin: pen.ring(0.5f, 0.36f, 0.2f), pen.line(0.5f, 0.56f, 0.5f, 0.9f); break;
    }
}

}  // namespace relamp::ui
