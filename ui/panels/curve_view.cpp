#include "panels/curve_view.h"

#include <imgui_internal.h>

#include <algorithm>
#include <cmath>

#include "item_map.h"
#include "keys.h"
#include "panels/curve_values.h"
#include "panels/emitter_controls.h"
#include "panels/value_key_menu.h"
#include "widgets.h"

namespace relamp::ui {
namespace {

constexpr const char* easeWords[] = {"Linear", "Smooth", "Hold"};
constexpr const char* easeTips[] = {"From these keys to the next at even speed", "Starts and ends slowly",
                                    "Stays until the next key, then changes at once"};

/// What a press began and where it was: spans stay while keys are dragged, so that they follow the pointer.
struct Gesture {
    enum class Kind { none, keys, box } kind = Kind::none;
    ImVec2 from{0, 0};
    std::vector<CurveHandle> handles;  ///< as they were
    std::vector<std::pair<KeyedOf, CurveSpan>> spans;
};

class CurveView {
public:
    CurveView(Editor& editor, const ImVec2& low, const ImVec2& high, std::vector<ValueCurve> curves, Gesture& gesture)
        : editor_(editor),
          time_(editor.state.time),
          low_(low),
          high_(high),
          curves_(std::move(curves)),
          gesture_(gesture) {
        for (const ValueCurve& curve : curves_) {
            CurveSpan span = spanOf(curve);
            for (const auto& [what, held] : gesture_.spans)
                if (what == curve.what) span = held;
            spans_.push_back(span);
        }
    }

    float x(float frame) const {
        const float span = float(std::max(1, time_.last - time_.first));
        return low_.x + em(1) + (frame - float(time_.first)) / span * (high_.x - low_.x - em(2));
    }
    int frameAt(float at) const { return int(std::lround(frameNear(at))); }
    float y(size_t curve, float value) const {
        const CurveSpan& s = spans_[curve];
        return high_.y - (value - s.low) / (s.high - s.low) * (high_.y - low_.y);
    }
    ImVec2 place(size_t curve, const ValueKey& key, int component) const {
        return {x(float(key.frame)), y(curve, shownValue(infoOf(curves_[curve].what.value), key.value, component))};
    }
    /// Calls `see` with each key's curve, key, handle and place.
    template <class See>
    void eachHandle(See&& see) const {
        for (size_t i = 0; i < curves_.size(); ++i)
            for (const ValueKey& key : curves_[i].keys)
                for (int c = 0; c < curvesOf(infoOf(curves_[i].what.value)); ++c)
                    see(i, key, CurveHandle{{curves_[i].what, key.frame}, c}, place(i, key, c));
    }
    std::optional<CurveHandle> handleAt(const ImVec2& at) const {
        std::optional<CurveHandle> nearest;
        float least = em(0.7f);
        eachHandle([&](size_t, const ValueKey&, const CurveHandle& handle, const ImVec2& p) {
            if (const float d = std::hypot(p.x - at.x, p.y - at.y); d < least) least = d, nearest = handle;
        });
        return nearest;
    }
    std::optional<KeyedOf> curveAt(const ImVec2& at) const {
        std::optional<KeyedOf> nearest;
        float least = em(0.6f);
        for (size_t i = 0; i < curves_.size(); ++i) {
            const KeyedValueInfo& info = infoOf(curves_[i].what.value);
            for (int c = 0; c < curvesOf(info); ++c)
                if (const float d = std::abs(y(i, shownValue(info, valueAt(curves_[i], frameAt(at.x)), c)) - at.y);
                    d < least)
                    least = d, nearest = curves_[i].what;
        }
        return nearest;
    }

