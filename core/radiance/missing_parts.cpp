#include "radiance/missing_parts.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "base/box.h"
#include "base/parallel.h"
#include "base/statistics.h"
#include "radiance/unexplained_pixels.h"
#include "scene/voxel_surface.h"

namespace relamp {
namespace {

constexpr float ownSpread = 0.25f;   ///< of log radiance: what shading makes a part differ by between views
constexpr float mostUnlike = 4;      ///< of one view, log likelihood
constexpr float leastGain = 4;       ///< log likelihood of a voxel, of all views together
constexpr float tellsAgainst = -1;   ///< gain of a view that speaks against a voxel
constexpr size_t fewestViews = 5;    ///< that a voxel stands before the mesh in
constexpr size_t fewestBefore = 3;   ///< of these: show it before the mesh, of which more is known than of a background
constexpr float mostAgainst = 0.2f;  ///< fraction of these, one at least
constexpr float voxelPerCell = 0.5f;     ///< side of a voxel over the median footprint of a cell
constexpr size_t leastVoxels = 100;      ///< of a part
constexpr float mostUnexplained = 0.1f;  ///< fraction of what is seen: beyond it the mesh is wrong, not incomplete
constexpr float clearOf = 3;             ///< voxels: a part stands that far off the mesh somewhere
constexpr float surfaceLevel = 0.5f;     ///< of the smoothed occupancy
constexpr float aboutTheMesh = 0.02f;  ///< diagonals: parts lie within the box of what is seen and that much around it
constexpr int rootSide = 64;           ///< voxels of a cube that is searched at once
constexpr double mostCubes = 2e6;      ///< of that box
constexpr size_t mostAsked = 65536;    ///< of these: thin parts fill little of a cube

/// Lowest and highest values over squares of 2^level cells.
class CellPyramid {
public:
    struct Range {
        float mostGain, leastDepth, mostDepth;
    };
    explicit CellPyramid(const UnexplainedView& view) : view_(view) {
        Level base{view.width, view.height, std::vector<Range>(view.gain.size())};
        for (size_t i = 0; i < view.gain.size(); ++i)
            base.cells[i] = {view.known[i] ? view.gain[i] : 0.0f, view.depth[i], view.depth[i]};
        levels_.push_back(std::move(base));
        while (levels_.back().width > 1 || levels_.back().height > 1) {
            const Level& fine = levels_.back();
            Level next{(fine.width + 1) / 2, (fine.height + 1) / 2, {}};
            next.cells.assign(size_t(next.width) * size_t(next.height), none());
            for (int y = 0; y < fine.height; ++y)
                for (int x = 0; x < fine.width; ++x)
                    join(next.cells[size_t(y / 2) * size_t(next.width) + size_t(x / 2)],
                         fine.cells[size_t(y) * size_t(fine.width) + size_t(x)]);
            levels_.push_back(std::move(next));
        }
    }
    /// Over at least the cells of a box; none outside the view.
    std::optional<Range> over(float lowX, float lowY, float highX, float highY) const {
        const int x0 = std::max(0, int(std::floor(lowX))), y0 = std::max(0, int(std::floor(lowY))),
                  x1 = std::min(view_.width - 1, int(std::floor(highX))),
                  y1 = std::min(view_.height - 1, int(std::floor(highY)));
        if (x0 > x1 || y0 > y1) return {};
        size_t level = 0;
        while ((std::max(x1 - x0, y1 - y0) >> level) > 2 && level + 1 < levels_.size()) ++level;
        Range range = none();
        for (int y = y0 >> level; y <= y1 >> level; ++y)
            for (int x = x0 >> level; x <= x1 >> level; ++x)
                join(range, levels_[level].cells[size_t(y) * size_t(levels_[level].width) + size_t(x)]);
        return range;
    }

private:
    struct Level {
        int width, height;
        std::vector<Range> cells;
    };
    static Range none() {
        return {-std::numeric_limits<float>::infinity(), std::numeric_limits<float>::infinity(),
                -std::numeric_limits<float>::infinity()};
    }
    static void join(Range& a, const Range& b) {
        a.mostGain = std::max(a.mostGain, b.mostGain);
        a.leastDepth = std::min(a.leastDepth, b.leastDepth);
        a.mostDepth = std::max(a.mostDepth, b.mostDepth);
    }
    const UnexplainedView& view_;
    std::vector<Level> levels_;
};

struct FoundVoxel {
    Voxel at;
    float clear = 0;  ///< voxels: least distance before the mesh, along the rays of the views
    bool operator<(const FoundVoxel& other) const { return at < other.at; }
};

class Hull {
public:
    Hull(const Capture& capture, const std::vector<UnexplainedView>& views, const Vec3& origin, float side)
        : capture_(capture),
          views_(views),
          states_(std::max<size_t>(1, capture.states.size())),
          origin_(origin),
          side_(side) {
        for (const UnexplainedView& view : views) pyramids_.emplace_back(view);
    }

