#include "viewport/light_stroke.h"

#include "base/parallel.h"
#include "image/image_io.h"
#include "item_map.h"
#include "widgets.h"

namespace relamp::ui {
namespace {

float radiusOf(const Canvas& canvas) { return canvas.editor->state.viewport.brush.radius * canvas.scale; }

float distanceToStroke(const Vec2& p, const Vec2& a, const Vec2& b) {
    const Vec2 along = b - a;
    const float length2 = glm::dot(along, along);
    const float t = length2 > 0 ? std::clamp(glm::dot(p - a, along) / length2, 0.0f, 1.0f) : 0.0f;
    return glm::length(p - a - t * along);
}

/// Of a light that is there: an undo may have taken a selected one away.
bool anySelected(const Editor& editor) {
    const auto& all = editor.emitters();
    return std::any_of(all.begin(), all.end(), [&](const EmitterState& e) { return editor.state.selection.has(e.id); });
}

/// The lights that a stroke may change: those selected, else all that shine.
std::vector<std::string> lightsOf(const Editor& editor) {
    const bool selected = anySelected(editor);
    std::vector<std::string> ids;
    for (const EmitterState& e : editor.emitters())
        if (e.shines() && (!selected || editor.state.selection.has(e.id))) ids.push_back(e.id);
    return ids;
}

ImU32 colourOfBrush(const LightBrushState& brush, bool invert, int alpha) {
    if (brush.brush.kind == LightBrush::Kind::colour) {
        const Rgb c = brush.brush.colour / std::max(1e-6f, maxChannel(brush.brush.colour));
        return IM_COL32(int(255 * srgbEncode(c.x)), int(255 * srgbEncode(c.y)), int(255 * srgbEncode(c.z)), alpha);
    }
    const bool brighter = (brush.brush.kind == LightBrush::Kind::brighter) != invert;
    return brighter ? IM_COL32(255, 244, 214, alpha) : IM_COL32(30, 40, 70, alpha);
}

bool shiftHeld() { return ImGui::GetIO().KeyShift; }

}  // namespace

void LightStroke::follow(const Canvas& canvas, const Vec2& mouse) {
    if (glm::length(mouse - places_.back()) > 0.2f * radiusOf(canvas)) places_.push_back(mouse);
}

std::vector<PaintedVertex> LightStroke::verticesUnder(const Canvas& canvas, const LiveFrame& frame) const {
    const float radius = radiusOf(canvas);
    const Mesh& mesh = *frame.mesh;
    const Scene* scene = canvas.editor->state.document.scene.get();
    std::vector<float> amount(mesh.vertexCount(), 0);
    parallelFor(mesh.vertexCount(), 1024, [&](size_t v) {
        const Vec3 p = mesh.positions[v], toEye = canvas.eye->towardEye(p);
        if (glm::dot(mesh.normals[v], toEye) <= 0) return;
        const auto at = canvas.eye->toScreen(p);
        if (!at || !canvas.eye->contains(*at)) return;
        float nearest = 1e9f;
        for (size_t i = 0; i < places_.size(); ++i)
            nearest = std::min(nearest, distanceToStroke(*at, places_[i], places_[i ? i - 1 : 0]));
        if (nearest >= radius) return;
        // Hidden ones are not painted. What was moved hides as it did where it was captured.
        if (scene && scene->tracer) {
            const float offset = 8 * scene->tracer->surfaceOffset();
            const float far = canvas.eye->orthographic ? 1e6f : glm::length(canvas.eye->position - p);
            if (scene->tracer->closest({p + mesh.normals[v] * offset, toEye, 0, far})) return;
        }
        const float t = 1 - nearest / radius;
        amount[v] = std::min(1.0f, 2 * t * t * (3 - 2 * t));
    });
    std::vector<PaintedVertex> painted;
    for (uint32_t v = 0; v < amount.size(); ++v)
        if (amount[v] > 0) painted.push_back({v, amount[v]});
    return painted;
}

void LightStroke::end(const Canvas& canvas, bool invert) {
    Editor& editor = *canvas.editor;
    const auto frame = editor.liveFrame();
    const auto estimate = editor.estimate();
    const LightBrushState state = editor.state.viewport.brush;
    if (!frame || !estimate || !running()) return abandon();
    const std::vector<PaintedVertex> painted = verticesUnder(canvas, *frame);
    abandon();
    if (painted.empty()) return editor.say("No surface was painted");
    LightBrush brush = state.brush;
    if (invert && brush.kind != LightBrush::Kind::colour)
        brush.kind = brush.kind == LightBrush::Kind::brighter ? LightBrush::Kind::darker : LightBrush::Kind::brighter;
    PaintedLights lights{{}, state.environment};
    std::vector<std::string> ids, names;
    for (const std::string& id : lightsOf(editor)) {
        const auto at = std::find(frame->emitterIds.begin(), frame->emitterIds.end(), id);
        if (at == frame->emitterIds.end()) continue;
        lights.emitters.push_back(size_t(at - frame->emitterIds.begin()));
        ids.push_back(id);
        names.push_back(shown(editor.emitter(id)->name));
    }
    if (ids.empty() && !state.environment) return editor.say("No light shines that could change");
    try {
        const LightGoal goal = brushedGoal(*frame, *estimate, editor.look(), painted, brush, lights);
        if (goal.points() == 0) return editor.say("No light falls there that could change");
        LightGoalOptions options;
        options.colour = brush.kind == LightBrush::Kind::colour;
        const LightGoalAnswer answer = reachGoal(goal, options);
        editor.edit(brush.kind == LightBrush::Kind::colour     ? "Paint a colour with light"
                    : brush.kind == LightBrush::Kind::brighter ? "Paint brighter"
                                                               : "Paint darker",
                    [&](Look& look) { scaleLights(look, *estimate, ids, state.environment, answer.scale); });
        editor.say(wordsOf(answer, names, state.environment));
    } catch (const Error& error) { editor.say(error.what()); }
}

void LightStroke::draw(const Canvas& canvas, const Vec2& mouse) const {
    const LightBrushState& brush = canvas.editor->state.viewport.brush;
    const float radius = radiusOf(canvas);
    const bool invert = shiftHeld();
    for (const Vec2& place : places_)
        canvas.list->AddCircleFilled(toIm(place), radius, colourOfBrush(brush, invert, 26), 40);
    canvas.list->AddCircle(toIm(mouse), radius, IM_COL32(0, 0, 0, 140), 48, 3 * canvas.scale);
    canvas.list->AddCircle(toIm(mouse), radius, colourOfBrush(brush, invert, 255), 48, 1.5f * canvas.scale);
}

void inspectLightBrush(Editor& editor) {
    LightBrushState& brush = editor.state.viewport.brush;
    using Kind = LightBrush::Kind;
    if (radio("Brighter", brush.brush.kind == Kind::brighter, "Lights change so that what is painted becomes brighter"))
        brush.brush.kind = Kind::brighter;
    sameLineIfFits(em(5));
    if (radio("Darker", brush.brush.kind == Kind::darker, "Lights change so that what is painted becomes darker"))
        brush.brush.kind = Kind::darker;
    sameLineIfFits(em(5));
    if (radio("Colour", brush.brush.kind == Kind::colour, "Lights change so that what is painted has this colour"))
        brush.brush.kind = Kind::colour;
    const auto row = [&](const char* name) {
        ImGui::AlignTextToFramePadding();
        dimText(name);
        ImGui::SameLine(em(6.2f));
        ImGui::SetNextItemWidth(-FLT_MIN);
    };
    row("Size");
    ImGui::DragFloat("##brush size", &brush.radius, 0.5f, 4, 400, "%.0f", ImGuiSliderFlags_AlwaysClamp);
    tooltip("Radius of the brush on the screen");
    if (brush.brush.kind == Kind::colour) {
        row("Colour");
        Rgb& colour = brush.brush.colour;
        Rgb coded(srgbEncode(colour.x), srgbEncode(colour.y), srgbEncode(colour.z));
        if (ImGui::ColorEdit3("##brush colour", &coded.x, ImGuiColorEditFlags_NoInputs))
            colour = Rgb(srgbDecode(coded.x), srgbDecode(coded.y), srgbDecode(coded.z));
        tooltip("The colour that is wanted; the brightness stays");
    } else {
        row("Strength");
        ImGui::DragFloat("##brush strength", &brush.brush.stops, 0.01f, 0.05f, 6, "%.2f stops",
                         ImGuiSliderFlags_AlwaysClamp);
        tooltip("By how much a stroke brightens or darkens, in stops: 1 is twice or half");
    }
    row("Keep the rest");
    ImGui::DragFloat("##brush stillness", &brush.brush.stillness, 0.01f, 0, 10, "%.2f", ImGuiSliderFlags_AlwaysClamp);
    tooltip("How much all that is not painted should stay as it is. 0: it may become anything.");
    checkbox("Environment too", brush.environment, "The environment's exposure and tint may change as well");
    const bool some = anySelected(editor);
    dimWrapped(some ? "Paint over the image: the selected lights change. Shift swaps brighter and darker."
                    : "Paint over the image: the lights that shine change as little as they can. Select some to change "
                      "these alone. Shift swaps brighter and darker.");
}

}  // namespace relamp::ui
