// Marks a light reference in a photograph: the photograph large, with what is marked drawn over it.
#include <atomic>
#include <thread>

#include "item_map.h"
#include "panels/dialogs.h"
#include "panels/images.h"
#include "panels/reference_marks.h"
#include "pipeline/pipeline.h"
#include "pipeline/probe_stage.h"
#include "solve/chart.h"
#include "widgets.h"

namespace relamp::ui {
namespace {

using Kind = MarkedReference::Kind;

/// Where a ball's rim was found, for what was marked. Filled by a thread of its own, which may outlive the dialog.
struct FoundRim {
    MarkedReference of;
    std::weak_ptr<const Capture> in;
    std::atomic<bool> done{false};
    std::vector<Vec2> rim;  ///< pixels
    std::string words, error;
};

void lookForRim(const Capture& capture, FoundRim& found) {
    PipelineOptions options;
    takeReference(found.of, options);
    const BallInView ball = findBall(options.mirrorBalls.at(0), capture);
    const Vec3 axis = ball.rim.axis,
               first = glm::normalize(glm::cross(axis, std::abs(axis.z) < 0.9f ? Vec3(0, 0, 1) : Vec3(1, 0, 0))),
               second = glm::cross(axis, first);
    constexpr int points = 72;
    for (int i = 0; i < points; ++i) {
        const float angle = 2 * pi * float(i) / points;
        const Vec3 direction = std::cos(ball.rim.halfAngle) * axis +
                               std::sin(ball.rim.halfAngle) * (std::cos(angle) * first + std::sin(angle) * second);
        if (const auto pixel = ball.camera.project(ball.camera.position() + DVec3(direction)))
            found.rim.push_back(*pixel);
    }
    found.words = fmt::format("Rim found: an edge along {} of it.", percent(double(ball.rim.support)));
}

/// Of the mark as it is now; null while it is being changed.
std::shared_ptr<const FoundRim> rimOf(const Document& document, const MarkedReference& mark, bool atRest) {
    static std::shared_ptr<FoundRim> last;
    if (!atRest || !document.capture) return nullptr;
    if (!last || !(last->of == mark) || last->in.lock() != document.capture) {
        last = std::make_shared<FoundRim>();
        last->of = mark;
        last->in = document.capture;
        std::thread([found = last, capture = document.capture] {
            try {
                lookForRim(*capture, *found);
            } catch (const std::exception& error) { found->error = error.what(); }
            found->done = true;
        }).detach();
    }
    if (!last->done) stayAwake();
    return last;
}

constexpr ImU32 lineColour = IM_COL32(255, 176, 64, 255), foundColour = IM_COL32(96, 220, 140, 255),
                shadowColour = IM_COL32(0, 0, 0, 160);

ImVec2 screenOf(const PhotographPlace& place, const Vec2& pixel) {
    const Vec2 at = place.toScreen(pixel);
    return {at.x, at.y};
}

void drawCircle(ImDrawList* list, const PhotographPlace& place, const Vec2& centre, float radius, ImU32 colour) {
    const float size = std::max(2.0f, place.scale * radius);
    list->AddCircle(screenOf(place, centre), size + 1, shadowColour, 64, em(0.1f));
    list->AddCircle(screenOf(place, centre), size, colour, 64, em(0.1f));
}

void drawChart(ImDrawList* list, const PhotographPlace& place, const MarkedReference& mark, std::string& trouble) {
    for (const Vec2& p : mark.points) drawCircle(list, place, p, 4 / place.scale, lineColour);
    if (!isComplete(mark)) return;
    try {
        for (const KnownPatch& patch :
             chartPatches(mark.view, {mark.points[0], mark.points[1], mark.points[2], mark.points[3]})) {
            drawCircle(list, place, patch.centre, patch.radius, lineColour);
            // What it should look like, beside it.
            const ImVec2 at = screenOf(place, patch.centre);
            list->AddCircleFilled(at, std::max(1.0f, 0.4f * place.scale * patch.radius),
                                  ImGui::GetColorU32(toScreen(glm::pow(patch.albedo, Rgb(1 / 2.2f)))), 24);
        }
    } catch (const Error& error) { trouble = error.what(); }
}

struct Shown {
    PhotographImage image;
    std::string trouble;  ///< why it cannot be used as it is
    std::string words;
    bool pending = false;  ///< it is not known yet whether it can be used
};

PhotographImage imageOf(const Document& document, const MarkedReference& mark) {
    return mark.photograph.empty() ? viewPhotograph(document, mark.view) : filePhotograph(mark.photograph);
}

MarkingGesture& gesture() {
    static MarkingGesture one;
    return one;
}

/// The photograph and what is marked in it, in `size`.
Shown drawCanvas(Editor& editor, ReferenceMarking& marking, const ImVec2& size) {
    Shown shown{imageOf(editor.state.document, marking.mark), {}, {}, false};
    const PhotographImage& image = shown.image;
    const ImVec2 low = ImGui::GetCursorScreenPos();
    ImGui::InvisibleButton(
        "##photograph", size,
        ImGuiButtonFlags_MouseButtonLeft | ImGuiButtonFlags_MouseButtonRight | ImGuiButtonFlags_MouseButtonMiddle);
    noteItem("marked photograph");
    ImDrawList* list = ImGui::GetWindowDrawList();
    list->AddRectFilled(low, {low.x + size.x, low.y + size.y}, IM_COL32(16, 16, 16, 255));
    if (!image.error.empty()) shown.trouble = image.error;
    if (image.width < 1 || image.height < 1) return shown;
    const float fit = std::min(size.x / float(image.width), size.y / float(image.height));
    if (!(marking.zoom > 0)) {
        marking.zoom = 1;
        marking.middle = 0.5f * Vec2(float(image.width), float(image.height));
    }
    PhotographPlace place{{low.x, low.y}, {size.x, size.y}, marking.middle, fit * marking.zoom};
    const Vec2 at{ImGui::GetIO().MousePos.x, ImGui::GetIO().MousePos.y};
    if (ImGui::IsItemHovered() && ImGui::GetIO().MouseWheel != 0) {
        // The pixel under the pointer stays there.
        const Vec2 pixel = place.toPixel(at);
        marking.zoom = std::clamp(marking.zoom * std::pow(1.25f, ImGui::GetIO().MouseWheel), 1.0f, 40.0f);
        place.scale = fit * marking.zoom;
        marking.middle += pixel - place.toPixel(at);
        place.middle = marking.middle;
    }
    if (ImGui::IsItemActive() && !ImGui::IsMouseDown(ImGuiMouseButton_Left)) {
        marking.middle -= Vec2(ImGui::GetIO().MouseDelta.x, ImGui::GetIO().MouseDelta.y) / place.scale;
        place.middle = marking.middle;
    }
    if (ImGui::IsItemActivated() && ImGui::IsMouseClicked(ImGuiMouseButton_Left))
        gesture().press(marking.mark, place, at, em(0.6f));
    if (gesture().active()) {
        if (ImGui::IsMouseDown(ImGuiMouseButton_Left)) gesture().drag(marking.mark, place, at);
        else gesture().release(marking.mark, place);
    }
    list->PushClipRect(low, {low.x + size.x, low.y + size.y}, true);
    if (image.texture)
        list->AddImage(textureId(image.texture), screenOf(place, {0, 0}),
                       screenOf(place, {float(image.width), float(image.height)}));
    const MarkedReference& mark = marking.mark;
    if (mark.kind == Kind::chart) drawChart(list, place, mark, shown.trouble);
    else if (!mark.points.empty()) drawCircle(list, place, mark.points[0], mark.radius, lineColour);
    if (mark.kind == Kind::mirrorBall && isComplete(mark)) {
        const auto rim = rimOf(editor.state.document, mark, !gesture().active());
        shown.pending = !rim || !rim->done;
        if (!shown.pending) {
            shown.words = rim->words;
            if (!rim->error.empty()) shown.trouble = rim->error;
            std::vector<ImVec2> line;
            for (const Vec2& p : rim->rim) line.push_back(screenOf(place, p));
            list->AddPolyline(line.data(), int(line.size()), foundColour, ImDrawFlags_Closed, em(0.1f));
        } else if (rim) {
            shown.words = "Looking for its rim...";
        }
    }
    list->PopClipRect();
    return shown;
}

void viewChoice(const Editor& editor, ReferenceMarking& marking) {
    const auto& views = editor.state.document.capture->views;
    size_t view = marking.mark.view;
    ImGui::AlignTextToFramePadding();
    dimText("View");
    ImGui::SameLine();
    ImGui::SetNextItemWidth(em(14));
    if (ImGui::BeginCombo("##view", shown(views[view].name).c_str())) {
        for (size_t i = 0; i < views.size(); ++i)
            if (ImGui::Selectable(fmt::format("{}##{}", shown(views[i].name), i).c_str(), i == view)) view = i;
        ImGui::EndCombo();
    }
    tooltip(marking.mark.kind == Kind::mirrorBall && !marking.mark.photograph.empty()
                ? "The view whose camera took the photograph, from the same place"
                : "The photograph that shows it");
    if (view == marking.mark.view) return;
    marking.mark.view = view;
    if (!marking.mark.photograph.empty()) return;
    marking.mark.points.clear();
    marking.mark.radius = 0;
    marking.zoom = 0;
}

void ballPhotograph(Editor& editor, ReferenceMarking& marking) {
    const std::filesystem::path& file = marking.mark.photograph;
    const auto take = [](Editor& e, const std::filesystem::path& chosen) {
        if (!e.state.marking) return;
        ReferenceMarking& open = *e.state.marking;
        open.mark.photograph = chosen;
        open.mark.points.clear();
        open.mark.radius = 0;
        open.zoom = 0;
    };
    if (button(
            file.empty() ? "Other photograph..." : shown(file.filename()).c_str(),
            "The ball in a photograph of its own, which the view's camera took from the same place (EXR, HDR, ...)")) {
        BrowserRequest request;
        request.title = "Choose a photograph of the mirror ball";
        request.confirm = "Use";
        request.extensions = {".exr", ".hdr", ".tif", ".tiff", ".dpx", ".png", ".jpg", ".jpeg"};
        request.note = "Taken with the view's camera, from the same place, in any size. HDR, so that lights are whole.";
        request.start = editor.state.document.captureFolder;
        browse(request, take);
    }
    if (file.empty()) return;
    ImGui::SameLine();
    if (iconButton("##no photograph", Icon::trash, "The ball is in the view's own photograph")) take(editor, {});
}

void greyAlbedo(MarkedReference& mark) {
    ImGui::AlignTextToFramePadding();
    dimText("Reflects");
    ImGui::SameLine();
    float value = 100 * mark.albedo.x;
    ImGui::SetNextItemWidth(em(5));
    if (ImGui::DragFloat("##albedo", &value, 0.2f, 0.5f, 100, "%.1f %%", ImGuiSliderFlags_AlwaysClamp))
        mark.albedo = Rgb(value / 100);
    tooltip("Albedo: what the card throws back of the light. Grey cards have 18 %, white ones about 90 %.");
}

}  // namespace

bool drawReferenceDialog(Editor& editor) {
    const auto close = [&editor] {
        editor.state.marking.reset();
        dropPhotographs();
        return true;
    };
    if (!editor.state.marking || !editor.state.document.capture ||
        editor.state.marking->mark.view >= editor.state.document.capture->views.size())
        return close();
    ReferenceMarking& marking = *editor.state.marking;
    viewChoice(editor, marking);
    if (marking.mark.kind == Kind::mirrorBall) {
        ImGui::SameLine();
        ballPhotograph(editor, marking);
    }
    if (marking.mark.kind == Kind::grey) {
        ImGui::SameLine();
        greyAlbedo(marking.mark);
    }
    wrapped(nextStepOf(marking.mark));
    const float below = 2 * ImGui::GetTextLineHeightWithSpacing() + ImGui::GetFrameHeightWithSpacing();
    const ImVec2 room = ImGui::GetContentRegionAvail();
    const Shown shown = drawCanvas(editor, marking, {std::max(em(8), room.x), std::max(em(6), room.y - below)});
    if (!shown.trouble.empty()) warningText(ui::shown(shown.trouble));
    else dimText(shown.words.empty() ? "Wheel: closer. Right or middle button: moves the photograph." : shown.words);
    ImGui::BeginDisabled(!isComplete(marking.mark) || shown.pending || !shown.trouble.empty());
    const bool use = primaryButton("Use", "The next estimate takes it as a measurement", em(7));
    noteItem("use reference");
    ImGui::EndDisabled();
    ImGui::SameLine();
    if (button("Cancel", "Changes nothing (Esc)", em(7)) || escapePressed()) return close();
    if (!use) return false;
    std::vector<MarkedReference>& marks = editor.state.solve.marks;
    if (marking.replaces && *marking.replaces < marks.size()) marks[*marking.replaces] = marking.mark;
    else marks.push_back(marking.mark);
    return close();
}

}  // namespace relamp::ui