    /// The voxels of a cube; none where too many have to be asked for thin parts.
    std::vector<FoundVoxel> search(const Voxel& low) const {
        std::vector<Cube> cubes{{low, 0}}, halves;
        for (int size = rootSide; size > 1; size /= 2) {
            halves.clear();
            for (Cube& cube : cubes)
                if (possible(cube, size)) addHalves(cube, size / 2, halves);
            std::swap(cubes, halves);
        }
        if (cubes.size() > mostAsked) return {};
        std::vector<FoundVoxel> found;
        for (const Cube& cube : cubes)
            if (const auto there = voxel(cube.low)) found.push_back(*there);
        return found;
    }

private:
    struct Cube {
        Voxel low;
        uint64_t past;  ///< a bit for each of the first 64 views that sees none of it
    };
    static void addHalves(const Cube& cube, int half, std::vector<Cube>& halves) {
        for (int k = 0; k < 8; ++k)
            halves.push_back(
                {{cube.low.x + (k & 1) * half, cube.low.y + (k >> 1 & 1) * half, cube.low.z + (k >> 2) * half},
                 cube.past});
    }
    Vec3 centre(const Voxel& low, int size) const {
        return origin_ + side_ * (Vec3(float(low.x), float(low.y), float(low.z)) + 0.5f * float(size - 1));
    }
    static bool refuted(size_t against, size_t views) {
        return float(against) > std::max(1.0f, mostAgainst * float(views));
    }

    /// What speaks against one surface that views of a lighting state show alike, log likelihood.
    float unlikeItself(const DVec3& point) const {
        std::vector<std::vector<Rgb>> shown(states_);
        for (size_t i = 0; i < views_.size(); ++i)
            if (const auto place = placeIn(i, point); place && views_[i].gain[place->cell] >= tellsAgainst)
                shown[capture_.views[i].state].push_back(views_[i].shown[place->cell]);
        float sum = 0;
        for (const std::vector<Rgb>& ofState : shown) {
            Rgb middle(0);
            for (int c = 0; c < 3; ++c) {
                std::vector<float> values;
                for (const Rgb& s : ofState) values.push_back(s[c]);
                middle[c] = meanMedianOf(std::move(values));
            }
            for (const Rgb& s : ofState) {
                const Rgb off = glm::abs(s - middle) / ownSpread;
                const float mean = (off.x + off.y + off.z) / 3;
                sum += std::min(mostUnlike, 0.5f * mean * mean);
            }
        }
        return sum;
    }

    /// Whether a cube may hold any. Views that see nothing of it see nothing of its parts.
    bool possible(Cube& cube, int size) const {
        const DVec3 middle(centre(cube.low, size));
        const float radius = 0.5f * std::sqrt(3.0f) * float(size) * side_;
        float gain = 0;
        size_t count = 0, against = 0;
        for (size_t i = 0; i < views_.size(); ++i) {
            const uint64_t bit = i < 64 ? uint64_t(1) << i : 0;
            if (cube.past & bit) continue;
            const Camera& camera = capture_.views[i].camera;
            const float distance = float(glm::length(middle - camera.position()));
            const std::optional<Vec2> at = camera.project(middle);
            if (distance < 3 * radius || !at) {  // too near to tell, or behind
                gain += UnexplainedView::mostGain;
                ++count;
                continue;
            }
            const float step = float(views_[i].step), reach = 1 + 1.5f * float(std::max(camera.focalX, camera.focalY)) *
                                                                      radius / (distance - radius) / step;
            const Vec2 cell = *at / step;
            const auto range = pyramids_[i].over(cell.x - reach, cell.y - reach, cell.x + reach, cell.y + reach);
            if (!range || distance - radius > range->mostDepth) {
                cube.past |= bit;
                continue;
            }
            ++count;
            if (distance + radius < range->leastDepth - side_ && range->mostGain < tellsAgainst && cell.x > reach &&
                cell.y > reach && cell.x + reach < float(views_[i].width) && cell.y + reach < float(views_[i].height)) {
                if (refuted(++against, views_.size())) return false;
                gain += range->mostGain;
            } else {
                gain += std::max(0.0f, range->mostGain);
            }
        }
        return count >= fewestViews && gain > leastGain && !refuted(against, count);
    }

    /// The cell of a view that a point lies in and how far before the mesh it is, metres; none where nothing is known.
    struct Place {
        size_t cell;
        float before;
    };
    std::optional<Place> placeIn(size_t view, const DVec3& point) const {
        const UnexplainedView& seen = views_[view];
        const Camera& camera = capture_.views[view].camera;
        const std::optional<Vec2> pixel = camera.project(point);
        const std::optional<size_t> cell = pixel ? seen.cellAt(*pixel) : std::nullopt;
        if (!cell || !seen.known[*cell]) return {};
        const float before = seen.depth[*cell] - float(glm::length(point - camera.position()));
        return before < side_ ? std::nullopt : std::optional(Place{*cell, before});
    }

