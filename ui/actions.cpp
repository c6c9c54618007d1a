#include "actions.h"

#include <algorithm>

#include "actions/menus.h"

namespace relamp::ui {
namespace {

std::vector<Action> makeActions() {
    std::vector<Action> table;
    addFileActions(table);
    addEditActions(table);
    addLightActions(table);
    addTimeActions(table);
    addViewActions(table);
    addHelpActions(table);
    return table;
}

}  // namespace

std::string KeyChord::text() const {
    std::string t;
    if (control) t += "Ctrl+";
    if (shift) t += "Shift+";
    if (alt) t += "Alt+";
    return t + keyName(key);
}

const std::vector<Action>& actions() {
    static const std::vector<Action> table = makeActions();
    return table;
}

const Action* findAction(const std::string& id) {
    for (const Action& a : actions())
        if (a.id == id) return &a;
    return nullptr;
}

bool runAction(Editor& editor, const std::string& id) {
    const Action* a = findAction(id);
    if (!a || (a->enabled && !a->enabled(editor))) return false;
    a->run(editor);
    return true;
}

bool runKey(Editor& editor, const KeyChord& chord) {
    for (const Action& a : actions())
        if (std::find(a.keys.begin(), a.keys.end(), chord) != a.keys.end() && (!a.enabled || a.enabled(editor))) {
            a.run(editor);
            return true;
        }
    return false;
}

}  // namespace relamp::ui
