// The program behind relamp-editor: window, editor and the loop that draws when there is something to draw.
#pragma once
#include <filesystem>
#include <string>

namespace relamp::ui {

struct ApplicationOptions {
    std::filesystem::path open;  ///< capture or shot; empty: nothing
    bool solve = false;          ///< estimate as soon as it is open
    std::string quality;         ///< "draft", "standard" or "fine" for estimates; empty: as the shot says, or standard
    float scale = 0;             ///< of the whole window; 0: as the monitor says
    int width = 1440, height = 900;
    std::string gpu = "auto";  ///< where light is summed: "auto", "on" or "off", as EditorOptions::gpu
};

/// Runs until the user quits. Returns the exit code. Throws Error when no window can be opened.
int runApplication(const ApplicationOptions& options);

}  // namespace relamp::ui
