#include "solve/qp.h"

#include <Eigen/Cholesky>
#include <vector>

namespace relamp {
namespace {

/// min x'Ax - 2 b'x over x >= 0, A scaled to unit diagonal.
struct Pivoting {
    const Eigen::MatrixXd& a;
    const Eigen::VectorXd& b;
    std::vector<char> free_;
    Eigen::VectorXd x, gradient;

    bool solveOnFree() {
        const Eigen::Index n = a.rows();
        std::vector<Eigen::Index> index;
        for (Eigen::Index i = 0; i < n; ++i)
            if (free_[size_t(i)]) index.push_back(i);
        const Eigen::Index m = Eigen::Index(index.size());
        x.setZero();
        if (m > 0) {
            Eigen::MatrixXd sub(m, m);
            Eigen::VectorXd rhs(m);
            for (Eigen::Index j = 0; j < m; ++j) {
                for (Eigen::Index i = 0; i < m; ++i) sub(i, j) = a(index[size_t(i)], index[size_t(j)]);
                rhs(j) = b(index[size_t(j)]);
            }
            Eigen::LLT<Eigen::MatrixXd> factor(sub);
            if (factor.info() != Eigen::Success) return false;
            Eigen::VectorXd y = factor.solve(rhs);
            y += factor.solve(rhs - sub * y);  // one step of refinement
            if (!y.allFinite()) return false;
            for (Eigen::Index j = 0; j < m; ++j) x(index[size_t(j)]) = y(j);
        }
        gradient.noalias() = a * x - b;
        return true;
    }
};

}  // namespace

QpResult solveBoundedQp(const Eigen::MatrixXd& q, const Eigen::VectorXd& c, const Eigen::VectorXd& lower, const Eigen::VectorXd* guess) {
    const Eigen::Index n = q.rows();
    QpResult result;
    result.x = lower;
    if (n == 0) {
        result.converged = true;
        return result;
    }
    if (!q.allFinite() || !c.allFinite() || !lower.allFinite()) {
        result.usable = false;
        result.reason = "the normal equations hold numbers that are not finite";
        return result;
    }
    // x = lower + scale * z, z >= 0, unit diagonal.
    Eigen::VectorXd scale(n);
    for (Eigen::Index i = 0; i < n; ++i) scale(i) = q(i, i) > 0 ? 1 / std::sqrt(q(i, i)) : 0;
    Eigen::MatrixXd a = scale.asDiagonal() * q * scale.asDiagonal();
    for (Eigen::Index i = 0; i < n; ++i) a(i, i) = 1 + 1e-12;
    const Eigen::VectorXd b = scale.asDiagonal() * (c - q * lower);
    const double tolerance = 1e-12 * std::max(b.cwiseAbs().maxCoeff(), 1e-300);

    Pivoting p{a, b, std::vector<char>(size_t(n), 0), Eigen::VectorXd::Zero(n), Eigen::VectorXd::Zero(n)};
    for (Eigen::Index i = 0; i < n; ++i) p.free_[size_t(i)] = scale(i) > 0 && (guess ? (*guess)(i) > lower(i) : b(i) > 0);
    Eigen::Index best = n + 1;
    int patience = 3;
    double ridge = 1e-12;
    for (result.iterations = 1; result.iterations <= 500; ++result.iterations) {
        if (!p.solveOnFree()) {
            // Not definite to working precision: strengthen the ridge and go on.
            a.diagonal().array() += ridge;
            ridge *= 10;
            if (ridge > 1) break;
            continue;
        }
        std::vector<Eigen::Index> wrong;
        for (Eigen::Index i = 0; i < n; ++i) {
            if (scale(i) == 0) continue;
            if (p.free_[size_t(i)] ? p.x(i) < -tolerance : p.gradient(i) < -tolerance) wrong.push_back(i);
        }
        if (wrong.empty()) {
            result.converged = true;
            break;
        }
        if (Eigen::Index(wrong.size()) < best) {
            best = Eigen::Index(wrong.size());
            patience = 3;
        } else if (--patience < 0) {
            wrong.assign(1, wrong.back());  // Murty's rule cannot cycle
        }
        for (Eigen::Index i : wrong) p.free_[size_t(i)] ^= 1;
    }
    if (!result.converged) result.reason = ridge > 1 ? "the normal equations are not positive definite" : "pivoting did not settle";
    p.x = p.x.cwiseMax(0.0);
    const auto kkt = [&] {
        p.gradient.noalias() = a * p.x - b;
        const double magnitude = std::max((a.cwiseAbs() * p.x + b.cwiseAbs()).maxCoeff(), 1e-300);
        double worst = 0;
        for (Eigen::Index i = 0; i < n; ++i)
            if (scale(i) > 0) worst = std::max(worst, (p.x(i) > 0 ? std::abs(p.gradient(i)) : std::max(0.0, -p.gradient(i))) / magnitude);
        return worst;
    };
    result.kktResidual = kkt();
    // Where pivoting fails, coordinate descent goes on from what it left: slower, but it cannot cycle.
    for (int sweep = 0; result.kktResidual > 1e-9 && sweep < 3000; ++sweep) {
        for (Eigen::Index i = 0; i < n; ++i) {
            if (!(scale(i) > 0)) continue;
            const double before = p.x(i), after = std::max(0.0, before - p.gradient(i) / a(i, i));
            if (after == before) continue;
            p.x(i) = after;
            p.gradient += (after - before) * a.col(i);
        }
        if (sweep % 50 == 49) result.kktResidual = kkt();
    }
    if (result.kktResidual < 1e-9) {
        result.converged = true;
        result.reason.clear();
    }
    result.x = lower + scale.asDiagonal() * p.x;
    return result;
}

}  // namespace relamp
