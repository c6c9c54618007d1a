#include "radiance/slab_sides.h"

#include <algorithm>
#include <cmath>

#include "base/log.h"
#include "base/parallel.h"
#include "radiance/seen_past.h"
#include "radiance/shown_edge.h"
#include "scene/rim.h"

namespace relamp {
namespace {

constexpr double cornerReach = 8;                      ///< spacings
constexpr double bandBeyond = 12;                      ///< spacings that a mesh may stand out of an edge
constexpr double bandWithin = 4;                       ///< spacings that it may stand back
constexpr double deepest = 0.15;                       ///< of the diagonal
constexpr double leastDepth = 1.5;                     ///< spacings
constexpr int depthsPerSpacing = 4;                    ///< tried
constexpr double apart = 0.6;                          ///< spacings on either side of a lower edge that are compared
constexpr float leastLowerContrast = 0.2f;             ///< log ratio: mean over lower edges
constexpr float lowerStandsOut = 2.4f;                 ///< contrast of a lower edge over that of other depths
constexpr size_t leastSeen = 30;                       ///< places along lower edges, in each view that sees them
constexpr double leastSlant = 0.15;                    ///< cosine: grazing views tell nothing
constexpr float sideDiffers = 0.3f, sideAlike = 0.1f;  ///< log ratios to what lies behind
constexpr float sideAgrees = 0.25f;                    ///< log ratio between views
constexpr double flush = 2;                            ///< spacings that what is left of a side may lie before it
constexpr double upright = 0.7;                        ///< cosine of its normal with the flat surface's, at most

class SlabSearch {
public:
    SlabSearch(const Scene& scene, const Capture& capture, const RadianceSamples& samples,
               const std::vector<uint8_t>& isLight)
        : scene_(scene),
          capture_(capture),
          isLight_(isLight),
          past_(scene, capture, samples),
          views_(scene, capture, past_.floor()) {}

    SlabSides result() {
        rims_ = shownEdges(views_, straightRims(scene_, isLight_));
        if (rims_.empty()) return {};
        double spacing = 0;
        for (const StraightRim& rim : rims_) spacing = std::max(spacing, rim.spacing);
        joinCorners(rims_, cornerReach * spacing);
        for (size_t i = 0; i < rims_.size(); ++i)
            depth_.push_back(i > 0 && rims_[i].surface == rims_[i - 1].surface ? depth_[i - 1]
                                                                               : depthOf(rims_[i].surface));
        dropOpened();
        if (rims_.empty()) return {};
        SlabSides found;
        found.edges = rims_.size();
        found.depth = *std::max_element(depth_.begin(), depth_.end());
        trim(found);
        for (size_t i = 0; i < rims_.size(); ++i) addSide(rims_[i], depth_[i], found.sides);
        return found;
    }

private:
    /// Where the mesh has a side it stays, unless photographs show one to take its place.
    void dropOpened() {
        for (size_t i = rims_.size(); i-- > 0;)
            if (rims_[i].creased && depth_[i] == 0) {
                rims_.erase(rims_.begin() + std::ptrdiff_t(i));
                depth_.erase(depth_.begin() + std::ptrdiff_t(i));
            }
    }

    /// What the photographs say of a side at a depth, over all edges of one slab.
    struct AtDepth {
        double contrast = 0, score = 0;
        size_t seen = 0;
        double mean() const { return seen ? contrast / double(seen) : 0; }
    };

    /// Metres to which photographs show the sides of a slab: where its lower edge is; 0 where they show none.
    double depthOf(uint32_t surface) const {
        double spacing = 0;
        for (const StraightRim& rim : rims_)
            if (rim.surface == surface) spacing = rim.spacing;
        const double step = spacing / depthsPerSpacing;
        std::vector<AtDepth> depths(size_t(deepest * double(scene_.diagonal) / step));
        parallelFor(depths.size(), 1, [&](size_t i) {
            for (const StraightRim& rim : rims_)
                if (rim.surface == surface) askAt(rim, double(i) * step, depths[i]);
        });
        size_t most = 0, best = 0;
        for (const AtDepth& d : depths) most = std::max(most, d.seen);
        double mean = 0, score = 0;
        size_t judged = 0;
        for (size_t i = size_t(leastDepth * depthsPerSpacing); i < depths.size(); ++i) {
            if (4 * depths[i].seen < most) continue;
            mean += depths[i].mean();
            ++judged;
            if (!best || depths[i].mean() > depths[best].mean()) best = i;
        }
        mean /= double(std::max<size_t>(1, judged));
        for (size_t i = 0; i < best; ++i) score += depths[i].score;
        const AtDepth& edge = depths[best];
        logInfo("lower edges {:.1f} mm below the upper ones: contrast {:.2f}, mean of all depths {:.2f}, {} places",
                1e3 * double(best) * step, edge.mean(), mean, edge.seen);
        const bool shown = edge.mean() > std::max(double(leastLowerContrast), double(lowerStandsOut) * mean);
        return shown && edge.seen >= leastSeen && score >= 0 ? refinedDepth(surface, double(best) * step) : 0;
    }