    void press(const ImVec2& at, bool more) {
        std::vector<CurveHandle>& chosen = time_.handles;
        gesture_ = {};
        gesture_.from = at;
        const auto handle = handleAt(at);
        if (!handle) {
            if (!more) chosen.clear();
            gesture_.kind = Gesture::Kind::box;
            return;
        }
        const auto there = std::find(chosen.begin(), chosen.end(), *handle);
        if (more && there != chosen.end()) {
            chosen.erase(there);
            return;
        }
        if (there == chosen.end()) {
            if (!more) chosen.clear();
            chosen.push_back(*handle);
        }
        gesture_.kind = Gesture::Kind::keys;
        gesture_.handles = chosen;
        for (size_t i = 0; i < curves_.size(); ++i) gesture_.spans.emplace_back(curves_[i].what, spans_[i]);
    }

    /// Moves the keys that were pressed on from where they were.
    void dragKeys(const ImVec2& to, bool oneWay) {
        float dx = to.x - gesture_.from.x, dy = to.y - gesture_.from.y;
        if (oneWay) (std::abs(dx) > std::abs(dy) ? dy : dx) = 0;
        const float perPixel = float(std::max(1, time_.last - time_.first)) / std::max(1.0f, high_.x - low_.x - em(2));
        const int frames = int(std::lround(dx * perPixel));
        const float height = high_.y - low_.y;
        std::vector<CurveHandle> now;
        editor_.preview([&](Look& look) {
            std::vector<KeyPick> picks;
            for (const CurveHandle& handle : gesture_.handles)
                if (std::find(picks.begin(), picks.end(), handle.key) == picks.end()) picks.push_back(handle.key);
            dragValueKeys(look, picks, {frames, 0, 0});
            now.clear();
            for (CurveHandle handle : gesture_.handles) {
                handle.key.frame = std::max(0, handle.key.frame + frames);
                for (const auto& [what, span] : gesture_.spans)
                    if (what == handle.key.what)
                        dragValueKeys(look, {handle.key}, {0, -dy / height * (span.high - span.low), handle.component});
                now.push_back(handle);
            }
        });
        time_.handles = now;
    }

    void chooseInBox(const ImVec2& to, bool more) {
        const ImVec2 a{std::min(to.x, gesture_.from.x), std::min(to.y, gesture_.from.y)};
        const ImVec2 b{std::max(to.x, gesture_.from.x), std::max(to.y, gesture_.from.y)};
        if (!more) time_.handles.clear();
        eachHandle([&](size_t, const ValueKey&, const CurveHandle& handle, const ImVec2& p) {
            if (p.x >= a.x && p.x <= b.x && p.y >= a.y && p.y <= b.y &&
                std::find(time_.handles.begin(), time_.handles.end(), handle) == time_.handles.end())
                time_.handles.push_back(handle);
        });
    }

    void draw(const ImVec2& pointer) const {
        ImDrawList* list = ImGui::GetWindowDrawList();
        list->AddRectFilled(low_, high_, IM_COL32(24, 24, 24, 255), 3);
        list->PushClipRect(low_, high_, true);
        drawAxes(list);
        list->AddLine({x(float(time_.frame)), low_.y}, {x(float(time_.frame)), high_.y}, IM_COL32(255, 150, 60, 160),
                      2);
        for (size_t i = 0; i < curves_.size(); ++i) drawCurve(list, i);
        if (gesture_.kind == Gesture::Kind::box && ImGui::IsMouseDown(0))
            list->AddRect(gesture_.from, pointer, IM_COL32(255, 255, 255, 120));
        list->PopClipRect();
    }

    const std::vector<ValueCurve>& curves() const { return curves_; }

private:
    Editor& editor_;
    TimeState& time_;
    ImVec2 low_, high_;
    std::vector<ValueCurve> curves_;
    Gesture& gesture_;
    std::vector<CurveSpan> spans_;

