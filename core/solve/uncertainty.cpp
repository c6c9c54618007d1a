#include "solve/uncertainty.h"

#include "base/parallel.h"
#include "base/dense.h"
#include "solve/light/weighted_gram.h"

namespace relamp {
namespace {

constexpr double mostSigma = 10;

/// "35 degrees above the horizon towards +X".
std::string directionInWords(const Vec3& d) {
    const float up = std::asin(std::clamp(d.z, -1.0f, 1.0f)) * 180 / pi;
    if (up > 70) return "straight above";
    if (up < -70) return "straight below";
    const char* names[] = {"+X", "+X+Y", "+Y", "-X+Y", "-X", "-X-Y", "-Y", "+X-Y"};
    const int sector = (int(std::lround(std::atan2(d.y, d.x) * 4 / pi)) + 8) % 8;
    if (std::abs(up) < 10) return fmt::format("the horizon towards {}", names[sector]);
    return fmt::format("{:.0f} degrees {} the horizon towards {}", std::abs(up), up > 0 ? "above" : "below",
                       names[sector]);
}

/// What stands behind the unknowns of one sign: an emitter when it gives most of the effect, else where the distant
/// light comes from.
std::string sideInWords(const Eigen::VectorXd& effect, double sign, const Lighting& lighting,
                        const std::vector<std::string>& emitterNames) {
    const Eigen::Index leaves = Eigen::Index(lighting.leaves.size());
    double distant = 0, strongest = 0;
    Vec3 towards(0);
    Eigen::Index emitter = -1;
    for (Eigen::Index i = 0; i < effect.size(); ++i) {
        const double value = sign * effect(i);
        if (!(value > 0)) continue;
        if (i < leaves) {
            distant += value;
            towards += float(value) * lighting.leaves.direction(size_t(i), Vec2(0.5f));
        } else if (value > strongest) {
            strongest = value;
            emitter = i - leaves;
        }
    }
    if (emitter >= 0 && strongest > 0.5 * distant)
        return size_t(emitter) < emitterNames.size() ? emitterNames[size_t(emitter)] : "an emitter";
    // Spread over more than a hemisphere it has no direction.
    if (glm::length(towards) < 0.3f * float(distant)) return "distant light from all around";
    return "distant light from " + directionInWords(glm::normalize(towards));
}

/// Variance of the scale under an information matrix restricted to `free` unknowns.
double scaleVariance(const Eigen::MatrixXd& information, const Eigen::VectorXd& mean) {
    const std::optional<Eigen::MatrixXd> factor = choleskyFactor(information);
    if (!factor) return mostSigma * mostSigma;
    const double variance = mean.dot(solveByFactor(*factor, mean));
    return std::isfinite(variance) ? std::clamp(variance, 1e-12, mostSigma * mostSigma) : mostSigma * mostSigma;
}

/// The unknowns of the light: leaves, then emitters, channel by channel.
struct LightUnknowns {
    const LightInformation& information;
    const Lighting& lighting;
    size_t leaves = lighting.leaves.size(), count = leaves + lighting.emitterRadiance.size();

