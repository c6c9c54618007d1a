#include "solve/work_samples.h"

#include "base/random.h"
#include "solve/albedo/albedo_step.h"
#include "solve/light/qp.h"
#include "solve/ratio/pair_gram.h"

namespace relamp {
namespace {

InfluenceMatrix madeUp(size_t rows, size_t columns) {
    InfluenceMatrix m;
    m.rows = rows;
    m.columns = columns;
    m.values.assign(rows * columns, 1.0f / float(columns));
    return m;
}

}  // namespace

void sampleGram(size_t rows, size_t columns, Progress& progress) {
    const InfluenceMatrix m = madeUp(rows, columns);
    constexpr size_t partners = 13;
    ChannelWeights weights;
    for (size_t i = 0; i <= rows; ++i) weights.start.push_back(uint32_t(i * partners));
    for (size_t i = 0; i < rows; ++i)
        for (size_t k = 0; k < partners; ++k) weights.other.push_back(uint32_t((i + k * 37) % rows));
    weights.weight.assign(weights.other.size(), {0.1f, 0.1f, 0.1f, 0.05f, 0.05f, 0.05f});
    channelGram(m, weights, false, progress);
}

void sampleProgram(size_t columns, Progress& progress) {
    const Eigen::Index n = Eigen::Index(columns);
    Eigen::MatrixXd q = Eigen::MatrixXd::Zero(n, n);
    Eigen::VectorXd c(n);
    for (Eigen::Index i = 0; i < n; ++i) {
        for (Eigen::Index j = 0; j < n; ++j) q(i, j) = std::exp(-0.1 * std::abs(double(i - j)));
        c(i) = i % 5 ? 1 + 0.1 * double(i % 7) : -1;
    }
    solveBoundedQp(q, c, Eigen::VectorXd::Zero(n), nullptr, {&progress});
}

void sampleAlbedo(int side, Progress& progress) {
    Scene scene;
    const uint32_t n = uint32_t(side) * uint32_t(side), s = uint32_t(side);
    scene.mesh.positions.assign(n, Vec3(0));
    scene.graph.start.push_back(0);
    MatteObservations matte;
    std::vector<Rgb> lit, sigma;
    for (uint32_t v = 0; v < n; ++v) {
        const uint32_t x = v % s, y = v / s;
        // Six neighbours, as on a mesh of triangles.
        if (y > 0) scene.graph.to.push_back(v - s);
        if (y > 0 && x + 1 < s) scene.graph.to.push_back(v - s + 1);
        if (x > 0) scene.graph.to.push_back(v - 1);
        if (x + 1 < s) scene.graph.to.push_back(v + 1);
        if (y + 1 < s && x > 0) scene.graph.to.push_back(v + s - 1);
        if (y + 1 < s) scene.graph.to.push_back(v + s);
        scene.graph.start.push_back(uint32_t(scene.graph.to.size()));
        matte.vertices.push_back(v);
        matte.radiance.push_back(Rgb(0.3f + 0.3f * unitFloat(mixBits(v))));
        matte.sigma.push_back(Rgb(0.01f));
        lit.push_back(Rgb(1));
        sigma.push_back(Rgb(0.01f));
    }
    AlbedoPrior prior;
    prior.iterations = 2;
    solveAlbedo(scene, matte, lit, sigma, prior, progress);
}

}  // namespace relamp
