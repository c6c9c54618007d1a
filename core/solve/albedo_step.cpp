#include "solve/albedo_step.h"

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>

#include "base/parallel.h"

namespace relamp {

AlbedoResult solveAlbedo(const Scene& scene, const MatteObservations& matte, const std::vector<Rgb>& lit, const std::vector<Rgb>& litSigma,
                         const AlbedoPrior& prior, Progress& progress) {
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
        std::nth_element(ratios.begin(), ratios.begin() + ptrdiff_t(ratios.size() / 2), ratios.end());
        typical[c] = std::clamp(ratios[ratios.size() / 2], 1e-3f, 2.0f);
    }
    std::vector<Rgb> logAlbedo(n), target(matte.vertices.size()), precision(matte.vertices.size());
    for (Rgb& a : logAlbedo) a = glm::log(typical);
    for (size_t i = 0; i < matte.vertices.size(); ++i)
        for (int c = 0; c < 3; ++c)
            if (lit[i][c] > 2 * litSigma[i][c] && matte.radiance[i][c] > 0 && lit[i][c] > 0)
                logAlbedo[matte.vertices[i]][c] = std::log(std::clamp(matte.radiance[i][c] / lit[i][c], 1e-4f, 20.0f));

    std::vector<std::pair<uint32_t, uint32_t>> edges;
    for (uint32_t v = 0; v < n; ++v)
        for (uint32_t e = scene.graph.start[v]; e < scene.graph.start[v + 1]; ++e)
            if (scene.graph.to[e] > v) edges.emplace_back(v, scene.graph.to[e]);

    using Sparse = Eigen::SparseMatrix<double>;
    std::vector<Eigen::Triplet<double>> entries;
    Eigen::SimplicialLDLT<Sparse> factors[3];
    bool analysed[3] = {false, false, false};
    progress.begin("Albedo", size_t(prior.iterations));
    for (int iteration = 0; iteration < prior.iterations; ++iteration) {
        std::vector<double> edgeWeight(edges.size());
        const float annealed = prior.edge * (iteration == 0 ? 3.0f : 1.0f);
        for (size_t k = 0; k < edges.size(); ++k) {
            const Rgb d = logAlbedo[edges[k].first] - logAlbedo[edges[k].second];
            const double d2 = double(glm::dot(d, d)) / 3;
            edgeWeight[k] = 1.0 / (double(prior.step) * prior.step * (1 + d2 / (double(annealed) * annealed)));
        }
        std::vector<Rgb> next = logAlbedo;
        std::vector<std::array<float, 3>> own(n, {0, 0, 0});
        parallelFor(3, 1, [&](size_t c) {
            std::vector<Eigen::Triplet<double>> triplets;
            triplets.reserve(edges.size() * 4 + n + matte.vertices.size());
            Eigen::VectorXd rhs = Eigen::VectorXd::Zero(Eigen::Index(n));
            std::vector<double> diagonal(n, 1e-4);
            for (size_t v = 0; v < n; ++v) rhs(Eigen::Index(v)) = 1e-4 * std::log(double(typical[int(c)]));
            for (size_t k = 0; k < edges.size(); ++k) {
                const auto [a, b] = edges[k];
                diagonal[a] += edgeWeight[k];
                diagonal[b] += edgeWeight[k];
                triplets.emplace_back(int(a), int(b), -edgeWeight[k]);
                triplets.emplace_back(int(b), int(a), -edgeWeight[k]);
            }
            for (size_t i = 0; i < matte.vertices.size(); ++i) {
                const uint32_t v = matte.vertices[i];
                const double l = lit[i][int(c)], y = matte.radiance[i][int(c)], albedo = std::exp(double(logAlbedo[v][int(c)]));
                const double s2 = std::pow(double(matte.sigma[i][int(c)]), 2) + std::pow(albedo * double(litSigma[i][int(c)]), 2) + 1e-30;
                if (!(l > 0)) continue;
                const double model = albedo * l;
                const double p = model * model / s2;
                const double step = y > 0.2 * model && y < 5 * model ? std::log(y / model) : std::clamp(y / model - 1, -1.0, 2.0);
                diagonal[v] += p;
                rhs(Eigen::Index(v)) += p * (double(logAlbedo[v][int(c)]) + step);
                own[v][c] = float(p / diagonal[v]);
            }
            for (size_t v = 0; v < n; ++v) triplets.emplace_back(int(v), int(v), diagonal[v]);
            Sparse matrix{Eigen::Index(n), Eigen::Index(n)};
            matrix.setFromTriplets(triplets.begin(), triplets.end());
            if (!analysed[c]) factors[c].analyzePattern(matrix);
            analysed[c] = true;
            factors[c].factorize(matrix);
            if (factors[c].info() != Eigen::Success) return;
            const Eigen::VectorXd solution = factors[c].solve(rhs);
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
