#include "solve/light/lighting_step.h"

#include "solve/light/qp.h"
#include "solve/light/weighted_gram.h"

namespace relamp {

LightingStepReport lightingStep(const InfluenceMatrix& influence, const MatteObservations& matte,
                                const std::vector<Rgb>& albedo, const std::vector<Rgb>& litSigma,
                                const LightPrior& prior, const std::vector<Rgb>& bounce, Lighting& lighting,
                                Progress& progress) {
    LightingStepReport report;
    const size_t rows = influence.rows, leaves = lighting.leaves.size(), emitters = lighting.emitterRadiance.size();
    const Eigen::Index n = Eigen::Index(influence.columns);
    const Eigen::Map<const Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>> b(
        influence.values.data(), Eigen::Index(rows), n);
    constexpr double scale2 = 9;  // Cauchy scale of three standard deviations, squared
    double squares = 0;
    for (int c = 0; c < 3; ++c) {
        Eigen::VectorXd x{n}, albedoOf{Eigen::Index(rows)};
        for (size_t i = 0; i < leaves; ++i) x(Eigen::Index(i)) = lighting.leafRadiance[i][c];
        for (size_t e = 0; e < emitters; ++e) x(Eigen::Index(leaves + e)) = lighting.emitterRadiance[e][c];
        x = x.cwiseMax(prior.lowest(c));
        std::vector<double> variance(rows), target(rows);
        for (size_t i = 0; i < rows; ++i) {
            const double a = albedo[matte.vertices[i]][c], y = matte.radiance[i][c];
            albedoOf(Eigen::Index(i)) = a;
            target[i] = y - (bounce.empty() ? 0.0 : a * double(bounce[i][c]));
            variance[i] = std::pow(double(matte.sigma[i][c]), 2) + std::pow(a * double(litSigma[i][c]), 2) +
                          std::pow(0.015 * y, 2) + 1e-30;
        }
        const auto residuals = [&](const Eigen::VectorXd& at) -> Eigen::VectorXd {
            Eigen::VectorXd r = (b * at.cast<float>()).cast<double>().cwiseProduct(albedoOf);
            for (size_t i = 0; i < rows; ++i) r(Eigen::Index(i)) -= target[i];
            return r;
        };
        const auto objective = [&](const Eigen::VectorXd& r, const Eigen::VectorXd& at) {
            double sum = 0;
            for (size_t i = 0; i < rows; ++i)
                sum += scale2 * std::log1p(r(Eigen::Index(i)) * r(Eigen::Index(i)) / variance[i] / scale2);
            return sum + prior.value(at, c);
        };
        Eigen::VectorXd r = residuals(x);
        const double start = objective(r, x);
        std::vector<float> weight(rows);
        Eigen::VectorXf pull{Eigen::Index(rows)};
        for (size_t i = 0; i < rows; ++i) {
            const double w = 1 / (variance[i] * (1 + r(Eigen::Index(i)) * r(Eigen::Index(i)) / variance[i] / scale2)),
                         a = albedoOf(Eigen::Index(i));
            weight[i] = float(w * a * a);
            pull(Eigen::Index(i)) = float(w * a * target[i]);
        }
        Eigen::MatrixXd q = weightedGram(
            influence,
            [&](size_t i, float* out) { Eigen::Map<Eigen::RowVectorXf>(out, n) = weight[i] * b.row(Eigen::Index(i)); },
            progress);
        Eigen::VectorXd moment = (b.transpose() * pull).cast<double>(), lower = Eigen::VectorXd::Zero(n);
        prior.add(x, c, q, moment, lower);
        const QpResult solution = solveBoundedQp(q, moment, lower, &x, {&progress});
        report.kktResidual = std::max(report.kktResidual, solution.kktResidual);
        double reached = start;
        if (solution.usable)
            for (double step = 1; step > 0.05; step *= 0.5) {
                const Eigen::VectorXd trial = x + step * (solution.x - x);
                const Eigen::VectorXd trialResidual = residuals(trial);
                const double value = objective(trialResidual, trial);
                if (value > start) continue;
                reached = value;
                x = trial;
                r = trialResidual;
                break;
            }
        report.before += start / 3;
        report.after += reached / 3;
        squares += r.squaredNorm();
        for (size_t i = 0; i < leaves; ++i) lighting.leafRadiance[i][c] = float(x(Eigen::Index(i)));
        for (size_t e = 0; e < emitters; ++e) lighting.emitterRadiance[e][c] = float(x(Eigen::Index(leaves + e)));
    }
    report.rmse = std::sqrt(squares / double(3 * std::max<size_t>(1, rows)));
    return report;
}

}  // namespace relamp
