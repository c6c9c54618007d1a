// A lighting problem without geometry: random positive influences, known light, known albedo.
#pragma once
#include <random>

#include "solve/ratio/albedo_free.h"

namespace relamp::test {

struct SmallProblem {
    InfluenceMatrix influence;
    MatteObservations matte;
    std::vector<AlbedoPair> pairs;
    LightAnchors anchors;
    Lighting truth, start;
    std::vector<Rgb> albedo;
};

/// `rows` vertices under 64 leaves and one emitter of radiance (20, 10, 4); albedo is constant over runs of ten
/// vertices.
inline SmallProblem smallProblem(size_t rows = 400, float noise = 0) {
    SmallProblem p;
    std::mt19937 random(5);
    std::uniform_real_distribution<float> uniform(0, 1);
    p.truth.leaves = LightLeaves::uniform(3);
    const size_t leaves = p.truth.leaves.size();
    for (size_t i = 0; i < leaves; ++i)
        p.truth.leafRadiance.push_back(Rgb(0.5f + float(i % 8) * 0.2f, 0.8f, 1.2f - float(i / 8) * 0.1f));
    p.truth.emitterRadiance.push_back({20, 10, 4});
    p.start = p.truth;
    for (Rgb& l : p.start.leafRadiance) l = Rgb(3);
    p.influence.rows = rows;
    p.influence.columns = leaves + 1;
    p.influence.values.resize(rows * p.influence.columns);
    for (size_t r = 0; r < rows; ++r) {
        for (size_t i = 0; i < leaves; ++i)
            p.influence.row(r)[i] = uniform(random) < 0.5f ? 0.0f : uniform(random) * 2 / float(leaves);
        p.influence.row(r)[leaves] = uniform(random) < 0.4f ? 0.0f : 0.1f * uniform(random);
        const float a = 0.2f + 0.6f * float((r / 10 * 7) % 10) / 10;
        p.albedo.push_back(Rgb(a, 0.8f * a, 0.5f * a));
        Rgb y(0);
        for (size_t i = 0; i < leaves; ++i) y += p.influence.row(r)[i] * p.truth.leafRadiance[i];
        y += p.influence.row(r)[leaves] * p.truth.emitterRadiance[0];
        p.matte.vertices.push_back(uint32_t(r));
        p.matte.radiance.push_back(y * p.albedo[r] * (1 + noise * (uniform(random) - 0.5f)));
        p.matte.sigma.push_back(p.matte.radiance[r] * 0.01f);
        for (size_t k = 1; k < 10 && r % 10 >= k; ++k) p.pairs.push_back({uint32_t(r - k), uint32_t(r), 0.9f});
    }
    p.anchors.leaves.resize(leaves);
    p.anchors.emitterRadiance = p.truth.emitterRadiance;
    p.anchors.emitterSigma = {1e-3f};
    p.anchors.emitterClipped = {0};
    return p;
}

/// Relative difference of the irradiance that two lightings give, worst channel.
inline double litDifference(const SmallProblem& p, const Lighting& a, const Lighting& b) {
    double worst = 0;
    for (int c = 0; c < 3; ++c) {
        double difference = 0, norm = 0;
        for (size_t r = 0; r < p.influence.rows; ++r) {
            double la = 0, lb = 0;
            for (size_t i = 0; i < a.leaves.size(); ++i) {
                la += double(p.influence.row(r)[i]) * a.leafRadiance[i][c];
                lb += double(p.influence.row(r)[i]) * b.leafRadiance[i][c];
            }
            for (size_t e = 0; e < a.emitterRadiance.size(); ++e) {
                la += double(p.influence.row(r)[a.leaves.size() + e]) * a.emitterRadiance[e][c];
                lb += double(p.influence.row(r)[a.leaves.size() + e]) * b.emitterRadiance[e][c];
            }
            difference += (la - lb) * (la - lb);
            norm += lb * lb;
        }
        worst = std::max(worst, std::sqrt(difference / norm));
    }
    return worst;
}

}  // namespace relamp::test
