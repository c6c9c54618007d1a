#include "solve/registration/crease_fit.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "base/statistics.h"
#include "solve/registration/contour_fit.h"
#include "solve/registration/normal_equations.h"
#include "solve/registration/pose_motion.h"
#include "solve/registration/step_edge.h"

namespace relamp {
namespace {

constexpr float creaseSpacing = 0.004f;        ///< of the nodes, of the diagonal
constexpr double creaseDisplacement = 0.0005;  ///< of the diagonal, at least: standard deviation of a node
constexpr double creaseOfMedian = 0.5;         ///< of the median that creases are off by: the same
constexpr double creaseBend = 0.5;             ///< of that: of a node from the mean of its neighbours
constexpr double creaseSigma = 0.3;            ///< pixels: of a crease's place
constexpr double creaseRepeated = 4;           ///< points that tell as much as an independent one
constexpr double creasesLeft = 0.85;           ///< of what creases are off by, that may be left
constexpr int creaseRounds = 3, slideRings = 3;
constexpr float slideFollows = 0.6f;  ///< of the ring before
constexpr float sidesApart = 0.82f;   ///< cosine between the normals of two sides; sides back to back have no crease
constexpr float facesEye = 0.15f;     ///< cosine: a side that a photograph shows
constexpr float creaseNoise = 0.03f;  ///< of a profile's value, relative to its mean

/// Where a photograph shows a crease, beside where the mesh has it.
struct CreasePoint {
    uint32_t view = 0, edge = 0;
    Vec2 across{0};  ///< unit, in the photograph
    float offset = 0;
};

class CreaseFit {
public:
    CreaseFit(const Capture& capture, const Scene& scene, const std::vector<CreaseVertex>& creases,
              const std::vector<uint8_t>& still, size_t vertices, float floor, Progress& progress)
        : capture_(capture),
          scene_(scene),
          still_(still),
          vertices_(vertices),
          floor_(floor),
          progress_(progress),
          graph_(buildDisplacementGraph(scene, creaseSpacing * scene.diagonal)) {
        moved_.assign(scene.mesh.vertexCount(), 0);
        takeEdges(creases);
        place();
        std::vector<float> metres;
        for (const CreasePoint& p : points_) {
            const std::array<double, 2> by = pixelsBy(p);
            metres.push_back(std::abs(p.offset) / float(std::max(1e-9, std::hypot(by[0], by[1]))));
        }
        displacement_ = std::max(creaseDisplacement * double(scene.diagonal),
                                 metres.empty() ? 0 : creaseOfMedian * double(medianOf(std::move(metres))));
    }

    void leaveOutViews(bool leaveOut) { viewsLeftOut_ = leaveOut; }
    size_t points() const { return points_.size(); }
    double medianOff(bool ofLeftOutViews) const {
        std::vector<float> off;
        for (const CreasePoint& p : points_)
            if (!ofLeftOutViews || isLeftOut(p.view)) off.push_back(std::abs(p.offset));
        return off.empty() ? 0 : double(medianOf(std::move(off)));
    }
    void run() {
        for (int k = 0; k < creaseRounds && !progress_.outOfTime(); ++k) {
            step();
            place();
            progress_.advance();
        }
    }
    const std::vector<Vec3>& positions() const { return mesh_.positions; }

private:
    using Edge = std::array<uint32_t, 2>;
    bool isLeftOut(size_t view) const { return viewsLeftOut_ && view % 4 == 3; }
    const Vec3& normal(uint32_t v) const { return scene_.mesh.normals[v]; }

    /// Edges that cross a crease.
    void takeEdges(const std::vector<CreaseVertex>& creases) {
        std::vector<uint8_t> atCrease(scene_.mesh.vertexCount(), 0);
        for (const CreaseVertex& c : creases) atCrease[c.vertex] = c.middle != c.normal;
        beyond_.resize(atCrease.size());
        for (const CreaseVertex& c : creases)
            for (uint32_t e = scene_.graph.start[c.vertex]; e < scene_.graph.start[c.vertex + 1]; ++e) {
                const uint32_t w = scene_.graph.to[e];
                const float cosine = glm::dot(normal(c.vertex), normal(w));
                if (!atCrease[c.vertex] || !atCrease[w] || cosine > sidesApart || cosine < -sidesApart) continue;
                beyond_[c.vertex].push_back(w);
                if (c.vertex < w) edges_.push_back({c.vertex, w});
            }
    }

    /// How the crease between sides of these normals goes when the first moves by a metre along its own.
    static Vec3 creaseBy(const Vec3& own, const Vec3& other) {
        const float cosine = glm::dot(own, other);
        return (own - cosine * other) / std::max(1 - sidesApart * sidesApart, 1 - cosine * cosine);
    }

