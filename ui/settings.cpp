#include "settings.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "base/atomic_file.h"
#include "base/json_fields.h"
#include "pipeline/texture_stage.h"

namespace relamp::ui {
namespace {
namespace fs = std::filesystem;

float number(const Json& document, const char* key, float fallback, float low, float high) {
    const auto at = document.find(key);
    return at != document.end() && at->is_number() ? std::clamp(at->get<float>(), low, high) : fallback;
}

void paths(const Json& document, const char* key, std::vector<fs::path>& out) {
    const auto at = document.find(key);
    if (at == document.end() || !at->is_array()) return;
    for (const Json& entry : *at)
        if (entry.is_string() && out.size() < 12) out.push_back(entry.get<std::string>());
}

constexpr const char* bounceNames[] = {"auto", "off", "on"};

void readEstimate(const Json& document, SolveRequest& solve) {
    const auto estimate = document.find("estimate");
    if (estimate == document.end() || !estimate->is_object()) return;
    const auto text = [&](const char* key) {
        const auto at = estimate->find(key);
        return at != estimate->end() && at->is_string() ? at->get<std::string>() : std::string();
    };
    for (const char* basis : {"built-in", "wide", "lambert"})
        if (text("basis") == basis) solve.basis = basis;
    solve.merl = text("merl");
    for (size_t i = 0; i < std::size(bounceNames); ++i)
        if (text("bounce") == bounceNames[i]) solve.bounce = SolveOptions::Bounce(i);
    if (const auto at = estimate->find("mesh_triangles"); at != estimate->end() && at->is_number_unsigned())
        solve.meshTriangles = at->get<size_t>();
    if (const auto at = estimate->find("texture"); at != estimate->end() && at->is_number_unsigned())
        if (const auto side = at->get<size_t>(); side == 0 || (side >= leastTextureSide && side <= mostTextureSide))
            solve.texture = int(side);
}

Json estimateJson(const SolveRequest& solve) {
    Json json{{"basis", solve.basis}, {"merl", solve.merl.string()}, {"bounce", bounceNames[size_t(solve.bounce)]}};
    if (solve.meshTriangles) json["mesh_triangles"] = *solve.meshTriangles;
    if (solve.texture) json["texture"] = *solve.texture;
    return json;
}

void readExport(const Json& document, ExportRequest& request) {
    const auto kept = document.find("export");
    if (kept == document.end() || !kept->is_object()) return;
    if (const auto at = kept->find("compression"); at != kept->end() && at->is_string())
        for (const char* name : exrCompressions)
            if (*at == name) request.exr.compression = name;
    if (const auto at = kept->find("floats"); at != kept->end() && at->is_boolean()) request.exr.floats = *at;
}

Json exportJson(const ExportRequest& request) {
    return {{"compression", request.exr.compression}, {"floats", request.exr.floats}};
}

}  // namespace

void loadSettings(const fs::path& folder, EditorState& state) {
    const fs::path file = folder / "settings.json";
    std::error_code error;
    if (!fs::exists(file, error)) return;
    std::string text;
    try {
        text = readBytes(file, 1 << 20);
    } catch (const Error&) { return; }
    Json document;
    try {
        document = parseJson(text);
    } catch (const Error&) {}
    if (!document.is_object()) {
        fs::rename(file, folder / "settings.damaged.json", error);
        return;
    }
    paths(document, "recent", state.recent);
    paths(document, "recent_environments", state.recentEnvironments);
    paths(document, "recent_looks", state.recentLooks);
    PanelState& p = state.panels;
    p.leftWidth = number(document, "left_width", p.leftWidth, 200, 800);
    p.rightWidth = number(document, "right_width", p.rightWidth, 200, 800);
    p.bottomHeight = number(document, "bottom_height", p.bottomHeight, 60, 600);
    state.uiScale = number(document, "ui_scale", 0, 0, 3);
    readEstimate(document, state.solve);
    state.time.keptMiB = int(number(document, "kept_mib", float(state.time.keptMiB), 256, 262'144));
    readExport(document, state.exportFrames);
    if (const auto at = document.find("export_file"); at != document.end() && at->is_string()) {
        // Where frames went last; a folder that is gone is no place.
        const fs::path place = at->get<std::string>();
        if (fs::is_directory(place.parent_path(), error)) state.exportFrames.file = place;
    }
    if (const auto at = document.find("length_unit"); at != document.end() && at->is_string())
        state.lengthUnit = lengthUnitNamed(at->get<std::string>()).value_or(state.lengthUnit);
    if (const auto at = document.find("view_transform"); at != document.end() && at->is_string())
        state.viewport.displayView = at->get<std::string>();
    else if (const auto old = document.find("display_view"); old != document.end() && old->is_string())
        // Versions that had no automatic choice wrote Standard where nothing was chosen.
        if (const auto name = old->get<std::string>(); name != "Standard") state.viewport.displayView = name;
}

void saveSettings(const fs::path& folder, const EditorState& state) {
    Json document{{"recent", Json::array()},
                  {"recent_environments", Json::array()},
                  {"recent_looks", Json::array()},
                  {"left_width", state.panels.leftWidth},
                  {"right_width", state.panels.rightWidth},
                  {"bottom_height", state.panels.bottomHeight},
                  {"view_transform", state.viewport.displayView},
                  {"length_unit", infoOf(state.lengthUnit).name},
                  {"export_file", state.exportFrames.file.string()},
                  {"export", exportJson(state.exportFrames)},
                  {"kept_mib", state.time.keptMiB},
                  {"estimate", estimateJson(state.solve)}};
    for (const fs::path& p : state.recent) document["recent"].push_back(p.string());
    for (const fs::path& p : state.recentEnvironments) document["recent_environments"].push_back(p.string());
    for (const fs::path& p : state.recentLooks) document["recent_looks"].push_back(p.string());
    std::error_code error;
    fs::create_directories(folder, error);
    try {
        writeBytesAtomically(folder / "settings.json", dumpJson(document, 1, BadText::replace));
    } catch (const Error&) {
        // Sizes and recent files are not worth a dialog.
    }
}

void remember(std::vector<fs::path>& recent, const fs::path& path) {
    std::erase(recent, path);
    recent.insert(recent.begin(), path);
    if (recent.size() > 12) recent.resize(12);
}

}  // namespace relamp::ui
