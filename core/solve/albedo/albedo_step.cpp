#include "solve/albedo/albedo_step.h"

#include <Eigen/SparseCholesky>

#include "base/statistics.h"
#include "solve/albedo/albedo_system.h"

namespace relamp {
namespace {

/// How far the prior holds across an edge of the mesh, (0, 1]: materials end at creases. A surface that turns by more
/// than 20 degrees an edge, or with less than 3 % of the scene's diagonal in radius, counts as one.
double smoothAcross(const Scene& scene, uint32_t a, uint32_t b) {
    constexpr double leastRadius = 0.03, mostTurn = 0.35, least = 0.01;
    if (scene.mesh.normals.empty()) return 1;
    const double turn = glm::distance(scene.mesh.normals[a], scene.mesh.normals[b]);
    if (!(turn > 0)) return 1;
    const double length = glm::distance(scene.mesh.positions[a], scene.mesh.positions[b]),
                 bend = turn * leastRadius * double(scene.diagonal) / std::max(length, 1e-30), kink = turn / mostTurn;
    return std::max(least, 1 / (1 + bend * bend + kink * kink));
}

}  // namespace

AlbedoSystem albedoSystem(const Scene& scene, const MatteObservations& matte, const std::vector<Rgb>& lit,
                          const std::vector<Rgb>& litSigma, const AlbedoPrior& prior, const std::vector<Rgb>& logAlbedo,
                          double edge, const ChannelValues& typical) {
    const size_t n = scene.mesh.vertexCount();
    constexpr double least = 1e-4;  // where nothing is known
    AlbedoSystem system;
    system.matrix.resize(Eigen::Index(n), Eigen::Index(n));
    system.moment.setConstant(Eigen::Index(n), least * typical);
    system.own.assign(n, 0);
    std::vector<Eigen::Triplet<ChannelValues>> triplets;
    triplets.reserve(scene.graph.to.size() + n);
    std::vector<ChannelValues> diagonal(n, least);
    for (uint32_t v = 0; v < n; ++v)
        for (uint32_t e = scene.graph.start[v]; e < scene.graph.start[v + 1]; ++e) {
            const uint32_t to = scene.graph.to[e];
            if (to <= v) continue;
            const Rgb d = logAlbedo[v] - logAlbedo[to];
            const double d2 = double(glm::dot(d, d)) / 3,
                         weight =
                             smoothAcross(scene, v, to) / (double(prior.step) * prior.step * (1 + d2 / (edge * edge)));
            diagonal[v] += weight;
            diagonal[to] += weight;
            triplets.emplace_back(int(v), int(to), -weight);
            triplets.emplace_back(int(to), int(v), -weight);
        }
    if (prior.towards)
        for (size_t v = 0; v < n; ++v) {
            const Rgb aim = glm::log(glm::max((*prior.towards)[v], Rgb(1e-4f))), d = logAlbedo[v] - aim;
            const double weight =
                1.0 / (double(prior.spread) * prior.spread * (1 + double(glm::dot(d, d)) / 3 / (edge * edge)));
            diagonal[v] += weight;
            system.moment(Eigen::Index(v)) += weight * ChannelValues(aim.x, aim.y, aim.z);
        }
    system.precision.resize(matte.vertices.size());
    std::vector<ChannelValues> precision(n);  // of all lighting states
    for (size_t i = 0; i < matte.vertices.size(); ++i) {
        const uint32_t v = matte.vertices[i];
        const auto told = [&](int c) -> std::pair<double, double> {
            const double l = lit[i][c], y = matte.radiance[i][c], log = logAlbedo[v][c], albedo = std::exp(log);
            const double s2 =
                std::pow(double(matte.sigma[i][c]), 2) + std::pow(albedo * double(litSigma[i][c]), 2) + 1e-30;
            if (!(l > 0)) return {0, 0};
            const double model = albedo * l, p = model * model / s2;
            const double step =
                y > 0.2 * model && y < 5 * model ? std::log(y / model) : std::clamp(y / model - 1, -1.0, 2.0);
            return {p, p * (log + step)};
        };
        const auto [red, redMoment] = told(0);
        const auto [green, greenMoment] = told(1);
        const auto [blue, blueMoment] = told(2);
        system.precision[i] = {red, green, blue};
        diagonal[v] += system.precision[i];
        precision[v] += system.precision[i];
        system.moment(Eigen::Index(v)) += ChannelValues(redMoment, greenMoment, blueMoment);
    }
    for (size_t v = 0; v < n; ++v) {
        triplets.emplace_back(int(v), int(v), diagonal[v]);
        const ChannelValues fraction = precision[v] / diagonal[v];
        system.own[v] = float((fraction[0] + fraction[1] + fraction[2]) / 3);
    }
    system.matrix.setFromTriplets(triplets.begin(), triplets.end());
    return system;
}

AlbedoResult solveAlbedo(const Scene& scene, const MatteObservations& matte, const std::vector<Rgb>& lit,
                         const std::vector<Rgb>& litSigma, const AlbedoPrior& prior, Progress& progress) {
    const size_t n = scene.mesh.vertexCount();
    AlbedoResult result;
    result.albedo.assign(n, Rgb(0.5f));
    result.confidence.assign(n, 0);
    if (matte.vertices.empty()) return result;

    // A typical albedo stands in where nothing is known.
    std::vector<float> ratios;
    Rgb typical(0.5f);
    for (int c = 0; c < 3; ++c) {
        ratios.clear();
        for (size_t i = 0; i < matte.vertices.size(); ++i)
            if (lit[i][c] > 5 * litSigma[i][c] && lit[i][c] > 0) ratios.push_back(matte.radiance[i][c] / lit[i][c]);
        if (ratios.empty()) continue;
        typical[c] = std::clamp(medianOf(ratios), 1e-3f, 2.0f);
    }
    std::vector<Rgb> logAlbedo(n);
    for (Rgb& a : logAlbedo) a = glm::log(typical);
    // The start is from the brightest lighting state.
    std::vector<Rgb> brightest(matte.states() > 1 ? n : 0, Rgb(0));
    const auto outshone = [&](size_t i, int c) {
        if (brightest.empty()) return false;
        float& most = brightest[matte.vertices[i]][c];
        if (!(lit[i][c] > most)) return true;
        most = lit[i][c];
        return false;
    };
    for (size_t i = 0; i < matte.vertices.size(); ++i)
        for (int c = 0; c < 3; ++c)
            if (lit[i][c] > 2 * litSigma[i][c] && matte.radiance[i][c] > 0 && lit[i][c] > 0 && !outshone(i, c))
                logAlbedo[matte.vertices[i]][c] = std::log(std::clamp(matte.radiance[i][c] / lit[i][c], 1e-4f, 20.0f));

    Eigen::SimplicialLDLT<Eigen::SparseMatrix<ChannelValues>> factor;
    const ChannelValues logTypical(std::log(typical.x), std::log(typical.y), std::log(typical.z));
    progress.begin("Albedo", size_t(prior.iterations));
    for (int iteration = 0; iteration < prior.iterations; ++iteration) {
        const double annealed = double(prior.edge) * (iteration == 0 ? 3 : 1);
        AlbedoSystem system = albedoSystem(scene, matte, lit, litSigma, prior, logAlbedo, annealed, logTypical);
        result.confidence = std::move(system.own);
        if (iteration == 0) factor.analyzePattern(system.matrix);
        factor.factorize(system.matrix);
        progress.advance();
        if (factor.info() != Eigen::Success) continue;
        const auto solution = factor.solve(system.moment).eval();
        for (int c = 0; c < 3; ++c) {
            const auto channel = [&](size_t v) { return solution(Eigen::Index(v))[c]; };
            bool finite = true;
            for (size_t v = 0; v < n; ++v) finite &= std::isfinite(channel(v));
            for (size_t v = 0; v < n && finite; ++v) logAlbedo[v][c] = float(std::clamp(channel(v), -10.0, 3.0));
        }
    }
    for (size_t v = 0; v < n; ++v) result.albedo[v] = glm::exp(logAlbedo[v]);
    return result;
}

}  // namespace relamp
