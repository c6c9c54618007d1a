// Products and factorisations of dense matrices: slow to compile, so they stand in one unit, behind functions.
#pragma once
#include <Eigen/Core>
#include <optional>

namespace relamp {

/// a b.
Eigen::MatrixXd product(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b);
/// a' b.
Eigen::MatrixXd transposedProduct(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b);

/// L of a = L L', in the lower triangle; what stands above it means nothing. Reads the lower triangle of `a` (n x n).
/// Nothing when `a` is not positive definite. Cost n^3 / 3.
std::optional<Eigen::MatrixXd> choleskyFactor(const Eigen::MatrixXd& a);
/// x of L L' x = b.
Eigen::VectorXd solveByFactor(const Eigen::MatrixXd& l, Eigen::VectorXd b);
/// L^-1 b, column by column.
Eigen::MatrixXd divideByFactor(const Eigen::MatrixXd& l, Eigen::MatrixXd b);

/// x of a x = b by a pivoted L D L'; `a` symmetric (n x n), reads its lower triangle. Cost n^3 / 3.
Eigen::VectorXd solveSymmetric(const Eigen::MatrixXd& a, const Eigen::VectorXd& b);

struct SymmetricEigen {
    Eigen::VectorXd values;   ///< ascending
    Eigen::MatrixXd vectors;  ///< in columns; empty when they were not asked for
};
/// Reads the lower triangle. Cost about 4 n^3 / 3 for the values, 9 n^3 with the vectors.
SymmetricEigen eigenOf(const Eigen::MatrixXd& symmetric, bool withVectors);

}  // namespace relamp
