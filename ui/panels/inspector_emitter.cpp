// One light, or the active one of several: place, size, light, attached geometry, evidence.
#include <glm/gtc/matrix_transform.hpp>

#include "base/significant.h"
#include "base/statistics.h"
#include "display/vertex_images.h"
#include "panels/emitter_controls.h"
#include "panels/inspector.h"
#include "panels/value_key_menu.h"
#include "viewport/overlays.h"
#include "widgets.h"

namespace relamp::ui {

namespace {

Mat4 around(const Vec3& pivot, const Mat3& change) {
    Mat4 m(change);
    m[3] = Vec4(pivot - change * pivot, 1);
    return m;
}

Mat4 shift(const Vec3& by) {
    Mat4 m(1);
    m[3] = Vec4(by, 1);
    return m;
}

Mat3 diagonal(const Vec3& d) { return Mat3(Vec3(d.x, 0, 0), Vec3(0, d.y, 0), Vec3(0, 0, d.z)); }

/// Three numbers in a row under one name.
void triple(Editor& editor, const char* name, const std::string& label, const Vec3& value, const DragRange& range,
            const std::string& explanation, const std::function<void(Look&, int, float)>& apply,
            const std::vector<KeyedOf>& keyed, const DVec3& offset = DVec3(0)) {
    ImGui::PushID(name);
    dimText(name);
    tooltip(explanation);
    const float width = (ImGui::GetContentRegionAvail().x - 2 * ImGui::GetStyle().ItemInnerSpacing.x) / 3;
    constexpr const char* ids[] = {"##x", "##y", "##z"};
    const bool colour = std::string(name).starts_with("Radiance");
    const char* const axes[] = {colour ? "Red: " : "X: ", colour ? "Green: " : "Y: ", colour ? "Blue: " : "Z: "};
    const ImU32 marks[] = {IM_COL32(196, 92, 92, 255), IM_COL32(110, 168, 92, 255), IM_COL32(92, 130, 200, 255)};
    for (int k = 0; k < 3; ++k) {
        if (k) ImGui::SameLine(0, ImGui::GetStyle().ItemInnerSpacing.x);
        ImGui::SetNextItemWidth(std::floor(width));
        DragRange own = range;
        own.offset = offset[k];
        dragLook(editor, ids[k], label, value[k], own, axes[k] + explanation + keysHint,
                 [&](Look& look, float number) { apply(look, k, number); });
        valueKeyMenu(editor, keyed);
        const ImVec2 a = ImGui::GetItemRectMin(), b = ImGui::GetItemRectMax();
        ImGui::GetWindowDrawList()->AddRectFilled(a, {a.x + std::max(2.0f, em(0.14f)), b.y}, marks[k],
                                                  ImGui::GetStyle().FrameRounding);
    }
    ImGui::PopID();
}

void place(Editor& editor, const EmitterState& emitter, const std::vector<std::string>& targets) {
    const std::string who = editor.namesOf(targets);
    const float size = editor.state.document.scene ? editor.state.document.scene->diagonal : 2;
    const LengthUnitInfo& unit = infoOf(editor.state.lengthUnit);
    const std::string format = unit.format(), withSymbol = fmt::format("{} {}", format, unit.symbol);
    const auto startOf = [&editor](const std::string& id) { return emitterAtStart(editor, id); };
    triple(
        editor, fmt::format("Position ({})", unit.symbol).c_str(), "Move " + who, emitter.pivot,
        {.speed = size / 800, .format = format.c_str(), .unit = unit.inMetres},
        fmt::format(
            "Where the middle of the light is, in {}. Its shadows and its geometry move along; so do attached objects.",
            unit.name),
        [&](Look& look, int axis, float value) {
            const auto active = startOf(emitter.id);
            if (!active) return;
            Vec3 by(0);
            by[axis] = value - active->pivot[axis];
            for (const std::string& id : targets) moveEmitter(look, id, shift(by));
        },
        valuesOf(KeyedValue::position, targets),
        editor.state.document.capture ? editor.state.document.capture->origin : DVec3(0));
    const Placement now = placementOf(emitter.matrix);
    triple(
        editor, "Rotation (degrees)", "Rotate " + who, now.degrees, {0.5f, 0, 0, "%.1f\u00b0"},
        emitter.recovered ? "Rotate about its middle, in degrees, against how it was recovered."
                          : "Rotate about its middle, in degrees.",
        [&](Look& look, int axis, float value) {
            const auto active = startOf(emitter.id);
            if (!active) return;
            const Placement before = placementOf(active->matrix);
            Vec3 degrees = before.degrees;
            degrees[axis] = value;
            const Mat3 change = rotationOf(degrees) * glm::transpose(rotationOf(before.degrees));
            for (const std::string& id : targets)
                if (const auto start = startOf(id)) moveEmitter(look, id, around(start->pivot, change));
        },
        valuesOf(KeyedValue::rotation, targets));
    triple(
        editor, "Scale", "Scale " + who, now.scale, {0.005f, 0.001f, 1000, "%.3f", true},
        "Size against how it was recovered. A larger light sends more light, because its brightness stays.",
        [&](Look& look, int axis, float value) {
            for (const std::string& id : targets)
                if (const auto start = startOf(id)) {
                    const Placement before = placementOf(start->matrix);
                    const float factor =
                        std::max(value, 1e-3f) / std::abs(placementOf(startOf(emitter.id)->matrix).scale[axis]);
                    Vec3 scale(1);
                    scale[axis] = factor;
                    const Mat3 r = rotationOf(before.degrees);
                    moveEmitter(look, id, around(start->pivot, r * diagonal(scale) * glm::transpose(r)));
                }
        },
        valuesOf(KeyedValue::scale, targets));
    if (!emitter.recovered && size_t(emitter.index) < editor.look().added.size()) {
        const AddedEmitter& added = editor.look().added[size_t(emitter.index)];
        if (const int sizes = infoOf(added.shape).sizes) {
            const Vec2 before = added.size;
            const bool two = sizes == 2, sun = emitter.sun;
            dimText(sun ? "Angle (degrees)"
                        : fmt::format("{} ({})", two ? "Width and height" : "Diameter", unit.symbol));
            const float width =
                (ImGui::GetContentRegionAvail().x - ImGui::GetStyle().ItemInnerSpacing.x) / (two ? 2.0f : 1.0f);
            for (int k = 0; k < (two ? 2 : 1); ++k) {
                if (k) ImGui::SameLine(0, ImGui::GetStyle().ItemInnerSpacing.x);
                ImGui::SetNextItemWidth(std::floor(width));
                dragLook(editor, k ? "##height" : "##width", "Size of " + emitter.name, before[k],
                         sun ? DragRange{0.02f, 0.05f, 45, "%.2f\u00b0"}
                             : DragRange{size / 2000, 1e-4f, 1e4f, withSymbol.c_str(), false, 0, unit.inMetres},
                         sun ? "How large it stands in the sky; the real one has 0.53 degrees. Larger gives softer "
                               "shadows, the brightness stays."
                             : "Size of the light before Scale. Larger gives softer shadows.",
                         [&](Look& look, float value) {
                             Vec2 changed = before;
                             changed[k] = std::max(value, 1e-4f);
                             if (!two) changed = Vec2(changed[0]);
                             setSize(look, emitter.id, changed);
                         });
                valueKeyMenu(editor, {{KeyedValue::size, emitter.id}});
            }
        }
    }
}

void light(Editor& editor, const EmitterState& emitter, const std::vector<std::string>& targets) {
    // Fields have room in a narrow column too.
    const float label = std::min(
        em(6.2f), std::max(0.35f * ImGui::GetContentRegionAvail().x, ImGui::CalcTextSize("Temperature").x + em(0.4f)));
    const auto row = [&](const char* name) {
        ImGui::AlignTextToFramePadding();
        dimText(name);
        ImGui::SameLine(label);
        ImGui::SetNextItemWidth(-FLT_MIN);
    };
    row("Exposure");
    stopsControl(editor, emitter, "##stops");
    row("Temperature");
    ImGui::SetNextItemWidth(
        std::max(em(3), ImGui::GetContentRegionAvail().x - ImGui::GetFrameHeight() - ImGui::GetStyle().ItemSpacing.x));
    kelvinControl(editor, emitter, "##kelvin");
    ImGui::SameLine();
    colourControl(editor, emitter, "##colour", ImGui::GetFrameHeight());
    row("Tint");
    tintControl(editor, emitter, "##tint");
    triple(
        editor, "Radiance (red, green, blue)", "Radiance of " + editor.namesOf(targets), emitter.radiance,
        {std::max(1e-4f, maxChannel(emitter.radiance) / 300), 0, 1e9f, "%.4g"},
        "The value of a pixel that sees the light directly, linear, in the units of the photographs; of a sun, of a "
        "pixel that sees a white matte surface facing it.",
        [&](Look& look, int axis, float value) {
            for (const std::string& id : targets)
                if (const auto start = emitterAtStart(editor, id)) {
                    Rgb changed = start->radiance;
                    changed[axis] = std::max(0.0f, value);
                    setRadiance(look, *editor.estimate(), id, changed);
                }
        },
        powersOf(editor, targets));
    bool shadows = emitter.shadows;
    if (checkbox("Casts shadows", shadows,
                 "Off: its light passes through everything, as a fill light's may. No real light does that."))
        editor.edit(fmt::format("{} of {}", shadows ? "Shadows" : "No shadows", editor.namesOf(targets)),
                    [&](Look& look) {
                        for (const std::string& id : targets) setShadows(look, id, shadows);
                    });
    valueKeyMenu(editor, valuesOf(KeyedValue::shadows, targets));
    fact(emitter.sun ? "Irradiance" : "Power",
         number(double(powerOf(editor, emitter))) + (emitter.shines() ? "" : " (off)"),
         emitter.sun ? "Light that falls on a square metre which faces it"
                     : "All light it sends out: radiance times area, in image units times square metres");
    if (emitter.sun) return;
    const float area = areaOf(editor, emitter);
    fact("Area", areaText(area, editor.state.lengthUnit), "Surface that shines");
}

void parts(Editor& editor, const EmitterState& emitter) {
    const Scene* scene = editor.state.document.scene.get();
    if (!scene) return;
    bool any = false;
    uint32_t detach = ~0u, reset = ~0u;
    for (const PartLook& part : editor.look().parts) {
        if (part.attachedTo != emitter.id || part.seedVertex >= scene->component.size()) continue;
        any = true;
        ImGui::PushID(int(part.seedVertex));
        iconText(Icon::link, dimColour);
        ImGui::SameLine(0, em(0.4f));
        ImGui::AlignTextToFramePadding();
        text(
            fmt::format("Object of {} points", count(size_t(std::count(scene->component.begin(), scene->component.end(),
                                                                       scene->component[part.seedVertex])))));
        if (ImGui::IsItemHovered()) pointOut(part.seedVertex);
        tooltip("The image frames it while the pointer is here");
        sameLineIfFits(buttonWidth("Detach"));
        if (button("Detach", "It stays where it is and follows the light no more")) detach = part.seedVertex;
        sameLineIfFits(buttonWidth("Put back"));
        if (button("Put back", "It goes back to where it was when the photographs were taken")) reset = part.seedVertex;
        ImGui::PopID();
    }
    if (!any)
        dimWrapped(
            "Nothing follows this light. Attach its shade and its stand, and they move along with their shadows.");
    if (detach != ~0u)
        editor.edit("Detach an object from " + emitter.name, [&](Look& look) { detachPart(look, *scene, detach); });
    if (reset != ~0u)
        editor.edit("Put an object of " + emitter.name + " back", [&](Look& look) { resetPart(look, *scene, reset); });
    const auto likely = [&] {
        std::vector<uint32_t> seeds = likelyParts(*scene, *editor.estimate(), emitter.id);
        std::erase_if(seeds, [&](uint32_t seed) {
            for (const PartLook& part : editor.look().parts)
                if (part.attachedTo == emitter.id && part.seedVertex < scene->component.size() &&
                    scene->component[part.seedVertex] == scene->component[seed])
                    return true;
            return false;
        });
        return seeds;
    };
    if (emitter.recovered &&
        button("Attach what is near", "Attaches the objects that touch the light or stand close to it"))
        if (const auto seeds = likely(); !seeds.empty())
            editor.edit(
                fmt::format("Attach {} object{} to {}", seeds.size(), seeds.size() == 1 ? "" : "s", emitter.name),
                [&](Look& look) {
                    for (const uint32_t seed : seeds) attachPart(look, *scene, seed, emitter.id);
                });
    if (emitter.recovered) sameLineIfFits(buttonWidth("Click an object"));
    if (iconTextButton("Click an object", Icon::link, "Then click the object that follows it from then on",
                       editor.state.viewport.clickTask == ClickTask::attach))
        armClick(editor, ClickTask::attach);
}

void evidence(Editor& editor, const EmitterState& emitter) {
    if (!emitter.recovered)
        return dimWrapped("Added by you: this light was not there when the photographs were taken.");
    const auto estimate = editor.estimate();
    const EmitterCluster& cluster = estimate->emitters.emitters[size_t(emitter.index)];
    const EmitterEvidence& e = cluster.evidence;
    const float sigma = uncertaintyOf(editor, emitter), identifiability = identifiabilityOf(editor, emitter);
    wrapped(fmt::format("Seen in {} photograph{}, {}{} triangles.", e.viewsSeen, e.viewsSeen == 1 ? "" : "s",
                        e.samples ? count(e.samples) + " observations on " : "", count(cluster.triangles.size())));
    if (e.sceneContrast > 0)
        wrapped(
            fmt::format("It is {} times as bright as the brightest other surfaces.", significant(e.sceneContrast, 3)));
    if (sigma >= 0) wrapped(fmt::format("Its brightness is known to about {}.", percent(double(sigma))));
    if (!cluster.level.empty())
        wrapped(fmt::format(
            "It shines unevenly: most of its surface has {} to {} times its mean radiance. Moved or "
            "turned, it keeps that.",
            significant(quantileOf(cluster.level, 0.05), 2), significant(quantileOf(cluster.level, 0.95), 2)));
    else if (e.uniformity > 0.12f)
        wrapped(fmt::format("It glows unevenly, by {} either way. It is given one brightness, the mean.",
                            percent(double(e.uniformity))));
    if (e.clippedFraction > 0.005f)
        warningText(fmt::format("{} of the pixels that see it are clipped: it may be brighter than it looks.",
                                percent(double(e.clippedFraction))));
    if (identifiability >= 0) {
        wrapped(fmt::format("{} of its effect on the photographs could not come from far away.",
                            percent(double(identifiability))));
        if (identifiability < weakIdentifiability)
            warningText("Hard to tell from distant light: its fraction and the environment's may have been mixed up.");
    }
}

/// Its name, which can be typed over; Escape leaves it as it was.
void nameField(Editor& editor, const EmitterState& emitter, float width) {
    static std::string typed, typedFor;
    bool& asked = editor.state.panels.renameLight;
    if (asked) ImGui::SetKeyboardFocusHere();
    asked = false;
    ImGui::SetNextItemWidth(std::max(em(4), width));
    if (typedFor != emitter.id) typed = emitter.name;
    const bool entered = inputText("##name", typed, emitter.id.c_str(),
                                   ImGuiInputTextFlags_EnterReturnsTrue | ImGuiInputTextFlags_AutoSelectAll);
    const bool done = entered || ImGui::IsItemDeactivatedAfterEdit();
    tooltip(
        fmt::format("What this light is called: in the lists, as a light group of exported frames and in exported "
                    "scenes (F2). Empty: {}",
                    emitter.id));
    // While it is being typed into, what it is called elsewhere does not matter.
    typedFor = ImGui::IsItemActive() ? emitter.id : std::string();
    if (done && typed != emitter.name)
        editor.edit(
            fmt::format("Rename {} to {}", emitter.name, tidyName(typed).empty() ? emitter.id : tidyName(typed)),
            [&](Look& look) { renameEmitter(look, emitter.id, typed); });
}

}  // namespace

void clearTransform(Editor& editor, const std::vector<std::string>& ids, TransformPart part) {
    const char* const what = part == TransformPart::position   ? "position"
                             : part == TransformPart::rotation ? "rotation"
                                                               : "scale";
    const size_t before = editor.history().index();
    bool nowhere = false;
    editor.edit(fmt::format("Clear {} of {}", what, editor.namesOf(ids)), [&](Look& look) {
        for (const std::string& id : ids) {
            const EmitterState* e = editor.emitter(id);
            if (!e) continue;
            const Placement now = placementOf(e->matrix);
            const Mat3 turn = rotationOf(now.degrees);
            if (part == TransformPart::rotation) {
                moveEmitter(look, id, around(e->pivot, glm::transpose(turn)));
            } else if (part == TransformPart::scale) {
                moveEmitter(look, id, around(e->pivot, turn * diagonal(1.0f / now.scale) * glm::transpose(turn)));
            } else if (!e->recovered && size_t(e->index) < editor.look().added.size() &&
                       infoOf(editor.look().added[size_t(e->index)].shape).own()) {
                nowhere = true;
            } else {
                const Vec3 home(glm::inverse(e->matrix) * Vec4(e->pivot, 1));
                moveEmitter(look, id, shift(home - e->pivot));
            }
        }
    });
    if (editor.history().index() != before) return;
    editor.say(nowhere ? "A light that was added has no recovered position to go back to"
                       : fmt::format("The {} is as it was recovered", what));
}

void inspectEmitter(Editor& editor, const EmitterState& emitter) {
    const auto targets = targetsOf(editor, emitter.id);
    const float side = ImGui::GetFrameHeight();
    // Name and switches.
    const ImVec2 at = ImGui::GetCursorScreenPos();
    const ImVec4 mark =
        emitter.recovered ? toScreen(clusterColour(size_t(emitter.index))) : ImVec4(0.5f, 0.5f, 0.5f, 1);
    ImGui::GetWindowDrawList()->AddRectFilled(at, {at.x + em(0.4f), at.y + side}, ImGui::GetColorU32(mark), em(0.15f));
    ImGui::SetCursorPosX(ImGui::GetCursorPosX() + em(0.7f));
    ImGui::AlignTextToFramePadding();
    const float whole = ImGui::GetContentRegionAvail().x, beside = whole - 4 * (side + ImGui::GetStyle().ItemSpacing.x);
    const bool twoRows = beside < em(4);  // of a narrow column
    const float room = twoRows ? whole : beside;
    if (targets.size() > 1)
        text(elided(fmt::format("{} (and {} more)", shown(emitter.name), targets.size() - 1), room));
    else nameField(editor, emitter, room);
    const float switches = ImGui::GetWindowContentRegionMax().x - 4 * side - 3 * ImGui::GetStyle().ItemSpacing.x;
    if (twoRows) ImGui::SetCursorPosX(switches);
    else ImGui::SameLine(switches);
    muteButton(editor, emitter, side);
    ImGui::SameLine();
    soloButton(editor, emitter, side);
    ImGui::SameLine();
    ImGui::BeginDisabled(!emitter.changed || !emitter.recovered);
    if (iconButton("##reset", Icon::reset, "Everything back to what was recovered"))
        resetEmitters(editor, targets, EmitterValue::all);
    ImGui::EndDisabled();
    ImGui::SameLine();
    if (iconButton("##more", Icon::dots, "Reset, duplicate, delete, attach")) ImGui::OpenPopup("##menu");
    if (ImGui::BeginPopup("##menu")) {
        emitterMenu(editor, emitter.id);
        ImGui::EndPopup();
    }
    if (targets.size() > 1) dimWrapped("An edit goes to all selected lights.");

    const ClickTask armed = editor.state.viewport.clickTask;
    const struct {
        const char* label;
        Icon icon;
        ClickTask task;
        const char* explanation;
    } tasks[] = {
        {"Aim", Icon::aim, ClickTask::aim, "Then click, or drag over, what the light points at"},
        {"Reflect", Icon::mirror, ClickTask::reflect,
         "Place by reflection: then click, or drag over, where its reflection is to be seen on a glossy surface"},
        {"Light", Icon::spot, ClickTask::illuminate,
         "Place by light: then click, or drag over, what it lights; it moves straight above it"}};
    const float third = std::floor((ImGui::GetContentRegionAvail().x - 2 * ImGui::GetStyle().ItemSpacing.x) / 3);
    for (int k = 0; k < 3; ++k) {
        if (k) ImGui::SameLine();
        if (iconTextButton(tasks[k].label, tasks[k].icon, tasks[k].explanation, armed == tasks[k].task, third))
            armClick(editor, tasks[k].task);
    }
    if (armed != ClickTask::none) dimWrapped(hintOf(armed));

    if (section("Light", "Exposure and colour")) light(editor, emitter, targets);
    inspectBeam(editor, emitter);
    inspectLink(editor, emitter, targets);
    if (section("Position", "Where it stands, how it is turned, how large it is")) {
        place(editor, emitter, targets);
        if (emitter.changed && button("Reset position", "Back to where it stood when the photographs were taken"))
            resetEmitters(editor, targets, EmitterValue::place);
    }
    if (section("Attached objects", "Objects of the scene that follow it: its shade, its stand", false))
        parts(editor, emitter);
    if (section("Evidence", "The evidence for this light in the photographs", false)) evidence(editor, emitter);
}

}  // namespace relamp::ui
