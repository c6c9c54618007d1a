// What the view modes of the window paint on the mesh: one colour per vertex of the capture's mesh. Scene-linear
// radiance or albedo goes through the display transform; the others are display colours (sRGB values) that are shown as
// they are.
#pragma once
#include <vector>

#include "capture/mesh_colours.h"
#include "radiance/samples.h"
#include "scene/scene.h"
#include "solve/estimate.h"

namespace relamp {

/// Weighted mean of what the photographs show (scene-linear). `view` >= 0: of that photograph only. Unobserved vertices
/// are dark blue-grey, or as the mesh's own file paints them, as bright as the photographs (a first look).
std::vector<Rgb> photographColours(const RadianceSamples& samples, int view = -1, const MeshColours* own = nullptr);
/// Albedo (scene-linear, lobe 0 plus the mean reflectance of the others).
std::vector<Rgb> albedoColours(const Estimate& estimate);
/// Correction colours: what is left of albedo without its brightness; grey is neutral. Scene-linear.
std::vector<Rgb> correctionColours(const Estimate& estimate);
/// Display colours: a distinct one per emitter, grey elsewhere.
std::vector<Rgb> clusterColours(const Estimate& estimate);
Rgb clusterColour(size_t emitter);
/// Display colours: confidence from low (purple) over middle (teal) to high (yellow), readable without colour vision;
/// unobserved vertices grey.
std::vector<Rgb> confidenceColours(const Estimate& estimate);
Rgb confidenceColour(float confidence);
/// Display colours: model against photographs, grey equal, orange the model is too bright, blue too dark; full colour
/// at a factor of 2. `model` = radiance per vertex.
std::vector<Rgb> differenceColours(const std::vector<Rgb>& model, const RadianceSamples& samples, int view = -1);
/// Scene-linear: light of one emitter on a white matte surface.
std::vector<Rgb> irradianceColours(const std::vector<float>& formFactor, const Rgb& radiance);

}  // namespace relamp
