#include "panels/light_presets.h"

#include <nlohmann/json.hpp>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/is_there.h"
#include "base/json_fields.h"
#include "panels/emitter_controls.h"
#include "panels/light_clipboard.h"
#include "widgets.h"

namespace relamp::ui {
namespace {

std::filesystem::path folderOf(const Editor& editor) { return editor.configFolder() / "lights"; }
std::filesystem::path fileOf(const Editor& editor, const std::string& name) {
    return folderOf(editor) / (name + ".json");
}

/// The name without what a file's name must not have.
std::string fileNameFor(std::string name) {
    for (char& c : name)
        if (c == '/' || (c >= 0 && c < ' ')) c = '-';
    if (name.empty() || name[0] == '.') name.insert(0, "Light ");
    // Not within a character of several bytes.
    size_t end = std::min<size_t>(name.size(), 80);
    while (end < name.size() && end > 0 && (static_cast<unsigned char>(name[end]) & 0xc0) == 0x80) --end;
    return name.substr(0, end);
}

}  // namespace

std::vector<std::string> lightPresets(const Editor& editor) {
    std::vector<std::string> names;
    std::error_code none;
    for (const auto& entry : std::filesystem::directory_iterator(folderOf(editor), none))
        if (entry.path().extension() == ".json") names.push_back(entry.path().stem().string());
    std::sort(names.begin(), names.end());
    return names;
}

void saveLightPreset(Editor& editor) {
    Look look;
    look.added = asAddedLights(editor, editor.state.selection.emitters);
    if (look.added.empty()) return;
    const EmitterState* last = editor.emitter(editor.state.selection.active());
    const std::string wanted = fileNameFor(last ? last->name : "Light");
    std::string name = wanted;
    for (int i = 2; isThere(fileOf(editor, name)); ++i) name = fmt::format("{} {}", wanted, i);
    try {
        std::filesystem::create_directories(folderOf(editor));
        writeBytesAtomically(fileOf(editor, name), dumpJson(lookToJson(look), 2));
        editor.say("Kept as preset " + name + ": Add light has it");
    } catch (const std::exception& error) {
        editor.fail("The preset could not be kept", error.what(), "Make room, or let the folder be written.");
    }
}

void addLightPreset(Editor& editor, const std::string& name) {
    const auto estimate = editor.estimate();
    if (!estimate) return;
    std::vector<AddedEmitter> lights;
    try {
        lights = readLook(fileOf(editor, name)).added;
    } catch (const std::exception& error) {
        editor.fail("The preset cannot be read", error.what(), "Delete it: Add light, Delete a preset.");
        return;
    }
    if (lights.empty()) return;
    const Vec3 by = Vec3(newEmitter(editor, lights[0].shape).matrix[3] - lights[0].matrix[3]);
    std::vector<std::string> added;
    editor.edit("Add " + name, [&](Look& look) {
        added.clear();
        for (AddedEmitter light : lights) {
            light.matrix[3] += Vec4(by, 0);
            added.push_back(addEmitter(look, *estimate, light));
        }
    });
    editor.state.selection.emitters = added;
}

void deleteLightPreset(Editor& editor, const std::string& name) {
    std::error_code failed;
    std::filesystem::remove(fileOf(editor, name), failed);
    if (failed) editor.fail("The preset could not be deleted", failed.message(), "Let the folder be written.");
}

void lightPresetItems(Editor& editor) {
    const std::vector<std::string> presets = lightPresets(editor);
    if (presets.empty()) return;
    const auto item = [](const std::string& name, const char* explanation) {
        const bool pressed = ImGui::MenuItem(shown(name).c_str());
        tooltip(explanation);
        return pressed;
    };
    ImGui::Separator();
    // A preset may be called as a shape is.
    ImGui::PushID("presets");
    for (const std::string& name : presets)
        if (item(name, "A light you have kept: Save as preset, in a light's menu")) addLightPreset(editor, name);
    ImGui::PopID();
    if (!ImGui::BeginMenu("Delete a preset")) return;
    for (const std::string& name : presets)
        if (item(name, "Lights in shots stay")) deleteLightPreset(editor, name);
    ImGui::EndMenu();
}

}  // namespace relamp::ui
