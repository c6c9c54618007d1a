// A photograph as a texture behind the scene: without lens distortion, so that it lies where a pinhole camera of the same pixels sees.
#pragma once
#include <memory>

#include "capture/capture.h"
#include "viewport/gl_objects.h"

namespace relamp::ui {

/// The photograph resampled to its camera without distortion, longest side at most `longest` pixels: RGB and coverage (0 where masked or
/// outside the photograph), premultiplied, top row first. Runs on all cores; about 20 ms a megapixel.
std::vector<Vec4> straightened(const View& view, int longest, int& width, int& height);

/// Textures of the last photographs looked through.
class PhotographTextures {
public:
    /// The texture of view `index`; 0 when it has no pixels.
    GLuint texture(const std::shared_ptr<const Capture>& capture, int index);

private:
    struct Entry {
        std::shared_ptr<const Capture> capture;
        int index = -1;
        uint64_t used = 0;
        GlTexture texture;
    };
    std::vector<Entry> entries_;
    uint64_t clock_ = 0;
};

}  // namespace relamp::ui
