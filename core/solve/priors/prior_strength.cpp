#include "solve/priors/prior_strength.h"

#include <Eigen/SparseCholesky>

#include "base/parallel.h"
#include "base/random.h"
#include "solve/albedo/albedo_system.h"

namespace relamp {
namespace {

constexpr size_t blockCount = 8;

/// A block for each position: cells of a twelfth of the extent are shared out at random.
std::vector<uint32_t> blocksOf(const std::vector<Vec3>& positions, size_t blocks, uint64_t seed) {
    Vec3 low(1e30f), high(-1e30f);
    for (const Vec3& p : positions) {
        low = glm::min(low, p);
        high = glm::max(high, p);
    }
    const float cell = std::max({high.x - low.x, high.y - low.y, high.z - low.z, 1e-30f}) / 12;
    std::vector<uint32_t> block(positions.size());
    for (size_t i = 0; i < positions.size(); ++i) {
        uint64_t key = seed;
        for (int k = 0; k < 3; ++k) key = mixBits(key ^ uint64_t(std::floor((positions[i][k] - low[k]) / cell)));
        block[i] = uint32_t(key % blocks);
    }
    return block;
}

/// The observations for which `take` says so, and the pairs among them.
struct PartOfPairs {
    InfluenceMatrix influence;
    MatteObservations matte;
    std::vector<AlbedoPair> pairs;
    std::vector<Rgb> bounce;

