#include "solve/light_prior.h"

namespace relamp {

LightPrior::LightPrior(const LightLeaves& leaves, const LightAnchors& anchors, const LightPriorOptions& options, const InfluenceMatrix* rows)
    : anchors_(anchors), options_(options), neighbours_(leaves.neighbourPairs()), share_(Eigen::Index(leaves.size())) {
    // Along the common edge: the rim of a lamp costs the same however finely it is divided.
    edge_.reserve(neighbours_.size());
    for (const auto& [i, j] : neighbours_) edge_.push_back(16.0 / double(1u << std::max(leaves[i].level, leaves[j].level)));
    for (size_t i = 0; i < leaves.size(); ++i) share_(Eigen::Index(i)) = double(leaves[i].solidAngle()) / (4 * piD);
    if (!rows) return;
    Eigen::VectorXd received = Eigen::VectorXd::Zero(share_.size());
    for (size_t r = 0; r < rows->rows; ++r) received += Eigen::Map<const Eigen::VectorXf>(rows->row(r), share_.size()).cast<double>();
    if (received.sum() > 0) share_ = received / received.sum();
}

double LightPrior::meanOf(const Eigen::VectorXd& x) const { return std::max({share_.dot(x.head(share_.size())), double(options_.darkness), 1e-30}); }

double LightPrior::smoothness(size_t pair) const {
    const auto [i, j] = neighbours_[pair];
    // A seen leaf must not pull its unseen neighbours to its own brightness: that would fix the scale by a prior.
    return double(options_.smoothness) * edge_[pair] * (1.02 - double(std::max(anchors_.leaves[i].coverage, anchors_.leaves[j].coverage)));
}

double LightPrior::background(size_t leaf, int channel, double unit) const {
    const LeafAnchor& a = anchors_.leaves[leaf];
    if (a.coverage <= 0.05f || a.clipped) return 0;
    const double spread = 0.02 + 0.7 * (1 - double(a.coverage)), value = a.radiance[channel];
    return options_.backgroundWeight / (spread * spread) / (value * value + 0.01 * unit * unit + 1e-300);
}

double LightPrior::emitter(size_t index, int channel, double data) const {
    const double value = anchors_.emitterRadiance[index][channel];
    const double sigma = std::max(double(anchors_.emitterSigma[index]) * value, 1e-4 * double(maxChannel(anchors_.emitterRadiance[index])));
    return 1 / (sigma * sigma) + options_.emitterWeight * data;
}

Eigen::VectorXd LightPrior::seenDirectly(const Eigen::VectorXd& x, int channel, const Eigen::MatrixXd& q) const {
    const Eigen::Index leaves = share_.size();
    Eigen::VectorXd weights = Eigen::VectorXd::Zero(q.rows());
    const double unit = meanOf(x);
    for (Eigen::Index i = 0; i < leaves; ++i) weights(i) = background(size_t(i), channel, unit);
    for (size_t e = 0; e < anchors_.emitterRadiance.size(); ++e) {
        const Eigen::Index i = leaves + Eigen::Index(e);
        if (!anchors_.emitterClipped[e]) weights(i) = emitter(e, channel, q(i, i));
    }
    return weights;
}

double LightPrior::value(const Eigen::VectorXd& x, int channel) const {
    const double unit = meanOf(x);
    double sum = 0;
    for (size_t k = 0; k < neighbours_.size(); ++k) {
        const auto [i, j] = neighbours_[k];
        const double middle = 0.5 * (x(i) + x(j)), difference = x(i) - x(j);
        sum += smoothness(k) * difference * difference / (unit * unit + middle * middle + 1e-300);
    }
    for (Eigen::Index i = 0; i < share_.size(); ++i) sum += background(size_t(i), channel, unit) * std::pow(x(i) - double(anchors_.leaves[size_t(i)].radiance[channel]), 2);
    return sum;
}

void LightPrior::add(const Eigen::VectorXd& x, int channel, Eigen::MatrixXd& q, Eigen::VectorXd& moment, Eigen::VectorXd& lower) const {
    const Eigen::Index leaves = share_.size();
    const double unit = meanOf(x);
    Eigen::VectorXd along = Eigen::VectorXd::Zero(leaves);
    double square = 0, pull = 0;
    const bool unitIsFree = share_.dot(x.head(leaves)) >= unit;  // at the floor the unit is a constant
    for (size_t k = 0; k < neighbours_.size(); ++k) {
        const auto [i, j] = neighbours_[k];
        const double middle = 0.5 * (x(i) + x(j)), d2 = unit * unit + middle * middle + 1e-300, d = std::sqrt(d2), r = (x(i) - x(j)) / d;
        const double w = smoothness(k);
        const double ai = 1 / d - r * middle / (2 * d2), aj = -1 / d - r * middle / (2 * d2), beta = unitIsFree ? r * unit / d2 : 0.0;
        q(i, i) += w * ai * ai;
        q(j, j) += w * aj * aj;
        q(i, j) += w * ai * aj;
        q(j, i) += w * ai * aj;
        along(i) += w * beta * ai;
        along(j) += w * beta * aj;
        square += w * beta * beta;
        moment(i) -= w * r * ai;
        moment(j) -= w * r * aj;
        pull += w * r * beta;
    }
    moment.head(leaves) += pull * share_;
    q.topLeftCorner(leaves, leaves) += square * share_ * share_.transpose() - along * share_.transpose() - share_ * along.transpose();
    for (Eigen::Index i = 0; i < leaves; ++i) {
        const double w = background(size_t(i), channel, unit);
        q(i, i) += w;
        moment(i) += w * double(anchors_.leaves[size_t(i)].radiance[channel]);
    }
    for (size_t e = 0; e < anchors_.emitterRadiance.size(); ++e) {
        const Eigen::Index i = leaves + Eigen::Index(e);
        const double value = anchors_.emitterRadiance[e][channel];
        if (anchors_.emitterClipped[e]) {
            lower(i) = value;
            continue;
        }
        const double w = emitter(e, channel, q(i, i));
        q(i, i) += w;
        moment(i) += w * value;
    }
}

}  // namespace relamp
