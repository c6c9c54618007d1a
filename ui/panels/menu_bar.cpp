// Menus, read from the table of actions.
#include <utility>

#include "actions.h"
#include "item_map.h"
#include "look_files.h"
#include "panels/panels.h"
#include "widgets.h"

namespace relamp::ui {
namespace {

/// A submenu of files that were used before; what was chosen.
std::filesystem::path recentOf(const char* label, const std::vector<std::filesystem::path>& recent, bool enabled) {
    if (!ImGui::BeginMenu(label, enabled && !recent.empty())) return {};
    std::filesystem::path chosen;
    int index = 0;
    for (const std::filesystem::path& path : recent) {
        ImGui::PushID(index++);
        if (ImGui::MenuItem(elided(shown(path), em(30)).c_str())) chosen = path;
        tooltip(shown(path));
        ImGui::PopID();
    }
    ImGui::EndMenu();
    return chosen;
}

void drawRecent(Editor& editor, const std::string& action) {
    if (action == "file.open") {
        if (const auto chosen = recentOf("Open recent", editor.state.recent, true); !chosen.empty())
            editor.open(chosen);
    } else if (action == "file.loadLook") {
        const auto chosen = recentOf("Recent looks", editor.state.recentLooks, editor.estimate() != nullptr);
        noteItem("menu recent looks");
        if (!chosen.empty()) loadLook(editor, chosen);
    }
}

}  // namespace

void drawMenuBar(Editor& editor) {
    std::vector<std::string> menus;
    for (const Action& action : actions())
        if (!action.menu.empty() && std::find(menus.begin(), menus.end(), action.menu) == menus.end())
            menus.push_back(action.menu);
    const Action* wanted = nullptr;
    // A menu that is taller than the room below the bar scrolls: laid over the bar, the click that opens it would also
    // choose what comes to lie under the pointer.
    const ImGuiIO& io = ImGui::GetIO();
    const float room = io.DisplaySize.y - ImGui::GetWindowPos().y - ImGui::GetWindowSize().y - em(0.6f);
    for (const std::string& menu : menus) {
        if (ImGui::IsPopupOpen(menu.c_str()))
            ImGui::SetNextWindowSizeConstraints({0, 0}, {FLT_MAX, std::max(room, em(8))});
        if (!ImGui::BeginMenu(menu.c_str())) continue;
        bool first = true, open = true;
        std::string inside;  // the submenu that is begun, closed or not
        const auto leave = [&] {
            if (!std::exchange(inside, {}).empty() && open) ImGui::EndMenu();
            open = true;
        };
        for (const Action& action : actions()) {
            if (action.menu != menu) continue;
            if (action.submenu != inside) {
                leave();
                if (action.separatorBefore && !first) ImGui::Separator();
                inside = action.submenu;
                if (!inside.empty()) {
                    open = ImGui::BeginMenu(inside.c_str());
                    noteItem("menu " + inside);
                }
            } else if (action.separatorBefore && !first) {
                ImGui::Separator();
            }
            first = false;
            if (!open) continue;
            const std::string keys = action.keys.empty() ? "" : action.keys.front().text();
            const bool enabled = !action.enabled || action.enabled(editor),
                       checked = action.checked && action.checked(editor);
            if (ImGui::MenuItem((action.label + "##" + action.id).c_str(), keys.c_str(), checked, enabled))
                wanted = &action;
            noteItem("menu " + action.id);
            tooltip(action.explanation);
            drawRecent(editor, action.id);
        }
        leave();
        ImGui::EndMenu();
    }
    // After the menus: what it does may change what they show.
    if (wanted) wanted->run(editor);
}

}  // namespace relamp::ui
