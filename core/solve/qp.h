// The bounded quadratic program of equation (5): min x'Qx - 2 c'x subject to x >= lower.
#pragma once
#include <Eigen/Core>
#include <string>

namespace relamp {

struct QpResult {
    Eigen::VectorXd x;
    double kktResidual = 0;  ///< largest violation of the optimality conditions over the largest term they are made of, column-scaled
    int iterations = 0;
    bool converged = false;
    bool usable = true;      ///< false: the input was not finite, x is only the bound
    std::string reason;      ///< why not, when it did not
};

/// Block principal pivoting (Portugal, Judice, Vicente 1994; Kim and Park 2011) on the column-scaled problem with a Cholesky
/// factor in double; falls back to single exchanges (Murty) when blocks cycle and to
/// projected coordinate descent when those do not settle. Q symmetric positive semi-definite; a relative
/// ridge of 1e-12 makes it definite, so duplicated columns are fine. Cost a few n^3 / 3. Never throws for bad numbers: reports them.
/// `guess`, if not null, names the likely free variables (those above their bound) and saves pivots.
QpResult solveBoundedQp(const Eigen::MatrixXd& q, const Eigen::VectorXd& c, const Eigen::VectorXd& lower, const Eigen::VectorXd* guess = nullptr);

}  // namespace relamp