    /// Mesh and creases as things stand.
    void place() {
        mesh_ = scene_.mesh;
        std::vector<Vec3> slide(vertices_, Vec3(0));
        std::vector<uint8_t> slides(vertices_, 0);
        std::vector<uint32_t> ring;
        for (uint32_t v = 0; v < vertices_; ++v) {
            mesh_.positions[v] += normal(v) * float(moved_[v]);
            if (beyond_[v].empty()) continue;
            Vec3 other(0);
            double moved = 0;
            for (const uint32_t w : beyond_[v]) {
                other += normal(w);
                moved += moved_[w] / double(beyond_[v].size());
            }
            if (!(glm::length(other) > 0.1f)) continue;
            other = glm::normalize(other);
            const Vec3 to = creaseBy(normal(v), other) * float(moved_[v]) + creaseBy(other, normal(v)) * float(moved);
            slide[v] = to - normal(v) * float(moved_[v]);
            slides[v] = 1;
            ring.push_back(v);
        }
        for (int k = 0; k < slideRings; ++k) ring = nextRing(ring, slides, slide);
        for (uint32_t v = 0; v < vertices_; ++v) mesh_.positions[v] += slide[v];
        find();
    }

    /// Those beside a ring on the same side follow it.
    std::vector<uint32_t> nextRing(const std::vector<uint32_t>& ring, std::vector<uint8_t>& slides,
                                   std::vector<Vec3>& slide) const {
        std::vector<uint32_t> next;
        const auto eachBeside = [&](uint32_t v, auto&& visit) {
            for (uint32_t e = scene_.graph.start[v]; e < scene_.graph.start[v + 1]; ++e) {
                const uint32_t w = scene_.graph.to[e];
                if (w < vertices_ && glm::dot(normal(v), normal(w)) > sidesApart) visit(w);
            }
        };
        for (const uint32_t v : ring)
            eachBeside(v, [&](uint32_t w) {
                if (slides[w]) return;
                slides[w] = 2;
                next.push_back(w);
            });
        std::sort(next.begin(), next.end());
        for (const uint32_t v : next) {
            Vec3 sum(0);
            float count = 0;
            eachBeside(v, [&](uint32_t w) {
                if (slides[w] != 1) return;
                sum += slide[w];
                count += 1;
            });
            if (count > 0) slide[v] = slideFollows / count * (sum - normal(v) * glm::dot(sum, normal(v)));
        }
        for (const uint32_t v : next) slides[v] = 1;
        return next;
    }

    Vec3 middleOf(const Edge& edge) const { return 0.5f * (mesh_.positions[edge[0]] + mesh_.positions[edge[1]]); }

    void find() {
        progress_.check();
        const RayTracer tracer(mesh_, scene_.diagonal, RayTracer::For::cameras);
        std::vector<std::vector<CreasePoint>> found(capture_.views.size());
        parallelFor(found.size(), 1, [&](size_t view) {
            for (uint32_t e = 0; e < edges_.size(); ++e)
                if (const std::optional<CreasePoint> point = pointAt(uint32_t(view), e, tracer))
                    found[view].push_back(*point);
        });
        points_.clear();
        for (const std::vector<CreasePoint>& part : found) points_.insert(points_.end(), part.begin(), part.end());
    }

    std::optional<CreasePoint> pointAt(uint32_t view, uint32_t edge, const RayTracer& tracer) const {
        const Camera& camera = capture_.views[view].camera;
        const Vec3 middle = middleOf(edges_[edge]), toEye = Vec3(camera.position()) - middle;
        const Vec3 &a = normal(edges_[edge][0]), &b = normal(edges_[edge][1]);
        const float distance = glm::length(toEye);
        if (glm::dot(a, toEye) < facesEye * distance || glm::dot(b, toEye) < facesEye * distance) return {};
        const float pixel = distance / float(std::min(camera.focalX, camera.focalY));
        const std::optional<Vec2> at = camera.project(DVec3(middle)),
                                  further = camera.project(DVec3(middle + pixel * glm::normalize(glm::cross(a, b))));
        if (!at || !further || glm::length(*further - *at) < 0.3f) return {};
        const Vec3 before = middle + 1.5f * pixel * glm::normalize(a + b), ray = Vec3(camera.position()) - before;
        if (tracer.occluded({before, glm::normalize(ray), 0, glm::length(ray)})) return {};
        const Vec2 along = glm::normalize(*further - *at);
        CreasePoint point{view, edge, {along.y, -along.x}, 0};
        const std::optional<Profile> profile = profileAcross(capture_.views[view], *at, point.across, floor_);
        if (!profile) return {};
        const std::optional<float> step = findStep(*profile, creaseNoise);
        if (!step) return {};
        point.offset = *step;
        return point;
    }

