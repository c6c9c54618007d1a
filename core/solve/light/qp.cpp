#include "solve/light/qp.h"

#include <Eigen/Cholesky>
#include <vector>

#include "base/parallel.h"

namespace relamp {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// min z'Az - 2 b'z over z >= 0, where A is Q with its columns scaled to a unit diagonal: never formed as a whole.
struct Scaled {
    const MatrixXd& q;
    VectorXd scale;  ///< 0 where a column is empty: that variable stays at its bound
    VectorXd b;
    double ridge = 1e-12;
    const QpWatch& watch;

    void check() const {
        if (watch.progress) watch.progress->check();
    }
    /// A z. Blocks of columns, each summed on its own and then in order: the same bits on any number of threads.
    VectorXd times(const VectorXd& z) const {
        check();
        const VectorXd x = scale.cwiseProduct(z);
        VectorXd y(x.size());
        constexpr Index block = 256;
        // Q is symmetric: rows are columns, which lie together in memory.
        parallelBlocks(size_t(x.size()), size_t(block), [&](size_t begin, size_t end) {
            y.segment(Index(begin), Index(end - begin)).noalias() =
                q.middleCols(Index(begin), Index(end - begin)).transpose() * x;
        });
        return scale.cwiseProduct(y) + ridge * z;
    }
    double element(Index i, Index j) const { return i == j ? 1 + ridge : scale(i) * q(i, j) * scale(j); }
};

/// Lower Cholesky factor in place, by panels, so that it can be stopped and spread over threads. False when not
/// positive definite.
template <class Matrix>
bool factorInPlace(Matrix& a, const Scaled& problem) {
    constexpr Index panel = 128;
    const Index m = a.rows();
    for (Index k = 0; k < m; k += panel) {
        problem.check();
        const Index w = std::min(panel, m - k), below = m - k - w;
        auto corner = a.block(k, k, w, w);
        Eigen::LLT<Eigen::Ref<Matrix>> small(corner);
        if (small.info() != Eigen::Success) return false;
        if (below == 0) break;
        const auto rows = size_t((below + panel - 1) / panel);
        parallelFor(rows, 1, [&](size_t r) {
            const Index at = k + w + Index(r) * panel, height = std::min(panel, m - at);
            auto strip = a.block(at, k, height, w);
            a.block(k, k, w, w)
                .template triangularView<Eigen::Lower>()
                .transpose()
                .template solveInPlace<Eigen::OnTheRight>(strip);
        });
        parallelFor(rows, 1, [&](size_t r) {
            problem.check();
            const Index at = k + w + Index(r) * panel, width = std::min(panel, m - at);
            a.block(at, at, m - at, width).noalias() -=
                a.block(at, k, m - at, w) * a.block(at, k, width, w).transpose();
        });
    }
    return true;
}

template <class Matrix, class Vector>
Vector solveFactored(const Matrix& l, Vector y) {
    l.template triangularView<Eigen::Lower>().solveInPlace(y);
    l.template triangularView<Eigen::Lower>().transpose().solveInPlace(y);
    return y;
}

/// The free variables and the point they are solved for.
class Pivoting {
public:
    explicit Pivoting(const Scaled& scaled)
        : problem(scaled), free_(size_t(scaled.b.size()), 0), z(VectorXd::Zero(scaled.b.size())), gradient(z) {}
    const Scaled& problem;
    std::vector<char> free_;
    VectorXd z, gradient;

    bool solveOnFree() {
        index.clear();
        for (Index i = 0; i < z.size(); ++i)
            if (free_[size_t(i)]) index.push_back(i);
        z.setZero();
        gradient = -problem.b;
        if (index.empty()) return true;
        constexpr Index large = 512;  // from here a factor costs much more than some products
        return (Index(index.size()) >= large && solveWithRoughFactor()) || solveWithFactor();
    }

private:
    std::vector<Index> index;  ///< free variables

    template <class Matrix>
    bool factorOfFree(Matrix& factor, double ridge) const {
        using Scalar = typename Matrix::Scalar;
        const Index m = Index(index.size());
        factor.resize(m, m);
        parallelFor(size_t(m), 32, [&](size_t j) {
            for (Index i = Index(j); i < m; ++i)
                factor(i, Index(j)) = Scalar(problem.element(index[size_t(i)], index[j]));
            factor(Index(j), Index(j)) += Scalar(ridge);
        });
        return factorInPlace(factor, problem);
    }
    VectorXd ofFree(const VectorXd& all) const { return all(index); }

