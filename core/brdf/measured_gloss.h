// What a measured material shows beside its matte part, as one lobe: a table per half angle, difference angle and
// azimuth [Matusik03].
#pragma once
#include <filesystem>
#include <vector>

#include "brdf/merl.h"

namespace relamp {

/// The solver has an albedo for every vertex and channel already, so a basis material is taken apart: matte part off,
/// what is left averaged over the channels, because a lobe's colour is in its weights.
struct MeasuredGloss {
    std::filesystem::path file;  ///< where it was read
    Rgb matte{
        0};  ///< albedo of the matte part: what the material sends back at the least, 5 % quantile over directions
    Rgb colour{1};    ///< gloss of the material per channel over the table: the weights that give the material itself
                      ///< back, mean 1
    float alpha = 1;  ///< GGX width that directions for it are best drawn from
    std::vector<float>
        cells;  ///< per steradian, without the cosine; negative where nothing was measured. Index: MeasuredBrdf::index

    /// Interpolated as MeasuredBrdf is.
    float evaluate(const Vec3& towardLight, const Vec3& towardEye) const;
};

/// Takes a measured material apart. Cost: about 0.1 s.
MeasuredGloss glossOf(const MeasuredBrdf& brdf, std::filesystem::path file);

}  // namespace relamp
