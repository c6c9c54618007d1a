#include "solve/albedo/albedo_step.h"

#include <Eigen/SparseCholesky>

#include "base/parallel.h"
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
                          double edge, double typical, int c) {
    const size_t n = scene.mesh.vertexCount();
    constexpr double least = 1e-4;  // where nothing is known
    AlbedoSystem system{Eigen::SparseMatrix<double>(Eigen::Index(n), Eigen::Index(n)),
                        Eigen::VectorXd::Constant(Eigen::Index(n), least * typical),
                        {},
                        std::vector<float>(n, 0)};
    std::vector<Eigen::Triplet<double>> triplets;
    triplets.reserve(scene.graph.to.size() + n);
    std::vector<double> diagonal(n, least);
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
            system.moment(Eigen::Index(v)) += weight * double(aim[c]);
        }
    system.precision.resize(matte.vertices.size(), 0);
    std::vector<double> precision(n, 0);  // of all lighting states
    for (size_t i = 0; i < matte.vertices.size(); ++i) {
        const uint32_t v = matte.vertices[i];
        const double l = lit[i][c], y = matte.radiance[i][c], albedo = std::exp(double(logAlbedo[v][c]));
        const double s2 = std::pow(double(matte.sigma[i][c]), 2) + std::pow(albedo * double(litSigma[i][c]), 2) + 1e-30;
        if (!(l > 0)) continue;
        const double model = albedo * l, p = model * model / s2;
        const double step =
            y > 0.2 * model && y < 5 * model ? std::log(y / model) : std::clamp(y / model - 1, -1.0, 2.0);
        diagonal[v] += p;
        system.moment(Eigen::Index(v)) += p * (double(logAlbedo[v][c]) + step);
        system.precision[i] = p;
        precision[v] += p;
        system.own[v] = float(precision[v] / diagonal[v]);
    }
    for (size_t v = 0; v < n; ++v) triplets.emplace_back(int(v), int(v), diagonal[v]);
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

    Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factors[3];
    bool analysed[3] = {false, false, false};
    progress.begin("Albedo", size_t(prior.iterations));
    for (int iteration = 0; iteration < prior.iterations; ++iteration) {
        const double annealed = double(prior.edge) * (iteration == 0 ? 3 : 1);
        std::vector<Rgb> next = logAlbedo;
        std::vector<std::array<float, 3>> own(n, {0, 0, 0});
        parallelFor(3, 1, [&](size_t c) {
            const AlbedoSystem system = albedoSystem(scene, matte, lit, litSigma, prior, logAlbedo, annealed,
                                                     std::log(double(typical[int(c)])), int(c));
            for (size_t v = 0; v < n; ++v) own[v][c] = system.own[v];
            if (!analysed[c]) factors[c].analyzePattern(system.matrix);
            analysed[c] = true;
            factors[c].factorize(system.matrix);
            if (factors[c].info() != Eigen::Success) return;
            const Eigen::VectorXd solution = factors[c].solve(system.moment);
            if (!solution.allFinite()) return;
            for (size_t v = 0; v < n; ++v) next[v][int(c)] = float(std::clamp(solution(Eigen::Index(v)), -10.0, 3.0));
        });
        logAlbedo = next;
        for (size_t v = 0; v < n; ++v) result.confidence[v] = (own[v][0] + own[v][1] + own[v][2]) / 3;
        progress.advance();
    }
    for (size_t v = 0; v < n; ++v) result.albedo[v] = glm::exp(logAlbedo[v]);
    return result;
}

}  // namespace relamp
