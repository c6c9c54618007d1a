#include "panels/emitter_controls.h"

#include <algorithm>
#include <cmath>

#include "item_map.h"
#include "panels/light_presets.h"
#include "panels/value_key_menu.h"
#include "widgets.h"

namespace relamp::ui {
namespace {

const EmitterCluster* clusterOf(const Editor& editor, const EmitterState& emitter) {
    const auto estimate = editor.estimate();
    if (!estimate || !emitter.recovered || size_t(emitter.index) >= estimate->emitters.emitters.size()) return nullptr;
    return &estimate->emitters.emitters[size_t(emitter.index)];
}

const AddedEmitter* addedOf(const Editor& editor, const EmitterState& emitter) {
    if (emitter.recovered || size_t(emitter.index) >= editor.look().added.size()) return nullptr;
    return &editor.look().added[size_t(emitter.index)];
}

/// The fraction of its light that a light's shaping leaves. The last ones are kept, because panels ask at every frame.
Rgb shapedFraction(const AddedEmitter& added) {
    const EmitterShapeInfo& info = infoOf(added.shape);
    if (added.shaping.plain() || !info.own()) return Rgb(1);
    struct Known {
        LightShaping shaping;
        bool flat;
        Rgb fraction;
    };
    static std::vector<Known> known;
    for (const Known& k : known)
        if (k.shaping == added.shaping && k.flat == info.flat) return k.fraction;
    if (known.size() > 16) known.clear();
    Rgb fraction(1);
    try {
        fraction = ShapedEmission(added.shaping, Mat4(1), added.size, info.flat).mean();
    } catch (const Error&) {
        // A file that is gone: the viewport says so.
    }
    known.push_back({added.shaping, info.flat, fraction});
    return fraction;
}

std::string describe(const Editor& editor, const char* verb, const std::vector<std::string>& ids) {
    return fmt::format("{} {}", verb, editor.namesOf(ids));
}

}  // namespace

std::vector<std::string> targetsOf(const Editor& editor, const std::string& id) {
    return editor.state.selection.has(id) ? editor.state.selection.emitters : std::vector<std::string>{id};
}

void selectEmitter(Editor& editor, const std::string& id, bool toggle, bool extend) {
    auto& chosen = editor.state.selection.emitters;
    editor.state.selection.point.reset();
    editor.pick(std::nullopt);
    if (extend && !chosen.empty() && chosen.back() != id) {
        const auto& all = editor.emitters();
        const auto at = [&](const std::string& name) {
            return std::find_if(all.begin(), all.end(), [&](const EmitterState& e) { return e.id == name; }) -
                   all.begin();
        };
        const std::string anchor = chosen.back();
        const auto from = at(anchor), to = at(id);
        if (from < std::ptrdiff_t(all.size()) && to < std::ptrdiff_t(all.size())) {
            if (!toggle) chosen.clear();
            for (auto i = std::min(from, to); i <= std::max(from, to); ++i)
                if (!editor.state.selection.has(all[size_t(i)].id)) chosen.push_back(all[size_t(i)].id);
            // The anchor stays the active one, so that a second Shift click extends from the same row.
            std::erase(chosen, anchor);
            chosen.push_back(anchor);
            return;
        }
    }
    if (toggle) {
        if (editor.state.selection.has(id)) std::erase(chosen, id);
        else chosen.push_back(id);
        return;
    }
    chosen = {id};
}

std::optional<EmitterState> emitterAtStart(const Editor& editor, const std::string& id) {
    const auto estimate = editor.estimate();
    if (!estimate || !editor.state.document.scene) return {};
    if (!editor.inGesture()) {
        const EmitterState* now = editor.emitter(id);
        return now ? std::optional(*now) : std::nullopt;
    }
    return findEmitter(*editor.state.document.scene, *estimate, editor.history().gestureStart(), id);
}

float referenceBrightness(const Editor& editor) {
    float most = 0;
    for (const EmitterState& e : editor.emitters())
        if (e.recovered) most = std::max(most, luminance(e.recoveredRadiance));
    return most > 0 ? most : 1;
}

namespace {
/// The brightness that its stops count from: what was recovered, of a sun a white surface of 1 image unit, of other
/// added ones the strongest recovered light.
float referenceFor(const Editor& editor, const EmitterState& emitter) {
    if (emitter.recovered) return luminance(emitter.recoveredRadiance);
    return emitter.sun ? 1 : referenceBrightness(editor);
}
}  // namespace

float stopsOf(const Editor& editor, const EmitterState& emitter) {
    const float reference = referenceFor(editor, emitter), now = luminance(emitter.radiance);
    if (!(reference > 0) || !(now > 0)) return -20;
    return std::log2(now / reference);
}

float areaOf(const Editor& editor, const EmitterState& emitter) {
    const Mat3 m(emitter.matrix);
    const float volume = std::abs(glm::determinant(m));
    if (!(volume > 0)) return 0;
    Vec3 normal(0);
    if (const EmitterCluster* cluster = clusterOf(editor, emitter)) normal = cluster->normal;
    else if (const AddedEmitter* added = addedOf(editor, emitter); added && infoOf(added->shape).flat)
        normal = Vec3(0, 0, -1);
    // A flat surface grows by the two directions it lies in; a part by all three, taken together.
    if (glm::dot(normal, normal) > 0.5f)
        return emitter.area * volume * glm::length(glm::transpose(glm::inverse(m)) * normal);
    return emitter.area * std::pow(volume, 2.0f / 3);
}

float powerOf(const Editor& editor, const EmitterState& emitter) {
    if (!emitter.shines()) return 0;
    if (emitter.sun) return pi * luminance(emitter.radiance * emitter.groupFactor);
    const AddedEmitter* added = addedOf(editor, emitter);
    return pi * luminance(emitter.radiance * emitter.groupFactor * (added ? shapedFraction(*added) : Rgb(1))) *
           areaOf(editor, emitter);
}

void stopsControl(Editor& editor, const EmitterState& emitter, const char* id) {
    const auto targets = targetsOf(editor, emitter.id);
    const std::string what = emitter.recovered
                                 ? "Exposure against what was recovered, in stops: +1 is twice as bright, -1 half."
                                 : "Exposure against the strongest recovered light, in stops: +1 is twice as bright. "
                                   "Of a sun against one that lights a white surface to 1.";
    dragLook(editor, id, describe(editor, "Exposure of", targets), stopsOf(editor, emitter), {0.02f, -20, 20, "%+.2f"},
             (targets.size() > 1 ? what + " All selected ones change by the same factor." : what) + keysHint,
             [&](Look& look, float stops) {
                 const auto first = emitterAtStart(editor, emitter.id);
                 if (!first) return;
                 const float reference = referenceFor(editor, *first), before = luminance(first->radiance);
                 const float wanted = reference * std::exp2(stops);
                 for (const std::string& target : targets)
                     if (const auto start = emitterAtStart(editor, target)) {
                         // Something that is black gets its brightness from what it was before.
                         const bool black = !(luminance(start->radiance) > 0) || !(before > 0);
                         const Rgb base = !black ? start->radiance
                                          : luminance(start->recoveredRadiance) > 0
                                              ? start->recoveredRadiance / luminance(start->recoveredRadiance)
                                              : Rgb(1);
                         setRadiance(look, *editor.estimate(), target, base * (black ? wanted : wanted / before));
                     }
             });
    valueKeyMenu(editor, powersOf(editor, targets));
}

namespace {
void setColour(Editor& editor, Look& look, const std::vector<std::string>& targets, const Rgb& colour) {
    const Rgb tint = colour / std::max(luminance(colour), 1e-12f);
    for (const std::string& target : targets)
        if (const auto start = emitterAtStart(editor, target))
            setRadiance(look, *editor.estimate(), target, tint * luminance(start->radiance));
}
}  // namespace

void kelvinControl(Editor& editor, const EmitterState& emitter, const char* id) {
    const auto targets = targetsOf(editor, emitter.id);
    kelvinLook(editor, id, describe(editor, "Colour temperature of", targets), emitter.radiance,
               "Colour temperature: 2700 K is a warm bulb, 6504 K is white, more is bluish. Tint and brightness stay.",
               [&](Look& look, const Rgb& tint) { setColour(editor, look, targets, tint); });
    valueKeyMenu(editor, powersOf(editor, targets));
}

void tintControl(Editor& editor, const EmitterState& emitter, const char* id) {
    const auto targets = targetsOf(editor, emitter.id);
    tintLook(editor, id, describe(editor, "Tint of", targets), emitter.radiance,
             "Tint of its colour: above 0 greener, below 0 more magenta. Temperature and brightness stay.",
             [&](Look& look, const Rgb& tint) { setColour(editor, look, targets, tint); });
    valueKeyMenu(editor, powersOf(editor, targets));
}

void colourControl(Editor& editor, const EmitterState& emitter, const char* id, float size) {
    const auto targets = targetsOf(editor, emitter.id);
    colourLook(
        editor, id, describe(editor, "Colour of", targets), emitter.radiance, size,
        "Colour of its light; click to change. The brightness stays.",
        [&](Look& look, const Rgb& colour) { setColour(editor, look, targets, colour); },
        [&] {
            if (!editor.state.selection.has(emitter.id)) selectEmitter(editor, emitter.id, false, false);
            editor.state.viewport.clickTask = ClickTask::takeColour;
        });
}

void muteButton(Editor& editor, const EmitterState& emitter, float size) {
    const bool on = emitter.enabled;
    if (iconButton("##mute", on ? Icon::eyeOpen : Icon::eyeShut,
                   on ? "Shines. Click to switch it off (M); its geometry stays and still casts shadows."
                      : "Is off. Click to switch it on (M).",
                   !on, size)) {
        const auto targets = targetsOf(editor, emitter.id);
        editor.edit(describe(editor, on ? "Switch off" : "Switch on", targets), [&](Look& look) {
            for (const std::string& target : targets) setEnabled(look, target, !on);
        });
    }
    noteItem("mute " + emitter.id);
    valueKeyMenu(editor, valuesOf(KeyedValue::enabled, targetsOf(editor, emitter.id)));
}

void soloButton(Editor& editor, const EmitterState& emitter, float size) {
    auto& solo = editor.state.viewport.solo;
    const bool on = std::find(solo.begin(), solo.end(), emitter.id) != solo.end();
    if (iconButton("##solo", Icon::solo,
                   on ? "Shown alone. Click to show all lights again."
                      : "Shows this light alone in the viewport (Shift+M). Files and exports are not touched.",
                   on, size)) {
        for (const std::string& target : targetsOf(editor, emitter.id)) {
            std::erase(solo, target);
            if (!on) solo.push_back(target);
        }
    }
    noteItem("solo " + emitter.id);
}

void resetEmitters(Editor& editor, const std::vector<std::string>& ids, EmitterValue value) {
    const char* what = value == EmitterValue::place      ? "Reset position of"
                       : value == EmitterValue::radiance ? "Reset exposure and colour of"
                       : value == EmitterValue::enabled  ? "Switch back"
                                                         : "Reset";
    editor.edit(describe(editor, what, ids), [&](Look& look) {
        for (const std::string& id : ids) resetEmitter(look, id, value);
    });
}

void duplicateEmitters(Editor& editor, const std::vector<std::string>& ids) {
    const auto estimate = editor.estimate();
    if (!estimate || !editor.state.document.scene) return;
    std::vector<std::string> copies;
    const Vec3 offset(0.06f * editor.state.document.scene->diagonal, 0, 0);
    editor.edit(describe(editor, "Duplicate", ids), [&](Look& look) {
        copies.clear();
        for (const std::string& id : ids)
            if (std::string copy = duplicateEmitter(look, *estimate, id, offset); !copy.empty()) {
                copies.push_back(std::move(copy));
            } else if (const EmitterState* e = editor.emitter(id)) {
                // An object of the scene is there once: its copy is a light of its own with the same power.
                AddedEmitter sphere;
                sphere.shape = EmitterShape::sphere;
                sphere.size = Vec2(std::max(1e-4f, std::sqrt(areaOf(editor, *e) / pi)));
                sphere.matrix[3] = Vec4(e->pivot + offset, 1);
                sphere.radiance = e->radiance;
                copies.push_back(addEmitter(look, *estimate, sphere));
            }
    });
    if (!copies.empty()) editor.state.selection.emitters = copies;
    else if (!ids.empty()) editor.say("Nothing to duplicate");
}

void deleteEmitters(Editor& editor, const std::vector<std::string>& ids) {
    const auto recovered = std::count_if(ids.begin(), ids.end(), [&](const std::string& id) {
        const EmitterState* e = editor.emitter(id);
        return e && e->recovered;
    });
    const bool all = size_t(recovered) == ids.size();
    if (recovered > 0)
        editor.say(fmt::format("{} switched off: {} part of the scene",
                               all ? editor.namesOf(ids) : fmt::format("{} of {} lights", recovered, ids.size()),
                               recovered == 1 ? "it is" : "they are"));
    editor.edit(describe(editor, all ? "Switch off" : "Delete", ids), [&](Look& look) {
        for (const std::string& id : ids) removeEmitter(look, id);
    });
    std::erase_if(editor.state.selection.emitters, [&](const std::string& id) { return !editor.emitter(id); });
    std::erase_if(editor.state.viewport.solo, [&](const std::string& id) { return !editor.emitter(id); });
}

AddedEmitter newEmitter(const Editor& editor, EmitterShape shape) {
    AddedEmitter added;
    added.shape = shape;
    const OrbitCamera& camera = editor.state.viewport.camera;
    const Scene* scene = editor.state.document.scene.get();
    const float radius = scene ? scene->diagonal / 2 : 1;
    Vec3 toEye = camera.position() - camera.target;
    const float eyeDistance = glm::length(toEye);
    toEye = eyeDistance > 1e-6f ? toEye / eyeDistance : Vec3(1, 0, 0);
    // Above the line of sight, so that it does not stand before what it lights.
    const Vec3 away = glm::normalize(toEye + Vec3(0, 0, 0.8f));
    float distance = std::min(0.5f * radius, eyeDistance > 0 ? 0.6f * eyeDistance : radius);
    const float size = radius / 8;
    if (scene && scene->tracer) {
        // Nearer when a wall stands between.
        const float start = 0.5f * distance;
        if (const Hit hit = scene->tracer->closest({camera.target + away * start, away, 0, distance - start + size}))
            distance = std::max(0.25f * distance, start + hit.distance - 1.5f * size);
    }
    added.matrix = Mat4(frameAround(away));
    added.matrix[3] = Vec4(camera.target + away * distance, 1);
    added.size = size * infoOf(shape).freshSize;
    // Beside those that stand there already.
    const Vec3 aside = glm::normalize(glm::cross(Vec3(0, 0, 1), std::abs(away.z) < 0.99f ? away : Vec3(1, 0, 0)));
    const auto taken = [&](const Vec3& at) {
        const auto& others = editor.look().added;
        return std::any_of(others.begin(), others.end(), [&](const AddedEmitter& other) {
            return infoOf(other.shape).own() && glm::distance(Vec3(other.matrix[3]), at) < 0.9f * size;
        });
    };
    for (int n = 1; n < 40 && taken(Vec3(added.matrix[3])); ++n)
        added.matrix[3] = Vec4(
            camera.target + away * distance + aside * (1.3f * size * float((n + 1) / 2) * (n % 2 ? 1.0f : -1.0f)), 1);
    Rgb strongest(0);
    if (const auto estimate = editor.estimate())
        for (const EmitterState& e : editor.emitters())
            if (e.recovered && luminance(e.recoveredRadiance) > luminance(strongest)) strongest = e.recoveredRadiance;
    if (!(luminance(strongest) > 0)) {
        // Without an emitter to go by: as bright as lights the target about like the environment do.
        float mean = 0;
        if (const auto estimate = editor.estimate(); estimate && !estimate->environment.empty()) {
            for (const Rgb& c : estimate->environment) mean += luminance(c);
            mean /= float(estimate->environment.size());
        }
        strongest = Rgb((mean > 0 ? mean : 0.1f) * 4 * pi * distance * distance / (size * size));
    }
    const Vec2 fresh = infoOf(shape).freshSize;
    added.radiance = strongest / (fresh.x * fresh.y);
    if (infoOf(shape).distant) {
        // Three times as much light as the environment sends, from high on the side of the camera's left.
        float mean = 0;
        if (const auto estimate = editor.estimate(); estimate && !estimate->environment.empty())
            for (const Rgb& c : estimate->environment) mean += luminance(c) / float(estimate->environment.size());
        added.radiance = Rgb(1.08f, 1, 0.88f) * (mean > 0 ? 3 * mean : 1.0f);
        added.size = fresh;
        const Vec3 left = glm::normalize(glm::cross(Vec3(0, 0, 1), std::abs(toEye.z) < 0.99f ? toEye : Vec3(1, 0, 0)));
        const Vec3 place = added.matrix[3];
        added.matrix = Mat4(frameAround(glm::normalize(toEye * 0.5f - left + Vec3(0, 0, 1.2f))));
        added.matrix[3] = Vec4(place, 1);
    }
    added.shaping.coneDegrees = infoOf(shape).freshCone;
    if (added.shaping.coneDegrees < 180) added.shaping.coneSoftness = 0.15f;
    return added;
}

void addNewEmitter(Editor& editor, EmitterShape shape) {
    const auto estimate = editor.estimate();
    if (!estimate) return;
    std::string id;
    const AddedEmitter added = newEmitter(editor, shape);
    editor.edit(infoOf(shape).edit, [&](Look& look) { id = addEmitter(look, *estimate, added); });
    if (!id.empty()) selectEmitter(editor, id, false, false);
}

void armClick(Editor& editor, ClickTask task) {
    editor.state.viewport.clickTask = editor.state.viewport.clickTask == task ? ClickTask::none : task;
}

void emitterMenu(Editor& editor, const std::string& id) {
    const auto targets = targetsOf(editor, id);
    const EmitterState* emitter = editor.emitter(id);
    const auto estimate = editor.estimate();
    if (!emitter || !estimate) return;
    dimText(shown(editor.namesOf(targets)));
    ImGui::Separator();
    const auto item = [&](const char* label, const char* explanation, bool enabled = true) {
        const bool pressed = ImGui::MenuItem(label, nullptr, false, enabled);
        tooltip(explanation);
        return pressed;
    };
    if (ImGui::BeginMenu("Reset to recovered")) {
        if (item("Position",
                 "Back to where it stood when the photographs were taken (added lights: to the middle of the world)"))
            resetEmitters(editor, targets, EmitterValue::place);
        if (item("Exposure and colour", "Back to the light that was recovered"))
            resetEmitters(editor, targets, EmitterValue::radiance);
        if (item("Colour only", "Back to the recovered colour, at the present exposure"))
            editor.edit(describe(editor, "Reset colour of", targets), [&](Look& look) {
                for (const std::string& target : targets)
                    if (const EmitterState* e = editor.emitter(target); e && luminance(e->recoveredRadiance) > 0)
                        setRadiance(look, *estimate, target,
                                    e->recoveredRadiance * (luminance(e->radiance) / luminance(e->recoveredRadiance)));
            });
        if (item("On or off", "Back to shining")) resetEmitters(editor, targets, EmitterValue::enabled);
        ImGui::Separator();
        if (item("Everything", "Back to what was recovered")) resetEmitters(editor, targets, EmitterValue::all);
        ImGui::EndMenu();
    }
    if (item("Duplicate", "Makes a copy beside it")) duplicateEmitters(editor, targets);
    if (item("Save as preset", "Keeps it for every shot: Add light has it then, under its name")) {
        if (!editor.state.selection.has(id)) selectEmitter(editor, id, false, false);
        saveLightPreset(editor);
    }
    if (item(emitter->recovered ? "Switch off" : "Delete",
             emitter->recovered ? "Switches it off: its geometry is part of the capture and stays" : "Removes it"))
        deleteEmitters(editor, targets);
    ImGui::Separator();
    if (item("Aim...", "Then click the spot it points at"))
        selectEmitter(editor, id, false, false), editor.state.viewport.clickTask = ClickTask::aim;
    if (item("Place by reflection...", "Then click where its reflection is to be seen"))
        selectEmitter(editor, id, false, false), editor.state.viewport.clickTask = ClickTask::reflect;
    if (item("Place by light...", "Then click the spot it lights"))
        selectEmitter(editor, id, false, false), editor.state.viewport.clickTask = ClickTask::illuminate;
    if (ImGui::BeginMenu("Attach objects")) {
        if (editor.state.document.scene) {
            const Scene& scene = *editor.state.document.scene;
            const auto parts = likelyParts(scene, *estimate, id);
            if (parts.empty()) dimText("Nothing stands close to it");
            for (const uint32_t seed : parts) {
                const auto vertices =
                    size_t(std::count(scene.component.begin(), scene.component.end(), scene.component[seed]));
                if (item(fmt::format("Object of {} points##{}", count(vertices), seed).c_str(),
                         "This object follows the light when it moves, and its shadow with it"))
                    editor.edit(fmt::format("Attach an object to {}", emitter->name),
                                [&](Look& look) { attachPart(look, scene, seed, id); });
            }
            if (parts.size() > 1 && item("All of these", "All objects that stand close to it"))
                editor.edit(fmt::format("Attach {} objects to {}", parts.size(), emitter->name), [&](Look& look) {
                    for (const uint32_t seed : parts) attachPart(look, scene, seed, id);
                });
        }
        ImGui::Separator();
        if (item("Click an object...", "Then click the object that follows it"))
            selectEmitter(editor, id, false, false), editor.state.viewport.clickTask = ClickTask::attach;
        ImGui::EndMenu();
    }
}

void addEmitterButton(Editor& editor, float width) {
    ImGui::BeginDisabled(!editor.estimate());
    if (iconTextButton("Add light", Icon::plus,
                       editor.estimate()
                           ? "Adds a light that was not there: a rectangle, a disk, a sphere, a spot, a sun, or an "
                             "object of the scene that begins to shine"
                           : "Estimate first: new lights need to know the surfaces",
                       false, width))
        ImGui::OpenPopup("##add light");
    ImGui::EndDisabled();
    if (ImGui::BeginPopup("##add light")) {
        const auto item = [&](const char* label, const char* explanation) {
            const bool pressed = ImGui::MenuItem(label);
            tooltip(explanation);
            return pressed;
        };
        for (const EmitterShapeInfo& info : emitterShapes()) {
            if (!*info.label || !item(info.label, info.explanation)) continue;
            if (info.own()) addNewEmitter(editor, info.shape);
            else editor.state.viewport.clickTask = ClickTask::newPart;
        }
        lightPresetItems(editor);
        ImGui::EndPopup();
    }
}

std::string evidenceInShort(const Editor& editor, const EmitterState& emitter) {
    const EmitterCluster* cluster = clusterOf(editor, emitter);
    if (!cluster) return {};
    std::string words =
        fmt::format("{} view{}", cluster->evidence.viewsSeen, cluster->evidence.viewsSeen == 1 ? "" : "s");
    // A shot that was opened again does not know how many there were.
    if (cluster->evidence.samples > 0) words += fmt::format(", {} observations", count(cluster->evidence.samples));
    if (cluster->evidence.clippedFraction > 0.005f)
        words += fmt::format(", {} clipped", percent(double(cluster->evidence.clippedFraction)));
    return words;
}

float uncertaintyOf(const Editor& editor, const EmitterState& emitter) {
    const auto estimate = editor.estimate();
    if (!estimate || !emitter.recovered || size_t(emitter.index) >= estimate->emitterSigma.size()) return -1;
    const float light = luminance(emitter.recoveredRadiance);
    return light > 0 ? luminance(estimate->emitterSigma[size_t(emitter.index)]) / light : -1;
}

float identifiabilityOf(const Editor& editor, const EmitterState& emitter) {
    const auto estimate = editor.estimate();
    if (!estimate || !emitter.recovered || size_t(emitter.index) >= estimate->identifiability.size()) return -1;
    return estimate->identifiability[size_t(emitter.index)];
}

Icon iconOf(const Editor& editor, const EmitterState& emitter) {
    const AddedEmitter* added = addedOf(editor, emitter);
    return added ? iconNamed(infoOf(added->shape).icon) : Icon::emitter;
}

}  // namespace relamp::ui
