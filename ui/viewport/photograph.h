// A photograph as a texture behind the scene: without lens distortion, so that it lies where a pinhole camera of the
// same pixels sees.
#pragma once
#include <memory>

#include "capture/capture.h"
#include "radiance/samples.h"
#include "relight/distant_light.h"
#include "viewport/gl_objects.h"

namespace relamp::ui {

/// The photograph resampled to its camera without distortion, longest side at most `longest` pixels: RGB and coverage
/// (0 where masked or outside the photograph), premultiplied, top row first. Runs on all cores; about 20 ms a
/// megapixel.
std::vector<Vec4> straightened(const View& view, int longest, int& width, int& height);

/// What lies behind the scene: the photograph where it shows no surface, elsewhere the environment, so that an emitter
/// that was moved leaves no ghost. `pixels` as straightened() gives them.
void coverSurfaces(const View& view, const ViewGeometry& geometry, const DistantLight& distant, int width, int height,
                   std::vector<Vec4>& pixels);

/// Textures of the last photographs looked through.
class PhotographTextures {
public:
    /// The texture of view `index`; 0 when it has no pixels.
    GLuint texture(const std::shared_ptr<const Capture>& capture, int index);
    /// The same without the surfaces of the scene (coverSurfaces).
    GLuint backdrop(const std::shared_ptr<const Capture>& capture, int index, const RadianceSamples& samples,
                    const std::shared_ptr<const DistantLight>& distant);

private:
    struct Entry {
        std::shared_ptr<const Capture> capture;
        int index = -1;
        std::shared_ptr<const DistantLight> distant;  // of a backdrop
        uint64_t used = 0;
        GlTexture texture;
    };
    std::vector<Entry> entries_;
    uint64_t clock_ = 0;

    GLuint find(const std::shared_ptr<const Capture>& capture, int index,
                const std::shared_ptr<const DistantLight>& distant);
    GLuint keep(const std::shared_ptr<const Capture>& capture, int index,
                const std::shared_ptr<const DistantLight>& distant, int width, int height,
                const std::vector<Vec4>& pixels);
};

}  // namespace relamp::ui
