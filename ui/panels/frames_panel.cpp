// Time: the frame that is shown, the look's keys on a strip, and playing.
#include "edit/look_keys.h"
#include "item_map.h"
#include "panels/curve_values.h"
#include "panels/curve_view.h"
#include "panels/panels.h"
#include "widgets.h"

namespace relamp::ui {
namespace {

constexpr const char* easeNames[] = {"Linear", "Smooth", "Hold"};
constexpr const char* easeExplanations[] = {"From this key to the next at even speed", "Starts and ends slowly",
                                            "Stays until the next key, then changes at once"};

/// A whole number to drag or to type; true when it changed.
bool wholeNumber(const char* id, const char* name, int& value, int least, int most, const char* explanation) {
    ImGui::SetNextItemWidth(em(4.5f));
    const bool changed = ImGui::DragInt(id, &value, 0.15f, least, most, (std::string(name) + " %d").c_str(),
                                        ImGuiSliderFlags_AlwaysClamp);
    noteItem(std::string("frames ") + name);
    tooltip(explanation);
    return changed;
}

void playRow(Editor& editor) {
    TimeState& time = editor.state.time;
    const bool keyed = !keyFrames(editor.look()).empty();
    ImGui::BeginDisabled(!editor.estimate());
    if (button(time.playing ? "Pause###play" : "Play###play", "Shows one frame after the other (Space)", em(4.5f)))
        editor.play(!time.playing);
    noteItem("frames play");
    ImGui::SameLine();
    int frame = time.frame;
    if (wholeNumber("##frame", "frame", frame, 0, 1'000'000, "The frame that is shown")) editor.goToFrame(frame);
    ImGui::SameLine();
    if (button("Set key",
               "Keeps the look as it is for this frame (K). With keys, every edit sets the key of its frame"))
        editor.setKey();
    noteItem("set key");
    ImGui::EndDisabled();
    ImGui::SameLine();
    const int at = keyAt(editor.look(), time.frame);
    ImGui::BeginDisabled(at < 0);
    if (button("Delete key", "Forgets the key of this frame (Shift+K)")) editor.deleteKey(time.frame);
    noteItem("delete key");
    sameLineIfFits(em(6));
    ImGui::SetNextItemWidth(em(5.5f));
    const int ease = at < 0 ? 0 : int(editor.look().keys[size_t(at)].ease);
    if (ImGui::BeginCombo("##ease", easeNames[ease])) {
        for (int e = 0; e < 3; ++e) {
            if (ImGui::Selectable(easeNames[e], e == ease)) editor.easeKey(time.frame, KeyEase(e));
            tooltip(easeExplanations[e]);
        }
        ImGui::EndCombo();
    }
    noteItem("ease");
    tooltip("How the look goes from this key to the next");
    ImGui::EndDisabled();
    sameLineIfFits(em(16));
    if (wholeNumber("##first", "from", time.first, 0, time.last, "First frame of the strip and of playing"))
        time.last = std::max(time.first, time.last);
    ImGui::SameLine();
    if (wholeNumber("##last", "to", time.last, time.first, 1'000'000, "Last frame of the strip and of playing"))
        time.first = std::min(time.first, time.last);
    ImGui::SameLine();
    ImGui::SetNextItemWidth(em(4.5f));
    float speed = float(time.framesPerSecond);
    if (ImGui::DragFloat("##speed", &speed, 0.1f, 1, 120, "%.3g fps", ImGuiSliderFlags_AlwaysClamp))
        time.framesPerSecond = double(speed);
    tooltip(
        "Frames a second while playing. The first pass shows every frame as soon as it is made; after it frames "
        "come at this speed.");
    sameLineIfFits(em(5));
    checkbox("Loop", time.loop, "Playing begins again at its end");
    sameLineIfFits(em(7));
    ImGui::SetNextItemWidth(em(7));
    ImGui::DragInt("##kept", &time.keptMiB, 16, 256, 262'144, "keep %d MiB", ImGuiSliderFlags_AlwaysClamp);
    noteItem("kept memory");
    tooltip(
        "Memory of frames that were played, for the scene and the plate a half each. A frame of a plate of 1280 x 720 "
        "takes 7 MiB.");
    if (editor.plate()) {
        sameLineIfFits(em(9));
        ImGui::SetNextItemWidth(em(8));
        float& opacity = editor.state.viewport.plateOpacity;
        ImGui::SliderFloat("##opacity", &opacity, 0, 1, "plate %.2f", ImGuiSliderFlags_AlwaysClamp);
        noteItem("plate opacity");
        tooltip("How opaque the plate lies behind the scene, when you look through its camera");
        sameLineIfFits(em(7));
        ViewportState& viewport = editor.state.viewport;
        if (checkbox("Plate relit", viewport.plateRelit,
                     "Shows the plate as the export relights it, steadied by its neighbours, once nothing moves: with "
                     "key 1, "
                     "in the wipe (9), and behind the scene. Key 2 shows it relit by itself at rest.") &&
            viewport.plateRelit)
            viewport.mode = ViewMode::photograph;
        noteItem("plate relit");
        if (editor.relightingPlate()) {
            ImGui::SameLine();
            dimText("relighting...");
        }
    }
    sameLineIfFits(em(6));
    checkbox("Curves", time.curves, "Values that have keys of their own, against the frames");
    noteItem("curves shown");
    if (!keyed && !time.curves)
        dimText(
            "No keys yet: go to a frame, set the lights, press K, and change them at another frame. Right click on a "
            "value keys that alone.");
}

/// The strip: numbers, kept frames, keys and the playhead.
class TimeStrip {
public:
    TimeStrip(Editor& editor, const ImVec2& low, const ImVec2& high)
        : editor_(editor), time_(editor.state.time), low_(low), high_(high) {}

    float x(double frame) const {
        const double span = std::max(1, time_.last - time_.first);
        return low_.x + margin() + float((frame - time_.first) / span) * (high_.x - low_.x - 2 * margin());
    }
    int frameAt(float x) const {
        const float part = (x - low_.x - margin()) / std::max(1.0f, high_.x - low_.x - 2 * margin());
        return std::clamp(time_.first + int(std::lround(part * float(time_.last - time_.first))), time_.first,
                          time_.last);
    }
    /// The key within reach of the pointer; -1: none.
    int keyUnder(const ImVec2& at) const {
        int nearest = -1;
        float least = em(0.7f);
        for (const LookKey& key : editor_.look().keys)
            if (const float d = std::abs(x(key.frame) - at.x); d < least) least = d, nearest = key.frame;
        return nearest;
    }
    void draw(int lifted, int liftedTo) const {
        ImDrawList* list = ImGui::GetWindowDrawList();
        list->AddRectFilled(low_, high_, IM_COL32(24, 24, 24, 255), 3);
        list->PushClipRect(low_, high_, true);
        for (int f = time_.first; f <= time_.last && time_.last - time_.first < 4096; ++f)
            if (editor_.frameKept(f))
                list->AddRectFilled({x(f - 0.5), high_.y - em(0.25f)}, {x(f + 0.5), high_.y},
                                    IM_COL32(72, 108, 148, 255));
        if (const auto plate = editor_.plate())
            for (const PlateFrame& frame : plate->plate.frames)
                if (frame.number >= time_.first && frame.number <= time_.last)
                    list->AddRectFilled({x(frame.number - 0.5), high_.y - em(0.4f)},
                                        {x(frame.number + 0.5), high_.y - em(0.25f)}, IM_COL32(120, 120, 120, 255));
        const int step = frameStep(time_.last - time_.first, high_.x - low_.x);
        for (int f = (time_.first + step - 1) / step * step; f <= time_.last; f += step) {
            list->AddLine({x(f), low_.y}, {x(f), low_.y + em(0.5f)}, IM_COL32(255, 255, 255, 90));
            const std::string words = std::to_string(f);
            // The last one stands before its line where there is no room behind it.
            const float width = ImGui::CalcTextSize(words.c_str()).x;
            const float at = x(f) + 3 + width <= high_.x ? x(f) + 3 : x(f) - 3 - width;
            list->AddText({at, low_.y}, IM_COL32(255, 255, 255, 120), words.c_str());
        }
        list->AddLine({x(time_.frame), low_.y}, {x(time_.frame), high_.y}, IM_COL32(255, 150, 60, 255), 2);
        const float y = 0.5f * (low_.y + high_.y) + em(0.3f), r = em(0.4f);
        for (const LookKey& key : editor_.look().keys) {
            const float at = x(key.frame == lifted ? liftedTo : key.frame);
            if (at < low_.x || at > high_.x) continue;
            const ImU32 colour = key.frame == time_.frame ? IM_COL32(255, 190, 110, 255) : IM_COL32(210, 210, 210, 255);
            list->AddQuadFilled({at - r, y}, {at, y - r}, {at + r, y}, {at, y + r}, colour);
        }
        for (const ValueCurve& curve : editor_.look().curves)
            for (const ValueKey& key : curve.keys)
                if (key.frame >= time_.first && key.frame <= time_.last)
                    list->AddCircleFilled({x(key.frame), high_.y - em(0.65f)}, em(0.2f), IM_COL32(110, 160, 230, 255));
        list->PopClipRect();
    }

private:
    Editor& editor_;
    const TimeState& time_;
    ImVec2 low_, high_;
    static float margin() { return em(1); }
};

void drawStrip(Editor& editor) {
    TimeState& time = editor.state.time;
    // Frames stand over those of the curves.
    if (time.curves) ImGui::SetCursorPosX(ImGui::GetCursorPosX() + curveListWidth(editor));
    const ImVec2 room = ImGui::GetContentRegionAvail();
    const float height = time.curves ? em(2.6f) : std::max(em(2.6f), std::min(room.y - 2, em(4)));
    const ImVec2 low = ImGui::GetCursorScreenPos(), high(low.x + std::max(room.x, em(8)), low.y + height);
    static int lifted = -1;
    ImGui::InvisibleButton("##strip", {high.x - low.x, height});
    noteItem("frames strip");
    const TimeStrip strip(editor, low, high);
    const ImVec2 pointer = ImGui::GetIO().MousePos;
    const int under = ImGui::IsItemHovered() ? strip.keyUnder(pointer) : -1;
    if (ImGui::IsItemActivated()) lifted = pointer.y > low.y + em(1) ? under : -1;
    const int to = strip.frameAt(pointer.x);
    time.scrubbing = ImGui::IsItemActive() && lifted < 0;
    if (time.scrubbing) {
        editor.play(false);
        editor.goToFrame(to);
    }
    strip.draw(lifted, to);
    if (ImGui::IsItemDeactivated() && lifted >= 0) {
        // A click on a key goes there; a drag moves it.
        if (to != lifted && !escapePressed()) editor.moveKey(lifted, to);
        editor.goToFrame(to);
        lifted = -1;
    }
    if (!ImGui::IsItemActive())
        tooltip(under >= 0 ? fmt::format("Key at frame {}: drag it to another frame, or click to go there", under)
                           : "Drag to go through the frames. Diamonds: keys of the look; dots: keys of single values. "
                             "Blue: frames that were played and come at once. Grey: frames of the plate");
}

}  // namespace

void drawFramesPanel(Editor& editor) {
    playRow(editor);
    drawStrip(editor);
    if (editor.state.time.curves) drawCurveView(editor);
}

}  // namespace relamp::ui
