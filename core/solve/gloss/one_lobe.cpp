#include "solve/gloss/one_lobe.h"

#include <limits>

#include "solve/light/qp.h"
#include "solve/light/weighted_gram.h"
#include "solve/ratio/albedo_free.h"

namespace relamp {
namespace {

/// What a light probe holds, as z_i = w g probe_i. A gain g that nothing tells is eliminated. `x`: where the last round
/// ended, null in the first.
void tieProbe(const ProbeAnchor& probe, int c, double unit, const Eigen::VectorXd* x, Eigen::MatrixXd& q) {
    constexpr double weight = 16, bend = 2.5 * 2.5;  // beside the background's as in LightPrior
    const Eigen::Index leaves = Eigen::Index(probe.radiance.size()), w = q.rows() - 1;
    const bool tied = probe.gainSigma > 0;
    Eigen::VectorXd pull = Eigen::VectorXd::Zero(leaves);
    double all = 0;
    for (Eigen::Index i = 0; i < leaves; ++i) {
        const double value = probe.radiance[size_t(i)][c], held = probe.held[size_t(i)];
        if (held < 0.5) continue;
        double strength = held / (double(probe.noise) * probe.noise * (value * value + 0.01 * unit * unit + 1e-30));
        if (x && tied && (*x)(w) > 0) strength /= 1 + strength * std::pow((*x)(i) / (*x)(w)-value, 2) / bend;
        strength *= weight;
        q(i, i) += strength;
        pull(i) = strength * value;
        all += strength * value * value;
    }
    if (!(all > 0)) return;
    if (tied) {
        q(w, w) += all;
        q.col(w).head(leaves) -= pull;
        q.row(w).head(leaves) -= pull.transpose();
    } else {
        q.topLeftCorner(leaves, leaves) -= pull * pull.transpose() / all;
    }
}

}  // namespace

OneLobeFit fitOneLobe(const InfluenceMatrix& rows, const std::vector<GlossyObservation>& observations,
                      const LightAnchors& anchors, const Lighting& guess, Progress& progress) {
    OneLobeFit fit;
    fit.lighting = guess;
    const size_t leaves = guess.leaves.size(), emitters = anchors.emitterRadiance.size();
    const Eigen::Index n = Eigen::Index(rows.columns), w = n;
    const auto neighbours = guess.leaves.neighbourPairs();
    for (int c = 0; c < 3; ++c) {
        std::vector<float> robust(observations.size(), 1);
        Eigen::VectorXd x = Eigen::VectorXd::Zero(n + 1);
        double unit = 0;
        for (size_t i = 0; i < leaves; ++i)
            unit += double(guess.leafRadiance[i][c]) * guess.leaves[i].solidAngle() / (4 * piD);
        double residual = 0;
        constexpr int rounds = 3;
        for (int round = 0; round < rounds; ++round) {
            const auto weightOf = [&](size_t i) { return robust[i] / (observations[i].sigma * observations[i].sigma); };
            Eigen::MatrixXd q = Eigen::MatrixXd::Zero(n + 1, n + 1);
            q.topLeftCorner(n, n) = weightedGram(
                rows,
                [&](size_t i, float* out) {
                    const float v = weightOf(i);
                    for (Eigen::Index j = 0; j < n; ++j) out[j] = v * rows.row(i)[j];
                },
                progress);
            Eigen::VectorXd moment = Eigen::VectorXd::Zero(n + 1);
            for (size_t i = 0; i < rows.rows; ++i)
                moment.head(n) += double(weightOf(i)) * observations[i].radiance[c] *
                                  Eigen::Map<const Eigen::VectorXf>(rows.row(i), n).cast<double>();
            const double ridge = 1e-5 * q.diagonal().maxCoeff();
            for (const auto& [i, j] : neighbours) {
                q(i, i) += ridge;
                q(j, j) += ridge;
                q(i, j) -= ridge;
                q(j, i) -= ridge;
            }
            const auto tie = [&](Eigen::Index i, double value, double strength) {
                q(i, i) += strength;
                q(w, w) += strength * value * value;
                q(i, w) -= strength * value;
                q(w, i) -= strength * value;
            };
            for (size_t i = 0; i < leaves; ++i) {
                const LeafAnchor& a = anchors.leaves[i];
                if (a.coverage < 0.05f || a.clipped) continue;
                const double spread = 0.02 + 0.7 * (1 - double(a.coverage)), value = a.radiance[c];
                tie(Eigen::Index(i), value, 3 / (spread * spread) / (value * value + 0.01 * unit * unit + 1e-30));
            }
            for (const ProbeAnchor& p : anchors.probes) tieProbe(p, c, unit, round ? &x : nullptr, q);
            for (size_t e = 0; e < emitters; ++e) {
                const double value = anchors.emitterRadiance[e][c];
                if (!anchors.emitterClipped[e])
                    tie(Eigen::Index(leaves + e), value,
                        1e4 /
                            (value * value +
                             1e-8 * double(glm::dot(anchors.emitterRadiance[e], anchors.emitterRadiance[e])) + 1e-30));
            }
            if (!(q(w, w) > 0)) {  // nothing is seen directly: a typical metal
                q(w, w) = 1;
                moment(w) = 0.7;
            }
            const QpResult solution =
                solveBoundedQp(q, moment, Eigen::VectorXd::Zero(n + 1), round ? &x : nullptr, {&progress});
            fit.kktResidual = std::max(fit.kktResidual, solution.kktResidual);
            if (!solution.usable) {
                residual = std::numeric_limits<double>::infinity();
                break;
            }
            x = solution.x;
            residual = 0;
            for (size_t i = 0; i < rows.rows; ++i) {
                const double y = Eigen::Map<const Eigen::VectorXf>(rows.row(i), n).cast<double>().dot(x.head(n));
                const double r = (y - observations[i].radiance[c]) / observations[i].sigma;
                robust[i] = float(1 / (1 + r * r / 9));
                residual += 9 * std::log1p(r * r / 9);
            }
        }
        fit.weight[c] = float(std::clamp(x(w), 1e-3, 4.0));
        fit.residual += residual / double(3 * std::max<size_t>(1, observations.size()));
        for (size_t i = 0; i < leaves; ++i) fit.lighting.leafRadiance[i][c] = float(x(Eigen::Index(i))) / fit.weight[c];
        for (size_t e = 0; e < emitters; ++e)
            fit.lighting.emitterRadiance[e][c] = anchors.emitterClipped[e]
                                                     ? float(x(Eigen::Index(leaves + e))) / fit.weight[c]
                                                     : anchors.emitterRadiance[e][c];
    }
    return fit;
}

}  // namespace relamp
