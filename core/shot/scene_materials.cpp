#include "shot/scene_materials.h"

#include <algorithm>
#include <cmath>

namespace relamp {

SurfaceMaterial surfaceMaterialOf(const ExportedComponent& component) {
    SurfaceMaterial material;
    Rgb coating(0);
    float bare = 0, energy = 0, roughness = 0;
    for (const ExportedLobe& l : component.lobes) {
        const bool underFresnel = l.lobe.kind == Lobe::Kind::ggxDielectric || l.lobe.kind == Lobe::Kind::ggxGrazing;
        if (underFresnel) coating += l.weight;
        else bare += luminance(l.weight);
        const float reflected = luminance(l.weight) * lobeAlbedo(l.lobe);
        energy += reflected;
        roughness += reflected * std::sqrt(l.lobe.alpha);
    }
    if (!(energy > 0)) return material;
    material.roughness = std::clamp(roughness / energy, 0.0f, 1.0f);
    if (maxChannel(coating) > 0) {
        material.specular = std::min(1.0f, maxChannel(coating));
        material.specularColour = coating / maxChannel(coating);
    }
    float matte = 0;
    for (const Rgb& a : component.albedo) matte += luminance(a) / float(component.albedo.size());
    if (bare > 0) material.metallic = std::clamp(bare / (bare + matte), 0.0f, 1.0f);
    return material;
}

}  // namespace relamp
