// One Gauss-Newton step of poses and displacement together.
#pragma once
#include <Eigen/Dense>
#include <Eigen/Sparse>

#include "solve/registration/displacement_graph.h"
#include "solve/registration/places.h"

namespace relamp {

using PoseVector = Eigen::Matrix<double, 6, 1>;  ///< turn, radians, and shift over the view's depth
using PoseMatrix = Eigen::Matrix<double, 6, 6>;

/// A pair in one view: the difference of its values without its mean over the views.
struct PairResidual {
    const PlaceObservation *from = nullptr, *to = nullptr;
    double value = 0, weight = 0;
};

/// Of all unknowns: six a view, then one a node.
class NormalEquations {
public:
    NormalEquations(size_t views, size_t nodes);

    /// Adds one pair; its mean over the views is eliminated.
    void add(const std::vector<PairResidual>& residuals, const DisplacementGraph::Share& from,
             const DisplacementGraph::Share& to);
    void add(const NormalEquations& other);
    void scale(double factor);
    /// Adds |x - value|^2 of one view in the metric `weight`.
    void addPosePrior(size_t view, const PoseMatrix& weight, const PoseVector& value);
    /// Adds weight (sum of factor x node - value)^2.
    void addNodePrior(const std::vector<std::pair<uint32_t, double>>& factors, double value, double weight);

    struct Step {
        Eigen::VectorXd poses, nodes;
        bool valid = false;
    };
    /// Nodes are eliminated by a sparse factorisation, then the poses solved densely. `shape`: false holds the nodes.
    Step solve(bool shape) const;

private:
    Eigen::MatrixXd posePose_, nodePose_;
    Eigen::VectorXd pose_, node_;
    std::vector<Eigen::Triplet<double>> nodeNode_;  ///< lower triangle
};

}  // namespace relamp
