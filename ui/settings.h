// What the window remembers between sessions: recent files, its own sizes, advanced settings of the estimate. Plain
// JSON; a damaged file is set aside, never an error.
#pragma once
#include <filesystem>

#include "editor_state.h"

namespace relamp::ui {

/// Fills recent files, panel sizes, display view, unit of length, UI scale, how exports are packed, memory of played
/// frames and advanced settings of the estimate of `state` from FOLDER/settings.json.
void loadSettings(const std::filesystem::path& folder, EditorState& state);
void saveSettings(const std::filesystem::path& folder, const EditorState& state);
/// Puts `path` first, keeps 12.
void remember(std::vector<std::filesystem::path>& recent, const std::filesystem::path& path);

}  // namespace relamp::ui
