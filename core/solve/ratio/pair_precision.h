// How exactly the three channels of a pair's ratio are known, and how far they err together: texture is mostly brighter
// and darker, rarely of another hue, so differences between the channels are known much better than any channel. They
// are known less where lights of several hues mix: too much of one of them is of another hue.
#pragma once
#include <array>
#include <vector>

#include "base/math.h"

namespace relamp {

/// Variance of the residual of a pair, per channel, by its cause.
struct PairVariance {
    Rgb noise;  ///< of the photographs
    Rgb model;  ///< texture, shadow edges, what the model does not know
    /// Of the channels (0,0), (1,1), (2,2), (1,0), (2,0), (2,1): by errors of single lights (hue_errors.h). Unlike the
    /// others it has no part that the channels share.
    std::array<float, 6> hue{};
};

/// What part of the variance of noise and model the channels do not share.
struct ChromaFraction {
    float noise = 1, model = 1;
    bool apart() const { return noise >= 1 && model >= 1; }  ///< each channel by itself
};

/// Symmetric 3 x 3 inverse of the covariance of a pair's residuals.
struct PairPrecision {
    float xx = 0, yy = 0, zz = 0, xy = 0, xz = 0, yz = 0;
    float operator()(int c, int d) const {
        if (c == d) return c == 0 ? xx : (c == 1 ? yy : zz);
        return c + d == 1 ? xy : (c + d == 2 ? xz : yz);
    }
    /// r' P r
    double square(const double* r) const {
        return xx * r[0] * r[0] + yy * r[1] * r[1] + zz * r[2] * r[2] +
               2 * (xy * r[0] * r[1] + xz * r[0] * r[2] + yz * r[1] * r[2]);
    }
};

/// From the residuals under the present light: robust medians of the differences between channels against the variances
/// given. Within [0.005, 1]; 1 where there is little to go by. Cost O(pairs log pairs).
ChromaFraction chromaFraction(const std::vector<Rgb>& residual, const std::vector<PairVariance>& variance);

/// Channels err on their own with a quarter of the fractions' part of the variance (all of it where they are 1), and
/// with the rest together. The quarter: see the source. The common error counts once for each channel, as if they were
/// independent, so that the brightness of a pair keeps its weight whatever the fractions are. Errors of
/// single lights come on top, unless all channels are apart.
PairPrecision pairPrecision(const PairVariance& variance, const ChromaFraction& fraction);

}  // namespace relamp
