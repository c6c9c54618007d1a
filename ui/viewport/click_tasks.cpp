#include "viewport/click_tasks.h"

#include "edit/link_edits.h"
#include "viewport/navigation.h"
#include "viewport/picking.h"

namespace relamp::ui {
namespace {

/// A component that is made to shine sends as much as the strongest light found, so that its effect is seen at once and
/// nothing is burnt out.
Rgb radianceForPart(const Scene& scene, const Estimate& estimate, uint32_t vertex) {
    Rgb strongest(0);
    float power = 0;
    for (size_t i = 0; i < estimate.emitters.emitters.size() && i < estimate.lighting.emitterRadiance.size(); ++i) {
        const Rgb& radiance = estimate.lighting.emitterRadiance[i];
        if (luminance(radiance) * estimate.emitters.emitters[i].area > power)
            power = luminance(radiance) * estimate.emitters.emitters[i].area, strongest = radiance;
    }
    if (!(power > 0)) return Rgb(1);
    float area = 0;
    for (size_t t = 0; t < scene.mesh.triangles.size(); ++t)
        if (scene.component[scene.mesh.triangles[t][0]] == scene.component[vertex]) area += scene.mesh.triangleArea(t);
    return strongest * std::min(1.0f, power / (luminance(strongest) * std::max(area, 1e-12f)));
}

}  // namespace

std::string emitterOfTriangle(const Editor& editor, uint32_t triangle) {
    if (const auto live = editor.liveFrame(); live && live->emitterOfTriangle) {
        if (triangle >= live->emitterOfTriangle->size()) return {};
        const int i = (*live->emitterOfTriangle)[triangle];
        return i >= 0 && size_t(i) < live->emitterIds.size() ? live->emitterIds[size_t(i)] : std::string();
    }
    const auto estimate = editor.estimate();
    if (!estimate || triangle >= estimate->emitters.emitterOfTriangle.size()) return {};
    const int i = estimate->emitters.emitterOfTriangle[triangle];
    return i >= 0 && size_t(i) < estimate->emitters.emitters.size() ? estimate->emitters.emitters[size_t(i)].id
                                                                    : std::string();
}

void selectInViewport(Editor& editor, const std::string& id, bool toggle) {
    std::vector<std::string>& selected = editor.state.selection.emitters;
    const bool had = editor.state.selection.has(id);
    if (!toggle) selected.clear();
    std::erase(selected, id);
    if (!(toggle && had)) selected.push_back(id);
}

void clickSurface(Editor& editor, const std::optional<PickedPoint>& point, bool toggle) {
    if (point) {
        if (const std::string id = emitterOfTriangle(editor, point->triangle); !id.empty() && editor.emitter(id)) {
            selectInViewport(editor, id, toggle);
            editor.pick(std::nullopt);
            return;
        }
    }
    if (!toggle) editor.state.selection.emitters.clear();
    editor.pick(point);
}

bool placesLights(ClickTask task) {
    return task == ClickTask::aim || task == ClickTask::reflect || task == ClickTask::illuminate;
}

std::string editLabelOf(ClickTask task) {
    switch (task) {
        case ClickTask::aim: return "Aim";
        case ClickTask::reflect: return "Place by reflection";
        case ClickTask::illuminate: return "Place by its light";
        case ClickTask::attach: return "Attach an object to";
        case ClickTask::leaveOut: return "Leave an object out of";
        case ClickTask::lightOnly: return "Light one object with";
        case ClickTask::takeColour: return "Take the colour for";
        case ClickTask::newPart: return "Make an object shine";
        case ClickTask::region:
        case ClickTask::none: break;
    }
    return {};
}

void placeLights(Look& look, const Editor& editor, ClickTask task, const PickedPoint& point, const EyeView& eye) {
    const Scene& scene = *editor.state.document.scene;
    const Estimate& estimate = *editor.estimate();
    // The side of the surface that is seen.
    const Vec3 toward = eye.towardEye(point.position);
    const Vec3 normal = glm::dot(point.normal, toward) < 0 ? -point.normal : point.normal;
    const Vec3 from = eye.orthographic ? point.position + toward * (2 * sceneExtent(editor).wholeRadius) : eye.position;
    for (const std::string& id : editor.state.selection.emitters) {
        if (task == ClickTask::aim) aimEmitter(look, scene, estimate, id, point.position);
        if (task == ClickTask::reflect) placeByReflection(look, scene, estimate, id, point.position, normal, from);
        if (task == ClickTask::illuminate) placeByLight(look, scene, estimate, id, point.position, normal);
    }
}

bool runClickTask(Editor& editor, const std::optional<PickedPoint>& point, const EyeView& eye) {
    const ClickTask task = editor.state.viewport.clickTask;
    if (task == ClickTask::none) return false;
    const auto& scene = editor.state.document.scene;
    const auto estimate = editor.estimate();
    if (!scene || !estimate) {
        editor.state.viewport.clickTask = ClickTask::none;
        return false;
    }
    if (!point) return true;  // a miss: still armed
    const std::vector<std::string> ids = editor.state.selection.emitters;
    const auto captureVertex = [&]() -> std::optional<uint32_t> {
        uint32_t v = point->vertex;
        if (const auto live = editor.liveFrame(); live && live->origin)
            v = v < live->origin->size() ? (*live->origin)[v] : ~0u;
        return v < scene->mesh.vertexCount() ? std::optional<uint32_t>(v) : std::nullopt;
    };
    switch (task) {
        case ClickTask::aim:
        case ClickTask::reflect:
        case ClickTask::illuminate:
            if (!ids.empty())
                editor.edit(editLabelOf(task) + " " + editor.namesOf(ids),
                            [&](Look& look) { placeLights(look, editor, task, *point, eye); });
            break;
        case ClickTask::attach: {
            const auto vertex = captureVertex();
            if (!vertex) return true;
            if (!ids.empty())
                editor.edit(editLabelOf(task) + " " + editor.namesOf({ids.back()}),
                            [&](Look& look) { attachPart(look, *scene, *vertex, ids.back()); });
            break;
        }
        case ClickTask::leaveOut:
        case ClickTask::lightOnly: {
            const auto vertex = captureVertex();
            if (!vertex) return true;
            const auto changed = task == ClickTask::leaveOut ? withoutPart : onlyOnPart;
            const size_t entry = editor.history().index();
            if (!ids.empty())
                editor.edit(editLabelOf(task) + " " + editor.namesOf(ids), [&](Look& look) {
                    for (const std::string& id : ids)
                        if (const EmitterState* light = editor.emitter(id))
                            setLink(look, id, changed(light->link, *scene, *vertex));
                });
            if (editor.history().index() == entry)
                editor.say(task == ClickTask::leaveOut ? "The light does not fall there as it is"
                                                       : "The light falls on that object alone as it is");
            break;
        }
        case ClickTask::takeColour: {
            const auto live = editor.liveFrame();
            if (!live || point->triangle >= live->mesh->triangles.size()) return true;
            const Rgb seen = radianceAt(*live, *point);
            if (!(luminance(seen) > 1e-6f)) {
                editor.say("It is dark there: no colour to take");
                return true;
            }
            editor.edit(editLabelOf(task) + " " + editor.namesOf(ids), [&](Look& look) {
                for (const std::string& id : ids)
                    if (const auto radiance = radianceOf(look, *estimate, id))
                        setRadiance(look, *estimate, id, seen * (luminance(*radiance) / luminance(seen)));
            });
            break;
        }
        case ClickTask::newPart: {
            const auto vertex = captureVertex();
            if (!vertex) return true;
            std::string added;
            editor.edit(editLabelOf(task), [&](Look& look) {
                AddedEmitter part;
                part.shape = EmitterShape::part;
                part.seedVertex = *vertex;
                part.radiance = radianceForPart(*scene, *estimate, *vertex);
                added = addEmitter(look, *estimate, part);
            });
            if (!added.empty() && editor.emitter(added)) editor.state.selection.emitters = {added};
            break;
        }
        case ClickTask::region:  // a drag
        case ClickTask::none: break;
    }
    editor.state.viewport.clickTask = ClickTask::none;
    return true;
}

}  // namespace relamp::ui