    template <class Take>
    PartOfPairs(const InfluenceMatrix& all, const MatteObservations& observations,
                const std::vector<AlbedoPair>& allPairs, const std::vector<Rgb>* bounces, Take&& take) {
        std::vector<uint32_t> at(all.rows, ~0u);
        influence.columns = all.columns;
        for (size_t i = 0; i < all.rows; ++i) {
            if (!take(i)) continue;
            at[i] = uint32_t(influence.rows++);
            influence.values.insert(influence.values.end(), all.row(i), all.row(i) + all.columns);
            matte.vertices.push_back(observations.vertices[i]);
            matte.radiance.push_back(observations.radiance[i]);
            matte.sigma.push_back(observations.sigma[i]);
            if (bounces) bounce.push_back((*bounces)[i]);
        }
        for (const AlbedoPair& p : allPairs)
            if (at[p.a] != ~0u && at[p.b] != ~0u) pairs.push_back({at[p.a], at[p.b], p.weight});
    }
};

}  // namespace

PriorStrength chooseStrength(const std::vector<std::vector<double>>& misfits) {
    PriorStrength result;
    const std::vector<float>& factors = strengthsTried();
    const size_t usual = size_t(std::find(factors.begin(), factors.end(), 1.0f) - factors.begin()),
                 blocks = misfits[usual].size();
    double whole = 0;
    for (const double m : misfits[usual]) whole += m;
    if (blocks < 2 || !(whole > 0)) return result;
    // Eight blocks and two factors to try: two errors would be wrong by chance once in twelve captures.
    constexpr double surely = 3;
    double best = 1;
    for (size_t k = 0; k < factors.size(); ++k) {
        double mean = 0, squares = 0;
        for (size_t b = 0; b < blocks; ++b) mean += (misfits[k][b] - misfits[usual][b]) / double(blocks);
        for (size_t b = 0; b < blocks; ++b) squares += std::pow(misfits[k][b] - misfits[usual][b] - mean, 2);
        const double n = double(blocks), ratio = 1 + mean * n / whole,
                     error = std::sqrt(squares / (n - 1) / n) * n / whole;
        result.trials.push_back({factors[k], ratio, error});
        if (!(ratio < best) || ratio + surely * error >= 1) continue;
        best = ratio;
        result.factor = factors[k];
        result.chosenBy = "photographs";
    }
    return result;
}

PriorStrength testLightStrength(const InfluenceMatrix& influence, const MatteObservations& matte,
                                const std::vector<AlbedoPair>& pairs, const std::vector<Vec3>& positions,
                                const LightAnchors& anchors, const AlbedoFreeOptions& options, const Lighting& lighting,
                                size_t maxRows, Progress& progress) {
    const size_t thinning = std::max<size_t>(1, influence.rows / std::max<size_t>(1, maxRows));
    const std::vector<uint32_t> block = blocksOf(positions, 2 * blockCount * thinning, 0x5eed);
    const PartOfPairs heard(influence, matte, pairs, options.bounce,
                            [&](size_t i) { return block[i] >= blockCount && block[i] < 2 * blockCount; });
    std::vector<PartOfPairs> left;
    for (uint32_t b = 0; b < blockCount; ++b) {
        PartOfPairs part(influence, matte, pairs, options.bounce, [&](size_t i) { return block[i] == b; });
        if (part.pairs.size() > 20) left.push_back(std::move(part));
    }
    if (heard.pairs.size() < 200) return {};
    std::vector<std::vector<double>> misfits;
    // The same fraction of chroma for all: what is predicted is held against one measure.
    Lighting present = lighting;
    AlbedoFreeOptions measure = options;
    measure.iterations = 0;
    measure.bounce = options.bounce ? &heard.bounce : nullptr;
    const ChromaFraction chroma =
        solveAlbedoFree(heard.influence, heard.matte, heard.pairs, anchors, nullptr, measure, present, progress, {})
            .chroma;
    for (const float factor : strengthsTried()) {
        AlbedoFreeOptions fit = options;
        fit.iterations = 2;
        fit.anneal = false;
        fit.chroma = chroma;
        fit.bounce = options.bounce ? &heard.bounce : nullptr;
        fit.light.smoothness *= factor;
        Lighting light = lighting;
        solveAlbedoFree(heard.influence, heard.matte, heard.pairs, anchors, nullptr, fit, light, progress, {});
        AlbedoFreeOptions ask = fit;
        ask.iterations = 0;
        ask.light.smoothness = ask.light.backgroundWeight = 0;
        misfits.emplace_back();
        for (const PartOfPairs& part : left) {
            ask.bounce = options.bounce ? &part.bounce : nullptr;
            misfits.back().push_back(
                solveAlbedoFree(part.influence, part.matte, part.pairs, anchors, nullptr, ask, light, progress, {})
                    .objective);
        }
    }
    return chooseStrength(misfits);
}

PriorStrength testAlbedoStrength(const Scene& scene, const RadianceSamples& samples, const MatteObservations& matte,
                                 const std::vector<Rgb>& lit, const std::vector<Rgb>& litSigma,
                                 const AlbedoPrior& prior, const std::vector<Rgb>& albedo, uint64_t seed,
                                 Progress& progress) {
    constexpr int channel = 1, probes = 6;
    const size_t n = scene.mesh.vertexCount();
    std::vector<Rgb> logAlbedo(n);
    for (size_t v = 0; v < n; ++v) logAlbedo[v] = glm::log(glm::max(albedo[v], Rgb(1e-4f)));
    std::vector<Vec3> positions(matte.vertices.size());
    for (size_t i = 0; i < positions.size(); ++i) positions[i] = scene.mesh.positions[matte.vertices[i]] * scene.axes;
    const std::vector<uint32_t> block = blocksOf(positions, blockCount, 0x5eed);
    std::vector<std::vector<double>> misfits(strengthsTried().size(), std::vector<double>(blockCount, 0));
    parallelFor(strengthsTried().size(), 1, [&](size_t k) {
        AlbedoPrior stronger = prior;
        stronger.step = prior.step / std::sqrt(strengthsTried()[k]);
        const AlbedoSystem system =
            albedoSystem(scene, matte, lit, litSigma, stronger, logAlbedo, double(prior.edge), std::log(0.5));
        const auto ofChannel = [](const ChannelValues& value) { return value[channel]; };
        const Eigen::SparseMatrix<double> matrix = system.matrix.unaryExpr(ofChannel);
        const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor(matrix);
        if (factor.info() != Eigen::Success) return;
        progress.check();
        const Eigen::VectorXd x = factor.solve(system.moment.unaryExpr(ofChannel));
        Eigen::VectorXd inverse = Eigen::VectorXd::Zero(Eigen::Index(n)), z{Eigen::Index(n)};
        for (int probe = 0; probe < probes; ++probe) {
            for (size_t v = 0; v < n; ++v)
                z(Eigen::Index(v)) = mixBits(mixBits(seed + uint64_t(probe)) ^ scene.rank[v]) & 1 ? 1.0 : -1.0;
            inverse += z.cwiseProduct(factor.solve(z)) / probes;
            progress.check();
        }
        for (size_t i = 0; i < matte.vertices.size(); ++i) {
            const uint32_t v = matte.vertices[i];
            const double precision = system.precision[i][channel];
            if (matte.componentGlossy[scene.material[v]] || !(precision > 0)) continue;
            const size_t state = matte.stateOf(i);
            const auto counts = [&](const RadianceSample& r) { return !r.clipped && samples.stateOf(r.view) == state; };
            float weights = 0;
            for (uint32_t s = samples.start[v]; s < samples.start[v + 1]; ++s)
                weights += counts(samples.samples[s]) ? samples.samples[s].weight : 0;
            const double diagonal = matrix.coeff(int(v), int(v)),
                         whole = std::clamp(precision * inverse(Eigen::Index(v)), precision / diagonal, 0.98);
            for (uint32_t s = samples.start[v]; s < samples.start[v + 1]; ++s) {
                const RadianceSample& r = samples.samples[s];
                const float y = r.radiance[channel];
                if (!counts(r) || !(y > 0)) continue;
                const double fraction = double(r.weight / weights) * whole,
                             residual = (std::log(double(y) / lit[i][channel]) - x(Eigen::Index(v))) / (1 - fraction);
                const double sigma2 = std::pow(double(samples.sigma(y) / y), 2) / double(r.weight) + 4e-4 +
                                      std::pow(double(litSigma[i][channel] / lit[i][channel]), 2);
                misfits[k][block[i]] += std::log1p(residual * residual / (9 * sigma2));
            }
        }
    });
    return chooseStrength(misfits);
}

}  // namespace relamp
