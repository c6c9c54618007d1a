// The fixed list of lobes the solver may mix: reflectance = sum over k of weight_k (per channel, >= 0) x lobe k.
#pragma once
#include <string>
#include <vector>

#include "brdf/models.h"

namespace relamp {

struct Lobe {
    enum class Kind { lambert, ggx, ggxDielectric } kind = Kind::lambert;
    float alpha = 1;    ///< GGX width, roughness squared
    std::string name;   ///< for info, for example "ggx roughness 0.3"
};

/// Lobe 0 is always Lambert, so weight 0 is the diffuse albedo.
struct BrdfBasis {
    std::vector<Lobe> lobes;
};

/// Lambert, bare GGX (metal) and GGX under a dielectric Fresnel term of index 1.5 (plastic, glaze); both GGX kinds at six
/// roughnesses in a geometric ladder 0.10, 0.15, 0.22, 0.32, 0.47, 0.70. 13 lobes.
BrdfBasis builtInBasis();

/// BRDF of a lobe (per steradian, without the cosine), local directions.
float evaluateLobe(const Lobe& lobe, const Vec3& towardLight, const Vec3& towardEye);

}  // namespace relamp
