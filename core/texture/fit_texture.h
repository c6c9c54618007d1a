// Albedo per texel from the photographs, under the light that was solved for.
#pragma once
#include <memory>

#include "base/progress.h"
#include "capture/capture.h"
#include "scene/scene.h"
#include "solve/estimate.h"

namespace relamp {

struct TextureOptions {
    int mostSide = 4096;           ///< texels
    float texelsPerPixel = 1.25f;  ///< of the photograph that sees a place finest, along one axis
    int passes = 6;
    bool always = false;  ///< also where views left out are not predicted better with it
};

/// What a texture is worth on views that it was not made from: squared difference to their pixels.
struct TextureGain {
    double perVertex = 0, perTexel = 0;
    double percent() const { return perVertex > 0 ? 100 * (1 - perTexel / perVertex) : 0; }
    bool better() const { return percent() > 2; }
    TextureGain& operator+=(const TextureGain& other) {
        perVertex += other.perVertex;
        perTexel += other.perTexel;
        return *this;
    }
};

struct TextureFit {
    std::shared_ptr<const AlbedoTexture> texture;  ///< null where there is nothing to gain
    std::shared_ptr<const AlbedoTexture>
        without;  ///< the same from all views but n / 3 and 2 n / 3 of the n of SurfaceLight::state, and those of
                  ///< other states from their places; null with three
    TextureGain gain;
    size_t charts = 0;
    bool own = false;       ///< laid out by the mesh's own texture coordinates
    std::string whyNotOwn;  ///< the mesh's own texture coordinates are not used, though it has some
    float scale = 1;        ///< of the resolution that photographs have, at most 1
    std::string why;        ///< there is none
};

/// Super-resolution by back-projection [IraniPeleg91] [Goldluecke14]: every photograph is predicted through its
/// pixels' footprints, and what is left over goes back to the texels that the pixel covers. Starts from the vertices'
/// albedo, which stays where no photograph says more; robust against what other views contradict. `scene` and
/// `estimate` are the capture's. Cost: a pass looks at 1.2e7 positions at most. Memory: 56 B a texel; 150 B a
/// pixel of 3 million at most, 2 to 7 B a pixel of more. The same bits on any number of threads. Throws Cancelled.
TextureFit fitTexture(const Capture& capture, const Scene& scene, const Estimate& estimate,
                      const TextureOptions& options, Progress& progress);

/// Core-seconds and memory that a fit to photographs of so many pixels takes.
double textureSeconds(double pixels, const TextureOptions& options);
double textureMib(double pixels, const TextureOptions& options);

}  // namespace relamp
