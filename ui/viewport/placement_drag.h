// A drag with Aim, Reflect or Light: the selected lights follow the surface point under the pointer, as one edit. Knows
// no GL and no ImGui.
#pragma once
#include "editor.h"
#include "viewport/eye_view.h"

namespace relamp::ui {

class PlacementDrag {
public:
    /// The armed task follows the pointer, and there is a light for it.
    static bool fits(const Editor& editor);
    /// Keeps the surface as it stands, without the lights that are about to move: they must not be hit themselves.
    /// `visible` (per triangle; empty: all).
    void begin(Editor& editor, const std::shared_ptr<const Mesh>& mesh, std::vector<uint8_t> visible);
    /// The lights go where the point under `ray` wants them; past the surface they stay. Cost: one ray, one preview.
    void follow(Editor& editor, const Ray& ray, const EyeView& eye);
    /// One edit, if a surface was ever under the pointer; the task is disarmed then.
    void commit(Editor& editor);
    /// Everything back; the task stays armed.
    void abandon(Editor& editor);
    bool running() const { return mesh_ != nullptr; }

private:
    std::shared_ptr<const Mesh> mesh_;
    std::vector<uint8_t> visible_;
    bool placed_ = false;
};

}  // namespace relamp::ui
