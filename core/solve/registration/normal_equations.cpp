#include "solve/registration/normal_equations.h"

#include <Eigen/SparseCholesky>
#include <algorithm>

#include "base/dense.h"

namespace relamp {
namespace {

using NodeRow = Eigen::Matrix<double, 8, 1>;  ///< of the nodes of either place; unused entries are 0

/// The nodes of two places without repetition, and where those of either stand among them.
struct PairNodes {
    std::array<uint32_t, 8> node{};
    std::array<Eigen::Index, 8> at{};
    Eigen::Index count = 0;

    PairNodes(const DisplacementGraph::Share& from, const DisplacementGraph::Share& to) {
        for (size_t k = 0; k < 8; ++k) {
            const uint32_t n = k < 4 ? from.node[k] : to.node[k - 4];
            at[k] = std::find(node.begin(), node.begin() + count, n) - node.begin();
            if (at[k] == count) node[size_t(count++)] = n;
        }
    }
};

}  // namespace

NormalEquations::NormalEquations(size_t views, size_t nodes) {
    const Eigen::Index poses = Eigen::Index(6 * views);
    posePose_.setZero(poses, poses);
    nodePose_.setZero(Eigen::Index(nodes), poses);
    pose_.setZero(poses);
    node_.setZero(Eigen::Index(nodes));
}

void NormalEquations::add(const std::vector<PairResidual>& residuals, const DisplacementGraph::Share& from,
                          const DisplacementGraph::Share& to) {
    const size_t views = residuals.size();
    const PairNodes near(from, to);
    std::vector<PoseVector> poseRow(views);
    std::vector<NodeRow> nodeRow(views, NodeRow::Zero());
    NodeRow nodeMean = NodeRow::Zero();
    double weights = 0;
    for (size_t i = 0; i < views; ++i) {
        const PairResidual& r = residuals[i];
        for (size_t k = 0; k < 6; ++k) poseRow[i](Eigen::Index(k)) = r.from->byPose[k] - r.to->byPose[k];
        for (size_t n = 0; n < 4; ++n) {
            nodeRow[i](near.at[n]) += r.from->byShape * double(from.weight[n]);
            nodeRow[i](near.at[4 + n]) -= r.to->byShape * double(to.weight[n]);
        }
        nodeMean += r.weight * nodeRow[i];
        weights += r.weight;
    }
    Eigen::Matrix<double, 8, 8> nodes = -nodeMean * nodeMean.transpose() / weights;
    NodeRow nodeGradient = NodeRow::Zero();
    for (size_t i = 0; i < views; ++i) {
        const double w = residuals[i].weight;
        const Eigen::Index a = Eigen::Index(6 * residuals[i].from->view);
        nodes += w * nodeRow[i] * nodeRow[i].transpose();
        nodeGradient -= w * residuals[i].value * nodeRow[i];
        pose_.segment<6>(a) -= w * residuals[i].value * poseRow[i];
        posePose_.block<6, 6>(a, a) += w * poseRow[i] * poseRow[i].transpose();
        for (size_t j = 0; j < views; ++j)
            posePose_.block<6, 6>(a, Eigen::Index(6 * residuals[j].from->view)) -=
                w * residuals[j].weight / weights * poseRow[i] * poseRow[j].transpose();
        const Eigen::Matrix<double, 8, 6> mixed = w * (nodeRow[i] - nodeMean / weights) * poseRow[i].transpose();
        for (Eigen::Index n = 0; n < near.count; ++n)
            nodePose_.block<1, 6>(Eigen::Index(near.node[size_t(n)]), a) += mixed.row(n);
    }
    for (Eigen::Index n = 0; n < near.count; ++n) {
        const uint32_t row = near.node[size_t(n)];
        node_(Eigen::Index(row)) += nodeGradient(n);
        for (Eigen::Index m = 0; m < near.count; ++m)
            if (const uint32_t column = near.node[size_t(m)]; column <= row)
                nodeNode_.emplace_back(int(row), int(column), nodes(n, m));
    }
}

void NormalEquations::add(const NormalEquations& other) {
    posePose_ += other.posePose_;
    nodePose_ += other.nodePose_;
    pose_ += other.pose_;
    node_ += other.node_;
    nodeNode_.insert(nodeNode_.end(), other.nodeNode_.begin(), other.nodeNode_.end());
}

void NormalEquations::scale(double factor) {
    posePose_ *= factor;
    nodePose_ *= factor;
    pose_ *= factor;
    node_ *= factor;
    for (Eigen::Triplet<double>& t : nodeNode_) t = {t.row(), t.col(), t.value() * factor};
}

void NormalEquations::addPosePrior(size_t view, const PoseMatrix& weight, const PoseVector& value) {
    const Eigen::Index a = Eigen::Index(6 * view);
    posePose_.block<6, 6>(a, a) += weight;
    pose_.segment<6>(a) += weight * value;
}

void NormalEquations::addNodePrior(const std::vector<std::pair<uint32_t, double>>& factors, double value,
                                   double weight) {
    for (const auto& [a, x] : factors) {
        node_(Eigen::Index(a)) += weight * x * value;
        for (const auto& [b, y] : factors)
            if (b <= a) nodeNode_.emplace_back(int(a), int(b), weight * x * y);
    }
}

NormalEquations::Step NormalEquations::solve(bool shape) const {
    Step step;
    step.nodes.setZero(node_.size());
    if (shape) {
        Eigen::SparseMatrix<double> matrix(node_.size(), node_.size());
        matrix.setFromTriplets(nodeNode_.begin(), nodeNode_.end());
        const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor(matrix);
        if (factor.info() != Eigen::Success) return step;
        const Eigen::VectorXd alone = factor.solve(node_);
        if (pose_.size() == 0) {
            step.nodes = alone;
            step.valid = alone.allFinite();
            return step;
        }
        const Eigen::MatrixXd solved = factor.solve(nodePose_);
        step.poses =
            solveSymmetric(posePose_ - transposedProduct(nodePose_, solved), pose_ - nodePose_.transpose() * alone);
        step.nodes = alone - solved * step.poses;
    } else {
        step.poses = solveSymmetric(posePose_, pose_);
    }
    step.valid = step.poses.allFinite() && step.nodes.allFinite();
    return step;
}

}  // namespace relamp
