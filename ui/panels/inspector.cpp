#include "panels/inspector.h"

#include "panels/images.h"
#include "panels/panels.h"
#include "viewport/light_stroke.h"
#include "widgets.h"

namespace relamp::ui {

void inspectView(Editor& editor, int index) {
    const Document& document = editor.state.document;
    if (!document.capture || index < 0 || size_t(index) >= document.capture->views.size()) return;
    const View& view = document.capture->views[size_t(index)];
    const Camera& camera = view.camera;
    const float width = std::min(ImGui::GetContentRegionAvail().x, em(18));
    image("##image", viewImage(document, size_t(index)), width,
          camera.width > 0 ? width * float(camera.height) / float(camera.width) : width * 0.75f, "no image");
    fact("Photograph", fmt::format("{} ({} of {})", shown(view.name), index + 1, document.capture->views.size()));
    fact("Size", fmt::format("{} x {} pixels", camera.width, camera.height));
    fact("Lens",
         fmt::format("{:.0f} pixels, {:.0f}\u00b0 wide", camera.focalX,
                     2 * std::atan(camera.width / 2.0 / std::max(1e-9, camera.focalX)) * 180 / piD),
         "Focal length in pixels, and the angle from the left to the right edge");
    fact("Lens model", lensModelName(camera.model),
         "How the lens bends straight lines; SIMPLE_PINHOLE and PINHOLE do not");
    const DVec3 p = document.capture->origin + camera.position();
    fact("Stands at", placeText(p, editor.state.lengthUnit));
    if (document.check && size_t(index) < document.check->views.size()) {
        const ViewCheck& check = document.check->views[size_t(index)];
        fact("Shows the mesh", percent(check.meshFraction), "Fraction of its pixels that see the mesh");
        fact("Clipped", percent(check.clippedFraction),
             "Pixels too bright for the file: they say \"at least this bright\"");
        if (check.maskedFraction > 0)
            fact("Left out", percent(check.maskedFraction), "Pixels that are masked or broken");
        if (check.comparedVertices > 0)
            fact("Exposure", fmt::format("{} stops against the others", signedStops(float(check.exposureStops))),
                 "How much brighter or darker it is than the other views of the same surfaces. All views must share "
                 "one scale.");
    }
    bool through = editor.state.viewport.throughView;
    if (checkbox("Look through it", through, "The viewport takes the place of this camera (C)"))
        editor.state.viewport.throughView = through;
    checkbox("Mesh over it", editor.state.viewport.meshOverlay,
             "Draws the mesh's edges over the photograph: they should lie on what they belong to");
}

namespace {

/// Components that have a triangle; counted once a scene.
size_t objectsOf(const std::shared_ptr<const Scene>& scene) {
    static std::weak_ptr<const Scene> counted;
    static size_t objects = 0;
    if (counted.lock() != scene) {
        std::vector<char> met(scene->components, 0);
        for (const auto& triangle : scene->mesh.triangles) met[scene->component[triangle[0]]] = 1;
        objects = size_t(std::count(met.begin(), met.end(), 1));
        counted = scene;
    }
    return objects;
}

}  // namespace

void inspectScene(Editor& editor) {
    const Document& document = editor.state.document;
    if (!document.capture)
        return dimWrapped(editor.job()
                              ? shown(editor.job()->title) + "..."
                              : "Nothing is open. Drop a capture folder or a shot on the window, or press Ctrl+O.");
    const auto estimate = editor.estimate();
    const std::filesystem::path& folder = document.captureFolder;
    fact("Capture", shown((folder.has_filename() ? folder : folder.parent_path()).filename()), shown(folder));
    if (!document.shotFolder.empty()) fact("Shot", shown(document.shotFolder.filename()), shown(document.shotFolder));
    fact("Views", count(document.capture->views.size()));
    if (document.scene) {
        fact("Mesh", fmt::format("{} points, {} triangles", count(document.scene->mesh.vertexCount()),
                                 count(document.scene->mesh.triangles.size())));
        fact("Components", count(objectsOf(document.scene)), "Parts of the mesh that do not touch each other");
    }
    if (document.check) {
        fact("Seen twice", percent(document.check->seenTwiceFraction),
             "Fraction of the surface that two photographs or more show; the more, the better light and surface can be "
             "told apart");
        if (!document.check->warnings.empty()) {
            warningText(fmt::format("{} thing{} to look at in the capture.", document.check->warnings.size(),
                                    document.check->warnings.size() == 1 ? "" : "s"));
            if (button("Check the capture...", "Shows what was noticed about cameras, exposure and mesh"))
                editor.state.panels.doctor = true;
        }
    }
    if (!estimate) {
        dimWrapped("Not estimated yet. Press Estimate, or Ctrl+Enter.");
        return;
    }
    heading("Estimate");
    fact("Lights", fmt::format("{} recovered", estimate->emitters.emitters.size()));
    if (estimate->lighting.leaves.size() > 0)
        fact("Distant light", fmt::format("{} patches of sky", estimate->lighting.leaves.size()),
             "Unknowns of the environment: bright parts are divided more finely");
    fact("Scale", estimate->gauge.kind == "assumed" ? "assumed" : "measured",
         "Brightness scale: how light and surface brightness were told apart");
    dimWrapped(estimate->gauge.evidence);
    if (estimate->gauge.kind == "assumed")
        warningText("All lights may be too bright and all surfaces too dark by one factor, or the other way round.");
    if (estimate->cancelled) warningText("It was stopped early: this is the best answer so far.");
    if (!estimate->timeline.empty())
        fact("Error", fmt::format("{:.3g}", estimate->timeline.back().rmse),
             "Mean difference between photographs and model, in the radiance units of the photographs");
    inspectLightReferences(*estimate);
    if (section("Certainty", "Figures about the calculation itself", false)) {
        const StabilityReport& s = estimate->stability;
        fact("Unknowns", fmt::format("{}, {} of them determined", s.unknowns, s.effectiveRank),
             "Unknown lights, and how many the photographs pin down by themselves");
        fact("Stiffness", fmt::format("{:.2g}", s.conditionNumber),
             "Condition number: how much noise in the photographs may be amplified. Below a million is harmless.");
        fact("Residual", fmt::format("{:.1g}", s.kktResidual),
             "How far the last calculation was from its optimum; near 0 is good");
        if (!s.reason.empty()) warningText(s.reason);
        if (document.resources.seconds > 0)
            fact("Took", fmt::format("{}, {}, {} threads", duration(document.resources.seconds),
                                     mebibytes(document.resources.peakMib), document.resources.threads));
    }
    if (!estimate->leftOut.empty() &&
        section("What was left out", "Effects that the estimate does not model, and why", false))
        for (const LeftOut& left : estimate->leftOut) {
            text(nameOf(left.what));
            dimWrapped(left.why);
        }
    if (const auto frame = editor.liveFrame(); frame && section("Viewport", "What the image on screen costs", false)) {
        fact("Prepared in", duration(frame->report.bakeSeconds));
        fact("Light change", fmt::format("{:.1f} ms", frame->report.lightMs));
        fact("Moved light", fmt::format("{:.1f} ms", frame->report.moveMs));
        fact("Memory", fmt::format("{} bytes a point", frame->report.bytesPerVertex));
    }
}

void drawInspectorPanel(Editor& editor) {
    if (editor.state.viewport.tool == Tool::paint && section("Paint with light", "Lights that do what is painted"))
        inspectLightBrush(editor);
    const Selection selection = editor.state.selection;
    const EmitterState* found = selection.emitters.empty() ? nullptr : editor.emitter(selection.active());
    const bool point = !found && selection.point.has_value();
    if (found) {
        const EmitterState emitter = *found;  // an edit below renews the list
        inspectEmitter(editor, emitter);
    } else if (point) {
        inspectPoint(editor, *selection.point);
    }
    const bool other = found || point;
    if (editor.state.document.capture && !point &&
        section(fmt::format("View {}###view", selection.view + 1).c_str(), "The selected photograph", !other))
        inspectView(editor, selection.view);
    if (other) {
        ImGui::PushID("folded");
        if (section("Scene", "The capture and its estimate in figures", false)) inspectScene(editor);
        ImGui::PopID();
    } else if (section("Scene", "The capture and its estimate in figures")) {
        inspectScene(editor);
    }
}

}  // namespace relamp::ui
