#include "viewport/overlays.h"

#include "display/vertex_images.h"
#include "item_map.h"
#include "viewport/display_transform.h"
#include "viewport/navigation.h"
#include "viewport/space_lines.h"
#include "widgets.h"

namespace relamp::ui {
namespace {

ImU32 tintOf(const Rgb& c, float alpha = 1) {
    const Rgb s = glm::clamp(c, Rgb(0), Rgb(1));
    return ImGui::ColorConvertFloat4ToU32({s.x, s.y, s.z, alpha});
}

constexpr float markRadius = 8;

float dividerX(const Canvas& canvas, float fraction) { return canvas.eye->corner.x + fraction * canvas.eye->size.x; }

/// Where the corner axes sit, and how long they are.
Vec2 axesCentre(const Canvas& canvas) {
    return canvas.corner + Vec2(canvas.size.x - 46 * canvas.scale, 46 * canvas.scale);
}
Vec2 axisTip(const Canvas& canvas, int axis, int sign) {
    const Vec3 d = Mat3(canvas.eye->viewFromWorld)[axis] * float(sign);
    return axesCentre(canvas) + Vec2(d.x, -d.y) * (28 * canvas.scale);
}
bool roomForAxes(const Canvas& canvas) {
    return canvas.size.x > 220 * canvas.scale && canvas.size.y > 160 * canvas.scale;
}

float distanceToSegment(const Vec2& p, const Vec2& a, const Vec2& b) {
    const Vec2 ab = b - a;
    const float t = glm::dot(ab, ab) > 0 ? std::clamp(glm::dot(p - a, ab) / glm::dot(ab, ab), 0.0f, 1.0f) : 0.0f;
    return glm::length(p - a - t * ab);
}

}  // namespace

void labelAt(const Canvas& canvas, const Vec2& at, const std::string& text, const Vec2& anchor, float widest) {
    if (text.empty()) return;
    const float wrap = std::max(40 * canvas.scale, std::min(widest, canvas.size.x - 24 * canvas.scale));
    const ImVec2 size = ImGui::CalcTextSize(text.c_str(), nullptr, false, wrap);
    const Vec2 pad = Vec2(6, 3) * canvas.scale;
    Vec2 corner = at - anchor * (Vec2(size.x, size.y) + 2.0f * pad);
    // Inside the viewport, whatever the place.
    corner = glm::max(glm::min(corner, canvas.corner + canvas.size - Vec2(size.x, size.y) - 2.0f * pad - 2.0f),
                      canvas.corner + 2.0f);
    corner = glm::floor(corner);
    canvas.list->AddRectFilled(toIm(corner), {corner.x + size.x + 2 * pad.x, corner.y + size.y + 2 * pad.y},
                               IM_COL32(18, 18, 18, 185), 3 * canvas.scale);
    canvas.list->AddText(ImGui::GetFont(), ImGui::GetFontSize(), toIm(corner + pad), IM_COL32(235, 235, 235, 255),
                         text.c_str(), nullptr, wrap);
}

namespace {

/// The edge of a shaped light's cone, as long as it is 120 points on the screen.
void drawCone(const Canvas& canvas, const EmitterState& emitter, ImU32 colour) {
    const auto& added = canvas.editor->look().added;
    if (emitter.recovered || size_t(emitter.index) >= added.size()) return;
    const float cone = added[size_t(emitter.index)].shaping.coneDegrees;
    if (cone > 85) return;
    const float length = canvas.eye->metresPerPoint(emitter.pivot) * 120 * canvas.scale,
                wide = length * std::tan(cone * (pi / 180));
    constexpr int around = 32;
    Vec2 a, b;
    for (int i = 0; i < around; ++i) {
        const auto rim = [&](int k) {
            const float angle = 2 * pi * float(k) / around;
            return emitter.pivot + length * emitter.axes[2] +
                   wide * (std::cos(angle) * emitter.axes[0] + std::sin(angle) * emitter.axes[1]);
        };
        if (canvas.eye->segmentToScreen(rim(i), rim(i + 1), a, b))
            canvas.list->AddLine(toIm(a), toIm(b), colour, 1.2f * canvas.scale);
        if (i % (around / 4) == 0 && canvas.eye->segmentToScreen(emitter.pivot, rim(i), a, b))
            canvas.list->AddLine(toIm(a), toIm(b), colour, 1.2f * canvas.scale);
    }
}

}  // namespace

void drawEmitterMarks(const Canvas& canvas, const std::string& hovered) {
    const float s = canvas.scale;
    const std::vector<std::string>& solo = canvas.editor->state.viewport.solo;
    for (const EmitterState& emitter : canvas.editor->emitters()) {
        const auto at = canvas.eye->toScreen(emitter.pivot);
        if (!at || !canvas.eye->contains(*at)) continue;
        const bool selected = canvas.editor->state.selection.has(emitter.id),
                   active = canvas.editor->state.selection.active() == emitter.id;
        const bool lit =
            emitter.shines() && (solo.empty() || std::find(solo.begin(), solo.end(), emitter.id) != solo.end());
        Rgb tint = emitter.radiance;
        const float most = maxChannel(tint);
        tint = most > 0 ? glm::pow(glm::max(tint / most, Rgb(0)), Rgb(1 / 2.2f)) : Rgb(0.5f);
        const ImU32 stroke = selected                ? tintOf(active ? tint : 0.75f * tint)
                             : hovered == emitter.id ? IM_COL32(255, 255, 255, 255)
                                                     : IM_COL32(205, 205, 205, 235);
        const float r = markRadius * 0.62f * s;
        // Where it faces; parts that shine to all sides have no arrow of meaning and get one only when selected.
        if (selected) drawCone(canvas, emitter, stroke);
        if (selected || hovered == emitter.id) {
            const float length = canvas.eye->metresPerPoint(emitter.pivot) * 46 * s;
            Vec2 a, b;
            if (canvas.eye->segmentToScreen(emitter.pivot, emitter.pivot + emitter.axes[2] * length, a, b) &&
                glm::length(b - a) > 4 * s) {
                const Vec2 d = glm::normalize(b - a), side(-d.y, d.x);
                canvas.list->AddLine(toIm(a + d * (r + 3 * s)), toIm(b), IM_COL32(0, 0, 0, 120), 4 * s);
                canvas.list->AddLine(toIm(a + d * (r + 3 * s)), toIm(b), stroke, 2 * s);
                canvas.list->AddTriangleFilled(toIm(b + d * (6 * s)), toIm(b + side * (4 * s) - d * s),
                                               toIm(b - side * (4 * s) - d * s), stroke);
            }
        }
        canvas.list->AddCircleFilled(toIm(*at), r + 5 * s, IM_COL32(0, 0, 0, 70));
        if (itemMapOn()) notePoint("emitter:" + emitter.id, *at);
        canvas.list->AddCircleFilled(toIm(*at), r, lit ? tintOf(tint) : IM_COL32(50, 50, 50, 230));
        canvas.list->AddCircle(toIm(*at), r, stroke, 0, 1.4f * s);
        if (lit) {
            for (int i = 0; i < 8; ++i) {
                const float angle = pi * float(i) / 4;
                const Vec2 d(std::cos(angle), std::sin(angle));
                canvas.list->AddLine(toIm(*at + d * (r + 2 * s)), toIm(*at + d * (r + 4.5f * s)), stroke, 1.3f * s);
            }
        } else {
            canvas.list->AddLine(toIm(*at + Vec2(-1, 1) * (r + 3 * s)), toIm(*at + Vec2(1, -1) * (r + 3 * s)), stroke,
                                 1.6f * s);
        }
        if (hovered == emitter.id)
            labelAt(canvas, *at + Vec2(14, 10) * s,
                    shown(emitter.name) + (lit                ? ""
                                           : emitter.shines() ? " (another is solo)"
                                                              : " (off)"));
    }
}

std::string emitterMarkAt(const Canvas& canvas, const Vec2& mouse) {
    std::string best;
    float nearest = (markRadius + 3) * canvas.scale;
    for (const EmitterState& emitter : canvas.editor->emitters())
        if (const auto at = canvas.eye->toScreen(emitter.pivot); at && glm::length(*at - mouse) < nearest)
            nearest = glm::length(*at - mouse), best = emitter.id;
    return best;
}

std::vector<std::string> emitterMarksIn(const Canvas& canvas, const Vec2& a, const Vec2& b) {
    const Vec2 low = glm::min(a, b), high = glm::max(a, b);
    std::vector<std::string> inside;
    for (const EmitterState& emitter : canvas.editor->emitters())
        if (const auto at = canvas.eye->toScreen(emitter.pivot);
            at && *at == glm::clamp(*at, low, high) && canvas.eye->contains(*at))
            inside.push_back(emitter.id);
    return inside;
}

int frustumAt(const Canvas& canvas, const Vec2& mouse) {
    const auto& capture = canvas.editor->state.document.capture;
    if (!capture || !canvas.editor->state.viewport.frusta || looksThrough(*canvas.editor)) return -1;
    const float depth = frustumDepth(sceneExtent(*canvas.editor).radius);
    int best = -1;
    float nearest = 6 * canvas.scale;
    for (size_t i = 0; i < capture->views.size(); ++i) {
        if (!frustumShown(capture->views[i].camera, canvas.eye->position, depth)) continue;
        const auto corners = frustumCorners(capture->views[i].camera, depth);
        const Vec3 eye(capture->views[i].camera.position());
        for (size_t k = 0; k < 4; ++k) {
            Vec2 a, b;
            if (canvas.eye->segmentToScreen(eye, corners[k], a, b) && distanceToSegment(mouse, a, b) < nearest)
                nearest = distanceToSegment(mouse, a, b), best = int(i);
            if (canvas.eye->segmentToScreen(corners[k], corners[(k + 1) % 4], a, b) &&
                distanceToSegment(mouse, a, b) < nearest)
                nearest = distanceToSegment(mouse, a, b), best = int(i);
        }
    }
    return best;
}

void drawFrustumName(const Canvas& canvas, int view) {
    const auto& capture = canvas.editor->state.document.capture;
    if (!capture || view < 0 || view >= int(capture->views.size())) return;
    if (const auto at = canvas.eye->toScreen(Vec3(capture->views[size_t(view)].camera.position())))
        labelAt(canvas, *at + Vec2(10, 8) * canvas.scale,
                capture->views[size_t(view)].name + "  (double click looks through it)");
}

void drawAxes(const Canvas& canvas, const Vec2& mouse) {
    if (!roomForAxes(canvas)) return;
    static const char* const names[] = {"X", "Y", "Z"};
    static const ImU32 colours[] = {IM_COL32(222, 84, 88, 255), IM_COL32(124, 188, 74, 255),
                                    IM_COL32(84, 140, 236, 255)};
    const Vec2 centre = axesCentre(canvas);
    const float s = canvas.scale;
    const auto under = axisAt(canvas, mouse);
    if (glm::length(mouse - centre) < 40 * s)
        canvas.list->AddCircleFilled(toIm(centre), 40 * s, IM_COL32(255, 255, 255, 22));
    // From the furthest to the nearest.
    std::array<std::pair<int, int>, 6> ends{{{0, 1}, {1, 1}, {2, 1}, {0, -1}, {1, -1}, {2, -1}}};
    const auto towardEye = [&](const std::pair<int, int>& e) {
        return float(e.second) * Mat3(canvas.eye->viewFromWorld)[e.first].z;
    };
    std::sort(ends.begin(), ends.end(), [&](const auto& a, const auto& b) { return towardEye(a) < towardEye(b); });
    for (const auto& [axis, sign] : ends) {
        const Vec2 tip = axisTip(canvas, axis, sign);
        const bool bright = under && under->first == axis && under->second == sign;
        if (sign > 0) {
            canvas.list->AddLine(toIm(centre), toIm(tip), colours[axis], 2 * s);
            canvas.list->AddCircleFilled(toIm(tip), 7.5f * s, bright ? IM_COL32(255, 255, 255, 255) : colours[axis]);
            const ImVec2 size = ImGui::CalcTextSize(names[axis]);
            const float font = ImGui::GetFontSize() * 0.8f;
            canvas.list->AddText(ImGui::GetFont(), font, {tip.x - size.x * 0.4f, tip.y - font * 0.5f},
                                 IM_COL32(20, 20, 20, 255), names[axis]);
        } else {
            canvas.list->AddCircleFilled(
                toIm(tip), 5 * s,
                bright ? IM_COL32(255, 255, 255, 255) : (colours[axis] & ~IM_COL32_A_MASK) | IM_COL32(0, 0, 0, 110));
        }
    }
}

std::optional<std::pair<int, int>> axisAt(const Canvas& canvas, const Vec2& mouse) {
    if (!roomForAxes(canvas)) return std::nullopt;
    std::optional<std::pair<int, int>> best;
    float front = -2;
    for (int axis = 0; axis < 3; ++axis)
        for (int sign : {1, -1}) {
            const float depth = float(sign) * Mat3(canvas.eye->viewFromWorld)[axis].z;
            if (glm::length(mouse - axisTip(canvas, axis, sign)) < 8 * canvas.scale && depth > front)
                front = depth, best = {axis, sign};
        }
    return best;
}

void drawStrips(const Canvas& canvas, const std::vector<Strip>& strips, int active) {
    const EyeView& eye = *canvas.eye;
    const float s = canvas.scale;
    canvas.list->PushClipRect(toIm(eye.corner), toIm(eye.corner + eye.size), true);
    for (size_t i = 0; i < strips.size(); ++i) {
        const float left = dividerX(canvas, strips[i].left), right = dividerX(canvas, strips[i].right);
        if (!strips[i].missing.empty() && right - left > 30 * s) {
            labelAt(canvas, {(left + right) / 2, eye.corner.y + eye.size.y / 2 - 20 * s}, strips[i].missing,
                    {0.5f, 0.5f}, std::min(right - left - 24 * s, 360 * s));
        }
        if (!strips[i].caption.empty()) {
            const float width = ImGui::CalcTextSize(strips[i].caption.c_str()).x + 12 * s;
            if (right - left > width + 12 * s)
                labelAt(canvas, {(left + right) / 2, eye.corner.y + eye.size.y - 10 * s}, strips[i].caption, {0.5f, 1});
        }
        if (i > 0) {
            const bool bright = active == int(i) - 1;
            const float middle = eye.corner.y + eye.size.y / 2;
            canvas.list->AddLine({left, eye.corner.y}, {left, eye.corner.y + eye.size.y}, IM_COL32(0, 0, 0, 140),
                                 3.5f * s);
            canvas.list->AddLine({left, eye.corner.y}, {left, eye.corner.y + eye.size.y},
                                 bright ? IM_COL32(255, 200, 90, 255) : IM_COL32(235, 235, 235, 220), 1.5f * s);
            const ImU32 fill = bright ? IM_COL32(255, 200, 90, 255) : IM_COL32(235, 235, 235, 235);
            canvas.list->AddCircleFilled({left, middle}, 9 * s, IM_COL32(20, 20, 20, 200));
            canvas.list->AddTriangleFilled({left - 6.5f * s, middle}, {left - 2 * s, middle - 4 * s},
                                           {left - 2 * s, middle + 4 * s}, fill);
            canvas.list->AddTriangleFilled({left + 6.5f * s, middle}, {left + 2 * s, middle - 4 * s},
                                           {left + 2 * s, middle + 4 * s}, fill);
        }
    }
    canvas.list->PopClipRect();
}

int dividerAt(const Canvas& canvas, const std::vector<Strip>& strips, const Vec2& mouse) {
    int best = -1;
    float nearest = 7 * canvas.scale;
    for (size_t i = 1; i < strips.size(); ++i) {
        const float x = dividerX(canvas, strips[i].left);
        // Two that lie together: the one that can still move.
        if (const float distance = std::abs(mouse.x - x);
            distance < nearest || (best >= 0 && distance == nearest && mouse.x > x))
            nearest = distance, best = int(i) - 1;
    }
    return best;
}

void moveDivider(const Canvas& canvas, int index, float screenX) {
    ViewportState& viewport = canvas.editor->state.viewport;
    const float fraction = std::clamp((screenX - canvas.eye->corner.x) / canvas.eye->size.x, 0.01f, 0.99f);
    // The others give way.
    const auto& dividers = infoOf(viewport.mode).dividers;
    for (int i = 0; i < int(dividers.size()); ++i) {
        float& at = viewport.*dividers[size_t(i)];
        at = i < index ? std::min(at, fraction) : i > index ? std::max(at, fraction) : fraction;
    }
}

void drawEmpty(const Canvas& canvas) {
    const auto& job = canvas.editor->job();
    const std::string text = job ? shown(job->title) + "..." : "Drop a capture folder here, or press Ctrl+O";
    const float wrap = std::max(canvas.size.x - 40 * canvas.scale, 60.0f);
    const ImVec2 size = ImGui::CalcTextSize(text.c_str(), nullptr, false, wrap);
    const Vec2 at = glm::floor(canvas.corner + (canvas.size - Vec2(size.x, size.y)) / 2.0f);
    canvas.list->AddText(ImGui::GetFont(), ImGui::GetFontSize(), toIm(at), IM_COL32(170, 170, 170, 255), text.c_str(),
                         nullptr, wrap);
}

namespace {

struct PointedOut {
    uint32_t vertex = 0;
    int frame = -10;  ///< of ImGui
};
PointedOut& pointedOut() {
    static PointedOut now;
    return now;
}

void drawPointedOut(const Canvas& canvas) {
    const auto& scene = canvas.editor->state.document.scene;
    const auto live = canvas.editor->liveFrame();
    const PointedOut& now = pointedOut();
    if (ImGui::GetFrameCount() > now.frame + 1 || !scene || !live || now.vertex >= scene->component.size()) return;
    // Where it is now: it may have been moved. Copies of it are not meant.
    Vec2 low(1e9f), high(-1e9f);
    for (size_t v = 0; v < std::min(live->mesh->vertexCount(), scene->component.size()); ++v)
        if (scene->component[v] == scene->component[now.vertex])
            if (const auto at = canvas.eye->toScreen(live->mesh->positions[v]))
                low = glm::min(low, *at), high = glm::max(high, *at);
    if (low.x > high.x) return;
    low = glm::max(low - 4 * canvas.scale, canvas.eye->corner + 2.0f);
    high = glm::min(high + 4 * canvas.scale, canvas.eye->corner + canvas.eye->size - 2.0f);
    canvas.list->AddRect(toIm(low), toIm(high), IM_COL32(0, 0, 0, 160), 3 * canvas.scale, 0, 3.5f * canvas.scale);
    canvas.list->AddRect(toIm(low), toIm(high), IM_COL32(255, 190, 110, 255), 3 * canvas.scale, 0, 1.6f * canvas.scale);
    if (itemMapOn()) noteRect("pointed out", low, high);
}

}  // namespace

void pointOut(uint32_t vertex) { pointedOut() = {vertex, ImGui::GetFrameCount()}; }

void drawPickedPoint(const Canvas& canvas) {
    drawPointedOut(canvas);
    const auto& point = canvas.editor->state.selection.point;
    if (!point) return;
    const auto at = canvas.eye->toScreen(point->position);
    if (!at || !canvas.eye->contains(*at)) return;
    const float s = canvas.scale;
    Vec2 a, b;
    if (canvas.eye->segmentToScreen(
            point->position, point->position + point->normal * (canvas.eye->metresPerPoint(point->position) * 26 * s),
            a, b)) {
        canvas.list->AddLine(toIm(a), toIm(b), IM_COL32(0, 0, 0, 140), 3.5f * s);
        canvas.list->AddLine(toIm(a), toIm(b), IM_COL32(120, 210, 255, 255), 1.6f * s);
    }
    canvas.list->AddCircle(toIm(*at), 5 * s, IM_COL32(0, 0, 0, 160), 0, 3.5f * s);
    canvas.list->AddCircle(toIm(*at), 5 * s, IM_COL32(120, 210, 255, 255), 0, 1.6f * s);
}

const char* hintOf(ClickTask task) {
    switch (task) {
        case ClickTask::aim: return "Click, or drag over, what the light points at (Esc cancels)";
        case ClickTask::reflect: return "Click, or drag over, where its reflection is to be seen (Esc cancels)";
        case ClickTask::illuminate: return "Click, or drag over, what it lights (Esc cancels)";
        case ClickTask::attach: return "Click the object that follows the light (Esc cancels)";
        case ClickTask::leaveOut: return "Click an object that the light does not fall on (Esc cancels)";
        case ClickTask::lightOnly: return "Click an object that the light falls on alone (Esc cancels)";
        case ClickTask::takeColour: return "Click where the light's new colour is seen (Esc cancels)";
        case ClickTask::region: return "Drag a rectangle over what is to be rendered (Esc cancels)";
        case ClickTask::newPart: return "Click the object that shines (Esc cancels)";
        default: return "";
    }
}

}  // namespace relamp::ui