    float frameNear(float at) const {
        const float part = (at - low_.x - em(1)) / std::max(1.0f, high_.x - low_.x - em(2));
        return std::clamp(float(time_.first) + part * float(time_.last - time_.first), float(time_.first),
                          float(time_.last));
    }
    /// Numbers of the frames, and of the curve whose key was selected last, or else the first one.
    void drawAxes(ImDrawList* list) const {
        const float line = ImGui::GetTextLineHeight();
        const ImU32 faint = IM_COL32(255, 255, 255, 22), grey = IM_COL32(255, 255, 255, 120);
        const int step = frameStep(time_.last - time_.first, high_.x - low_.x);
        for (int f = (time_.first + step - 1) / step * step; f <= time_.last; f += step) {
            list->AddLine({x(float(f)), low_.y}, {x(float(f)), high_.y}, faint);
            const std::string words = std::to_string(f);
            list->AddText({std::min(x(float(f)) + 3, high_.x - ImGui::CalcTextSize(words.c_str()).x), high_.y - line},
                          grey, words.c_str());
        }
        size_t curve = 0;
        int component = 0;
        if (!time_.handles.empty())
            for (size_t i = 0; i < curves_.size(); ++i)
                if (curves_[i].what == time_.handles.back().key.what)
                    curve = i, component = time_.handles.back().component;
        const KeyedValueInfo& info = infoOf(curves_[curve].what.value);
        const ImU32 colour = (curveColour(info, curve, component) & ~IM_COL32_A_MASK) | IM_COL32(0, 0, 0, 200);
        const int most = std::max(2, int((high_.y - low_.y) / (2.2f * line)));
        for (const AxisTick& tick : axisTicks(editor_, curves_[curve].what, component, spans_[curve], most)) {
            const float at = y(curve, tick.drawn);
            list->AddLine({low_.x, at}, {high_.x, at}, faint);
            if (at < high_.y - 1.6f * line)
                list->AddText({low_.x + 3, std::max(at - line, low_.y)}, colour, tick.words.c_str());
        }
    }
    void drawCurve(ImDrawList* list, size_t i) const {
        const ValueCurve& curve = curves_[i];
        const KeyedValueInfo& info = infoOf(curve.what.value);
        const int numbers = curvesOf(info);
        for (int c = 0; c < numbers; ++c) {
            const ImU32 colour = curveColour(info, i, c);
            // Whole frames are what exists; a step every few pixels is enough to see the way.
            const int step = std::max(1, int(std::ceil(float(time_.last - time_.first) / (high_.x - low_.x) * 3)));
            std::vector<ImVec2> way;
            for (int f = time_.first;; f = std::min(f + step, time_.last)) {
                way.push_back({x(float(f)), y(i, shownValue(info, valueAt(curve, f), c))});
                if (f >= time_.last) break;
            }
            list->AddPolyline(way.data(), int(way.size()), colour, 0, std::max(1.0f, em(0.1f)));
        }
        for (const ValueKey& key : curve.keys)
            for (int c = 0; c < numbers; ++c) {
                const ImVec2 p = place(i, key, c);
                const bool chosen = std::find(time_.handles.begin(), time_.handles.end(),
                                              CurveHandle{{curve.what, key.frame}, c}) != time_.handles.end();
                const float r = em(chosen ? 0.42f : 0.32f);
                ImU32 colour = curveColour(info, i, c);
                if (info.kind == KeyedValueInfo::Kind::light) colour = ImGui::GetColorU32(lightColour(key.value));
                list->AddQuadFilled({p.x - r, p.y}, {p.x, p.y - r}, {p.x + r, p.y}, {p.x, p.y + r}, colour);
                list->AddQuad({p.x - r, p.y}, {p.x, p.y - r}, {p.x + r, p.y}, {p.x, p.y + r},
                              chosen ? IM_COL32(255, 255, 255, 255) : IM_COL32(0, 0, 0, 200), em(0.1f));
            }
    }
};

/// The curves of the selected lights, and without a selection all of them.
std::vector<ValueCurve> shownCurves(const Editor& editor) {
    const std::vector<std::string>& chosen = editor.state.selection.emitters;
    std::vector<ValueCurve> curves;
    for (const ValueCurve& curve : editor.look().curves)
        if (chosen.empty() || (infoOf(curve.what.value).ofLight() &&
                               std::find(chosen.begin(), chosen.end(), curve.what.of) != chosen.end()))
            curves.push_back(curve);
    return curves;
}

std::vector<KeyPick> picksOf(const std::vector<CurveHandle>& handles) {
    std::vector<KeyPick> picks;
    for (const CurveHandle& handle : handles)
        if (std::find(picks.begin(), picks.end(), handle.key) == picks.end()) picks.push_back(handle.key);
    return picks;
}

void deleteChosen(Editor& editor) {
    const std::vector<KeyPick> picks = picksOf(editor.state.time.handles);
    editor.edit("Delete keys", [&](Look& look) { deleteValueKeys(look, picks); });
    editor.state.time.handles.clear();
}

/// Under the right button: what is done to the selected keys.
void keyMenu(Editor& editor) {
    if (!ImGui::BeginPopup("##curve keys")) return;
    const std::vector<KeyPick> picks = picksOf(editor.state.time.handles);
    ImGui::BeginDisabled(picks.empty());
    for (int e = 0; e < 3; ++e) {
        if (ImGui::MenuItem(easeWords[e]))
            editor.edit(std::string(easeWords[e]) + " keys",
                        [&](Look& look) { easeValueKeys(look, picks, KeyEase(e)); });
        noteItem(std::string("curve ") + easeWords[e]);
        tooltip(easeTips[e]);
    }
    ImGui::Separator();
    if (ImGui::MenuItem("Delete keys", "Del")) deleteChosen(editor);
    noteItem("curve delete");
    tooltip("Forgets the selected keys");
    ImGui::EndDisabled();
    ImGui::EndPopup();
}

void curveList(Editor& editor, const std::vector<ValueCurve>& curves) {
    for (size_t i = 0; i < curves.size(); ++i) {
        const ValueCurve& curve = curves[i];
        const KeyedValueInfo& info = infoOf(curve.what.value);
        ImGui::PushID(int(i));
        const ImVec2 at = ImGui::GetCursorScreenPos();
        const int numbers = curvesOf(info);
        const float high = ImGui::GetTextLineHeight() / float(numbers);
        for (int c = 0; c < numbers; ++c)
            ImGui::GetWindowDrawList()->AddRectFilled(
                {at.x, at.y + high * float(c)}, {at.x + em(0.4f), at.y + high * float(c + 1)}, curveColour(info, i, c));
        ImGui::Indent(em(0.8f));
        const Vec3 value = valueAt(curve, editor.state.time.frame);
        const float room = ImGui::GetContentRegionAvail().x;
        const std::string name = nameOfValues(editor, {curve.what});
        text(elided(name, room));
        tooltip(fmt::format("{}: {} key{}", name, curve.keys.size(), curve.keys.size() == 1 ? "" : "s"));
        dimText(elided(valueWords(editor, curve, value), room));
        ImGui::Unindent(em(0.8f));
        ImGui::PopID();
    }
}

void forgetLostHandles(Editor& editor, const std::vector<ValueCurve>& curves) {
    std::erase_if(editor.state.time.handles, [&](const CurveHandle& handle) {
        for (const ValueCurve& curve : curves)
            if (curve.what == handle.key.what) return !valueKeyAt(curve, handle.key.frame);
        return true;
    });
}

}  // namespace

float curveListWidth(const Editor& editor) {
    if (shownCurves(editor).empty()) return 0;
    return std::floor(std::min(em(13), ImGui::GetContentRegionAvail().x * 0.35f)) + ImGui::GetStyle().ItemSpacing.x;
}

void drawCurveView(Editor& editor) {
    static Gesture gesture;
    const std::vector<ValueCurve> curves = shownCurves(editor);
    const ImVec2 room = ImGui::GetContentRegionAvail();
    if (curves.empty()) {
        dimWrapped(editor.look().curves.empty()
                       ? "No value has keys of its own yet: right click on a value of a light, the environment or the "
                         "materials, and set a key."
                       : "No value of the selected lights has keys of its own. With nothing selected, all curves are "
                         "shown.");
        return;
    }
    const float side = curveListWidth(editor) - ImGui::GetStyle().ItemSpacing.x, height = std::max(em(4), room.y - 2);
    if (beginChild("##curve list", {side, height})) curveList(editor, curves);
    ImGui::EndChild();
    ImGui::SameLine();
    const ImVec2 low = ImGui::GetCursorScreenPos();
    const ImVec2 high(low.x + std::max(em(8), ImGui::GetContentRegionAvail().x), low.y + height);
    if (!ImGui::IsMouseDown(0) && !editor.inGesture()) gesture = {};
    forgetLostHandles(editor, curves);
    CurveView view(editor, low, high, curves, gesture);
    ImGui::InvisibleButton("##curves", {high.x - low.x, high.y - low.y});
    noteItem("curves");
    view.eachHandle([&](size_t, const ValueKey&, const CurveHandle& handle, const ImVec2& p) {
        notePoint(fmt::format("curve {} {} {}", infoOf(handle.key.what.value).name, handle.key.frame, handle.component),
                  {p.x, p.y});
    });
    const ImVec2 pointer = ImGui::GetIO().MousePos;
    const bool more = ImGui::GetIO().KeyShift || ImGui::GetIO().KeyCtrl;
    const bool hovered = ImGui::IsItemHovered();
    if (ImGui::IsItemActivated()) view.press(pointer, more);
    const bool dragging = ImGui::IsItemActive() && ImGui::IsMouseDragging(0, em(0.2f));
    // Nothing else follows the pointer while the button is held, so that what was pressed first goes on.
    const bool moves = gesture.kind == Gesture::Kind::keys && (dragging || editor.inGesture());
    if (moves && ImGui::IsItemActive() && !editor.inGesture()) editor.beginGesture("Move keys");
    if (moves && editor.inGesture()) {
        if (ImGui::IsItemActive() && escapePressed()) {
            takeEscape();
            editor.abandonGesture();
            editor.state.time.handles = gesture.handles;
            gesture = {};
            ImGui::ClearActiveID();
        } else if (ImGui::IsItemActive()) {
            view.dragKeys(pointer, ImGui::GetIO().KeyShift);
        } else {
            editor.commitGesture();
            gesture = {};
        }
    }
    if (gesture.kind == Gesture::Kind::box && dragging) view.chooseInBox(pointer, more);
    if (hovered && ImGui::IsMouseDoubleClicked(0) && !view.handleAt(pointer))
        if (const auto what = view.curveAt(pointer))
            editor.edit("Set key of " + nameOfValues(editor, {*what}),
                        [&](Look& look) { putOnCurve(look, *what, view.frameAt(pointer.x)); });
    if (hovered && ImGui::IsMouseReleased(ImGuiMouseButton_Right)) {
        if (const auto handle = view.handleAt(pointer))
            if (auto& chosen = editor.state.time.handles;
                std::find(chosen.begin(), chosen.end(), *handle) == chosen.end())
                chosen = {*handle};
        ImGui::OpenPopup("##curve keys");
    }
    keyMenu(editor);
    // The part of the window that was clicked last has the key Del: keys here, lights elsewhere.
    bool& takes = editor.state.time.takesDelete;
    takes = !editor.state.time.handles.empty() && !editor.inGesture() &&
            ImGui::IsWindowFocused(ImGuiFocusedFlags_RootAndChildWindows);
    if (takes && input().pressed == keyDelete) deleteChosen(editor);
    view.draw(pointer);
    if (!ImGui::IsItemActive() && hovered) {
        std::string words =
            "Drag keys in time and value, Shift in one direction alone. A box selects several; right "
            "click: how they go on; Del deletes. Double click on a curve sets a key. Each value has its own scale: the "
            "numbers are those of the key that was selected last.";
        if (const auto handle = view.handleAt(pointer))
            if (const ValueCurve* curve = curveOf(editor.look(), handle->key.what))
                if (const ValueKey* key = valueKeyAt(*curve, handle->key.frame))
                    words = fmt::format("{}, frame {}: {}", nameOfValues(editor, {curve->what}), key->frame,
                                        valueWords(editor, *curve, key->value));
        tooltip(words);
    }
}

}  // namespace relamp::ui
