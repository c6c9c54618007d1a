// A palette of materials: where a scene has few paints, every point is one of them but for texture.
#pragma once
#include "solve/albedo/albedo_step.h"

namespace relamp {

/// One material: its colour, and the fraction of the points that photographs show.
struct PaletteColour {
    Rgb albedo{0};
    float fraction = 0;
};

struct Palette {
    std::vector<PaletteColour> colours;  ///< most used first
    std::vector<Rgb> nearest;            ///< per mesh vertex: the albedo of its material
};

/// The `count` colours (or fewer, where there are not so many) that the albedos gather about: weighted k-means of log
/// albedo, robust (points far from every centre pull little), from the farthest of what was taken first, so without
/// chance. `weight`: per vertex, 0 leaves it out. O(count x vertices), some 20 times.
Palette findPalette(const std::vector<Rgb>& albedo, const std::vector<float>& weight, size_t count);

/// The albedo step with a prior that draws every vertex towards its material (AlbedoPrior::towards), materials and
/// albedo in turn three times, from `first`.
AlbedoResult solveAlbedoWithPalette(const Scene& scene, const MatteObservations& matte, const std::vector<Rgb>& lit,
                                    const std::vector<Rgb>& litSigma, const AlbedoPrior& prior, size_t count,
                                    AlbedoResult first, Palette& palette, Progress& progress);

}  // namespace relamp
