#include "solve/probe/probe_rows.h"

#include "solve/ratio/ratio_residual.h"

namespace relamp {
namespace {

using Eigen::Index;
constexpr CauchyLoss bend{2.5};
constexpr int rounds = 6;  // of reweighting, for the gain

}  // namespace

ProbeRows::ProbeRows(const ProbeAnchor& anchor, const Eigen::VectorXd& fraction)
    : anchor_(anchor), fraction_(fraction) {}

double ProbeRows::unit(int channel) const {
    double sum = 0;
    for (Index i = 0; i < fraction_.size(); ++i)
        sum += fraction_(i) * double(anchor_.held[size_t(i)] * anchor_.radiance[size_t(i)][channel]);
    return sum;
}

double ProbeRows::precision(Index leaf, int channel, double unit) const {
    const double held = anchor_.held[size_t(leaf)], value = anchor_.radiance[size_t(leaf)][channel];
    if (held < 0.5) return 0;
    return held / (double(anchor_.noise) * anchor_.noise * (value * value + 0.01 * unit * unit + 1e-300));
}

double ProbeRows::gain(const Eigen::VectorXd& x, int channel) const {
    const double u = unit(channel),
                 known = anchor_.gainSigma > 0 ? 1 / (double(anchor_.gainSigma) * anchor_.gainSigma) : 0;
    double g = 1;
    if (known == 0) {
        double light = 0, probed = 0;
        for (Index i = 0; i < fraction_.size(); ++i) {
            light += fraction_(i) * double(anchor_.held[size_t(i)]) * x(i);
            probed += fraction_(i) * double(anchor_.held[size_t(i)] * anchor_.radiance[size_t(i)][channel]);
        }
        g = probed > 0 ? light / probed : 1;
    }
    for (int round = 0; round < rounds; ++round) {
        double above = known, below = known;
        for (Index i = 0; i < fraction_.size(); ++i) {
            const double value = anchor_.radiance[size_t(i)][channel], r = x(i) - g * value;
            double w = precision(i, channel, u);
            w *= bend.weight(w * r * r);
            above += w * value * x(i);
            below += w * value * value;
        }
        if (below > 0) g = std::max(0.0, above / below);
    }
    return g;
}

double ProbeRows::value(const Eigen::VectorXd& x, int channel) const {
    const double u = unit(channel), g = gain(x, channel);
    double sum = anchor_.gainSigma > 0 ? std::pow((g - 1) / double(anchor_.gainSigma), 2) : 0;
    for (Index i = 0; i < fraction_.size(); ++i) {
        const double r = x(i) - g * double(anchor_.radiance[size_t(i)][channel]);
        sum += bend.loss(precision(i, channel, u) * r * r);
    }
    return weight * sum;
}

void ProbeRows::add(const Eigen::VectorXd& x, int channel, Eigen::MatrixXd& q, Eigen::VectorXd& moment) const {
    const double u = unit(channel), g = gain(x, channel),
                 known = anchor_.gainSigma > 0 ? 1 / (double(anchor_.gainSigma) * anchor_.gainSigma) : 0;
    const Index leaves = fraction_.size();
    Eigen::VectorXd pull(leaves);  // w probe
    double all = known;
    for (Index i = 0; i < leaves; ++i) {
        const double value = anchor_.radiance[size_t(i)][channel], r = x(i) - g * value;
        double w = precision(i, channel, u);
        w *= bend.weight(w * r * r);
        q(i, i) += weight * w;
        pull(i) = w * value;
        all += w * value * value;
    }
    if (!(all > 0)) return;
    // The minimum over g of the sum of w (x - g probe)^2 and known (g - 1)^2.
    q.topLeftCorner(leaves, leaves) -= weight / all * pull * pull.transpose();
    moment.head(leaves) += weight * known / all * pull;
}

}  // namespace relamp
