// The other runners: what a textbook or a package would do with x'Qx - 2 c'x over x >= 0. All but IPOPT get the
// column-scaled problem, as ours does; each tells its feasible points to a Recorder and stops when that says so.
#pragma once
#include <time.h>

#include <functional>

#include "bench/race_problems.h"

namespace relamp::bench {

/// CPU seconds (all threads) and objective along a run, the time it takes to judge a point left out.
class Recorder {
public:
    Recorder(const RaceProblem& problem, double limitSeconds)
        : problem_(problem), limit_(limitSeconds), start_(now()) {}
    void goal(double objective) { goal_ = objective; }
    /// Takes a point; negative values count as zero.
    void operator()(const Eigen::VectorXd& x) {
        const double at = now();
        const double value = problem_.objective(x.cwiseMax(0.0));
        if (points.empty() || value < points.back().second) points.emplace_back(at - start_ - judged_, value);
        judged_ += now() - at;
    }
    bool stop() const {
        return now() - start_ - judged_ > limit_ || (!points.empty() && points.back().second <= goal_);
    }
    void finish() { ended_ = seconds(); }
    double best() const { return points.empty() ? 1e300 : points.back().second; }
    double seconds() const { return ended_ > 0 ? ended_ : now() - start_ - judged_; }
    /// Seconds until the objective was at most `value`; infinity when it never was.
    double secondsTo(double value) const {
        for (const auto& [seconds, objective] : points)
            if (objective <= value) return seconds;
        return std::numeric_limits<double>::infinity();
    }
    std::vector<std::pair<double, double>> points;

private:
    const RaceProblem& problem_;
    double limit_, start_, judged_ = 0, ended_ = 0, goal_ = -1e300;
    static double now() {
        timespec t;
        clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
        return double(t.tv_sec) + 1e-9 * double(t.tv_nsec);
    }
};

struct ScaledProblem {
    Eigen::MatrixXd a;
    Eigen::VectorXd b, scale;
    explicit ScaledProblem(const RaceProblem& p) : scale(p.c.size()) {
        for (Eigen::Index i = 0; i < scale.size(); ++i) scale(i) = p.q(i, i) > 0 ? 1 / std::sqrt(p.q(i, i)) : 0;
        a = scale.asDiagonal() * p.q * scale.asDiagonal();
        b = scale.cwiseProduct(p.c);
    }
};

/// Lawson and Hanson 1974 on the normal equations: one variable enters at a time, the Cholesky factor grows by a row
/// and is rebuilt from the first variable that leaves.
inline void lawsonHanson(const RaceProblem& problem, Recorder& record) {
    const ScaledProblem s(problem);
    const Eigen::Index n = s.b.size();
    std::vector<Eigen::Index> passive;
    std::vector<char> in(size_t(n), 0);
    Eigen::MatrixXd l = Eigen::MatrixXd::Zero(n, n);
    Eigen::VectorXd x = Eigen::VectorXd::Zero(n);
    const auto grow = [&](Eigen::Index from) {  // rows from ... of the factor
        for (Eigen::Index r = from; r < Eigen::Index(passive.size()); ++r) {
            Eigen::VectorXd row(r);
            for (Eigen::Index k = 0; k < r; ++k) row(k) = s.a(passive[size_t(k)], passive[size_t(r)]);
            l.topLeftCorner(r, r).triangularView<Eigen::Lower>().solveInPlace(row);
            l.row(r).head(r) = row.transpose();
            l(r, r) = std::sqrt(
                std::max(s.a(passive[size_t(r)], passive[size_t(r)]) * (1 + 1e-12) - row.squaredNorm(), 1e-13));
        }
    };
    while (!record.stop()) {
        const Eigen::VectorXd w = s.b - s.a * x;
        Eigen::Index enter = -1;
        for (Eigen::Index i = 0; i < n; ++i)
            if (!in[size_t(i)] && w(i) > 1e-9 && (enter < 0 || w(i) > w(enter))) enter = i;
        if (enter < 0) break;
        in[size_t(enter)] = 1;
        passive.push_back(enter);
        grow(Eigen::Index(passive.size()) - 1);
        while (!record.stop()) {
            const Eigen::Index m = Eigen::Index(passive.size());
            Eigen::VectorXd y(m);
            for (Eigen::Index k = 0; k < m; ++k) y(k) = s.b(passive[size_t(k)]);
            const auto factor = l.topLeftCorner(m, m).triangularView<Eigen::Lower>();
            factor.solveInPlace(y);
            factor.transpose().solveInPlace(y);
            double step = 1;
            for (Eigen::Index k = 0; k < m; ++k)
                if (const double at = x(passive[size_t(k)]); y(k) <= 0) step = std::min(step, at / (at - y(k)));
            for (Eigen::Index k = 0; k < m; ++k) x(passive[size_t(k)]) += step * (y(k) - x(passive[size_t(k)]));
            if (step >= 1) break;
            Eigen::Index first = m;
            std::vector<Eigen::Index> kept;
            for (Eigen::Index k = 0; k < m; ++k) {
                if (x(passive[size_t(k)]) > 1e-14) {
                    kept.push_back(passive[size_t(k)]);
                } else {
                    x(passive[size_t(k)]) = 0;
                    in[size_t(passive[size_t(k)])] = 0;
                    first = std::min(first, k);
                }
            }
            passive = kept;
            grow(first);
        }
        record(s.scale.cwiseProduct(x));
    }
}

/// Spectral projected gradient: Barzilai and Borwein's step lengths, projected (Birgin, Martinez, Raydan 2000, without
/// the line search).
inline void projectedGradient(const RaceProblem& problem, Recorder& record) {
    const ScaledProblem s(problem);
    const Eigen::Index n = s.b.size();
    Eigen::VectorXd x = Eigen::VectorXd::Zero(n), gradient = -s.b;
    double length = 1 / double(n);
    for (int k = 0; k < 200000 && !record.stop(); ++k) {
        const Eigen::VectorXd next = (x - length * gradient).cwiseMax(0.0), step = next - x;
        const Eigen::VectorXd along = s.a * step;
        const double bend = step.dot(along);
        if (!(bend > 0)) break;
        // Exact along the feasible step, and never beyond it.
        const double fraction = std::min(1.0, -gradient.dot(step) / bend);
        x += fraction * step;
        gradient += fraction * along;
        length = step.squaredNorm() / bend;
        if (k % 4 == 0) record(s.scale.cwiseProduct(x));
    }
}

/// Beck and Teboulle 2009 with O'Donoghue and Candes's restart by the gradient.
inline void fista(const RaceProblem& problem, Recorder& record) {
    const ScaledProblem s(problem);
    const Eigen::Index n = s.b.size();
    Eigen::VectorXd v = Eigen::VectorXd::Ones(n);
    double largest = 1;
    for (int k = 0; k < 8; ++k) {
        v = s.a * (v / v.norm());
        largest = v.norm();
    }
    const double length = 1 / (1.02 * largest);
    Eigen::VectorXd x = Eigen::VectorXd::Zero(n), y = x;
    double t = 1;
    for (int k = 0; k < 200000 && !record.stop(); ++k) {
        const Eigen::VectorXd gradient = s.a * y - s.b, next = (y - length * gradient).cwiseMax(0.0);
        if (gradient.dot(next - x) > 0) t = 1;
        const double grown = (1 + std::sqrt(1 + 4 * t * t)) / 2;
        y = next + ((t - 1) / grown) * (next - x);
        x = next;
        t = grown;
        if (k % 4 == 0) record(s.scale.cwiseProduct(x));
    }
}

#ifdef RELAMP_RACE_IPOPT
/// IPOPT with the exact, constant Hessian, or with its own limited-memory one. In race_ipopt.cpp.
void ipopt(const RaceProblem& problem, Recorder& record, bool limitedMemory);
#endif

}  // namespace relamp::bench