    bool solveWithFactor() {
        z.setZero();
        MatrixXd factor;
        if (!factorOfFree(factor, 0)) return false;
        const VectorXd y = solveFactored(factor, ofFree(problem.b));
        if (!y.allFinite()) return false;
        z(index) = y;
        gradient = problem.times(z) - problem.b;  // one step of refinement
        z(index) -= solveFactored(factor, ofFree(gradient));
        if (!z.allFinite()) return false;
        gradient = problem.times(z) - problem.b;
        return true;
    }

    /// A factor in single precision costs half; conjugate gradients in double, preconditioned by it, end where a factor
    /// in double would. False, and nothing is said of z, where the matrix is too stiff for that.
    bool solveWithRoughFactor() {
        constexpr int most = 12;
        Eigen::MatrixXf factor;
        if (!factorOfFree(factor, 1e-6)) return false;
        const auto soften = [&](const VectorXd& r) {
            const double unit = std::max(r.cwiseAbs().maxCoeff(), 1e-300);
            return VectorXd(unit *
                            solveFactored(factor, Eigen::VectorXf((r / unit).cast<float>())).template cast<double>());
        };
        const double wanted = 1e-14 * ofFree(problem.b).cwiseAbs().maxCoeff();
        VectorXd r = ofFree(problem.b), s = soften(r), direction = s, whole = VectorXd::Zero(z.size());
        double along = r.dot(s);
        z.setZero();
        for (int step = 0; step < most; ++step) {
            if (!(along > 0) || !std::isfinite(along)) return false;
            whole(index) = direction;
            const VectorXd product = ofFree(problem.times(whole));
            const double length = along / direction.dot(product);
            if (!std::isfinite(length)) return false;
            z(index) += length * direction;
            r -= length * product;
            if (r.cwiseAbs().maxCoeff() <= wanted) break;
            // Stiff: a factor in double is the shorter way.
            if (step == 4 && r.cwiseAbs().maxCoeff() > 1e8 * wanted) return false;
            s = soften(r);
            const double next = r.dot(s);
            direction = s + (next / along) * direction;
            along = next;
        }
        gradient = problem.times(z) - problem.b;
        return z.allFinite() && ofFree(gradient).cwiseAbs().maxCoeff() <= 100 * wanted;
    }
};

/// Largest violation of the conditions over the largest term they are made of.
double kktOf(const Scaled& p, const VectorXd& z, const VectorXd& gradient) {
    const VectorXd x = p.scale.cwiseProduct(z);
    VectorXd terms(z.size());
    parallelFor(size_t(z.size()), 64, [&](size_t i) {
        terms(Index(i)) = p.scale(Index(i)) * p.q.col(Index(i)).cwiseAbs().dot(x) + std::abs(p.b(Index(i)));
    });
    const double magnitude = std::max(terms.maxCoeff(), 1e-300);
    double worst = 0;
    for (Index i = 0; i < z.size(); ++i)
        if (p.scale(i) > 0)
            worst = std::max(worst, (z(i) > 0 ? std::abs(gradient(i)) : std::max(0.0, -gradient(i))) / magnitude);
    return worst;
}

/// The scaled matrix in single precision: half the memory to read in each product, enough to find out which variables
/// are free.
class Rough {
public:
    explicit Rough(const Scaled& p) : problem_(p), a_(p.q.rows(), p.q.cols()) {
        const Eigen::VectorXf scale = p.scale.cast<float>();
        columns([&](Index j) { a_.col(j) = (p.q.col(j) * p.scale(j)).cast<float>().cwiseProduct(scale); });
    }
    Eigen::VectorXf times(const Eigen::VectorXf& z) const {
        problem_.check();
        const Index n = z.size();
        Eigen::VectorXf y(n);
        // Symmetric: rows are columns, which lie together in memory. Every element is summed by itself: the same bits
        // on any number of threads.
        if (n < block) y.noalias() = a_.transpose() * z;
        else
            parallelBlocks(size_t(n), size_t(block), [&](size_t begin, size_t end) {
                y.segment(Index(begin), Index(end - begin)).noalias() =
                    a_.middleCols(Index(begin), Index(end - begin)).transpose() * z;
            });
        return y;
    }

private:
    static constexpr Index block = 512;
    const Scaled& problem_;
    Eigen::MatrixXf a_;
    template <class Part>
    void columns(Part&& part) {
        if (a_.cols() < block)
            for (Index j = 0; j < a_.cols(); ++j) part(j);
        else parallelFor(size_t(a_.cols()), 64, [&](size_t j) { part(Index(j)); });
    }
};

/// Projected conjugate gradients from `z` in single precision, at most `steps` products: first as if there were no
/// bounds, because most light is free, then with proportioning (MPRGP, Dostal and Schoeberl 2005) until the set of free
/// variables rests.
void approach(const Scaled& p, int steps, VectorXd& z0, const VectorXd& lower) {
    using VectorXf = Eigen::VectorXf;
    const Index n = z0.size();
    const Rough a(p);
    // Gradients in units of the largest element of b, so that single precision holds whatever the photographs' units
    // are.
    const double unit = std::max(p.b.cwiseAbs().maxCoeff(), 1e-300);
    const VectorXf b = (p.b / unit).cast<float>();
    VectorXf z = (z0 / unit).cast<float>();
    if (!b.allFinite() || !z.allFinite()) return;
    VectorXf gradient = z0.isZero(0) ? VectorXf(-b) : VectorXf(a.times(z) - b);
    const auto tell = [&] {
        if (p.watch.each) p.watch.each(lower + unit * p.scale.cwiseProduct(z.cwiseMax(0.0f).cast<double>()));
    };
    VectorXf direction = gradient, along(n);
    float largest = 1, square = gradient.squaredNorm();
    const float first = square;
    int spent = 0;
    for (; spent < std::min(steps, int(8 + n / 512)) && square > 1e-8f * first; ++spent) {
        along = a.times(direction);
        const float curvature = direction.dot(along);
        if (!(curvature > 0)) break;
        largest = std::max(largest, curvature / direction.squaredNorm());
        const float length = square / curvature;
        z -= length * direction;
        gradient -= length * along;
        const float next = gradient.squaredNorm();
        direction = gradient + (next / square) * direction;
        square = next;
        if (spent >= 6) tell();
        // Bounds that are held against this strongly will be active: no use in going on without them.
        if (spent >= 3 && -z.cwiseMin(0.0f).sum() > 0.1f * z.cwiseMax(0.0f).sum()) break;
    }
    const bool inside = z.minCoeff() >= 0;
    if (!inside) {
        z = z.cwiseMax(0.0f);
        gradient = a.times(z) - b;
        ++spent;
        tell();
    }
    const float stride = 1.7f / (1.1f * largest);
    VectorXf free(n), chopped(n);
    const auto split = [&] {
        for (Index i = 0; i < n; ++i) {
            const bool loose = z(i) > 0;
            free(i) = loose ? gradient(i) : 0;
            chopped(i) = loose || p.scale(i) == 0 ? 0 : std::min(0.0f, gradient(i));
        }
    };
    const auto value = [&](const VectorXf& at, const VectorXf& slope) {
        return 0.5 * at.cast<double>().dot((slope - b).cast<double>());
    };
    split();
    direction = free;
    // Nothing met a bound: the factor does the rest better.
    int calm = inside ? 16 : 0;
    while (spent < steps && calm < 16) {
        float reduced = 0;
        for (Index i = 0; i < n; ++i) reduced += std::min(z(i) / stride, free(i)) * free(i);
        if (free.squaredNorm() + chopped.squaredNorm() < 1e-10f * first) break;
        const bool letGo = chopped.squaredNorm() > reduced;
        const VectorXf& step = letGo ? chopped : direction;
        along = a.times(step);
        ++spent;
        const float curvature = step.dot(along);
        if (!(curvature > 0)) break;
        const float length = gradient.dot(step) / curvature;
        float reach = 1e30f;
        if (!letGo)
            for (Index i = 0; i < n; ++i)
                if (direction(i) > 0) reach = std::min(reach, z(i) / direction(i));
        if (length <= reach) {
            z -= length * step;
            gradient -= length * along;
            split();
            if (letGo) direction = free;
            else direction = free - (free.dot(along) / curvature) * direction;
            calm = letGo ? 0 : calm + 1;
        } else {
            // The whole step, projected, where that helps; else to the first bound and a short step along the gradient.
            const VectorXf trial = (z - length * direction).cwiseMax(0.0f), slope = a.times(trial) - b;
            ++spent;
            if (value(trial, slope) < value(z, gradient)) {
                z = trial;
                gradient = slope;
            } else {
                z -= reach * direction;
                gradient -= reach * along;
                for (Index i = 0; i < n; ++i)
                    if (free(i) != 0) z(i) = std::max(0.0f, z(i) - stride * gradient(i));
                z = z.cwiseMax(0.0f);
                gradient = a.times(z) - b;
                ++spent;
            }
            split();
            direction = free;
            calm = 0;
        }
        tell();
    }
    if (z.allFinite()) z0 = unit * z.cwiseMax(0.0f).cast<double>();
}

/// Where pivoting fails, coordinate descent goes on from what it left: slower, but it cannot cycle.
void descend(const Scaled& p, VectorXd& z, VectorXd& gradient, double& kkt) {
    for (int sweep = 0; kkt > 1e-9 && sweep < 3000; ++sweep) {
        p.check();
        for (Index i = 0; i < z.size(); ++i) {
            if (!(p.scale(i) > 0)) continue;
            const double before = z(i), after = std::max(0.0, before - gradient(i) / (1 + p.ridge));
            if (after == before) continue;
            z(i) = after;
            gradient += ((after - before) * p.scale(i)) * p.scale.cwiseProduct(p.q.col(i));
            gradient(i) += (after - before) * p.ridge;
        }
        if (sweep % 50 == 49) {
            gradient = p.times(z) - p.b;
            kkt = kktOf(p, z, gradient);
        }
    }
}

}  // namespace

