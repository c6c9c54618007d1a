// The viewport as a widget: draws the scene in the present view mode, moves the camera, picks, and runs the gizmo. The
// only folder with GL calls besides window.cpp.
#pragma once
#include <memory>

#include "editor.h"

namespace relamp::ui {

class Viewport {
public:
    /// Needs a current OpenGL 4.3 context. Throws Error naming what the driver lacks.
    Viewport();
    ~Viewport();
    /// Fills the present ImGui window's content region: toolbar on top, image, overlays. Mouse and keys inside it act
    /// on `editor`.
    void draw(Editor& editor);
    /// Shows the image.
    uint64_t texture() const;
    /// The driver draws on the processors that also relight.
    bool software() const;
    /// A drag over the image that Esc gives up.
    bool takesEscape() const;
    /// CPU time of the last draw() without what the rasteriser took, milliseconds.
    double cpuMs() const;
    /// An image as a texture for a panel, uploaded once per key. Returns 0 when there is no GL.
    /// Keys: "view:3", "env:PATH", "env:recovered".
    uint64_t thumbnail(const std::string& key, const std::function<Image()>& make);
    /// Frees the textures whose key starts with `prefix`.
    void dropThumbnails(const std::string& prefix);

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace relamp::ui