    double radiance(size_t i, int c) const {
        return double(i < leaves ? lighting.leafRadiance[i][c] : lighting.emitterRadiance[i - leaves][c]);
    }
    /// Those of a channel that are not held by their bound.
    std::vector<Eigen::Index> free(int c) const {
        double top = 0;
        for (size_t i = 0; i < count; ++i) top = std::max(top, radiance(i, c));
        std::vector<Eigen::Index> free;
        for (size_t i = 0; i < count; ++i) {
            const Eigen::Index k = Eigen::Index(size_t(c) * count + i);
            if (radiance(i, c) > 1e-7 * top && information.all(k, k) > 0) free.push_back(Eigen::Index(i));
        }
        return free;
    }
    /// What is known of one channel when the other two are unknown as well: a Schur complement.
    Eigen::MatrixXd marginal(int c) const {
        const Eigen::Index m = Eigen::Index(count), first = c * m;
        std::vector<Eigen::Index> others;
        for (int d = 0; d < 3; ++d)
            if (d != c)
                for (Eigen::Index i : free(d)) others.push_back(d * m + i);
        Eigen::MatrixXd own = information.all.block(first, first, m, m);
        if (others.empty()) return own;
        Eigen::MatrixXd between = information.all(others, Eigen::seqN(first, m)),
                        rest = information.all(others, others);
        rest.diagonal() *= 1 + 1e-9;
        const std::optional<Eigen::MatrixXd> factor = choleskyFactor(rest);
        if (!factor) return own;
        between = divideByFactor(*factor, std::move(between));
        own -= transposedProduct(between, between);
        return own;
    }
};

/// A change of the light in words; `light`: the light itself in the same unknowns.
std::string changeInWords(const Eigen::VectorXd& change, const Eigen::VectorXd& light, int c, const Lighting& lighting,
                          const std::vector<std::string>& emitterNames) {
    const char* colour[] = {"red", "green", "blue"};
    const double alike = change.dot(light) / std::max(1e-300, change.norm() * light.norm()),
                 against = change.cwiseMin(0).sum() / std::max(1e-300, change.cwiseMax(0).sum());
    if (alike > 0.9) return fmt::format("{}: all light brighter and all surfaces darker", colour[c]);
    const std::string brighter = sideInWords(change, 1, lighting, emitterNames);
    if (against > -0.25) return fmt::format("{}: {} brighter and the surfaces it lights darker", colour[c], brighter);
    return fmt::format("{}: {} brighter and {} darker", colour[c], brighter,
                       sideInWords(change, -1, lighting, emitterNames));
}

/// What the scale of a channel rests on, for the free unknowns; `observations` for all of them.
struct ScaleEvidence {
    const Eigen::MatrixXd& all;
    const Eigen::VectorXd &mean, &known, &background;
    const Eigen::MatrixXd& observations;
};

/// The deviation of the scale of channel c, and what fixes it: the evidence that is lost without each source.
template <class Restricted>
void assessScale(const ScaleEvidence& e, const Restricted& restricted, const UncertaintyOptions& options, int c,
                 LightUncertainty& result) {
    const double precision = 1 / scaleVariance(e.all, e.mean);
    result.scaleSigma[c] = float(std::min(mostSigma, std::hypot(1 / std::sqrt(precision), double(options.scaleFloor))));
    const auto lost = [&](const Eigen::MatrixXd& part) {
        Eigen::MatrixXd rest = e.all - part;
        rest.diagonal() += 1e-9 * e.all.diagonal();
        return std::max(0.0, precision - 1 / scaleVariance(rest, e.mean));
    };
    const Eigen::MatrixXd &probes = options.probes[size_t(c)], &patches = options.patches[size_t(c)];
    const bool patched = patches.size() > 0 && patches.size() == e.observations.size();
    const double known = lost(e.known.asDiagonal()), background = lost(e.background.asDiagonal()),
                 gloss = patched                 ? lost(restricted(e.observations - patches))
                         : e.observations.size() ? lost(restricted(e.observations))
                                                 : 0.0,
                 probed = probes.size() ? lost(restricted(probes)) : 0.0,
                 told = patched ? lost(restricted(patches)) : 0.0,
                 bounces =
                     options.bounced ? std::max(0.0, precision - known - background - gloss - probed - told) : 0.0,
                 sum = known + background + gloss + bounces + probed + told;
    if (!(sum > 0)) return;
    result.fromEmitters[c] = float(known / sum);
    result.fromBackground[c] = float(background / sum);
    result.fromGloss[c] = float(gloss / sum);
    result.fromBounces[c] = float(bounces / sum);
    result.fromProbes[c] = float(probed / sum);
    result.fromPatches[c] = float(told / sum);
}

}  // namespace

LightUncertainty lightUncertainty(const LightInformation& information, const InfluenceMatrix& b,
                                  const std::vector<Rgb>& lit, const Lighting& lighting,
                                  const std::vector<std::string>& emitterNames, const UncertaintyOptions& options,
                                  Progress& progress) {
    LightUncertainty result;
    const size_t leaves = lighting.leaves.size(), emitters = lighting.emitterRadiance.size(), n = leaves + emitters;
    result.leafSigma.assign(leaves, Rgb(0));
    result.emitterSigma.assign(emitters, Rgb(0));
    result.litSigma.assign(b.rows, Rgb(0));
    const LightUnknowns unknowns{information, lighting};
    for (int c = 0; c < 3; ++c) {
        if (size_t(information.all.rows()) != 3 * n || b.columns != n || b.rows == 0) continue;
        const std::vector<Eigen::Index> free = unknowns.free(c);
        if (free.empty()) continue;
        const Eigen::Index m = Eigen::Index(free.size());
        const double widening = double(options.widening) * options.widening;
        const auto restricted = [&](const Eigen::MatrixXd& q) -> Eigen::MatrixXd { return q(free, free) / widening; };
        const Eigen::VectorXd& seen = information.seen[size_t(c)];
        const Eigen::MatrixXd& observations = information.observations[size_t(c)];
        // The effect of the unknowns on the light, relative to it.
        const size_t step = std::max<size_t>(1, b.rows / 6000);
        InfluenceMatrix some;
        some.columns = size_t(m);
        Eigen::VectorXd mean = Eigen::VectorXd::Zero(m);
        for (size_t r = 0; r < b.rows; r += step) {
            if (!(lit[r][c] > 0)) continue;
            const float* row = b.row(r);
            for (Eigen::Index k = 0; k < m; ++k) {
                some.values.push_back(row[free[size_t(k)]] / lit[r][c]);
                mean(k) += double(some.values.back());
            }
            ++some.rows;
        }
        if (some.rows == 0) continue;
        mean /= double(some.rows);

        Eigen::MatrixXd all = restricted(unknowns.marginal(c));
        if (options.backdrop)
            for (Eigen::Index k = 0; k < m; ++k)
                if (size_t(free[size_t(k)]) < leaves) all(k, k) -= (1 - 1e-6) * seen(free[size_t(k)]) / widening;
        all.diagonal() *= 1 + 1e-9;
        const std::optional<Eigen::MatrixXd> factor = choleskyFactor(all);
        if (!factor) {
            result.scaleSigma[c] = float(mostSigma);
            continue;
        }
        Eigen::VectorXd background = Eigen::VectorXd::Zero(m), known = Eigen::VectorXd::Zero(m);
        for (Eigen::Index k = 0; k < m; ++k)
            (size_t(free[size_t(k)]) < leaves ? background : known)(k) =
                (options.backdrop && size_t(free[size_t(k)]) < leaves ? 0 : 1) * seen(free[size_t(k)]) / widening;
        assessScale({all, mean, known, background, observations}, restricted, options, c, result);
        if (options.scaleOnly) continue;

        const auto relative = [&](size_t i, double sigma) {
            return float(std::min(mostSigma, sigma / std::max(unknowns.radiance(i, c), 1e-30)));
        };
        const Eigen::MatrixXd inverseFactor =
            divideByFactor(*factor, Eigen::MatrixXd::Identity(m, m));  // L^-1: covariance = L^-T L^-1
        for (Eigen::Index k = 0; k < m; ++k) {
            const size_t i = size_t(free[size_t(k)]);
            const double sigma = inverseFactor.col(k).norm();
            (i < leaves ? result.leafSigma[i] : result.emitterSigma[i - leaves])[c] = relative(i, sigma);
        }
        const Eigen::MatrixXd effect =
            weightedGram(
                some, [&](size_t i, float* out) { std::copy(some.row(i), some.row(i) + m, out); }, progress) /
            double(some.rows);
        // Directions by how much they may change the light on the surfaces: eigenvectors of L^-1 E L^-T.
        const Eigen::MatrixXd within = product(product(inverseFactor, effect), inverseFactor.transpose());
        const SymmetricEigen eigen = eigenOf(0.5 * (within + within.transpose()), true);
        const Eigen::Index count = std::min<Eigen::Index>(m, options.directions);
        const Eigen::MatrixXd directions =
            transposedProduct(inverseFactor, eigen.vectors.rightCols(count).rowwise().reverse());
        Eigen::MatrixXf wide = Eigen::MatrixXf::Zero(Eigen::Index(n), count);
        for (Eigen::Index k = 0; k < m; ++k) wide.row(free[size_t(k)]) = directions.row(k).cast<float>();
        parallelBlocks(b.rows, 1024, [&](size_t begin, size_t end) {
            const Eigen::Map<const Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>> rows(
                b.row(begin), Eigen::Index(end - begin), Eigen::Index(n));
            const Eigen::VectorXf norm = (rows * wide).rowwise().norm();
            for (size_t r = begin; r < end; ++r)
                result.litSigma[r][c] =
                    lit[r][c] > 0 ? std::min(float(mostSigma),
                                             std::hypot(norm(Eigen::Index(r - begin)) / lit[r][c], options.scaleFloor))
                                  : float(mostSigma);
        });

        const double sigma = std::sqrt(std::max(0.0, eigen.values(m - 1)));
        if (sigma <= double(result.weakestSigma)) continue;
        result.weakestSigma = float(std::min(sigma, mostSigma));
        Eigen::VectorXd change = Eigen::VectorXd::Zero(Eigen::Index(n)),
                        fraction = Eigen::VectorXd::Zero(Eigen::Index(n));
        for (Eigen::Index k = 0; k < m; ++k) {
            change(free[size_t(k)]) = mean(k) * directions(k, 0);
            fraction(free[size_t(k)]) = mean(k) * unknowns.radiance(size_t(free[size_t(k)]), c);
        }
        if (change.sum() < 0) change = -change;
        result.weakest = changeInWords(change, fraction, c, lighting, emitterNames);
    }
    return result;
}

}  // namespace relamp
