// The albedo-free start (docs/method.md 11): light from ratios of radiance between vertices of probably equal albedo.
#pragma once
#include <array>
#include <functional>
#include <optional>

#include "base/progress.h"
#include "solve/gloss/matte.h"
#include "solve/light/qp.h"
#include "solve/priors/anchors.h"
#include "solve/priors/light_prior.h"
#include "solve/ratio/influence_rows.h"
#include "solve/ratio/pair_precision.h"
#include "solve/ratio/pairs.h"

namespace relamp {

struct AlbedoFreeOptions {
    int iterations = 12;
    float mismatch = 0.015f;     ///< relative model error of an observation (tau)
    float sameMismatch = 0.01f;  ///< of one vertex's in two lighting states, which is off alike in both for the most
    float mixing = 0.25f;      ///< fraction of the irradiance step to the next vertex that an observation may be off by
    float lightError = 0;      ///< relative: of what one emitter, or all other light, gives an observation
    float robustScale = 2.5f;  ///< Cauchy scale in standard deviations
    float tolerance = 1e-3f;   ///< relative change of the irradiance that counts as none
    float leastGain = 0;       ///< ends once an iteration lowers the objective by less than this, relative
    float keepProducts =
        0.05f;  ///< while the light has changed less than this, relative, since the products were formed, they are kept
    bool anneal = true;        ///< start with a wide robust scale
    bool emptyColumns = true;  ///< false: columns that hold nothing but zeros are left out of the products, which
                               ///< changes nothing but rounding
    bool closing = true;  ///< false: the report's objective and information are those of the last iteration's start,
                          ///< not of the light found
    int leastIterations = 0;  ///< that many are done whatever the time budget says
    /// Which leaves, in the equations' products, the first `foldedRows` rows are taken not to tell apart, per column
    /// (solve/folded_gram.h); empty: all are told apart. It changes the way and not the end. No pair stands between a
    /// row before and one behind.
    std::vector<uint32_t> fold;
    size_t foldedRows = 0;
    LightPriorOptions light;
    /// Per observation the light that other surfaces send it, in the photographs' own unit (as shown by a white matte
    /// surface); null: none. It is measured, not solved for: B x + bounce lights the observation.
    const std::vector<Rgb>* bounce = nullptr;
    /// How far the channels err on their own; none: found from the residuals while the weights are taken. Fits whose
    /// objectives are to be compared need the same.
    std::optional<ChromaFraction> chroma;
};

/// Looks at glossy surfaces of known reflectance, as ordinary rows: row_c . x = radiance_c.
struct ViewRows {
    InfluenceMatrix influence[3];  ///< per channel, the same number of rows
    std::vector<Rgb> radiance;
    std::vector<float> sigma;       ///< radiance
    std::vector<float> count = {};  ///< of observations that a row counts for; empty: one each
    bool tieScale = false;          ///< their reflectance is known without the light, so they tell its scale
};

/// What fixed the light: the quadratic model of the objective about the answer.
struct LightInformation {
    Eigen::MatrixXd all;  ///< of everything, priors included, 3n x 3n for n unknowns a channel, channel after channel
    std::array<Eigen::MatrixXd, 3>
        observations;  ///< its part from observations at glossy surfaces, n x n per channel, empty without any
    std::array<Eigen::VectorXd, 3> seen;  ///< its part from light seen directly, all of it on the diagonal
};

struct AlbedoFreeReport {
    double objective = 0;
    double kktResidual = 0;  ///< of the last program
    int iterations = 0;
    bool endedEarly = false;       ///< by AlbedoFreeOptions::leastGain
    LightInformation information;  ///< about the last step's start
    ChromaFraction chroma;         ///< that the objective was computed with
};

/// Solves for x = [L; P] of all three channels together, x >= 0, by Gauss-Newton: one program of 3n unknowns an
/// iteration, nine products B'W B when the light has moved since the last ones. For a pair the residual is 2 (p - q) /
/// (p + q), p = y_i B_j x, q = y_j B_i x: albedo is gone, the scale of x is an exact null space left to the anchors
/// alone (and to bounced light, whose scale is known), and unlit vertices stay finite where logs would not. (Minimising
/// (p - q)^2 with fixed weights instead shrinks x: noise in y correlates with the rows.) Weights: the residual's
/// covariance under noise, texture and shadow-edge mixing (solve/pair_precision.h: differences between channels are
/// known better than any channel, so the channels are solved for together), and a Cauchy weight. `lighting` is the
/// start and the result, and holds the best so far whenever `each(iteration, objective, rmse)` is told of an iteration.
/// The objective never rises: its weights are taken anew while it anneals, and then once. Out of time it ends with what
/// was best; rmse is the relative difference of the pairs (robustStep). `viewRows` may be null.
AlbedoFreeReport solveAlbedoFree(const InfluenceRows& influence, const MatteObservations& matte,
                                 const std::vector<AlbedoPair>& pairs, const LightAnchors& anchors,
                                 const ViewRows* viewRows, const AlbedoFreeOptions& options, Lighting& lighting,
                                 Progress& progress, const std::function<void(int, double, double)>& each);

}  // namespace relamp
