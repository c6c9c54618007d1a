#include "viewport/navigation.h"

#include "base/box.h"
#include "edit/bookmark_edits.h"
#include "viewport/display_transform.h"

namespace relamp::ui {
namespace {

const Capture* captureOf(const Editor& editor) { return editor.state.document.capture.get(); }

/// A sphere about the target fills the viewport's smaller side.
void frameSphere(Editor& editor, const Vec3& centre, float radius) {
    ViewportState& viewport = editor.state.viewport;
    if (looksThrough(editor)) leaveView(editor);
    const float narrow = std::min(viewport.aspect, 1.0f);
    viewport.camera.frame(centre, radius / std::max(narrow, 0.1f));
}

/// The viewport's camera: the free one, or the orbit that comes next to a photograph's or the plate's.
OrbitCamera orbitCamera(const Editor& editor) {
    const ViewportState& viewport = editor.state.viewport;
    OrbitCamera orbit = viewport.camera;
    const Capture* capture = captureOf(editor);
    const Camera* plate = editor.plateCamera();
    const int view = editor.state.selection.view;
    const bool photograph = viewport.throughView && capture && view >= 0 && view < int(capture->views.size());
    if (!plate && !photograph) return orbit;
    const Camera& camera = plate ? *plate : capture->views[size_t(view)].camera;
    const SceneExtent& extent = sceneExtent(editor);
    float distance = float(camera.depthOf(DVec3(extent.centre)));
    if (const auto& scene = editor.state.document.scene; scene && scene->tracer)
        if (const Hit hit = scene->tracer->closest({Vec3(camera.position()), Vec3(camera.forward())}))
            distance = hit.distance;
    orbit.matchCamera(camera, distance > 0 ? distance : extent.radius);
    // In a viewport narrower than the photograph the letterbox made the image smaller: more is seen above and below.
    const float imageAspect = float(camera.width) / float(std::max(camera.height, 1));
    if (viewport.aspect < imageAspect)
        orbit.verticalFov = std::min(
            2 * std::atan(std::tan(orbit.verticalFov / 2) * imageAspect / std::max(viewport.aspect, 0.05f)), 2.6f);
    return orbit;
}

}  // namespace

const SceneExtent& sceneExtent(const Editor& editor) {
    static std::weak_ptr<const Scene> measured;
    static SceneExtent extent;
    // Measured on the capture: an emitter that moves does not move the floor.
    const auto& scene = editor.state.document.scene;
    if (!scene) return extent = {};
    if (measured.lock() != scene) {
        extent = extentOf(scene->mesh);
        measured = scene;
    }
    return extent;
}

void frameAll(Editor& editor) {
    const SceneExtent& extent = sceneExtent(editor);
    if (looksThrough(editor)) leaveView(editor);
    editor.state.viewport.camera.frameBox(extent.low, extent.high, editor.state.viewport.aspect);
}

void frameSelected(Editor& editor) {
    const Selection& selection = editor.state.selection;
    const auto live = editor.liveFrame();
    Box box;
    for (const std::string& id : selection.emitters) {
        const EmitterState* emitter = editor.emitter(id);
        if (!emitter) continue;
        box.grow(emitter->pivot);
        if (!live || !live->mesh || !live->emitterOfTriangle) continue;
        for (size_t i = 0; i < live->emitterIds.size(); ++i) {
            if (live->emitterIds[i] != id) continue;
            for (size_t t = 0; t < live->mesh->triangles.size(); ++t)
                if ((*live->emitterOfTriangle)[t] == int(i))
                    for (uint32_t v : live->mesh->triangles[t]) box.grow(live->mesh->positions[v]);
        }
    }
    const float scene = sceneExtent(editor).radius;
    if (!box.empty()) {
        // Some of the environment stay in sight: an emitter alone says little.
        frameSphere(editor, box.centre(), std::max(box.diagonal(), 0.05f * scene));
    } else if (selection.point) {
        frameSphere(editor, selection.point->position, 0.2f * scene);
    } else {
        frameAll(editor);
    }
}

void lookThrough(Editor& editor, int view) {
    const Capture* capture = captureOf(editor);
    if (!capture || view < 0 || view >= int(capture->views.size())) return;
    editor.state.selection.view = view;
    editor.state.viewport.throughView = true;
    editor.state.viewport.throughPlate = false;
}

bool looksThrough(const Editor& editor) { return editor.state.viewport.throughView || editor.plateCamera() != nullptr; }

void toggleLookThroughPlate(Editor& editor) {
    if (editor.plateCamera()) {
        leaveView(editor);
        return;
    }
    editor.state.viewport.throughView = false;
    editor.state.viewport.throughPlate = editor.plate() != nullptr;
}

void leaveView(Editor& editor) {
    ViewportState& viewport = editor.state.viewport;
    viewport.camera = orbitCamera(editor);
    viewport.throughView = viewport.throughPlate = false;
}

CameraBookmark presentView(const Editor& editor) { return orbitCamera(editor).bookmark(); }

void goToBookmark(Editor& editor, const CameraBookmark& bookmark) {
    ViewportState& viewport = editor.state.viewport;
    viewport.throughView = viewport.throughPlate = false;
    viewport.camera = OrbitCamera::at(bookmark);
}

void bookmarkView(Editor& editor) {
    if (!editor.estimate()) return;
    const CameraBookmark view = presentView(editor);
    editor.edit("Bookmark this view", [&](Look& look) { addBookmark(look, view); });
}

const CameraBookmark* presentBookmark(const Editor& editor) {
    if (looksThrough(editor)) return nullptr;
    CameraBookmark view = presentView(editor);
    for (const CameraBookmark& bookmark : editor.look().bookmarks) {
        view.name = bookmark.name;
        if (bookmark == view) return &bookmark;
    }
    return nullptr;
}

void nextBookmark(Editor& editor) {
    const std::vector<CameraBookmark>& all = editor.look().bookmarks;
    if (all.empty()) return;
    const CameraBookmark* now = presentBookmark(editor);
    goToBookmark(editor, all[now ? size_t(now - all.data() + 1) % all.size() : 0]);
}

void toggleLookThrough(Editor& editor) {
    if (looksThrough(editor)) leaveView(editor);
    else lookThrough(editor, std::max(editor.state.selection.view, 0));
}

void stepView(Editor& editor, int step) {
    const Capture* capture = captureOf(editor);
    if (!capture || capture->views.empty()) return;
    const int count = int(capture->views.size());
    editor.state.selection.view = ((editor.state.selection.view + step) % count + count) % count;
}

void lookAlongAxis(Editor& editor, int axis, int sign) {
    if (looksThrough(editor)) leaveView(editor);
    OrbitCamera& camera = editor.state.viewport.camera;
    const float side = sign > 0 ? 0.0f : pi;
    if (axis == 0) camera.azimuth = side, camera.elevation = 0;
    if (axis == 1) camera.azimuth = sign > 0 ? pi / 2 : -pi / 2, camera.elevation = 0;
    if (axis == 2) camera.azimuth = -pi / 2, camera.elevation = float(sign) * (pi / 2 - 0.002f);
}

void toggleOrthographic(Editor& editor) {
    if (looksThrough(editor)) leaveView(editor);
    editor.state.viewport.camera.orthographic = !editor.state.viewport.camera.orthographic;
}

std::optional<uint32_t> pickedCaptureVertex(const Editor& editor) {
    const auto& point = editor.state.selection.point;
    const auto& scene = editor.state.document.scene;
    if (!point || !scene) return std::nullopt;
    uint32_t vertex = point->vertex;
    if (const auto live = editor.liveFrame(); live && live->origin) {
        if (vertex >= live->origin->size()) return std::nullopt;
        vertex = (*live->origin)[vertex];
    }
    if (vertex >= scene->mesh.vertexCount()) return std::nullopt;
    return vertex;
}

void hidePicked(Editor& editor) {
    const auto& scene = editor.state.document.scene;
    if (!scene) return;
    std::optional<uint32_t> vertex = pickedCaptureVertex(editor);
    if (!vertex) {
        const EmitterState* emitter = editor.emitter(editor.state.selection.active());
        const auto estimate = editor.estimate();
        if (emitter && emitter->recovered && estimate && size_t(emitter->index) < estimate->emitters.emitters.size() &&
            !estimate->emitters.emitters[size_t(emitter->index)].vertices.empty())
            vertex = estimate->emitters.emitters[size_t(emitter->index)].vertices.front();
    }
    if (vertex && *vertex < scene->component.size())
        editor.state.viewport.hiddenComponents.insert(scene->component[*vertex]);
}

void showAll(Editor& editor) { editor.state.viewport.hiddenComponents.clear(); }

void setMode(Editor& editor, ViewMode mode) { editor.state.viewport.mode = mode; }

void changeExposure(Editor& editor, float stops) {
    float& exposure = editor.state.viewport.exposureStops;
    exposure = std::clamp(exposure + stops, -20.0f, 20.0f);
}

std::string displayViewOf(const Editor& editor) {
    const DisplayTransform& display = displayTransform();
    const auto has = [&](const std::string& name) {
        return std::find(display.views().begin(), display.views().end(), name) != display.views().end();
    };
    const std::string& chosen = editor.state.viewport.displayView;
    if (!chosen.empty() && has(chosen)) return chosen;
    const std::string soft = "Soft highlights";
    const auto& capture = editor.state.document.capture;
    const bool bright = !editor.emitters().empty() ||
                        (capture && std::any_of(capture->views.begin(), capture->views.end(), [](const View& view) {
                             return view.saturation == 0 && !view.image.pixels.empty();
                         }));
    return bright && display.source() == "built in" && has(soft) ? soft : display.defaultView();
}

}  // namespace relamp::ui
