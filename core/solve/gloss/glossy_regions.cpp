#include "solve/gloss/glossy_regions.h"

#include <array>

#include "base/minimum_cut.h"
#include "base/random.h"
#include "base/statistics.h"
#include "scene/surface_cells.h"
#include "solve/gloss/arriving_light.h"

namespace relamp {
namespace {

constexpr size_t leastOfComponent = 300;  // vertices
constexpr float changingVariance = 2;     // between observations, over that of noise

/// Variance between the observations of a vertex over that of noise; 0 with one.
float viewVariance(const RadianceSamples& samples, uint32_t v) {
    double sum = 0, squares = 0, weight = 0;
    int count = 0;
    for (uint32_t s = samples.start[v]; s < samples.start[v + 1]; ++s) {
        const RadianceSample& r = samples.samples[s];
        if (r.clipped || r.weight < 0.25f) continue;
        const double y = double(luminance(r.radiance)), noise = double(samples.sigma(float(y))),
                     w = 1 / (noise * noise / double(r.weight) + 9e-4 * y * y + 1e-30);
        sum += w * y;
        squares += w * y * y;
        weight += w;
        ++count;
    }
    if (count < 2) return 0;
    return float(std::max(0.0, squares - sum * sum / weight) / (count - 1));
}

/// Observations of all vertices of cells that change with the view, and of every eighth elsewhere.
class CellObservations {
public:
    CellObservations(const Capture& capture, const Scene& scene, const RadianceSamples& samples,
                     const SurfaceCells& cells, size_t most)
        : varianceOf(cells.count, 1) {
        std::vector<float> variance(scene.mesh.vertexCount(), 0);
        std::vector<std::vector<float>> ofCell(cells.count);
        for (uint32_t v = 0; v < variance.size(); ++v) {
            if (cells.cellOf[v] == noCell || samples.countOf(v) < 2) continue;
            variance[v] = viewVariance(samples, v);
            ofCell[cells.cellOf[v]].push_back(variance[v]);
        }
        std::vector<uint8_t> whole(cells.count, 0);
        double wanted = 0;
        for (uint32_t c = 0; c < cells.count; ++c) {
            whole[c] = quantileOf(ofCell[c], 0.75) > changingVariance;
            changing += whole[c];
            varianceOf[c] = std::max(1.0f, medianOf(std::move(ofCell[c])));
        }
        const auto usable = [&](uint32_t v) { return cells.cellOf[v] != noCell && samples.countOf(v) >= 2; };
        for (uint32_t v = 0; v < variance.size(); ++v)
            if (usable(v)) wanted += double(samples.countOf(v)) / (whole[cells.cellOf[v]] ? 1 : 8);
        const float part = float(std::min(1.0, double(most) / std::max(1.0, wanted)));
        for (uint32_t v = 0; v < variance.size(); ++v)
            if (usable(v) && unitFloat(mixBits(scene.rank[v])) < part * (whole[cells.cellOf[v]] ? 1 : 0.125f))
                addObservations(capture, scene, samples, v, observations);
    }
    std::vector<GlossyObservation> observations;
    std::vector<float> varianceOf;  ///< per cell, at least 1
    size_t changing = 0;            ///< cells that do with the view
};

/// What the observations of a cell say of a lobe of weight w, beside free Lambert parts: w b - w^2 a / 2.
struct CellStatistics {
    double a = 0, b = 0;
};

/// Sums over the vertices of each cell and each lobe. Vertices that change more than their cell's do count less.
std::vector<std::vector<CellStatistics>> statisticsOf(const CellObservations& seen, const SurfaceCells& cells,
                                                      const std::vector<std::vector<Rgb>>& responses) {
    std::vector<std::vector<CellStatistics>> sums(cells.count, std::vector<CellStatistics>(responses.size()));
    const std::vector<GlossyObservation>& all = seen.observations;
    for (size_t begin = 0, end = 0; begin < all.size(); begin = end) {
        while (end < all.size() && all[end].sharesMatte(all[begin])) ++end;
        if (end - begin < 2) continue;
        const auto weightOf = [&](size_t i) { return 1 / (double(all[i].sigma) * double(all[i].sigma)); };
        const auto meanOf = [&](const auto& value) {
            glm::dvec3 sum(0);
            double weight = 0;
            for (size_t i = begin; i < end; ++i) {
                sum += weightOf(i) * glm::dvec3(value(i));
                weight += weightOf(i);
            }
            return sum / weight;
        };
        const glm::dvec3 middle = meanOf([&](size_t i) { return all[i].radiance; });
        double change = 0;
        for (size_t i = begin; i < end; ++i) {
            const glm::dvec3 y = glm::dvec3(all[i].radiance) - middle;
            change += weightOf(i) * glm::dot(y, y) / 3;
        }
        const uint32_t cell = cells.cellOf[all[begin].vertex];
        const double counts = 1 / std::max(double(seen.varianceOf[cell]), change / double(end - begin - 1));
        for (size_t k = 1; k < responses.size(); ++k) {
            const glm::dvec3 mean = meanOf([&](size_t i) { return responses[k][i]; });
            for (size_t i = begin; i < end; ++i) {
                const glm::dvec3 r = glm::dvec3(responses[k][i]) - mean, y = glm::dvec3(all[i].radiance) - middle;
                sums[cell][k].a += counts * weightOf(i) * glm::dot(r, r) / 3;
                sums[cell][k].b += counts * weightOf(i) * glm::dot(r, y) / 3;
            }
        }
    }
    return sums;
}

/// Logarithm of the likelihood with a lobe over that without: the mean over widths and over weights, which may be from
/// a fifth to 1.6 of a glass's, times `sign`.
double evidenceOf(const std::vector<CellStatistics>& lobes, double sign, double worst) {
    constexpr std::array<double, 4> weights{0.2, 0.4, 0.8, 1.6};
    std::vector<double> logs;
    for (size_t k = 1; k < lobes.size(); ++k)
        for (const double w : weights) logs.push_back(sign * w * lobes[k].b - w * w * lobes[k].a / 2);
    const double most = *std::max_element(logs.begin(), logs.end());
    double sum = 0;
    for (const double l : logs) sum += std::exp(l - most);
    return std::max(-worst, most + std::log(sum / double(logs.size())));
}

/// Cells that are joined through cells with the same label: the first of them.
std::vector<uint32_t> joinedCells(const SurfaceCells& cells, const std::vector<uint8_t>& label) {
    std::vector<uint32_t> first(cells.count);
    for (uint32_t c = 0; c < cells.count; ++c) first[c] = c;
    const auto root = [&](uint32_t c) {
        while (first[c] != c) c = first[c] = first[first[c]];
        return c;
    };
    for (const CellBorder& border : cells.borders) {
        if (label[border.a] != label[border.b]) continue;
        const uint32_t a = root(border.a), b = root(border.b);
        first[std::max(a, b)] = std::min(a, b);
    }
    for (uint32_t c = 0; c < cells.count; ++c) first[c] = root(c);
    return first;
}

/// What changes with the view as lobes of weights of this sign do, by the minimum cut: a region for each set of joined
/// cells, in the order of vertices.
std::vector<GlossyRegion> regionsOf(const Scene& scene, const SurfaceCells& cells,
                                    const std::vector<std::vector<CellStatistics>>& statistics, double sign,
                                    const GlossyRegionOptions& options) {
    std::vector<double> evidence(cells.count);
    for (uint32_t c = 0; c < cells.count; ++c) evidence[c] = evidenceOf(statistics[c], sign, options.worstCell);
    std::vector<CutEdge> edges;
    for (const CellBorder& b : cells.borders) edges.push_back({b.a, b.b, options.parting * b.alike});
    const std::vector<uint8_t> glossy = minimumCut(evidence, edges);
    const std::vector<uint32_t> first = joinedCells(cells, glossy);
    std::vector<GlossyRegion> all(cells.count);
    for (uint32_t v = 0; v < cells.cellOf.size(); ++v)
        if (const uint32_t c = cells.cellOf[v]; c != noCell && glossy[c]) {
            all[first[c]].vertices.push_back(v);
            all[first[c]].component = scene.component[v];
        }
    for (uint32_t c = 0; c < cells.count; ++c)
        if (glossy[c]) all[first[c]].evidence += evidence[c];
    std::erase_if(all, [](const GlossyRegion& region) { return region.vertices.empty(); });
    return all;
}

std::vector<size_t> verticesOfComponents(const Scene& scene, const std::vector<uint8_t>& skip) {
    std::vector<size_t> counts(scene.components, 0);
    for (uint32_t v = 0; v < skip.size(); ++v) counts[scene.component[v]] += !skip[v] && scene.referenced[v];
    return counts;
}

/// Emitters, and components too small to have parts.
std::vector<uint8_t> withoutParts(const Scene& scene, const std::vector<uint8_t>& skip) {
    const std::vector<size_t> counts = verticesOfComponents(scene, skip);
    std::vector<uint8_t> without = skip;
    for (uint32_t v = 0; v < without.size(); ++v)
        without[v] = without[v] || counts[scene.component[v]] < leastOfComponent;
    return without;
}

}  // namespace

bool mayHaveParts(const Scene& scene, const RadianceSamples& samples, const std::vector<uint8_t>& skip, bool exact) {
    const std::vector<uint8_t> without = withoutParts(scene, skip);
    std::vector<size_t> changing(scene.components, 0), observed(scene.components, 0);
    for (uint32_t v = 0; v < without.size(); ++v) {
        if (without[v] || samples.countOf(v) < 2) continue;
        ++observed[scene.component[v]];
        changing[scene.component[v]] += viewVariance(samples, v) > changingVariance;
    }
    for (uint32_t p = 0; p < scene.components; ++p) {
        const double share = double(changing[p]) / double(std::max<size_t>(1, observed[p]));
        if (changing[p] >= 60 && (!exact || (share > 0.03 && share < 0.6))) return true;
    }
    return false;
}

std::vector<GlossyRegion> glossyRegions(const Capture& capture, const Scene& scene, const RadianceSamples& samples,
                                        const std::vector<EmitterSurface>& emitters,
                                        const std::vector<int>& emitterOfTriangle, const MatteObservations& matte,
                                        const std::vector<uint8_t>& skip, const Lighting& lighting,
                                        const GlossyRegionOptions& options, Progress& progress) {
    std::vector<Rgb> colour(scene.mesh.vertexCount(), Rgb(0));
    for (size_t i = 0; i < matte.vertices.size(); ++i) colour[matte.vertices[i]] = matte.radiance[i];
    const std::vector<uint8_t> without = withoutParts(scene, skip);
    const SurfaceCells cells = surfaceCells(scene, colour, without, {.seed = options.seed});
    const CellObservations seen(capture, scene, samples, cells, options.mostObservations);
    if (seen.changing == 0) return {};
    std::vector<Lobe> lobes{Lobe{}};
    for (const Lobe& l : builtInBasis().lobes)
        if (l.kind == Lobe::Kind::ggxDielectric) lobes.push_back(l);
    LobeRowOptions rows;
    rows.seed = options.seed;
    rows.lobeSamples = 48;
    rows.cosineSamples = 24;
    rows.emitterSamples = 16;
    const auto responses =
        lobeResponses(scene, emitters, emitterOfTriangle, lighting, lobes, seen.observations, rows, progress);
    const auto statistics = statisticsOf(seen, cells, responses);
    // Errors of shape and place reach over many vertices, and may look like a lobe. They look like one of negative
    // weight, which nothing has, as often.
    double least = options.leastEvidence;
    for (const GlossyRegion& region : regionsOf(scene, cells, statistics, -1, options))
        least = std::max(least, options.overChance * region.evidence);
    std::vector<GlossyRegion> regions;
    const std::vector<size_t> ofComponent = verticesOfComponents(scene, skip);
    for (GlossyRegion& region : regionsOf(scene, cells, statistics, 1, options)) {
        if (region.vertices.size() < options.leastVertices || region.evidence < least) continue;
        region.whole = float(region.vertices.size()) > options.largestPart * float(ofComponent[region.component]);
        regions.push_back(std::move(region));
    }
    return regions;
}

}  // namespace relamp
