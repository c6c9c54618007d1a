// What a view mode paints: strips of the image, each with a colour per vertex of the mesh that is drawn. Pure; no GL.
#pragma once
#include <string>

#include "editor.h"

namespace relamp::ui {

/// One vertical strip of the image.
struct Strip {
    float left = 0, right = 1;  ///< fraction of the width
    Paint paint = Paint::model;
    std::string caption;  ///< what is seen, when there are several strips
    std::string missing;  ///< what to do to see it; empty: it can be painted
    bool operator==(const Strip&) const = default;
};

/// The strips of the present mode, with what is missing for them.
std::vector<Strip> stripsOf(const Editor& editor);

struct PaintedMesh {
    std::shared_ptr<const Mesh> mesh;                     ///< null: nothing to draw
    std::shared_ptr<const std::vector<uint32_t>> origin;  ///< null: the capture's own vertices
    std::vector<Rgb> colours;                             ///< per vertex
    bool display = false;                                 ///< display values, else scene-linear
    bool shading = false;                                 ///< with a soft light at the eye
};

/// Everything the colours depend on; equal keys give equal colours.
struct PaintKey {
    Paint paint = Paint::model;
    std::shared_ptr<const void> scene, samples, live, estimate;
    int view = -1;
    std::string emitter;
    bool operator==(const PaintKey&) const = default;
};
PaintKey paintKey(const Editor& editor, Paint paint);
/// Colours for the key's paint. Where data is missing: the mesh in grey.
PaintedMesh paintMesh(const Editor& editor, Paint paint);

/// Index of the emitter that mode "irradiance" shows in the live frame: the active one, else the first; -1: none.
int irradianceEmitter(const Editor& editor, const LiveFrame& live);

}  // namespace relamp::ui
