// The residual that everything about ratios of radiance rests on (docs/method.md 11): with its derivatives, its
// variance and how it is bent against outliers.
#pragma once
#include <algorithm>
#include <cmath>

namespace relamp {

/// For radiances ya, yb of two points of equal albedo and irradiances la, lb under the light in question:
/// r = 2 (p - q) / (p + q), p = ya lb, q = yb la. That is the difference of log albedo where it is small, and stays
/// finite in the dark. `byA`, `byB`: dr/dla = -byA, dr/dlb = byB.
struct RatioResidual {
    double residual, byA, byB;

    static constexpr double dark = 1e-30;
    static double value(double ya, double yb, double la, double lb) {
        const double p = ya * lb, q = yb * la;
        return 2 * (p - q) / std::max(p + q, dark);
    }
    static RatioResidual at(double ya, double yb, double la, double lb) {
        const double p = ya * lb, q = yb * la, sum = std::max(p + q, dark);
        return {2 * (p - q) / sum, 4 * p * yb / (sum * sum), 4 * q * ya / (sum * sum)};
    }
    /// Variance of r when p is off by `sigmaP` and q by `sigmaQ`.
    static double variance(double ya, double yb, double la, double lb, double sigmaP, double sigmaQ) {
        const double sum = std::max(ya * lb + yb * la, dark);
        return 4 * (sigmaP * sigmaP + sigmaQ * sigmaQ) / (sum * sum);
    }
};

/// Robust loss (Cauchy): of the square of a residual in standard deviations, and the weight of that residual in a
/// Gauss-Newton step.
struct CauchyLoss {
    double scale = 2.5;  ///< standard deviations
    double loss(double squared, double times = 1) const {
        return times * scale * scale * std::log1p(squared / (scale * scale));
    }
    double weight(double squared) const { return 1 / (1 + squared / (scale * scale)); }
};

/// Square of a pair's relative difference, bent (Cauchy, 0.05) so that pairs across a real edge of albedo do not rule a
/// mean.
inline double robustStep(double difference) {
    constexpr double bend = 0.05 * 0.05;
    return bend * std::log1p(difference * difference / bend);
}

}  // namespace relamp
