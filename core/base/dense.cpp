#include "base/dense.h"

#include <Eigen/Eigenvalues>

namespace relamp {

Eigen::MatrixXd product(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) { return a * b; }

Eigen::MatrixXd transposedProduct(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) { return a.transpose() * b; }

std::optional<Eigen::MatrixXd> choleskyFactor(const Eigen::MatrixXd& a) {
    const Eigen::LLT<Eigen::MatrixXd> factor(a);
    if (factor.info() != Eigen::Success) return std::nullopt;
    return factor.matrixLLT();
}

Eigen::VectorXd solveByFactor(const Eigen::MatrixXd& l, Eigen::VectorXd b) {
    l.triangularView<Eigen::Lower>().solveInPlace(b);
    l.adjoint().triangularView<Eigen::Upper>().solveInPlace(b);
    return b;
}

Eigen::MatrixXd divideByFactor(const Eigen::MatrixXd& l, Eigen::MatrixXd b) {
    l.triangularView<Eigen::Lower>().solveInPlace(b);
    return b;
}

Eigen::VectorXd solveSymmetric(const Eigen::MatrixXd& a, const Eigen::VectorXd& b) { return a.ldlt().solve(b); }

SymmetricEigen eigenOf(const Eigen::MatrixXd& symmetric, bool withVectors) {
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(
        symmetric, withVectors ? Eigen::ComputeEigenvectors : Eigen::EigenvaluesOnly);
    SymmetricEigen result{eigen.eigenvalues(), {}};
    if (withVectors) result.vectors = eigen.eigenvectors();
    return result;
}

}  // namespace relamp