QpResult solveBoundedQp(const MatrixXd& q, const VectorXd& c, const VectorXd& lower, const VectorXd* guess,
                        const QpWatch& watch) {
    const Index n = q.rows();
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
    Scaled problem{q, VectorXd(n), VectorXd(n), 1e-12, watch};
    for (Index i = 0; i < n; ++i) problem.scale(i) = q(i, i) > 0 ? 1 / std::sqrt(q(i, i)) : 0;
    problem.b = problem.scale.cwiseProduct(lower.isZero(0) ? c : VectorXd(c - q * lower));
    const double tolerance = 1e-12 * std::max(problem.b.cwiseAbs().maxCoeff(), 1e-300);

    VectorXd start = VectorXd::Zero(n);
    if (guess)
        for (Index i = 0; i < n; ++i)
            if (problem.scale(i) > 0 && std::isfinite((*guess)(i)))
                start(i) = std::max(0.0, ((*guess)(i)-lower(i)) / problem.scale(i));
    Pivoting p(problem);
    constexpr Index small = 48;  // below this a factor costs less than the way to it
    if (n > small) {
        approach(problem, int(8 + n / 512 + (n < 512 ? 0 : n / 64)), start, lower);
        for (Index i = 0; i < n; ++i) p.free_[size_t(i)] = start(i) > 0;
    } else {
        for (Index i = 0; i < n; ++i)
            p.free_[size_t(i)] = problem.scale(i) > 0 && (guess ? start(i) > 0 : problem.b(i) > 0);
    }
    Index best = n + 1;
    int patience = 3;
    double more = 1e-12;
    for (result.iterations = 1; result.iterations <= 500; ++result.iterations) {
        if (!p.solveOnFree()) {
            // Not definite to working precision: strengthen the ridge and go on.
            problem.ridge += more;
            more *= 10;
            if (more > 1) break;
            continue;
        }
        if (watch.each) watch.each(lower + problem.scale.cwiseProduct(p.z.cwiseMax(0.0)));
        std::vector<Index> wrong;
        for (Index i = 0; i < n; ++i) {
            if (problem.scale(i) == 0) continue;
            if (p.free_[size_t(i)] ? p.z(i) < -tolerance : p.gradient(i) < -tolerance) wrong.push_back(i);
        }
        if (wrong.empty()) {
            result.converged = true;
            break;
        }
        if (Index(wrong.size()) < best) {
            best = Index(wrong.size());
            patience = 3;
        } else if (--patience < 0) {
            wrong.assign(1, wrong.back());  // Murty's rule cannot cycle
        }
        for (Index i : wrong) p.free_[size_t(i)] ^= 1;
    }
    if (!result.converged)
        result.reason = more > 1 ? "the normal equations are not positive definite" : "pivoting did not settle";
    p.z = p.z.cwiseMax(0.0);
    p.gradient = problem.times(p.z) - problem.b;
    result.kktResidual = kktOf(problem, p.z, p.gradient);
    descend(problem, p.z, p.gradient, result.kktResidual);
    if (result.kktResidual < 1e-9) {
        result.converged = true;
        result.reason.clear();
    }
    result.x = lower + problem.scale.cwiseProduct(p.z);
    return result;
}

}  // namespace relamp
