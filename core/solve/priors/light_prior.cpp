#include "solve/priors/light_prior.h"

namespace relamp {

LightPrior::LightPrior(const LightLeaves& leaves, const LightAnchors& anchors, const LightPriorOptions& options,
                       std::optional<InfluenceRows> rows)
    : anchors_(anchors),
      options_(options),
      neighbours_(leaves.neighbourPairs()),
      fraction_(leaves.environments(), Eigen::VectorXd::Zero(Eigen::Index(leaves.size()))) {
    // Along the common edge: the rim of an emitter costs the same however finely it is divided.
    edge_.reserve(neighbours_.size());
    for (const auto& [i, j] : neighbours_)
        edge_.push_back(16.0 / double(1u << std::max(leaves[i].level, leaves[j].level)));
    for (size_t i = 0; i < leaves.size(); ++i) {
        environment_.push_back(leaves[i].environment);
        fraction_[environment_[i]](Eigen::Index(i)) = double(leaves[i].solidAngle()) / (4 * piD);
    }
    for (const ProbeAnchor& p : anchors.probes) {
        const auto held = std::find_if(p.held.begin(), p.held.end(), [](float fraction) { return fraction > 0; });
        probes_.emplace_back(p, fraction_[held == p.held.end() ? 0 : environment_[size_t(held - p.held.begin())]]);
    }
    if (!rows) return;
    Eigen::VectorXd received = Eigen::VectorXd::Zero(this->leaves());
    for (size_t r = 0; r < rows->rows; ++r)
        received += Eigen::Map<const Eigen::VectorXf>(rows->row(r), received.size()).cast<double>();
    for (size_t e = 0; e < fraction_.size(); ++e) {
        Eigen::VectorXd own = received;
        for (Eigen::Index i = 0; i < own.size(); ++i)
            if (environment_[size_t(i)] != e) own(i) = 0;
        if (own.sum() > 0) fraction_[e] = own / own.sum();
    }
}

std::vector<double> LightPrior::meansOf(const Eigen::VectorXd& x) const {
    std::vector<double> means;
    for (const Eigen::VectorXd& fraction : fraction_)
        means.push_back(std::max({fraction.dot(x.head(leaves())), double(options_.darkness), 1e-30}));
    return means;
}

std::vector<uint8_t> LightPrior::areFree(const Eigen::VectorXd& x, const std::vector<double>& units) const {
    std::vector<uint8_t> free;
    for (size_t e = 0; e < units.size(); ++e) free.push_back(fraction_[e].dot(x.head(leaves())) >= units[e]);
    return free;
}

double LightPrior::smoothness(size_t pair) const {
    const auto [i, j] = neighbours_[pair];
    // A seen leaf must not pull its unobserved neighbours to its own brightness: that would fix the scale by a prior.
    return double(options_.smoothness) * edge_[pair] *
           (1.02 - double(std::max(anchors_.leaves[i].coverage, anchors_.leaves[j].coverage)));
}

double LightPrior::background(size_t leaf, int channel, double unit) const {
    const LeafAnchor& a = anchors_.leaves[leaf];
    if (!a.seen() || a.clipped) return 0;
    const double spread = 0.02 + 0.7 * (1 - double(a.coverage)), value = a.radiance[channel];
    return options_.backgroundWeight / (spread * spread) / (value * value + 0.01 * unit * unit + 1e-300);
}

double LightPrior::emitter(size_t index, int channel, double data) const {
    const double value = anchors_.emitterRadiance[index][channel];
    const double sigma = std::max(double(anchors_.emitterSigma[index]) * value,
                                  1e-4 * double(maxChannel(anchors_.emitterRadiance[index])));
    return 1 / (sigma * sigma) + options_.emitterWeight * data;
}

Eigen::VectorXd LightPrior::seenDirectly(const Eigen::VectorXd& x, int channel, const Eigen::MatrixXd& q) const {
    Eigen::VectorXd weights = Eigen::VectorXd::Zero(q.rows());
    const std::vector<double> units = meansOf(x);
    for (Eigen::Index i = 0; i < leaves(); ++i)
        weights(i) = background(size_t(i), channel, units[environment_[size_t(i)]]);
    for (size_t e = 0; e < anchors_.emitterRadiance.size(); ++e) {
        const Eigen::Index i = leaves() + Eigen::Index(e);
        if (!anchors_.emitterClipped[e]) weights(i) = emitter(e, channel, q(i, i));
    }
    return weights;
}

Eigen::MatrixXd LightPrior::fromProbes(const Eigen::VectorXd& x, int channel) const {
    Eigen::MatrixXd q = Eigen::MatrixXd::Zero(x.size(), x.size());
    Eigen::VectorXd moment = Eigen::VectorXd::Zero(x.size());
    for (const ProbeRows& p : probes_) p.add(x, channel, q, moment);
    return q;
}

LightPrior::Difference LightPrior::difference(const Eigen::VectorXd& x, size_t pair, double unit, bool free) const {
    const auto [i, j] = neighbours_[pair];
    const double middle = 0.5 * (x(i) + x(j)), d2 = unit * unit + middle * middle + 1e-300, d = std::sqrt(d2),
                 r = (x(i) - x(j)) / d;
    Difference result{
        r, {1 / d - r * middle / (2 * d2), -1 / d - r * middle / (2 * d2)}, free ? r * unit / d2 : 0.0, 0};
    // Along the whole light nothing changes.
    if (!free) result.atPresent = result.along[0] * x(i) + result.along[1] * x(j);
    return result;
}

double LightPrior::value(const Eigen::VectorXd& x, int channel) const {
    const std::vector<double> units = meansOf(x);
    double sum = 0;
    for (size_t k = 0; k < neighbours_.size(); ++k)
        sum += smoothness(k) * std::pow(difference(x, k, units[environmentOf(k)], true).value, 2);
    for (Eigen::Index i = 0; i < leaves(); ++i)
        sum += background(size_t(i), channel, units[environment_[size_t(i)]]) *
               std::pow(x(i) - double(anchors_.leaves[size_t(i)].radiance[channel]), 2);
    for (const ProbeRows& p : probes_) sum += p.value(x, channel);
    return sum;
}

std::vector<LightPrior::HueCoupling> LightPrior::hueCouplings(const std::array<std::vector<double>, 3>& units) const {
    std::vector<HueCoupling> couplings(fraction_.size());
    for (size_t e = 0; e < couplings.size(); ++e) {
        HueCoupling& m = couplings[e] = {};
        const double least = 0.01 * std::max({units[0][e], units[1][e], units[2][e]});
        for (size_t c = 0; c < 3; ++c)
            for (size_t d = 0; d < c; ++d) {
                if (units[c][e] < least || units[d][e] < least) continue;
                m[c][c] += 1;
                m[d][d] += 1;
                m[c][d] = m[d][c] = -1;
            }
    }
    return couplings;
}

double LightPrior::hueValue(const Eigen::VectorXd* x) const {
    const std::array<std::vector<double>, 3> units{meansOf(x[0]), meansOf(x[1]), meansOf(x[2])};
    const std::vector<HueCoupling> couplings = hueCouplings(units);
    double sum = 0;
    for (size_t k = 0; k < neighbours_.size(); ++k) {
        const HueCoupling& m = couplings[environmentOf(k)];
        double r[3];
        for (size_t c = 0; c < 3; ++c) r[c] = difference(x[c], k, units[c][environmentOf(k)], true).value;
        for (size_t c = 0; c < 3; ++c)
            for (size_t d = 0; d < 3; ++d) sum += double(options_.hue) * smoothness(k) * m[c][d] * r[c] * r[d];
    }
    return sum;
}

void LightPrior::addHue(const Eigen::VectorXd* x, Eigen::MatrixXd& q, Eigen::VectorXd& moment) const {
    const Eigen::Index n = x[0].size();
    const std::array<std::vector<double>, 3> units{meansOf(x[0]), meansOf(x[1]), meansOf(x[2])};
    const std::vector<HueCoupling> couplings = hueCouplings(units);
    std::array<std::vector<uint8_t>, 3> free;
    for (size_t c = 0; c < 3; ++c) free[c] = areFree(x[c], units[c]);
    for (size_t e = 0; e < fraction_.size(); ++e) {
        Eigen::VectorXd along[3][3];
        double square[3][3] = {}, pull[3] = {};
        for (auto& row : along)
            for (Eigen::VectorXd& v : row) v = Eigen::VectorXd::Zero(leaves());
        for (size_t k = 0; k < neighbours_.size(); ++k) {
            if (environmentOf(k) != e) continue;
            const Eigen::Index at[2] = {Eigen::Index(neighbours_[k].first), Eigen::Index(neighbours_[k].second)};
            Difference r[3];
            for (size_t c = 0; c < 3; ++c) r[c] = difference(x[c], k, units[c][e], free[c][e]);
            for (size_t c = 0; c < 3; ++c)
                for (size_t d = 0; d < 3; ++d) {
                    const double w = double(options_.hue) * smoothness(k) * couplings[e][c][d],
                                 residual = w * (r[d].value - r[d].atPresent);
                    if (w == 0) continue;
                    for (int a = 0; a < 2; ++a) {
                        for (int b = 0; b < 2; ++b)
                            q(Eigen::Index(c) * n + at[a], Eigen::Index(d) * n + at[b]) +=
                                w * r[c].along[a] * r[d].along[b];
                        along[c][d](at[a]) += w * r[d].beta * r[c].along[a];
                        moment(Eigen::Index(c) * n + at[a]) -= residual * r[c].along[a];
                    }
                    square[c][d] += w * r[c].beta * r[d].beta;
                    pull[c] += residual * r[c].beta;
                }
        }
        const Eigen::VectorXd& fraction = fraction_[e];
        for (Eigen::Index c = 0; c < 3; ++c) {
            moment.segment(c * n, leaves()) += pull[c] * fraction;
            for (Eigen::Index d = 0; d < 3; ++d)
                q.block(c * n, d * n, leaves(), leaves()) += square[c][d] * fraction * fraction.transpose() -
                                                             along[c][d] * fraction.transpose() -
                                                             fraction * along[d][c].transpose();
        }
    }
}

Eigen::VectorXd LightPrior::lowest(int channel) const {
    Eigen::VectorXd lower = Eigen::VectorXd::Zero(leaves() + Eigen::Index(anchors_.emitterRadiance.size()));
    for (size_t i = 0; i < size_t(leaves()); ++i)
        lower(Eigen::Index(i)) = double(anchors_.leaves[i].coverage * anchors_.leaves[i].radiance[channel]);
    for (size_t e = 0; e < anchors_.emitterRadiance.size(); ++e)
        if (anchors_.emitterClipped[e])
            lower(leaves() + Eigen::Index(e)) = double(anchors_.emitterRadiance[e][channel]);
    return lower;
}

void LightPrior::add(const Eigen::VectorXd& x, int channel, Eigen::MatrixXd& q, Eigen::VectorXd& moment,
                     Eigen::VectorXd& lower) const {
    const std::vector<double> units = meansOf(x);
    const std::vector<uint8_t> free = areFree(x, units);
    for (size_t e = 0; e < fraction_.size(); ++e) {
        Eigen::VectorXd along = Eigen::VectorXd::Zero(leaves());
        double square = 0, pull = 0;
        for (size_t k = 0; k < neighbours_.size(); ++k) {
            if (environmentOf(k) != e) continue;
            const Eigen::Index at[2] = {Eigen::Index(neighbours_[k].first), Eigen::Index(neighbours_[k].second)};
            const Difference r = difference(x, k, units[e], free[e]);
            const double w = smoothness(k), residual = w * (r.value - r.atPresent);
            for (int a = 0; a < 2; ++a) {
                for (int b = 0; b < 2; ++b) q(at[a], at[b]) += w * r.along[a] * r.along[b];
                along(at[a]) += w * r.beta * r.along[a];
                moment(at[a]) -= residual * r.along[a];
            }
            square += w * r.beta * r.beta;
            pull += residual * r.beta;
        }
        const Eigen::VectorXd& fraction = fraction_[e];
        moment.head(leaves()) += pull * fraction;
        q.topLeftCorner(leaves(), leaves()) +=
            square * fraction * fraction.transpose() - along * fraction.transpose() - fraction * along.transpose();
    }
    for (Eigen::Index i = 0; i < leaves(); ++i) {
        const double w = background(size_t(i), channel, units[environment_[size_t(i)]]);
        q(i, i) += w;
        moment(i) += w * double(anchors_.leaves[size_t(i)].radiance[channel]);
    }
    for (const ProbeRows& p : probes_) p.add(x, channel, q, moment);
    // There may be more unknowns than the priors know of.
    const Eigen::VectorXd least = lowest(channel);
    lower.head(least.size()) = lower.head(least.size()).cwiseMax(least);
    for (size_t e = 0; e < anchors_.emitterRadiance.size(); ++e) {
        const Eigen::Index i = leaves() + Eigen::Index(e);
        const double value = anchors_.emitterRadiance[e][channel];
        if (anchors_.emitterClipped[e]) continue;
        const double w = emitter(e, channel, q(i, i));
        q(i, i) += w;
        moment(i) += w * value;
    }
}

}  // namespace relamp
