// Which parts of the interface a frame draws otherwise than the frame before it: where OpenGL is software, only those
// are drawn while a hand waits for the light.
#pragma once
#include <imgui.h>

#include <string>
#include <vector>

namespace relamp::ui {

/// Screen units.
struct ChangedPart {
    ImVec2 low, high;
};

class ChangedParts {
public:
    /// Rectangles that hold all that `data` draws otherwise than the data of the last call, and everything that shows
    /// the texture `changing`. They do not overlap. The whole screen after forget(), and where windows come or go.
    std::vector<ChangedPart> next(const ImDrawData& data, ImTextureID changing);
    void forget() { lists_.clear(); }

private:
    struct Command {
        ImVec4 clip;
        ImTextureID texture;
    };
    struct List {
        std::string window;
        std::vector<ImDrawVert> vertices;
        std::vector<Command> commands;
    };
    std::vector<List> lists_;
    ImVec2 size_{0, 0};
};

}  // namespace relamp::ui
