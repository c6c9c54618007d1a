// What the lobes of an exported surface are called in other programs' materials.
#pragma once
#include "shot/export_scene.h"

namespace relamp {

/// Metallic-roughness with a specular weight, as glTF, OpenPBR and UsdPreviewSurface have it. Without gloss roughness
/// means nothing to them, but it bends the diffuse part of Burley, "Physically Based Shading at Disney" (2012), which
/// programs use: 1/2 is nearest to Lambert's.
struct SurfaceMaterial {
    float metallic = 0;     ///< 0 to 1
    float roughness = .5f;  ///< 0 to 1: the root of GGX's alpha
    float specular = 0;     ///< 0 to 1, of a dielectric of index 1.5
    Rgb specularColour{1};  ///< its largest channel is 1
    bool plain() const { return metallic == 0 && specular == 0; }
};

/// The nearest such material. Lobes under a Fresnel term become the specular weight, bare ones the metallic part by
/// what they reflect beside the matte part; roughness is their mean by reflected energy.
SurfaceMaterial surfaceMaterialOf(const ExportedComponent& component);

}  // namespace relamp