    /// Pixels that the crease goes across by a metre that either side moves.
    std::array<double, 2> pixelsBy(const CreasePoint& p) const {
        const Camera& camera = capture_.views[p.view].camera;
        const Edge& edge = edges_[p.edge];
        const std::optional<std::array<float, 6>> moves = pixelsByPoint(camera, DVec3(middleOf(edge)));
        std::array<double, 2> by{};
        for (size_t k = 0; moves && k < 2; ++k) {
            if (still_[edge[k]]) continue;
            const DVec3 to(creaseBy(normal(edge[k]), normal(edge[1 - k])));
            const Vec3 n(glm::transpose(glm::dmat3(camera.worldFromCamera)) * to);
            by[k] = double(p.across.x * ((*moves)[0] * n.x + (*moves)[1] * n.y + (*moves)[2] * n.z) +
                           p.across.y * ((*moves)[3] * n.x + (*moves)[4] * n.y + (*moves)[5] * n.z));
        }
        return by;
    }

    void step() {
        NormalEquations equations(0, graph_.nodes.size());
        const double scale = std::max(2 * creaseSigma, 1.5 * medianOff(false));
        for (const CreasePoint& p : points_) {
            if (isLeftOut(p.view)) continue;
            const std::array<double, 2> by = pixelsBy(p);
            std::vector<std::pair<uint32_t, double>> row;
            for (size_t k = 0; k < 2; ++k)
                for (size_t n = 0; n < 4; ++n) {
                    const DisplacementGraph::Share& share = graph_.shares[edges_[p.edge][k]];
                    if (const double factor = by[k] * double(share.weight[n]); factor != 0)
                        row.push_back({share.node[n], factor});
                }
            if (row.empty()) continue;
            const double off = double(p.offset) / scale;
            equations.addNodePrior(row, double(p.offset),
                                   1 / ((1 + off * off) * creaseSigma * creaseSigma * creaseRepeated));
        }
        for (uint32_t n = 0; n < graph_.nodes.size(); ++n) {
            equations.addNodePrior({{n, 1.0}}, 0, 1 / (displacement_ * displacement_));
            std::vector<std::pair<uint32_t, double>> row{{n, 1.0}};
            for (const uint32_t m : graph_.neighbours[n]) row.push_back({m, -1 / double(graph_.neighbours[n].size())});
            if (row.size() > 1) equations.addNodePrior(row, 0, 1 / std::pow(creaseBend * displacement_, 2));
        }
        const NormalEquations::Step found = equations.solve(true);
        if (!found.valid) return;
        const std::vector<double> nodes(found.nodes.begin(), found.nodes.end());
        for (uint32_t v = 0; v < vertices_; ++v)
            if (!still_[v]) moved_[v] += graph_.at(v, nodes);
    }

    const Capture& capture_;
    const Scene& scene_;
    const std::vector<uint8_t>& still_;
    size_t vertices_;
    float floor_;
    Progress& progress_;
    const DisplacementGraph graph_;
    bool viewsLeftOut_ = false;
    double displacement_ = 0;                    ///< metres: standard deviation of a node
    std::vector<double> moved_;                  ///< of each vertex, metres along its normal
    std::vector<Edge> edges_;                    ///< that cross a crease
    std::vector<std::vector<uint32_t>> beyond_;  ///< of each vertex: those across the crease
    Mesh mesh_;
    std::vector<CreasePoint> points_;
};

}  // namespace

bool CreaseEstimate::needed() const {
    return points >= leastPoints && before > closeEnough && after < creasesLeft * before;
}

std::string toText(const CreaseEstimate& e) {
    return fmt::format("creases of the mesh lie {:.2f} pixels from the photographs' ({:.2f} before)", e.after,
                       e.before);
}

CreaseEstimate alignCreases(const Capture& capture, const Scene& scene, const std::vector<CreaseVertex>& creases,
                            const std::vector<uint8_t>& still, size_t vertices, float floor, Progress& progress) {
    CreaseEstimate found;
    CreaseFit fit(capture, scene, creases, still, vertices, floor, progress);
    found.points = fit.points();
    fit.leaveOutViews(true);
    found.before = found.after = fit.medianOff(true);
    if (found.points < leastPoints || !(found.before > closeEnough)) return found;
    progress.begin("Creases of the mesh brought to the photographs'", 2 * creaseRounds);
    fit.run();
    found.after = fit.medianOff(true);
    if (!found.needed()) return found;
    fit.leaveOutViews(false);
    fit.run();
    found.positions = fit.positions();
    return found;
}

}  // namespace relamp
