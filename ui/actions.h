// One table of every command: menus, the command palette, the keys page and the keyboard all read it.
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "editor.h"
#include "keys.h"

namespace relamp::ui {

struct KeyChord {
    int key = 0;  ///< from keys.h, 0: none
    bool control = false, shift = false, alt = false;
    bool operator==(const KeyChord&) const = default;
    std::string text() const;  ///< "Ctrl+Shift+P"
};

struct Action {
    std::string id;           ///< "file.open"
    std::string label;        ///< "Open..."
    std::string explanation;  ///< tooltip and palette, one sentence
    std::string menu;         ///< "File", "Edit", ...; empty: palette and keys only
    std::vector<KeyChord> keys;
    std::function<void(Editor&)> run;
    std::function<bool(const Editor&)> enabled;  ///< empty: always
    std::function<bool(const Editor&)> checked;  ///< empty: not a switch
    bool separatorBefore = false;
    std::string submenu = {};  ///< of `menu`; neighbours with the same one stand in it
};

const std::vector<Action>& actions();
const Action* findAction(const std::string& id);
/// Runs it when it is enabled; false otherwise.
bool runAction(Editor& editor, const std::string& id);
/// Runs the first enabled action of this chord. False: no action has it.
bool runKey(Editor& editor, const KeyChord& chord);

}  // namespace relamp::ui
