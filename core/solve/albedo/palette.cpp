#include "solve/albedo/palette.h"

#include <numeric>

#include "base/parallel.h"

namespace relamp {
namespace {
constexpr float reach = 0.15f;  // difference in log albedo beyond which a point speaks for another material

Rgb logOf(const Rgb& albedo) { return glm::log(glm::clamp(albedo, Rgb(1e-4f), Rgb(20))); }
float squareOf(const Rgb& d) { return glm::dot(d, d) / 3; }
}  // namespace

Palette findPalette(const std::vector<Rgb>& albedo, const std::vector<float>& weight, size_t count) {
    Palette palette;
    palette.nearest = albedo;
    std::vector<size_t> used;
    for (size_t v = 0; v < albedo.size(); ++v)
        if (weight[v] > 0) used.push_back(v);
    if (used.empty() || count == 0) return palette;
    std::vector<Rgb> points(used.size()), centres;
    for (size_t i = 0; i < used.size(); ++i) points[i] = logOf(albedo[used[i]]);
    // Each new centre where the most weight stands unexplained, so that single strange points do not become materials.
    DVec3 mean(0);
    double total = 0;
    for (size_t i = 0; i < points.size(); ++i) {
        mean += double(weight[used[i]]) * DVec3(points[i]);
        total += double(weight[used[i]]);
    }
    centres.push_back(Rgb(mean / total));
    std::vector<float> far(points.size());
    std::vector<uint32_t> of(points.size(), 0);
    std::vector<double> counted;
    const auto assign = [&] {
        parallelFor(points.size(), 1024, [&](size_t i) {
            far[i] = std::numeric_limits<float>::max();
            for (uint32_t k = 0; k < centres.size(); ++k)
                if (const float d = squareOf(points[i] - centres[k]); d < far[i]) {
                    far[i] = d;
                    of[i] = k;
                }
        });
    };
    const auto settle = [&](int rounds) {
        for (int round = 0; round < rounds; ++round) {
            assign();
            std::vector<DVec3> sum(centres.size(), DVec3(0));
            std::vector<double> pull(centres.size(), 0);
            counted.assign(centres.size(), 0);
            for (size_t i = 0; i < points.size(); ++i) {
                const double w = double(weight[used[i]]) / (1 + double(far[i]) / (reach * reach));
                sum[of[i]] += w * DVec3(points[i]);
                pull[of[i]] += w;
                counted[of[i]] += double(weight[used[i]]);
            }
            for (size_t k = 0; k < centres.size(); ++k)
                if (pull[k] > 0) centres[k] = Rgb(sum[k] / pull[k]);
        }
    };
    settle(5);
    while (centres.size() < count) {
        // The neighbourhood of the unexplained point that the most unexplained weight lies in, among some.
        std::vector<size_t> candidates;
        for (size_t i = 0; i < points.size(); i += std::max<size_t>(1, points.size() / 256))
            if (far[i] > reach * reach) candidates.push_back(i);
        std::vector<double> gathered(candidates.size(), 0);
        parallelFor(candidates.size(), 4, [&](size_t c) {
            for (size_t i = 0; i < points.size(); ++i)
                if (far[i] > reach * reach && squareOf(points[i] - points[candidates[c]]) < reach * reach)
                    gathered[c] += double(weight[used[i]]);
        });
        const auto best = std::max_element(gathered.begin(), gathered.end());
        if (best == gathered.end() || *best < 1e-3 * total) break;
        centres.push_back(points[candidates[size_t(best - gathered.begin())]]);
        settle(5);
    }
    settle(5);
    assign();
    std::vector<size_t> order(centres.size());
    std::iota(order.begin(), order.end(), size_t(0));
    std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) { return counted[a] > counted[b]; });
    for (const size_t k : order)
        if (counted[k] > 0) palette.colours.push_back({glm::exp(centres[k]), float(counted[k] / total)});
    for (size_t v = 0; v < albedo.size(); ++v) {
        float nearest = std::numeric_limits<float>::max();
        for (const Rgb& centre : centres)
            if (const float d = squareOf(logOf(albedo[v]) - centre); d < nearest) {
                nearest = d;
                palette.nearest[v] = glm::exp(centre);
            }
    }
    return palette;
}

AlbedoResult solveAlbedoWithPalette(const Scene& scene, const MatteObservations& matte, const std::vector<Rgb>& lit,
                                    const std::vector<Rgb>& litSigma, const AlbedoPrior& prior, size_t count,
                                    AlbedoResult first, Palette& palette, Progress& progress) {
    for (int round = 0; round < 3; ++round) {
        palette = findPalette(first.albedo, first.confidence, count);
        AlbedoPrior drawn = prior;
        drawn.towards = &palette.nearest;
        first = solveAlbedo(scene, matte, lit, litSigma, drawn, progress);
    }
    return first;
}

}  // namespace relamp
