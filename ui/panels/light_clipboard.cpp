#include "panels/light_clipboard.h"

#include <cmath>

#include "panels/emitter_controls.h"

namespace relamp::ui {
namespace {

std::string lightsOf(size_t n) { return n == 1 ? "1 light" : fmt::format("{} lights", n); }

/// A light of this capture as one that needs nothing of it: a disk of the same area in the same place.
AddedEmitter diskFor(const Editor& editor, const EmitterState& emitter) {
    AddedEmitter disk;
    disk.shape = EmitterShape::disk;
    disk.matrix = Mat4(emitter.axes);
    // Shapes of their own face -Z.
    disk.matrix[0] = Vec4(-emitter.axes[0], 0);
    disk.matrix[2] = Vec4(-emitter.axes[2], 0);
    disk.matrix[3] = Vec4(emitter.pivot, 1);
    disk.size = Vec2(std::max(1e-4f, 2 * std::sqrt(areaOf(editor, emitter) / pi)));
    return disk;
}

}  // namespace

std::vector<AddedEmitter> asAddedLights(const Editor& editor, const std::vector<std::string>& ids) {
    std::vector<AddedEmitter> lights;
    for (const std::string& id : ids) {
        const EmitterState* emitter = editor.emitter(id);
        if (!emitter) continue;
        AddedEmitter light;
        const bool own = !emitter->recovered && size_t(emitter->index) < editor.look().added.size() &&
                         infoOf(editor.look().added[size_t(emitter->index)].shape).own();
        light = own ? editor.look().added[size_t(emitter->index)] : diskFor(editor, *emitter);
        light.radiance = emitter->radiance;
        light.enabled = emitter->enabled;
        light.shadows = emitter->shadows;
        light.name.clear();
        light.link = {};  // of objects of this capture
        lights.push_back(light);
    }
    return lights;
}

void copyLights(Editor& editor) {
    std::vector<AddedEmitter> lights = asAddedLights(editor, editor.state.selection.emitters);
    if (lights.empty()) return;
    editor.state.copied.lights = std::move(lights);
    editor.say("Copied " + lightsOf(editor.state.copied.lights.size()));
}

void pasteLights(Editor& editor) {
    const auto estimate = editor.estimate();
    const CopiedLights& copied = editor.state.copied;
    if (!estimate || copied.lights.empty()) return;
    std::vector<std::string> pasted;
    editor.edit("Paste " + lightsOf(copied.lights.size()), [&](Look& look) {
        pasted.clear();
        for (const AddedEmitter& light : copied.lights) pasted.push_back(addEmitter(look, *estimate, light));
    });
    editor.state.selection.emitters = pasted;
}

void pasteLightValues(Editor& editor) {
    const auto estimate = editor.estimate();
    if (!estimate || editor.state.copied.lights.empty()) return;
    const std::vector<std::string> targets = editor.state.selection.emitters;
    editor.edit("Paste exposure and colour to " + editor.namesOf(targets), [&](Look& look) {
        for (const std::string& id : targets)
            setRadiance(look, *estimate, id, editor.state.copied.lights.back().radiance);
    });
}

}  // namespace relamp::ui
