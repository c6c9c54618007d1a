// Lighting programs for the race: x'Qx - 2 c'x over x >= 0, from the forward model on a made world under a sky with a
// sun and emitters.
#pragma once
#include <string>

#include "bench/bench_world.h"
#include "solve/light/weighted_gram.h"
#include "solve/priors/light_prior.h"
#include "solve/ratio/albedo_free.h"
#include "transport/incident.h"

namespace relamp::bench {

struct RaceProblem {
    std::string name;
    Eigen::MatrixXd q;
    Eigen::VectorXd c;
    double constant = 0;  ///< so that objective() is the misfit itself, not negative
    double objective(const Eigen::VectorXd& x) const { return x.dot(q * x) - 2 * c.dot(x) + constant; }
};

/// `level`: 4, 5, 6 for 256, 1024, 4096 leaves; three emitters beside. `stiff`: almost no prior, emitters of 1 : 1000 :
/// 1e6, dark albedos weighted as exactly as bright ones.
inline RaceProblem makeRaceProblem(int level, bool stiff) {
    Progress progress;
    const World world = makeWorld(level < 6 ? 4000 : 7000, false);
    const Scene& scene = *world.scene;
    VisibilityOptions visibilityOptions;
    visibilityOptions.gridSide = 64;
    const Visibility visibility = computeVisibility(scene, visibilityOptions, progress);
    // The made world has one emitter; its column stands for three at different places by three vertices' shadows.
    const NearField nearField = computeNearField(scene, world.estimate->emitters, {}, progress);
    const LightLeaves leaves = LightLeaves::uniform(level);
    std::vector<uint32_t> vertices;
    for (uint32_t v = 0; v < scene.mesh.vertexCount(); ++v)
        if (world.estimate->emitters.emitterOfVertex[v] < 0) vertices.push_back(v);
    const InfluenceMatrix one = lambertInfluence(scene, visibility, nearField, leaves, vertices, progress);
    const size_t n = leaves.size() + 3, rows = one.rows;
    InfluenceMatrix b{rows, n, std::vector<float>(rows * n)};
    for (size_t r = 0; r < rows; ++r) {
        std::copy(one.row(r), one.row(r) + leaves.size(), b.row(r));
        const Vec3 p = scene.mesh.positions[vertices[r]];
        for (int k = 0; k < 3; ++k)
            b.row(r)[leaves.size() + size_t(k)] =
                one.row(r)[leaves.size()] * (0.5f + 0.5f * std::sin(float(k + 1) * p.x + float(k) * p.y));
    }
    // Truth, then what photographs say of it with 1 % noise.
    Eigen::VectorXd truth = Eigen::VectorXd::Zero(Eigen::Index(n));
    const DirectionGrid fine{256};
    std::vector<int> cells(leaves.size(), 0);
    for (int cell = 0; cell < fine.cells(); ++cell) {
        const size_t leaf = leaves.leafOf(fine.direction(cell));
        truth(Eigen::Index(leaf)) += world.estimate->environment[size_t(cell)].y;
        ++cells[leaf];
    }
    for (size_t i = 0; i < leaves.size(); ++i) truth(Eigen::Index(i)) /= std::max(1, cells[i]);
    for (int k = 0; k < 3; ++k) truth(Eigen::Index(leaves.size()) + k) = stiff ? 36 * std::pow(1e-3, k) : 20 + 8 * k;
    const Eigen::Map<const Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>> matrix(
        b.values.data(), Eigen::Index(rows), Eigen::Index(n));
    const Eigen::VectorXd clean = matrix.cast<double>() * truth;
    std::vector<float> weight(rows);
    Eigen::VectorXd moment = Eigen::VectorXd::Zero(Eigen::Index(n));
    RaceProblem p;
    for (size_t r = 0; r < rows; ++r) {
        const float noise =
            2 * unitFloat(mixBits(r * 3)) + 2 * unitFloat(mixBits(r * 3 + 1)) - 2;  // standard deviation 0.82
        const double y = clean(Eigen::Index(r)) * (1 + 0.012 * double(noise)),
                     sigma = 0.01 * y + (stiff ? 1e-6 : 1e-2 * clean.mean());
        weight[r] = float(1 / (sigma * sigma));
        moment += (double(weight[r]) * y) * matrix.row(Eigen::Index(r)).cast<double>().transpose();
        p.constant += double(weight[r]) * y * y;
    }
    p.name = std::string(stiff ? "stiff" : "plain") + ", " + std::to_string(leaves.size()) + " leaves";
    p.q = weightedGram(
        b,
        [&](size_t r, float* out) {
            for (size_t k = 0; k < n; ++k) out[k] = weight[r] * b.row(r)[k];
        },
        progress);
    p.c = moment;
    LightAnchors anchors;
    anchors.leaves.resize(leaves.size());
    anchors.emitterRadiance.assign(3, Rgb(0));
    anchors.emitterSigma.assign(3, 1.0f);
    anchors.emitterClipped.assign(3, 1);
    LightPriorOptions options;
    options.smoothness *= stiff ? 1e-4f : 1.0f;
    const LightPrior prior(leaves, anchors, options);
    Eigen::VectorXd lower = Eigen::VectorXd::Zero(Eigen::Index(n)), priorMoment = lower;
    Eigen::MatrixXd priorQ = Eigen::MatrixXd::Zero(Eigen::Index(n), Eigen::Index(n));
    prior.add(truth, 0, priorQ, priorMoment, lower);
    p.constant += prior.value(truth, 0) - truth.dot(priorQ * truth) + 2 * priorMoment.dot(truth);
    p.q += priorQ;
    p.c += priorMoment;
    return p;
}

}  // namespace relamp::bench
