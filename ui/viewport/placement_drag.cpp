#include "viewport/placement_drag.h"

#include "viewport/click_tasks.h"
#include "viewport/picking.h"

namespace relamp::ui {

bool PlacementDrag::fits(const Editor& editor) {
    const auto& all = editor.emitters();
    return placesLights(editor.state.viewport.clickTask) && editor.estimate() &&
           std::any_of(all.begin(), all.end(), [&](const EmitterState& e) { return editor.state.selection.has(e.id); });
}

void PlacementDrag::begin(Editor& editor, const std::shared_ptr<const Mesh>& mesh, std::vector<uint8_t> visible) {
    mesh_ = mesh;
    visible_ = std::move(visible);
    placed_ = false;
    if (!mesh_) return;
    visible_.resize(mesh_->triangles.size(), 1);
    for (uint32_t t = 0; t < mesh_->triangles.size(); ++t)
        if (visible_[t])
            if (const std::string id = emitterOfTriangle(editor, t); !id.empty() && editor.state.selection.has(id))
                visible_[t] = 0;
    editor.beginGesture(editLabelOf(editor.state.viewport.clickTask) + " " +
                        editor.namesOf(editor.state.selection.emitters));
}

void PlacementDrag::follow(Editor& editor, const Ray& ray, const EyeView& eye) {
    const std::optional<PickedPoint> point = pickSurface(*mesh_, ray, visible_);
    if (!point) return;
    placed_ = true;
    editor.preview([&](Look& look) { placeLights(look, editor, editor.state.viewport.clickTask, *point, eye); });
}

void PlacementDrag::commit(Editor& editor) {
    mesh_ = nullptr;
    if (!placed_) {
        editor.abandonGesture();
        return;
    }
    editor.commitGesture();
    editor.state.viewport.clickTask = ClickTask::none;
}

void PlacementDrag::abandon(Editor& editor) {
    mesh_ = nullptr;
    editor.abandonGesture();
}

}  // namespace relamp::ui
