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

    bool empty() const { return components.empty(); }
    static bool isMetal(const ComponentGloss& g) { return !g.matte; }
    bool hasMetal() const { return std::any_of(components.begin(), components.end(), isMetal); }
    /// Metals have no albedo.
    void withoutMetals(const Scene& scene, std::vector<Rgb>& albedo) const {
        for (const ComponentGloss& g : components)
            if (isMetal(g))
                for (size_t v = 0; v < scene.mesh.vertexCount(); ++v)
                    if (scene.material[v] == g.component) albedo[v] = Rgb(0);
    }
};

}  // namespace relamp
