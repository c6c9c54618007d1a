#include "item_map.h"

#include <imgui.h>

#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>

#include "base/json_fields.h"

namespace relamp::ui {
namespace {

const char* fileName() {
    static const char* const name = std::getenv("RELAMP_ITEM_MAP");
    return name;
}

Json& items() {
    static Json noted = Json::object();
    return noted;
}

}  // namespace

bool itemMapOn() { return fileName() != nullptr; }

void noteRect(const std::string& name, const Vec2& low, const Vec2& high) {
    if (itemMapOn()) items()[name] = {low.x, low.y, high.x, high.y};
}

void notePoint(const std::string& name, const Vec2& point) { noteRect(name, point, point); }

void noteItem(const std::string& name) {
    if (!itemMapOn() || !ImGui::IsItemVisible()) return;
    const ImVec2 low = ImGui::GetItemRectMin(), high = ImGui::GetItemRectMax();
    noteRect(name, {low.x, low.y}, {high.x, high.y});
}

void writeItemMap(const Editor& editor) {
    if (!itemMapOn()) return;
    static uint64_t frame = 0, liveMeshes = 0;
    static std::weak_ptr<const Mesh> lastMesh;
    if (const auto live = editor.liveFrame(); live && live->mesh != lastMesh.lock())
        lastMesh = live->mesh, ++liveMeshes;
    const EditorState& state = editor.state;
    Json document{{"frame", ++frame},
                  {"items", std::move(items())},
                  {"document", state.document.name()},
                  {"estimate", editor.estimate() != nullptr},
                  {"job", editor.job() ? editor.job()->title : ""},
                  {"progress", editor.job() ? editor.job()->whole.value_or(0) : 0},
                  {"stage", editor.job() ? editor.job()->stage : ""},
                  {"busy", editor.busy()},
                  {"live", editor.liveFrame() != nullptr},
                  {"live_meshes", liveMeshes},  // how often a moved light has been shown
                  {"refined", editor.liveFrame() && editor.liveFrame()->refined},
                  {"rest", editor.restFrame() != nullptr},
                  {"region", state.viewport.region.has_value()},
                  {"gesture", editor.inGesture()},
                  {"mode", int(state.viewport.mode)},
                  {"through_view", state.viewport.throughView},
                  {"plate_frame", editor.plateImage() ? editor.plateImage()->frame : -1},
                  {"plate_relit", editor.relitPlateImage() != nullptr},
                  {"plate_at_rest", editor.relitAtRest() != nullptr},
                  {"time", state.time.frame},
                  {"view", state.selection.view},
                  {"selected", state.selection.emitters},
                  {"point", state.selection.point.has_value()},
                  {"notice", state.notices.empty() ? "" : state.notices.front().text},
                  {"recovery", state.recovery.has_value()},
                  {"locked", state.locked.has_value()},
                  {"read_only", state.document.readOnly},
                  {"unsaved", editor.unsavedChanges()},
                  {"entry", editor.history().index()},
                  {"entries", editor.history().entries().size()},
                  {"label", editor.history().entries()[editor.history().index()].label},
                  {"frame_cpu_ms", state.frameCpuMs},
                  {"frames_per_second", state.framesPerSecond}};
    items() = Json::object();
    const std::string name = fileName(), temporary = name + ".part";
    std::ofstream(temporary) << dumpJson(document, -1, BadText::replace);
    std::error_code ignored;
    std::filesystem::rename(temporary, name, ignored);
}

}  // namespace relamp::ui