    void askAt(const StraightRim& rim, double depth, AtDepth& sum) const {
        const int columns = std::max(2, int(rim.length() / rim.spacing));
        const DVec3 step = apart * rim.spacing * rim.up;
        for (int column = 0; column < columns; ++column) {
            const DVec3 p = rim.from + (column + 0.5) / columns * (rim.to - rim.from) - depth * rim.up;
            sum.score += std::clamp(sideScore(rim, p), -2, 2);
            for (const View& view : capture_.views) {
                const DVec3 eye = view.camera.position();
                if (glm::dot(glm::normalize(eye - p), rim.out()) < leastSlant) continue;
                const std::optional<float> contrast = views_.contrast(view, p + step, p - step);
                if (!contrast || views_.hidden(eye, p, 3 * rim.spacing)) continue;
                sum.contrast += double(*contrast);
                ++sum.seen;
            }
        }
    }

    /// The depth to a fraction of a pixel.
    double refinedDepth(uint32_t surface, double depth) const {
        std::vector<EdgeCrossing> all;
        double spacing = 0;
        for (const StraightRim& rim : rims_) {
            if (rim.surface != surface) continue;
            const std::vector<EdgeCrossing> own =
                views_.crossings(rim.from - depth * rim.up, rim.to - depth * rim.up, rim.spacing, -rim.up, rim.out());
            all.insert(all.end(), own.begin(), own.end());
            spacing = rim.spacing;
        }
        const double off = lineThrough(all, false).x;
        return std::abs(off) < spacing ? depth + off : depth;
    }

    /// How many photographs show a side there over those that show what lies behind; 0 where they do not agree.
    int sideScore(const StraightRim& rim, const DVec3& p) const {
        int score = 0;
        std::vector<float> shown;
        for (size_t i = 0; i < capture_.views.size(); ++i) {
            const View& view = capture_.views[i];
            const DVec3 eye = view.camera.position(), direction = glm::normalize(p - eye);
            if (-glm::dot(direction, rim.out()) < leastSlant || views_.hidden(eye, p, 3 * rim.spacing)) continue;
            const std::optional<Rgb> radiance = views_.shownAt(view, p);
            if (!radiance) continue;
            shown.push_back(std::log(std::max(luminance(*radiance), past_.floor())));
            const float outer = float(glm::length(p - eye) + 4 * rim.spacing);
            if (const std::optional<float> off = past_.difference(i, Vec3(direction), outer, *radiance))
                score += *off > sideDiffers ? 1 : *off < sideAlike ? -1 : 0;
        }
        if (shown.size() < 2) return std::min(score, 0);
        const auto [low, high] = std::minmax_element(shown.begin(), shown.end());
        const float spread = *high - *low;
        if (score > 0 && spread > 4 * sideAgrees) return 0;
        return score;
    }

    bool along(const StraightRim& rim, const DVec3& p, double reach) const {
        return rim.at(p) > (rim.cornerFrom ? -reach : 0) && rim.at(p) < rim.length() + (rim.cornerTo ? reach : 0);
    }
    /// Number of the rim beyond which a point lies; -1: none.
    int beyondWhich(const DVec3& p) const {
        for (size_t i = 0; i < rims_.size(); ++i) {
            const StraightRim& rim = rims_[i];
            const double off = rim.beyond(p);
            if (off > 0 && off < bandBeyond * rim.spacing && std::abs(rim.above(p)) < heightBesideRim(scene_) &&
                along(rim, p, bandBeyond * rim.spacing))
                return int(i);
        }
        return -1;
    }
    /// On the edge of one rim, at the corner where it would lie beyond the next.
    Vec3 onEdge(const StraightRim& rim, const DVec3& p) const {
        const double at = std::clamp(rim.at(p), 0.0, rim.length());
        return Vec3(rim.from + at * rim.along());
    }

    void trim(SlabSides& found) const {
        const Mesh& mesh = scene_.mesh;
        std::vector<int> outer(mesh.vertexCount(), -1);
        parallelFor(outer.size(), 1024, [&](size_t v) {
            if (!isLight_[v]) outer[v] = beyondWhich(DVec3(mesh.positions[v]));
        });
        Mesh kept;
        kept.positions = mesh.positions;
        for (uint32_t t = 0; t < mesh.triangles.size(); ++t) {
            const Triangle& corners = mesh.triangles[t];
            const bool outside = std::all_of(corners.begin(), corners.end(), [&](uint32_t v) { return outer[v] >= 0; });
            if (outside || ofSide(t)) found.removed.push_back(t);
            else kept.triangles.push_back(corners);
        }
        dropScraps(kept, found);
        std::vector<uint8_t> used(mesh.vertexCount(), 0);
        for (const Triangle& t : kept.triangles)
            for (const uint32_t v : t) used[v] = 1;
        const std::vector<uint8_t> rimVertex = rimVertices(kept);
        for (uint32_t v = 0; v < mesh.vertexCount(); ++v) {
            if (!used[v] || isLight_[v]) continue;
            const DVec3 p(mesh.positions[v]);
            int at = outer[v];
            for (size_t i = 0; i < rims_.size() && at < 0 && rimVertex[v]; ++i) {
                const double off = -rims_[i].beyond(p);
                if (off >= 0 && off < bandWithin * rims_[i].spacing &&
                    std::abs(rims_[i].above(p)) < heightBesideRim(scene_) && along(rims_[i], p, 0))
                    at = int(i);
            }
            if (at >= 0) found.moved.push_back({v, onEdge(rims_[size_t(at)], p)});
        }
    }

