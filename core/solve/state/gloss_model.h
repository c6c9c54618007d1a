// Connected components that change with the view, and their lobes.
#pragma once
#include <algorithm>

#include "solve/gloss/gloss.h"

namespace relamp {

struct GlossModel {
    std::vector<ComponentGloss> components;  ///< with a lobe
    std::vector<ComponentGloss> early;       ///< the same by a few observations, until `components` has them
    bool noMetals = false;  ///< components that change with the view as metals do were not explained by being metals
    bool heard = false;     ///< components that seem to be metal were taken for metal once,
    bool joined = false;    ///< and had a say in the light
    bool settled = false;   ///< the last fit found the coatings of the one before: light fitted with them is as it was

    bool empty() const { return components.empty(); }
    static bool isMetal(const ComponentGloss& g) { return !g.matte; }
    bool hasMetal() const { return std::any_of(components.begin(), components.end(), isMetal); }
    /// Whether `found` are coatings, and the same: to a twentieth of roughness and weight. Lobes that are more than a
    /// roughness (mixtures, measured ones) are the same by name.
    bool sameCoatings(const std::vector<ComponentGloss>& found) const {
        constexpr float alike = 0.05f;
        return std::equal(components.begin(), components.end(), found.begin(), found.end(),
                          [](const ComponentGloss& a, const ComponentGloss& b) {
                              return a.component == b.component && a.matte && b.matte && a.lobe && b.lobe &&
                                     a.lobe->kind == b.lobe->kind &&
                                     (a.lobe->kind <= Lobe::Kind::ggxDielectric || a.lobe->name == b.lobe->name) &&
                                     std::abs(std::log(a.lobe->alpha / b.lobe->alpha)) < 2 * alike &&
                                     maxChannel(glm::abs(a.weight - b.weight)) < alike * maxChannel(a.weight);
                          });
    }
    /// Metals have no albedo.
    void withoutMetals(const Scene& scene, std::vector<Rgb>& albedo) const {
        for (const ComponentGloss& g : components)
            if (isMetal(g))
                for (size_t v = 0; v < scene.mesh.vertexCount(); ++v)
                    if (scene.material[v] == g.component) albedo[v] = Rgb(0);
    }
};

}  // namespace relamp
