// A reflectance as a non-negative mixture of lobes: the constrained least squares of [Lawrence06] and [Weistroffer07].
#pragma once
#include <functional>
#include <vector>

#include "base/progress.h"
#include "brdf/basis.h"

namespace relamp {

/// Any BRDF: per steradian, without the cosine, local directions.
using BrdfFunction = std::function<Rgb(const Vec3& towardLight, const Vec3& towardEye)>;

/// A lobe that a mixture may hold, per steradian without the cosine.
struct NamedLobe {
    std::string name;
    std::function<float(const Vec3& towardLight, const Vec3& towardEye)> value;
};
/// The solver's own basis.
std::vector<NamedLobe> lobesOf(const BrdfBasis& basis);
/// A wide choice that covers measured materials, 73 lobes: GGX bare, under a dielectric Fresnel term and rising towards
/// grazing [Schlick94], Cook-Torrance, Ward and Lafortune lobes. To be pruned by the data: no material needs more than
/// a few.
std::vector<NamedLobe> lobeDictionary();

/// A pair of directions and how much of the light's hemisphere it stands for.
struct BrdfSample {
    Vec3 towardLight{0, 0, 1}, towardEye{0, 0, 1};
    float solidAngle = 0;  ///< steradians of light directions, for this eye direction
};

/// Pairs for eye directions 0 to 75 degrees from the normal in steps of 15; light directions follow the half vector,
/// dense about the normal, so that mirror-like lobes are resolved. `detail` is the number of half angles.
std::vector<BrdfSample> brdfSamples(int detail = 48);

/// What a fit minimises. `radiance` is the error of reflected radiance under even light, ruled by highlights;
/// `cubeRoot` weights the same error as the cube root of radiance would see it, which stands closer to what people see
/// [Fores12].
enum class FitMetric { radiance, cubeRoot };

struct BrdfFit {
    std::vector<Rgb> weights;  ///< per lobe of the basis, 0 or more
    double radianceError = 0;  ///< relative L2 of BRDF x cosine over the samples, all channels
    double cubeRootError = 0;  ///< root mean square difference of the cube roots of BRDF x cosine
    size_t lobes = 0;          ///< with a weight above 0 in some channel
};

/// The errors of `model` against `truth` on the samples, as in BrdfFit.
std::pair<double, double> brdfErrors(const std::vector<BrdfSample>& samples, const std::vector<Rgb>& truth,
                                     const std::vector<Rgb>& model);

/// Weights per channel that minimise sum w (sum_k weight_k lobe_k - truth)^2 under weight >= 0, exact (active set).
/// With `mostLobes` the lobes are chosen one after the other, the one that lowers the error most first, and the rest
/// stay 0: a dictionary pruned by the data. Cost: lobes^2 x samples. Throws Cancelled only.
BrdfFit projectBrdf(const BrdfFunction& truth, const std::vector<NamedLobe>& basis,
                    const std::vector<BrdfSample>& samples, FitMetric metric, size_t mostLobes, Progress& progress);

/// Least squares min x'Ax - 2 b'x under x >= 0 for a symmetric positive semidefinite A (row-major, n x n): Lawson and
/// Hanson's active set. Only columns in `allowed` may be above 0 (empty: all).
std::vector<double> nonNegativeLeastSquares(const std::vector<double>& gram, const std::vector<double>& moment,
                                            const std::vector<size_t>& allowed = {});

}  // namespace relamp
