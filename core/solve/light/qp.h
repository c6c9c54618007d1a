// The bounded quadratic program of equation (5): min x'Qx - 2 c'x subject to x >= lower.
#pragma once
#include <Eigen/Core>
#include <functional>
#include <string>

#include "base/progress.h"

namespace relamp {

struct QpResult {
    Eigen::VectorXd x;
    double kktResidual =
        0;  ///< largest violation of the optimality conditions over the largest term they are made of, column-scaled
    int iterations = 0;  ///< factors computed
    bool converged = false;
    bool usable = true;  ///< false: the input was not finite, x is only the bound
    std::string reason;  ///< why not, when it did not
};

/// Who looks on while a program is solved; what is seen changes nothing in the answer.
struct QpWatch {
    Progress* progress = nullptr;  ///< asked at least every 50 ms or so whether to stop: then Cancelled is thrown
    std::function<void(const Eigen::VectorXd&)> each =
        {};  ///< hears points that keep the bounds, on the way to the answer, mostly better and better
};

/// Projected conjugate gradients (Dostal and Schoeberl 2005) find which variables are free, block principal pivoting
/// (Portugal, Judice, Vicente 1994; Kim and Park 2011) ends exactly, on the column-scaled problem: large ones with a
/// Cholesky factor in single precision that preconditions conjugate gradients in double, small and stiff ones with a
/// factor in double; falls back to single exchanges (Murty) when blocks cycle and to projected coordinate descent when
/// those do not settle. Q symmetric positive semi-definite; a relative ridge of 1e-12 makes it definite, so duplicated
/// columns are fine. Cost some tens of products with Q and a few factors of its free part, m^3 / 3 each. Never throws
/// for bad numbers: reports them. The same bits on any number of threads. `guess`, if not null, is a point near the
/// answer, or at least one that is free in the right places: it saves steps.
QpResult solveBoundedQp(const Eigen::MatrixXd& q, const Eigen::VectorXd& c, const Eigen::VectorXd& lower,
                        const Eigen::VectorXd* guess = nullptr, const QpWatch& watch = {});

}  // namespace relamp