    /// Small pieces that hung on what was taken away, out and down of an edge.
    void dropScraps(Mesh& kept, SlabSides& found) const {
        const Mesh& mesh = scene_.mesh;
        uint32_t pieces = 0;
        const std::vector<uint32_t> piece = connectedComponents(buildVertexGraph(kept), &pieces);
        std::vector<uint8_t> hung(pieces, 0), inside(pieces, 0);
        for (const uint32_t t : found.removed)
            for (const uint32_t v : mesh.triangles[t]) hung[piece[v]] = 1;
        for (uint32_t v = 0; v < piece.size(); ++v)
            if (hung[piece[v]] && (isLight_[v] || !hangsOut(DVec3(mesh.positions[v])))) inside[piece[v]] = 1;
        const auto goes = [&](const Triangle& t) { return hung[piece[t[0]]] && !inside[piece[t[0]]]; };
        for (uint32_t t = 0; t < mesh.triangles.size(); ++t)
            if (goes(mesh.triangles[t])) found.removed.push_back(t);
        std::sort(found.removed.begin(), found.removed.end());
        found.removed.erase(std::unique(found.removed.begin(), found.removed.end()), found.removed.end());
        std::erase_if(kept.triangles, goes);
    }
    bool hangsOut(const DVec3& p) const {
        return std::any_of(rims_.begin(), rims_.end(), [&](const StraightRim& rim) {
            const double reach = 2 * bandBeyond * rim.spacing;
            return rim.beyond(p) > -flush * rim.spacing && rim.beyond(p) < reach &&
                   rim.above(p) < heightBesideRim(scene_) && rim.above(p) > -reach && along(rim, p, reach);
        });
    }

    /// Whether a triangle is what the mesh has of a side.
    bool ofSide(uint32_t t) const {
        const Triangle& corners = scene_.mesh.triangles[t];
        const DVec3 normal(scene_.mesh.faceNormal(t));
        for (size_t i = 0; i < rims_.size(); ++i) {
            const StraightRim& rim = rims_[i];
            if (depth_[i] == 0 || glm::dot(normal, rim.up) > upright) continue;
            if (std::all_of(corners.begin(), corners.end(), [&](uint32_t v) {
                    const DVec3 p(scene_.mesh.positions[v]);
                    return !isLight_[v] && std::abs(rim.beyond(p)) < flush * rim.spacing &&
                           rim.above(p) < 0.5 * rim.spacing && rim.above(p) > -depth_[i] - flush * rim.spacing &&
                           along(rim, p, flush * rim.spacing);
                }))
                return true;
        }
        return false;
    }

    static void addSide(const StraightRim& rim, double depth, SurfacePatch& patch) {
        if (depth == 0) return;
        const int columns = std::max(1, int(std::ceil(rim.length() / rim.spacing))),
                  rows = std::max(2, int(std::ceil(depth / rim.spacing)));
        const auto first = uint32_t(patch.positions.size());
        for (int row = 0; row <= rows; ++row)
            for (int column = 0; column <= columns; ++column)
                patch.positions.push_back(Vec3(rim.from + double(column) / columns * (rim.to - rim.from) -
                                               double(row) / rows * depth * rim.up));
        const auto at = [&](int row, int column) { return first + uint32_t(row * (columns + 1) + column); };
        for (int row = 0; row < rows; ++row)
            for (int column = 0; column < columns; ++column) {
                patch.triangles.push_back({at(row, column), at(row + 1, column), at(row + 1, column + 1)});
                patch.triangles.push_back({at(row, column), at(row + 1, column + 1), at(row, column + 1)});
            }
        patch.area += float(rim.length() * depth);
    }

    const Scene& scene_;
    const Capture& capture_;
    const std::vector<uint8_t>& isLight_;
    const SeenPast past_;
    const EdgeViews views_;
    std::vector<StraightRim> rims_;
    std::vector<double> depth_;  ///< metres, per rim; 0: no side
};

}  // namespace

SlabSides slabSides(const Scene& scene, const Capture& capture, const RadianceSamples& samples,
                    const std::vector<uint8_t>& isLight) {
    return SlabSearch(scene, capture, samples, isLight).result();
}

}  // namespace relamp
