// The table of commands in parts, one a menu, in the order of the menu.
#pragma once
#include "actions.h"

namespace relamp::ui {

void addFileActions(std::vector<Action>& table);
void addEditActions(std::vector<Action>& table);
void addSnapshotActions(std::vector<Action>& table);  ///< of the menu Edit
void addLightActions(std::vector<Action>& table);
void addTimeActions(std::vector<Action>& table);
void addViewActions(std::vector<Action>& table);
void addHelpActions(std::vector<Action>& table);

// When they are enabled.
inline bool hasDocument(const Editor& e) { return e.state.document.capture != nullptr; }
inline bool hasEstimate(const Editor& e) { return e.estimate() != nullptr; }

}  // namespace relamp::ui
