#include "solve/photometric_estimate.h"

#include <Eigen/Core>

#include "base/dense.h"
#include "base/statistics.h"

namespace relamp {
namespace {

constexpr int rounds = 8;
constexpr float leastWeight = 0.3f;  // of an observation: grazing ones and those at edges mix surfaces

/// One observation as an equation: the gain of its view, and its place in the image.
struct Look {
    uint32_t view = 0;
    float r2 = 0;
    Rgb log{0};
    float weight = 0;
};

/// Usable observations, vertex after vertex; only vertices that two views see. What a vertex shows in different
/// lighting states are different vertices.
struct Looks {
    std::vector<uint32_t> start{0};
    std::vector<Look> observations;
};

Looks usableObservations(const Capture& capture, const Scene& scene, const RadianceSamples& samples) {
    Looks result;
    for (size_t k = 0; k < scene.mesh.vertexCount() * samples.states; ++k) {
        const size_t first = result.observations.size();
        const auto v = uint32_t(k / samples.states);
        for (uint32_t s = samples.start[v]; s < samples.start[v + 1]; ++s) {
            const RadianceSample& r = samples.samples[s];
            if (samples.stateOf(r.view) != k % samples.states) continue;
            const float darkest = std::min({r.radiance.x, r.radiance.y, r.radiance.z});
            if (r.clipped || r.weight < leastWeight || !(darkest > 4 * samples.noiseFloor)) continue;
            const Camera& camera = capture.views[r.view].camera;
            const auto pixel = camera.project(DVec3(scene.mesh.positions[v]));
            if (!pixel) continue;
            result.observations.push_back({r.view, radiusSquared(camera, *pixel), glm::log(r.radiance), r.weight});
        }
        if (result.observations.size() - first < 2) result.observations.resize(first);
        else result.start.push_back(uint32_t(result.observations.size()));
    }
    return result;
}

/// Gains in logarithms, view after view, three channels each, then the fall-off's two coefficients.
Rgb correction(const Eigen::VectorXd& u, const Look& observation) {
    const Eigen::Index gains = u.size() - 2, i = 3 * Eigen::Index(observation.view);
    const double falloff =
        u(gains) * double(observation.r2) + u(gains + 1) * double(observation.r2) * double(observation.r2);
    return Rgb(float(u(i) + falloff), float(u(i + 1) + falloff), float(u(i + 2) + falloff));
}

/// Residuals about each vertex's weighted mean; `robust`: per observation and channel the weight of the last round.
void residualsOf(const Looks& all, const Eigen::VectorXd& u, const std::vector<Rgb>& robust,
                 std::vector<Rgb>& residual) {
    for (size_t v = 0; v + 1 < all.start.size(); ++v) {
        Rgb sum(0), weight(0);
        for (uint32_t k = all.start[v]; k < all.start[v + 1]; ++k) {
            residual[k] = all.observations[k].log - correction(u, all.observations[k]);
            sum += all.observations[k].weight * robust[k] * residual[k];
            weight += all.observations[k].weight * robust[k];
        }
        for (uint32_t k = all.start[v]; k < all.start[v + 1]; ++k) residual[k] -= sum / glm::max(weight, Rgb(1e-20f));
    }
}

float spreadOf(const std::vector<Rgb>& residual) {
    std::vector<float> size;
    size.reserve(residual.size());
    for (const Rgb& r : residual) size.push_back(std::sqrt(glm::dot(r, r) / 3));
    return medianOf(std::move(size));
}

}  // namespace

namespace {

PhotometricEstimate fitted(const Capture& capture, const Looks& all, float noise, bool falloff, Progress& progress) {
    PhotometricEstimate result;
    const size_t views = capture.views.size();
    const Eigen::Index gains = 3 * Eigen::Index(views), n = gains + 2;
    Eigen::VectorXd u = Eigen::VectorXd::Zero(n);
    std::vector<Rgb> robust(all.observations.size(), Rgb(1)), residual(all.observations.size());
    residualsOf(all, u, robust, residual);
    progress.begin("Do exposures differ?", rounds);
    for (int round = 0; round < rounds; ++round) {
        // Cauchy weights about the residuals of the round before; their scale is their own.
        std::vector<float> size;
        for (const Rgb& r : residual)
            for (int c = 0; c < 3; ++c) size.push_back(std::abs(r[c]));
        const float scale = std::max(1.4826f * medianOf(std::move(size)), 0.3f * noise) * 2;
        for (size_t k = 0; k < robust.size(); ++k)
            robust[k] = 1.0f / (1.0f + residual[k] * residual[k] / (scale * scale));
        if (round == 0) {
            residualsOf(all, u, robust, residual);
            result.spread = spreadOf(residual);
        }
        Eigen::MatrixXd q = Eigen::MatrixXd::Zero(n, n);
        Eigen::VectorXd moment = Eigen::VectorXd::Zero(n);
        for (size_t v = 0; v + 1 < all.start.size(); ++v)
            for (int c = 0; c < 3; ++c) {
                // The vertex's mean is eliminated: rows less their weighted mean.
                Eigen::VectorXd mean = Eigen::VectorXd::Zero(n);
                double weight = 0, value = 0;
                for (uint32_t k = all.start[v]; k < all.start[v + 1]; ++k) {
                    const Look& l = all.observations[k];
                    const double w = double(l.weight * robust[k][c]), r2 = l.r2;
                    const Eigen::Index at[3] = {3 * Eigen::Index(l.view) + c, gains, gains + 1};
                    const double x[3] = {1, r2, r2 * r2};
                    for (int i = 0; i < 3; ++i) {
                        mean(at[i]) += w * x[i];
                        moment(at[i]) += w * x[i] * double(l.log[c]);
                        for (int j = 0; j < 3; ++j) q(at[i], at[j]) += w * x[i] * x[j];
                    }
                    weight += w;
                    value += w * double(l.log[c]);
                }
                if (!(weight > 0)) continue;
                for (uint32_t k = all.start[v]; k < all.start[v + 1]; ++k) {
                    const Eigen::Index i = 3 * Eigen::Index(all.observations[k].view) + c;
                    for (uint32_t m = all.start[v]; m < all.start[v + 1]; ++m)
                        q(i, 3 * Eigen::Index(all.observations[m].view) + c) -=
                            mean(i) * mean(3 * Eigen::Index(all.observations[m].view) + c) / weight;
                    for (Eigen::Index f = gains; f < n; ++f) {
                        q(i, f) -= mean(i) * mean(f) / weight;
                        q(f, i) -= mean(f) * mean(i) / weight;
                    }
                    moment(i) -= mean(i) * value / weight;
                }
                for (Eigen::Index f = gains; f < n; ++f) {
                    for (Eigen::Index g = gains; g < n; ++g) q(f, g) -= mean(f) * mean(g) / weight;
                    moment(f) -= mean(f) * value / weight;
                }
            }
        // Each channel's gains have mean 0; what nothing tells stays 0.
        const double strong = q.diagonal().mean() + 1e-12;
        for (Eigen::Index i = 0; i < gains; ++i)
            for (Eigen::Index j = i % 3; j < gains; j += 3) q(i, j) += strong / double(views * views);
        q.diagonal().array() += 1e-6 * strong;
        if (!falloff) q.diagonal().tail<2>().array() += 1e12 * strong;
        u = solveSymmetric(q, moment);
        if (!u.allFinite()) return {};
        residualsOf(all, u, robust, residual);
        progress.advance();
    }
    result.spreadAfter = spreadOf(residual);
    double squares = 0;
    for (size_t i = 0; i < views; ++i) {
        const Eigen::Vector3d g = u.segment<3>(3 * Eigen::Index(i));
        squares += g.squaredNorm();
        result.fix.gains.push_back(
            {capture.views[i].name, Rgb(std::exp(float(g.x())), std::exp(float(g.y())), std::exp(float(g.z())))});
    }
    result.gainRms = float(std::sqrt(squares / double(gains)));
    result.fix.falloff2 = float(u(gains));
    result.fix.falloff4 = float(u(gains + 1));
    return result;
}

}  // namespace

PhotometricEstimate estimatePhotometric(const Capture& capture, const Scene& scene, const RadianceSamples& samples,
                                        Progress& progress) {
    const Looks all = usableObservations(capture, scene, samples);
    if (capture.views.size() < 2 || all.observations.size() < 20 * capture.views.size()) return {};
    const PhotometricEstimate gains = fitted(capture, all, samples.relativeNoise, false, progress),
                              both = fitted(capture, all, samples.relativeNoise, true, progress);
    return both.spreadAfter < 0.95f * gains.spreadAfter ? both : gains;
}

std::string toText(const PhotometricEstimate& e) {
    double exposure = 0, balance = 0;
    for (const auto& g : e.fix.gains) {
        const Rgb log = glm::log(g.gain);
        const float mean = (log.x + log.y + log.z) / 3;
        exposure += mean * mean;
        balance += double(glm::dot(log - mean, log - mean)) / 3;
    }
    const double count = double(std::max<size_t>(1, e.fix.gains.size()));
    return fmt::format(
        "exposures differ by {:.1f} %, white balance by {:.1f} %, the lens lets {:.1f} % less through in the corners; "
        "surfaces differ between the views by {:.1f} % without and {:.1f} % with that taken out",
        100 * std::sqrt(exposure / count), 100 * std::sqrt(balance / count), 100 * (1 - e.fix.falloffAt(1)),
        100 * e.spread, 100 * e.spreadAfter);
}

}  // namespace relamp
