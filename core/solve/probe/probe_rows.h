// The rows of a light probe: leaf_i = g probe_i, each with its noise. The gain g of a channel is an unknown of the fit
// like the light, with what background tells of it as its prior; it is eliminated in closed form.
#pragma once
#include <Eigen/Core>

#include "solve/priors/anchors.h"

namespace relamp {

class ProbeRows {
public:
    /// Observations that a row counts for. What pairs have in common, errors of mesh and model, is not independent: a
    /// row must outweigh thousands of them where its noise is small (tests/bench/README.md).
    static constexpr double weight = 160;

    /// `fraction`: of each leaf in the mean brightness; together 1. Both must outlive this.
    ProbeRows(const ProbeAnchor& anchor, const Eigen::VectorXd& fraction);
    /// Robust (Cauchy, 2.5 deviations) and with the gain that suits x best.
    double value(const Eigen::VectorXd& x, int channel) const;
    /// Adds the quadratic model about x: minimise x'qx - 2 moment'x.
    void add(const Eigen::VectorXd& x, int channel, Eigen::MatrixXd& q, Eigen::VectorXd& moment) const;
    /// g of the light x.
    double gain(const Eigen::VectorXd& x, int channel) const;

private:
    const ProbeAnchor& anchor_;
    const Eigen::VectorXd& fraction_;
    double precision(Eigen::Index leaf, int channel, double unit) const;  ///< of a row before it is bent
    double unit(int channel) const;
};

}  // namespace relamp
