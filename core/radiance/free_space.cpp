#include "radiance/free_space.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>

#include "base/parallel.h"
#include "base/statistics.h"
#include "image/direction_grid.h"
#include "radiance/agreement.h"
#include "radiance/background_cells.h"
#include "radiance/random_walker.h"
#include "scene/connected_region.h"
#include "scene/rim.h"
#include "scene/vertex_rings.h"

namespace relamp {
namespace {

constexpr float alike = 0.1f;                 ///< of log radiance: what background or surface may be off by
constexpr float explained = 0.2f;             ///< up to which the background explains a vertex
constexpr int wholeRange = 5;                 ///< cells of nine without which the background's range is not known
constexpr float bend = 0.25f;                 ///< beyond which a vertex says no more
constexpr float unknownBackground = alike;    ///< how well one that nobody saw would explain a vertex
constexpr float unknownDiffers = -alike / 2;  ///< no surface of one radiance, before a background that nobody saw
constexpr int meanRings = 3;                  ///< of neighbours that a vertex is asked with
constexpr size_t borderRings = 10;            ///< of neighbours by which the edges in the photographs may move a border
constexpr float priorWeight = 0.05f;          ///< of a vertex that is sure
constexpr float leastLikeness = 0.01f;        ///< of neighbours
constexpr size_t leastRegion = 30;            ///< vertices of a skirt
constexpr float refutedOfTelling = 0.4f;      ///< fraction of a skirt's vertices of which photographs tell anything
constexpr float refutedOfAll = 0.03f;         ///< fraction of all its vertices
constexpr size_t leastBackground = 16;        ///< cells without which nothing is said

constexpr size_t fewViews = 5;  ///< with fewer, none can be left out
const DirectionGrid backgroundGrid{256};

std::vector<BackgroundCells> shownBy(const Capture& capture, const RadianceSamples& samples) {
    std::vector<BackgroundCells> shown(capture.views.size());
    parallelFor(shown.size(), 1,
                [&](size_t i) { shown[i] = backgroundCells(capture.views[i], samples.geometry[i], backgroundGrid); });
    return shown;
}

/// What the background shows around a direction.
class Background {
public:
    static constexpr size_t none = ~size_t(0);

    /// `shown` by the views, all but one of them.
    Background(const std::vector<BackgroundCells>& shown, float floor, size_t without = none) : floor_(floor) {
        std::vector<Rgb> sum(size_t(backgroundGrid.cells()), Rgb(0));
        std::vector<uint32_t> pixels(sum.size(), 0);
        std::vector<Rgb> lowest(sum.size(), Rgb(1e30f)), highest(sum.size(), Rgb(0));  // of the views' means
        std::vector<uint8_t> views(sum.size(), 0);
        for (size_t i = 0; i < shown.size(); ++i) {
            if (i == without) continue;
            const BackgroundCells& ofView = shown[i];
            for (size_t cell = 0; cell < sum.size(); ++cell) {
                sum[cell] += ofView.sum[cell];
                pixels[cell] += ofView.pixels[cell];
                if (ofView.pixels[cell] < 4) continue;
                const Rgb mean = ofView.mean(cell);
                lowest[cell] = glm::min(lowest[cell], mean);
                highest[cell] = glm::max(highest[cell], mean);
                views[cell] = uint8_t(std::min(2, views[cell] + 1));
            }
        }
        low_.assign(sum.size(), Rgb(1e30f));
        high_.assign(sum.size(), Rgb(0));
        around_.assign(sum.size(), 0);
        for (int y = 0; y < backgroundGrid.side; ++y)
            for (int x = 0; x < backgroundGrid.side; ++x)
                for (int k = 0; k < 9; ++k) {
                    const int nx = x + k % 3 - 1, ny = y + k / 3 - 1;
                    if (nx < 0 || ny < 0 || nx >= backgroundGrid.side || ny >= backgroundGrid.side) continue;
                    const auto from = size_t(ny * backgroundGrid.side + nx), to = size_t(y * backgroundGrid.side + x);
                    if (!pixels[from]) continue;
                    const Rgb mean = sum[from] / float(pixels[from]);
                    low_[to] = glm::min(low_[to], mean);
                    high_[to] = glm::max(high_[to], mean);
                    ++around_[to];
                    if (k == 4) ++known_;
                }
        for (size_t cell = 0; cell < sum.size(); ++cell) {
            if (views[cell] < 2) continue;
            ++shared_;
            float apart = 0;
            for (int c = 0; c < 3; ++c)
                apart += std::log(std::max(highest[cell][c], floor_) / std::max(lowest[cell][c], floor_)) / 3;
            agreeing_ += apart < explained;
        }
    }

