// How sure the light, the albedo and the environment image are.
#include "base/log.h"
#include "base/dense.h"
#include "solve/light/weighted_gram.h"
#include "solve/steps/steps.h"

namespace relamp {

void assessConditioning(SolveRun& s, Estimate& estimate) {
    // Gram of the lighting problem under the albedo found, on a spread of vertices.
    const size_t n = s.light.influence.columns, leaves = s.light.lighting.leaves.size();
    const InfluenceMatrix& rows = s.light.influence;
    Eigen::MatrixXd gram = weightedGram(
        rows,
        [&](size_t i, float* out) {
            const Rgb albedo = s.surfaces.albedo.albedo[s.observed.matte.vertices[i]],
                      sigma = s.observed.matte.sigma[i] + 0.01f * s.observed.matte.radiance[i];
            const float w = s.in.scene.rank[s.observed.matte.vertices[i]] % 4 == 0
                                ? albedo.y * albedo.y / std::max(sigma.y * sigma.y, 1e-20f)
                                : 0.0f;
            for (size_t k = 0; k < n; ++k) out[k] = w * rows.row(i)[k];
        },
        s.in.progress);
    if (!s.gloss.empty()) {
        // Glossy observations tell directions apart that matte ones cannot.
        const ViewRows glossy = viewRows(s, s.in.progress);
        gram += weightedGram(
            glossy.influence[1],
            [&](size_t i, float* out) {
                const float w = 1 / std::max(glossy.sigma[i] * glossy.sigma[i], 1e-20f);
                for (size_t k = 0; k < n; ++k) out[k] = w * glossy.influence[1].row(i)[k];
            },
            s.in.progress);
    }
    Eigen::VectorXd scale(gram.rows());
    for (Eigen::Index i = 0; i < gram.rows(); ++i) scale(i) = gram(i, i) > 0 ? 1 / std::sqrt(gram(i, i)) : 0;
    const Eigen::MatrixXd scaled = scale.asDiagonal() * gram * scale.asDiagonal();
    const Eigen::VectorXd eigenvalues = eigenOf(scaled, false).values;
    estimate.stability = s.stability;
    estimate.stability.unknowns = int(n);
    if (s.stability.kktResidual > 1e-6)
        estimate.stability.reason =
            fmt::format("a lighting program stopped at a relative KKT residual of {:.1e}", s.stability.kktResidual);
    const double largest = std::max(eigenvalues.maxCoeff(), 1e-300);
    double smallest = largest;
    for (Eigen::Index i = 0; i < gram.rows(); ++i) {
        const double value = eigenvalues(i) / largest;
        if (value > 1e-6) ++estimate.stability.effectiveRank;
        if (value > 1e-14) smallest = std::min(smallest, value * largest);
    }
    estimate.stability.conditionNumber = largest / smallest;
    const Eigen::Index step = std::max<Eigen::Index>(1, (gram.rows() + 255) / 256);
    for (Eigen::Index i = gram.rows() - 1; i >= 0; i -= step)
        estimate.stability.spectrum.push_back(float(std::max(0.0, eigenvalues(i) / largest)));
    const Eigen::Index m = Eigen::Index(leaves);
    Eigen::MatrixXd distant = scaled.topLeftCorner(m, m);
    distant.diagonal().array() += 1e-6;
    const std::optional<Eigen::MatrixXd> factor = choleskyFactor(distant);
    for (size_t e = 0; e < s.emitters.surfaces.size(); ++e) {
        const Eigen::VectorXd column = scaled.block(0, m + Eigen::Index(e), m, 1);
        const double self = scaled(m + Eigen::Index(e), m + Eigen::Index(e));
        const double imitated = self > 0 && factor ? column.dot(solveByFactor(*factor, column)) / self : 1;
        estimate.identifiability.push_back(float(std::sqrt(std::clamp(1 - imitated, 0.0, 1.0))));
        estimate.emitterSigma.push_back(s.light.lighting.emitterRadiance[e] *
                                        (s.emitters.clusters.emitters[e].unobserved ? 1.0f
                                         : s.light.anchors.emitterClipped[e]        ? 0.5f
                                                                                    : s.light.anchors.emitterSigma[e]));
    }
}

LightUncertainty uncertaintyOf(const SolveRun& s, const Irradiance& irradiance, bool scaleOnly) {
    UncertaintyOptions options;
    options.bounced = s.bounce.joined();
    options.scaleOnly = scaleOnly;
    options.backdrop = !tiesScale(s.light.anchors, s.light.prior.darkness);
    if (!s.light.anchors.probes.empty()) options.probes = probeInformation(s);
    options.patches = s.patchPart;
    std::vector<std::string> names;
    for (const EmitterCluster& e : s.emitters.clusters.emitters) names.push_back(e.id);
    LightUncertainty light = lightUncertainty(s.light.information, s.light.influence, irradiance.value,
                                              s.light.lighting, names, options, s.in.progress);
    logInfo("scale known to {:.1f} {:.1f} {:.1f} %", 100 * light.scaleSigma.x, 100 * light.scaleSigma.y,
            100 * light.scaleSigma.z);
    if (!scaleOnly && !light.weakest.empty())
        logInfo("least known: {} ({:.1f} %)", light.weakest, 100 * light.weakestSigma);
    return light;
}

void assessUncertainty(const SolveRun& s, const Irradiance& irradiance, const LightUncertainty& light,
                       Estimate& estimate) {
    estimate.stability.weakest = light.weakest;
    estimate.stability.weakestSigma = light.weakestSigma;
    if (!(light.scaleSigma.y > 0)) return;
    // Albedo: the light on the vertex, its own observations, and what its neighbours tell of it where those are weak or
    // there are none.
    constexpr float fromNeighbours = 0.06f, unobserved = 0.15f, background = 0.02f, most = 10;
    double mean = 0;
    for (const Rgb& known : light.litSigma) mean += double(known.x + known.y + known.z) / 3;
    const float typical = light.litSigma.empty() ? 0.0f : float(mean / double(light.litSigma.size()));
    std::vector<float>& sigma = estimate.reflectance.sigma;
    sigma.assign(s.in.scene.mesh.vertexCount(), std::hypot(typical, unobserved));
    for (size_t i = 0; i < s.observed.matte.vertices.size(); ++i) {
        const uint32_t v = s.observed.matte.vertices[i];
        const float own = s.surfaces.albedo.confidence[v];
        float sum = 0;
        for (int c = 0; c < 3; ++c) {
            // Bounded, because nothing times infinity is not a number.
            const float observation = std::min(
                            most, s.observed.matte.sigma[i][c] / std::max(s.observed.matte.radiance[i][c], 1e-20f)),
                        edge = std::min(most, irradiance.sigma[i][c] / std::max(irradiance.value[i][c], 1e-20f));
            const float variance = light.litSigma[i][c] * light.litSigma[i][c] +
                                   own * (observation * observation + edge * edge) +
                                   (1 - own) * fromNeighbours * fromNeighbours;
            sum += std::min(std::sqrt(variance), most);
        }
        sigma[v] = sum / 3;
    }
    for (size_t e = 0; e < s.emitters.clusters.emitters.size(); ++e)
        if (s.emitters.clusters.emitters[e].unobserved && e < light.emitterSigma.size())
            estimate.emitterSigma[e] = estimate.lighting.emitterRadiance[e] * light.emitterSigma[e];
    const DirectionGrid fine{estimate.environmentSide};
    const std::vector<size_t> order = environmentsInOrder(s);
    for (size_t k = 0; k < order.size(); ++k) {
        const std::vector<uint32_t> leafOf = s.light.lighting.leaves.leafOfCells(fine, order[k]);
        const std::vector<Rgb>& cells = k == 0 ? estimate.environment : estimate.otherEnvironments[k - 1].environment;
        std::vector<Rgb>& deviations = k == 0 ? estimate.environmentSigma : estimate.otherEnvironments[k - 1].sigma;
        deviations.resize(cells.size());
        for (size_t c = 0; c < cells.size(); ++c) {
            const uint32_t leaf = leafOf[c];
            const Rgb relative =
                backgroundAt(s, fine, order[k], int(c), leaf) ? Rgb(background) : light.leafSigma[leaf];
            deviations[c] = relative * cells[c];
        }
    }
}

}  // namespace relamp
