// The lobes the solver may mix: reflectance = sum over k of weight_k (per channel, >= 0) x lobe k.
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "brdf/measured_gloss.h"
#include "brdf/models.h"

namespace relamp {

struct Lobe {
    enum class Kind {
        lambert,
        ggx,
        ggxDielectric,
        ggxGrazing,
        cookTorrance,
        ward,
        lafortuneBack,     ///< cxy = -1, cz = 1
        lafortuneForward,  ///< cxy = 1, cz = 0
        measured,          ///< the gloss of a measured material
        mixture            ///< of other lobes; lives inside a solve only
    } kind = Kind::lambert;
    /// Width: GGX's alpha, roughness squared; Beckmann's slope; of a Lafortune lobe of exponent n, (2 / (n + 2))^1/2.
    /// Directions are drawn from GGX of this width, whatever the kind.
    float alpha = 1;
    std::string name;  ///< for info, for example "ggx roughness 0.3"; of a measured lobe the material's name
    std::shared_ptr<const MeasuredGloss> measured = {};
    std::vector<Lobe> parts = {};  ///< of a mixture
    float fraction = 1;            ///< in the mixture that it is part of: more than 0, the largest there is 1
};

/// Lobe 0 is always Lambert, so weight 0 is the diffuse albedo.
struct BrdfBasis {
    std::vector<Lobe> lobes;
};

/// Lambert, bare GGX (metal) and GGX under a dielectric Fresnel term of index 1.5 (plastic, coating); both GGX kinds at
/// six roughnesses in a geometric ladder 0.10, 0.15, 0.22, 0.32, 0.47, 0.70. 13 lobes.
BrdfBasis builtInBasis();

/// A wide choice that covers measured materials, 55 lobes: Lambert, GGX bare, under a dielectric Fresnel term and
/// rising towards grazing [Schlick94], Cook-Torrance, Ward and Lafortune lobes. To be pruned by the data: no material
/// needs more than a few.
BrdfBasis wideBasis();

/// "built-in", "wide" or "lambert" (Lambert alone: for measured lobes to join). Throws Error for another name.
BrdfBasis basisNamed(const std::string& name);

/// The gloss of a measured material as a lobe; named after its file.
Lobe measuredLobe(std::shared_ptr<const MeasuredGloss> gloss);

/// Reads every `.binary` file of a folder, in the order of their names, each as one lobe. Memory: 5.6 MiB a material.
/// Throws Error naming the file; a folder without such files is an error too.
std::vector<Lobe> readMeasuredLobes(const std::filesystem::path& folder);

/// BRDF of a lobe (per steradian, without the cosine), local directions.
float evaluateLobe(const Lobe& lobe, const Vec3& towardLight, const Vec3& towardEye);

/// About what fraction of light a lobe of weight 1 sends back at right angles: a coating of index 1.5 reflects 4 %,
/// whatever its weight looks like.
float lobeAlbedo(const Lobe& lobe);

/// What files and people call a kind: "ggx_dielectric".
const char* kindName(Lobe::Kind kind);

}  // namespace relamp