    size_t known() const { return known_; }
    /// Whether it is as far away as a background must be to show the same in one direction from everywhere.
    bool distant() const { return 3 * agreeing_ >= 2 * shared_; }

    /// How far a radiance is from what the background shows there: mean of the channels' logarithms; negative: nobody
    /// saw the background there.
    float distance(const Vec3& direction, const Rgb& radiance) const {
        const auto cell = size_t(backgroundGrid.cellOf(direction));
        return high_[cell].x >= low_[cell].x ? logDistance(radiance, low_[cell], high_[cell], floor_) : -1;
    }
    /// Whether what is known there is all that it may show.
    bool whole(const Vec3& direction) const { return around_[size_t(backgroundGrid.cellOf(direction))] >= wholeRange; }

private:
    std::vector<Rgb> low_, high_;
    std::vector<uint8_t> around_;                   ///< cells of the nine that are known
    size_t known_ = 0, shared_ = 0, agreeing_ = 0;  ///< cells: seen, seen by several views, alike to these
    float floor_ = 0;
};

/// How much better a surface explains a vertex than the background does, in log radiance: within [-bend, bend].
/// `apart`: of each photograph from the others, none of a single one. `off`: from the background, where it is known.
/// `sure`: of how many of these the background may not be as well.
float surfaceBefore(std::vector<float> apart, std::vector<float> off, size_t sure) {
    const size_t views = apart.size(), known = off.size();
    const float differs = views ? medianOf(std::move(apart)) : 0;
    float least = known ? medianOf(off) : 0;
    // A few directions in which the background seems to be something else tell nothing against those that differ.
    if (known == 0 || (least > explained && (sure == 0 || 2 * sure < views))) {
        if (differs > bend) return known ? 0 : unknownDiffers;
        if (views == 0 || differs > alike) return 0;
        return known ? bend : alike - differs;
    }
    // Prints finer than the mesh differ between views as well: the background has to explain them.
    if (least > explained) return bend;
    if (views == 0) return least < alike ? unknownDiffers : 0;
    if (known < views) {
        off.resize(views, unknownBackground);
        least = std::max(least, medianOf(std::move(off)));
    }
    return std::clamp(least - differs, -bend, bend);
}

/// Per vertex surfaceBefore; 0 where photographs tell nothing.
std::vector<float> evidenceOf(const Scene& scene, const Capture& capture, const RadianceSamples& samples,
                              const Background& background, const std::vector<uint8_t>& isLight) {
    std::vector<float> better(scene.mesh.vertexCount(), 0);
    const float floor = samples.noiseFloor;
    parallelFor(better.size(), 256, [&](size_t v) {
        if (isLight[v]) better[v] = bend;
        if (isLight[v] || !scene.referenced[v]) return;
        std::vector<float> apart, off;
        size_t sure = 0;
        for (uint32_t k = samples.start[v]; k < samples.start[v + 1]; ++k) {
            const RadianceSample& s = samples.samples[k];
            if (s.clipped) continue;
            const Vec3 eye(capture.views[s.view].camera.position());
            const Vec3 direction = glm::normalize(scene.mesh.positions[v] - eye);
            const float distance = background.distance(direction, s.radiance);
            if (distance >= 0) off.push_back(distance);
            sure += distance >= 0 && background.whole(direction);
            if (const std::optional<Rgb> others = medianObservation(samples, uint32_t(v), s.view))
                apart.push_back(logDistance(s.radiance, *others, *others, floor));
        }
        better[v] = surfaceBefore(std::move(apart), std::move(off), sure);
    });
    return better;
}

/// The mean over a few rings of neighbours.
std::vector<float> overNeighbours(const Scene& scene, std::vector<float> value) {
    for (int ring = 0; ring < meanRings; ++ring) {
        std::vector<float> mean(value.size());
        parallelFor(value.size(), 1024, [&](size_t v) {
            const uint32_t begin = scene.graph.start[v], end = scene.graph.start[v + 1];
            float sum = value[v];
            for (uint32_t e = begin; e < end; ++e) sum += value[scene.graph.to[e]];
            mean[v] = sum / float(1 + end - begin);
        });
        value.swap(mean);
    }
    return value;
}

/// What was labelled anew without being connected with anything that was found: an edge of a surface, such as a
/// table's.
void dropIslands(const Scene& scene, const std::vector<uint8_t>& found, std::vector<uint8_t>& skirt) {
    std::vector<uint8_t> visited(skirt.size(), 0);
    for (uint32_t seed = 0; seed < skirt.size(); ++seed) {
        if (!skirt[seed] || visited[seed]) continue;
        const std::vector<uint32_t> island =
            connectedRegion(scene.graph, seed, visited, [&](uint32_t v) { return skirt[v] != 0; });
        if (std::any_of(island.begin(), island.end(), [&](uint32_t v) { return found[v] != 0; })) continue;
        for (const uint32_t v : island) skirt[v] = 0;
    }
}

/// What skirts cut off from the rest is of them where it is small and no light.
void addIslands(const Scene& scene, size_t largest, const std::vector<uint8_t>& isLight, std::vector<uint8_t>& skirt) {
    const std::vector<uint8_t> before = skirt;
    std::vector<uint8_t> visited(skirt.size(), 0);
    for (uint32_t seed = 0; seed < skirt.size(); ++seed) {
        if (before[seed] || visited[seed]) continue;
        const std::vector<uint32_t> island =
            connectedRegion(scene.graph, seed, visited, [&](uint32_t v) { return !before[v]; });
        if (island.size() > largest ||
            std::any_of(island.begin(), island.end(), [&](uint32_t v) { return isLight[v]; }))
            continue;
        const bool beside = std::any_of(island.begin(), island.end(), [&](uint32_t v) {
            const auto to = scene.graph.to.begin();
            return std::any_of(to + scene.graph.start[v], to + scene.graph.start[v + 1],
                               [&](uint32_t w) { return before[w] != 0; });
        });
        if (!beside) continue;
        for (const uint32_t v : island) skirt[v] = 1;
    }
}

/// Per entry of graph.to how alike the photographs show both vertices: 1, less where all of them show an edge between.
std::vector<float> likeness(const Scene& scene, const RadianceSamples& samples) {
    std::vector<float> weight(scene.graph.to.size(), 1);
    parallelFor(scene.graph.start.size() - 1, 256, [&](size_t v) {
        for (uint32_t e = scene.graph.start[v]; e < scene.graph.start[v + 1]; ++e) {
            const uint32_t w = scene.graph.to[e];
            std::vector<float> contrast;
            for (uint32_t i = samples.start[v], k = samples.start[w];
                 i < samples.start[v + 1] && k < samples.start[w + 1];) {
                const RadianceSample &a = samples.samples[i], &b = samples.samples[k];
                if (a.view == b.view)
                    contrast.push_back(logDistance(a.radiance, b.radiance, b.radiance, samples.noiseFloor));
                i += a.view <= b.view;
                k += b.view <= a.view;
            }
            if (contrast.empty()) continue;
            const float edge = medianOf(std::move(contrast)) / alike;
            weight[e] = std::max(std::exp(-edge * edge), leastLikeness);
        }
    });
    return weight;
}

/// Skirts up to the edges that photographs show: vertices near their borders are labelled anew.
std::vector<uint8_t> delimited(const Scene& scene, const RadianceSamples& samples, const std::vector<float>& better,
                               const std::vector<uint8_t>& isLight, const std::vector<uint8_t>& skirt) {
    std::vector<size_t> rings(skirt.size(), ~size_t(0));  // from the other kind
    std::vector<uint32_t> reached;
    for (uint32_t v = 0; v < skirt.size(); ++v)
        for (uint32_t e = scene.graph.start[v]; e < scene.graph.start[v + 1]; ++e)
            if (skirt[v] != skirt[scene.graph.to[e]] && rings[v] != 0) {
                rings[v] = 0;
                reached.push_back(v);
            }
    for (size_t i = 0; i < reached.size(); ++i) {
        const uint32_t v = reached[i];
        if (rings[v] == borderRings) continue;
        for (uint32_t e = scene.graph.start[v]; e < scene.graph.start[v + 1]; ++e)
            if (rings[scene.graph.to[e]] == ~size_t(0)) {
                rings[scene.graph.to[e]] = rings[v] + 1;
                reached.push_back(scene.graph.to[e]);
            }
    }
    std::vector<LabelPrior> priors(skirt.size());
    for (size_t v = 0; v < skirt.size(); ++v) {
        if (rings[v] >= borderRings || isLight[v])
            priors[v] = {skirt[v] && !isLight[v] ? 0.0f : 1.0f, std::numeric_limits<float>::infinity()};
        else priors[v] = {better[v] > 0 ? 1.0f : 0.0f, priorWeight * std::abs(better[v]) / bend};
    }
    const std::vector<float> labels = randomWalkerLabels(scene.graph, likeness(scene, samples), priors);
    std::vector<uint8_t> result(skirt.size());
    for (size_t v = 0; v < skirt.size(); ++v) result[v] = labels[v] < 0.5f;
    return result;
}

/// Vertices of skirts: large regions, at a rim of the mesh or at a light, that the background explains and a surface
/// does not. Glare hides what a light is beside: reconstructions close it with bubbles.
std::vector<uint8_t> skirtsOf(const Scene& scene, const RadianceSamples& samples, const std::vector<float>& better,
                              const std::vector<uint8_t>& isLight) {
    const std::vector<float> around = overNeighbours(scene, better);
    const std::vector<uint8_t> rim = rimVertices(scene.mesh);
    std::vector<uint32_t> lights;
    for (uint32_t v = 0; v < isLight.size(); ++v)
        if (isLight[v]) lights.push_back(v);
    // The mean over neighbours knows of lights so far.
    const std::vector<int> fromLight = ringsAbout(scene.graph, meanRings + 1, lights);
    const size_t least = std::max<size_t>(leastRegion, better.size() / 500);
    std::vector<uint8_t> skirt(better.size(), 0), visited = skirt;
    for (uint32_t seed = 0; seed < better.size(); ++seed) {
        if (!(around[seed] < 0) || visited[seed]) continue;
        const std::vector<uint32_t> region =
            connectedRegion(scene.graph, seed, visited, [&](uint32_t v) { return around[v] < 0; });
        size_t refuted = 0, telling = 0, atBorder = 0;
        for (const uint32_t v : region) {
            refuted += better[v] < -alike;
            telling += better[v] != 0 && better[v] != unknownDiffers;
            atBorder += rim[v] || fromLight[v] >= 0;
        }
        const float needed = std::max(refutedOfTelling * float(telling), refutedOfAll * float(region.size()));
        if (region.size() < least || refuted < leastRegion || float(refuted) < needed || atBorder == 0) continue;
        for (const uint32_t v : region) skirt[v] = 1;
    }
    const std::vector<uint8_t> found = skirt;
    skirt = delimited(scene, samples, better, isLight, skirt);
    dropIslands(scene, found, skirt);
    addIslands(scene, 2 * least, isLight, skirt);
    return skirt;
}

/// The view without which the others agree on a background; Background::none: all do. Nothing where they do not. One
/// view may show surfaces beyond the mesh, such as the outside of a wall. Which one: the mesh contradicts the
/// background that the rest show least, because most of it is right.
std::optional<size_t> viewToLeaveOut(const Scene& scene, const Capture& capture, const RadianceSamples& samples,
                                     const std::vector<BackgroundCells>& shown, const std::vector<uint8_t>& isLight) {
    const auto tells = [](const Background& b) { return b.known() >= leastBackground && b.distant(); };
    if (tells(Background(shown, samples.noiseFloor))) return Background::none;
    std::optional<size_t> best;
    float most = -std::numeric_limits<float>::infinity();
    for (size_t i = 0; i < shown.size() && shown.size() >= fewViews; ++i) {
        const Background background(shown, samples.noiseFloor, i);
        if (!tells(background)) continue;
        const std::vector<float> better = evidenceOf(scene, capture, samples, background, isLight);
        const float all = std::accumulate(better.begin(), better.end(), 0.0f);
        if (!(all > most)) continue;
        most = all;
        best = i;
    }
    return best;
}

}  // namespace

std::vector<uint32_t> freeSpaceTriangles(const Scene& scene, const Capture& capture, const RadianceSamples& samples,
                                         const std::vector<uint8_t>& isLight, Progress& progress) {
    const std::vector<BackgroundCells> shown = shownBy(capture, samples);
    const std::optional<size_t> without = viewToLeaveOut(scene, capture, samples, shown, isLight);
    if (!without) return {};
    const Background background(shown, samples.noiseFloor, *without);
    const std::vector<float> better = evidenceOf(scene, capture, samples, background, isLight);
    const std::vector<uint8_t> skirt = skirtsOf(scene, samples, better, isLight);
    const auto corners = [&](uint32_t t) {
        int count = 0;
        for (const uint32_t v : scene.mesh.triangles[t]) count += skirt[v];
        return count;
    };
    const auto isSurface = [&](uint32_t t) {
        const Triangle& at = scene.mesh.triangles[t];
        return std::any_of(at.begin(), at.end(), [&](uint32_t v) { return better[v] > alike; });
    };
    // Pixels that show the background through a skirt deny all that lies along their ray.
    std::vector<uint32_t> passed(scene.mesh.triangles.size(), 0), stopped = passed;
    progress.begin("Surfaces in free space", capture.views.size());
    const auto vote = [](uint32_t& count) { std::atomic_ref(count).fetch_add(1, std::memory_order_relaxed); };
    const auto ask = [&](size_t i) {
        const View& view = capture.views[i];
        const ViewGeometry& g = samples.geometry[i];
        const Vec3 eye(view.camera.position());
        for (int y = 0; y < g.height; ++y)
            for (int x = 0; x < g.width; ++x) {
                const uint32_t first = g.triangle[size_t(y) * size_t(g.width) + size_t(x)];
                if (first == Hit::none || !view.image.usableAt(x, y)) continue;
                if (corners(first) < 2) {
                    vote(stopped[first]);
                    continue;
                }
                const Vec3 direction = view.camera.rayDirection(Vec2(float(x) + 0.5f, float(y) + 0.5f));
                const float apart = background.distance(direction, view.image.at(x, y));
                if (apart < 0 || apart > alike) continue;
                float from = 0;
                for (int layers = 0; layers < 8; ++layers) {
                    const Hit hit = scene.cameraTracer->closest({eye, direction, from, 1e30f});
                    if (!hit) break;
                    vote(passed[hit.triangle]);
                    from = hit.distance * (1 + 1e-6f) + 0.25f * scene.tracer->surfaceOffset();
                }
            }
    };
    parallelFor(capture.views.size(), 1, ask, &progress);
    std::vector<uint32_t> free;
    for (uint32_t t = 0; t < passed.size(); ++t)
        if (corners(t) == 3 || (passed[t] > 3 * stopped[t] && !isSurface(t))) free.push_back(t);
    return free;
}

}  // namespace relamp