    /// What a voxel holds; none where it holds nothing.
    std::optional<FoundVoxel> voxel(const Voxel& at) const {
        const DVec3 middle(centre(at, 1));
        float gain = 0, clear = std::numeric_limits<float>::infinity();
        size_t count = 0, against = 0, beforeMesh = 0;
        for (size_t i = 0; i < views_.size(); ++i) {
            const std::optional<Place> place = placeIn(i, middle);
            if (!place) continue;
            ++count;
            gain += views_[i].gain[place->cell];
            against += views_[i].gain[place->cell] < tellsAgainst;
            beforeMesh += views_[i].gain[place->cell] > 0 && std::isfinite(place->before);
            if (refuted(against, views_.size())) return {};
            clear = std::min(clear, place->before / side_);
        }
        if (count < fewestViews || beforeMesh < fewestBefore || gain <= leastGain || refuted(against, count)) return {};
        gain -= unlikeItself(middle);
        return gain > leastGain ? std::optional(FoundVoxel{at, clear}) : std::nullopt;
    }

    const Capture& capture_;
    const std::vector<UnexplainedView>& views_;
    const size_t states_;
    const Vec3 origin_;
    const float side_;
    std::vector<CellPyramid> pyramids_;
};

/// Metres. 0 where no cell shows the mesh.
float voxelSide(const Capture& capture, const std::vector<UnexplainedView>& views) {
    std::vector<float> widths;
    for (size_t i = 0; i < views.size(); ++i)
        for (size_t k = 0; k < views[i].depth.size(); k += 61)
            if (std::isfinite(views[i].depth[k]))
                widths.push_back(views[i].depth[k] * float(views[i].step) / float(capture.views[i].camera.focalX));
    return widths.empty() ? 0 : voxelPerCell * medianOf(std::move(widths));
}

/// The fraction of what views see of the mesh that the others do not confirm, of the median view.
float unexplainedOf(const std::vector<UnexplainedView>& views) {
    std::vector<float> fractions;
    for (const UnexplainedView& view : views) {
        size_t known = 0, unexplained = 0;
        for (size_t cell = 0; cell < view.gain.size(); ++cell) {
            if (!view.known[cell] || std::isinf(view.depth[cell])) continue;
            ++known;
            unexplained += view.gain[cell] > 0;
        }
        if (known) fractions.push_back(float(unexplained) / float(known));
    }
    return fractions.empty() ? 0 : medianOf(std::move(fractions));
}

}  // namespace

MissingParts missingParts(const Scene& scene, const Capture& capture, const RadianceSamples& samples,
                          const std::vector<uint8_t>& isLight, Progress& progress) {
    MissingParts parts;
    if (capture.views.size() < fewestViews) return parts;
    const std::vector<UnexplainedView> views = unexplainedPixels(scene, capture, samples, isLight, progress);
    if (unexplainedOf(views) > mostUnexplained) return parts;
    const float side = voxelSide(capture, views);
    if (!(side > 0)) return parts;
    Box box;
    for (size_t v = 0; v < scene.mesh.vertexCount(); ++v)
        if (samples.countOf(uint32_t(v)) > 0) box.grow(scene.mesh.positions[v]);
    box.widen(aboutTheMesh * box.diagonal());
    const Hull hull(capture, views, box.min, side);
    const Vec3 roots = glm::ceil(box.size() / (side * float(rootSide)));
    if (!(double(roots.x) * double(roots.y) * double(roots.z) <= mostCubes)) return parts;
    const auto nx = size_t(roots.x), ny = size_t(roots.y), nz = size_t(roots.z);
    std::vector<std::vector<FoundVoxel>> found(nx * ny * nz);
    progress.begin("Parts that the mesh lacks", found.size());
    parallelFor(
        found.size(), 1,
        [&](size_t i) {
            found[i] =
                hull.search({rootSide * int(i % nx), rootSide * int(i / nx % ny), rootSide * int(i / (nx * ny))});
        },
        &progress);
    std::vector<FoundVoxel> all;
    for (const auto& some : found) all.insert(all.end(), some.begin(), some.end());
    std::sort(all.begin(), all.end());
    std::vector<Voxel> voxels;
    for (const FoundVoxel& f : all) voxels.push_back(f.at);
    for (const std::vector<Voxel>& part : touchingVoxels(voxels)) {
        if (part.size() < leastVoxels) continue;
        std::vector<float> clear;
        for (const Voxel& v : part) clear.push_back(std::lower_bound(all.begin(), all.end(), FoundVoxel{v})->clear);
        if (quantileOf(std::move(clear), 0.9) < clearOf) continue;
        const VoxelSurface surface = voxelSurface(part, box.min, side, surfaceLevel);
        if (surface.triangles.empty()) continue;
        ++parts.parts;
        const auto first = uint32_t(parts.surface.positions.size());
        parts.surface.positions.insert(parts.surface.positions.end(), surface.positions.begin(),
                                       surface.positions.end());
        for (const auto& [a, b, c] : surface.triangles) {
            parts.surface.triangles.push_back({first + a, first + b, first + c});
            const Vec3 &p = surface.positions[a], &q = surface.positions[b], &r = surface.positions[c];
            parts.surface.area += 0.5f * glm::length(glm::cross(q - p, r - p));
        }
    }
    return parts;
}

}  // namespace relamp
