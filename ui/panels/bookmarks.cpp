// Views that were kept, under the photographs: a click goes there, a right click renames or deletes.
#include "edit/bookmark_edits.h"
#include "item_map.h"
#include "panels/panels.h"
#include "viewport/navigation.h"
#include "widgets.h"

namespace relamp::ui {
namespace {

/// Name, what it can be set to, and its end.
void bookmarkMenu(Editor& editor, const CameraBookmark& bookmark) {
    if (!ImGui::BeginPopupContextItem("##menu")) return;
    static std::string name;
    if (ImGui::IsWindowAppearing()) name = bookmark.name;
    ImGui::SetNextItemWidth(em(12));
    if (inputText("##name", name, "Name", ImGuiInputTextFlags_EnterReturnsTrue)) {
        editor.edit("Rename " + bookmark.name, [&](Look& look) { renameBookmark(look, bookmark.name, name); });
        ImGui::CloseCurrentPopup();
    }
    noteItem("bookmark name");
    tooltip("What the view is called; Enter takes it.");
    if (ImGui::MenuItem("Set to the present view"))
        editor.edit("Set " + bookmark.name + " to the present view",
                    [&, view = presentView(editor)](Look& look) { moveBookmark(look, bookmark.name, view); });
    tooltip("Keeps what the viewport shows now under this name");
    if (ImGui::MenuItem("Delete"))
        editor.edit("Delete " + bookmark.name, [&](Look& look) { deleteBookmark(look, bookmark.name); });
    tooltip("Takes it off the list");
    ImGui::EndPopup();
}

}  // namespace

void drawBookmarks(Editor& editor) {
    // A copy, because a click may change the look.
    const std::vector<CameraBookmark> bookmarks = editor.look().bookmarks;
    const CameraBookmark* at = presentBookmark(editor);
    const std::string present = at ? at->name : "";
    const float side = ImGui::GetFrameHeight();
    for (const CameraBookmark& bookmark : bookmarks) {
        ImGui::PushID(bookmark.name.c_str());
        ImGui::AlignTextToFramePadding();
        const float width = ImGui::GetContentRegionAvail().x - side - ImGui::GetStyle().ItemSpacing.x;
        const std::string label = elided(shown(bookmark.name), width);
        if (ImGui::Selectable((label + "###bookmark").c_str(), bookmark.name == present, 0, {width, side}))
            goToBookmark(editor, bookmark);
        noteItem("bookmark " + bookmark.name);
        tooltip(shown(bookmark.name) +
                "\nA click goes to this view (V goes through them), a right click renames, sets or deletes it.");
        bookmarkMenu(editor, bookmark);
        ImGui::SameLine();
        if (iconButton("##delete", Icon::trash, "Takes the view off the list", false, side))
            editor.edit("Delete " + bookmark.name, [&](Look& look) { deleteBookmark(look, bookmark.name); });
        ImGui::PopID();
    }
}

}  // namespace relamp::ui
