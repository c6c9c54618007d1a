#include "scene/revolution_surface.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "base/random.h"

namespace relamp {
namespace {

constexpr size_t mostTried = 20000;  ///< vertices, any of them
constexpr size_t mostJudges = 300;   ///< vertices that a trial's surface is tried on
constexpr uint64_t trials = 1500, drawsPerTrial = 10;
constexpr float near = 0.05f, far = 0.1f;           ///< of the diagonal: in which a trial looks about its seed
constexpr double facing = 0.9;                      ///< cosine between normals of mesh and surface
constexpr double apart = 0.95;                      ///< cosine that three normals must differ by
constexpr double thinnest = 0.002, thickest = 0.5;  ///< radii, of the diagonal
constexpr double steepest = 3;                      ///< slope: flatter cones are discs
constexpr float flat = 0.97f;                       ///< length of the mean normal: hardly any surface of revolution
constexpr size_t leastPool = 50;
constexpr int refinements = 6;
constexpr int attempts = 3;  ///< where all vertices refute what some told

/// Unit direction in which the matrix is least (inverse iteration; it is symmetric and has no negative values).
DVec3 leastDirection(const glm::dmat3& matrix) {
    const double trace = matrix[0][0] + matrix[1][1] + matrix[2][2];
    const glm::dmat3 inverse = glm::inverse(matrix + glm::dmat3(1e-6 * trace));
    DVec3 direction = glm::normalize(DVec3(0.3, 0.5, 0.8));
    for (int i = 0; i < 60; ++i) direction = glm::normalize(inverse * direction);
    return direction;
}

class Search {
public:
    Search(const Scene& scene, const std::vector<uint8_t>& taken, float tolerance)
        : scene_(scene), tolerance_(double(tolerance)) {
        for (uint32_t v = 0; v < scene.mesh.vertexCount(); ++v)
            if (scene.referenced[v] && !taken[v]) all_.push_back(v);
        std::sort(all_.begin(), all_.end(),
                  [&](uint32_t a, uint32_t b) { return std::pair(scene.rank[a], a) < std::pair(scene.rank[b], b); });
    }

    /// The first of the best.
    void tryAll() {
        if (all_.empty()) return;
        std::vector<Trial> found(trials);
        parallelFor(found.size(), 16, [&](size_t trial) { found[trial] = tryOnce(trial); });
        const auto best = std::max_element(found.begin(), found.end(),
                                           [](const Trial& a, const Trial& b) { return a.area < b.area; });
        bestArea_ = best->area;
        if (bestArea_ > 0)
            best_ = {best->surface, verticesOn(best->surface, poolOf(uint64_t(best - found.begin())), tolerance_), 0,
                     0};
    }

    /// Vertices of the best surface.
    const std::vector<uint32_t>& best() const { return best_.vertices; }

    std::optional<FoundRevolution> refined() && {
        if (!(bestArea_ > 0)) return {};
        for (int i = 0; i < refinements; ++i) {
            std::vector<DVec3> at, normal;
            DVec3 middle(0);
            for (const uint32_t v : best_.vertices) {
                at.push_back(DVec3(scene_.mesh.positions[v]));
                normal.push_back(DVec3(scene_.mesh.normals[v]));
                middle += at.back();
            }
            middle /= double(at.size());
            const std::optional<RevolutionSurface> surface = fitRevolution(at, normal);
            if (!surface || !plausible(*surface)) return {};
            double reach = 0;
            for (const DVec3& p : at) reach = std::max(reach, glm::length(p - middle));
            std::vector<uint32_t> around;
            for (const uint32_t v : all_)
                if (glm::length(DVec3(scene_.mesh.positions[v]) - middle) < 1.3 * reach) around.push_back(v);
            best_.surface = *surface;
            best_.vertices = verticesOn(*surface, around, 2 * tolerance_);
            if (best_.vertices.size() < leastPool) return {};
        }
        best_.low = 1e30;
        best_.high = -1e30;
        for (const uint32_t v : best_.vertices) {
            const double height = best_.surface.height(DVec3(scene_.mesh.positions[v]));
            best_.low = std::min(best_.low, height);
            best_.high = std::max(best_.high, height);
        }
        return std::move(best_);
    }

private:
    struct Trial {
        RevolutionSurface surface;
        double area = 0;
    };
    /// Vertices about the trial's seed, in the order of their ranks.
    std::vector<uint32_t> poolOf(uint64_t trial) const {
        const uint32_t seed = all_[size_t(unitFloat(mixBits(trial)) * float(all_.size()))];
        const float reach = (trial % 2 ? near : far) * scene_.diagonal;
        std::vector<uint32_t> pool;
        for (size_t i = 0; i < std::min(all_.size(), mostTried); ++i)
            if (glm::length(scene_.mesh.positions[all_[i]] - scene_.mesh.positions[seed]) < reach)
                pool.push_back(all_[i]);
        return pool;
    }
    Trial tryOnce(uint64_t trial) const {
        const std::vector<uint32_t> pool = poolOf(trial);
        Vec3 sum(0);
        for (const uint32_t v : pool) sum += scene_.mesh.normals[v];
        Trial best;
        if (pool.size() < leastPool || glm::length(sum) > flat * float(pool.size())) return best;
        // In the order of their ranks: any of them.
        const std::vector<uint32_t> judges(pool.begin(), pool.begin() + long(std::min(pool.size(), mostJudges)));
        for (uint64_t draw = 0; draw < drawsPerTrial; ++draw) {
            std::array<DVec3, 3> at, normal;
            for (uint64_t k = 0; k < 3; ++k) {
                const float u = unitFloat(mixBits(mixBits(trial * drawsPerTrial + draw) ^ k));
                const uint32_t v = pool[size_t(u * float(pool.size()))];
                at[k] = DVec3(scene_.mesh.positions[v]);
                normal[k] = DVec3(scene_.mesh.normals[v]);
            }
            if (glm::dot(normal[0], normal[1]) > apart || glm::dot(normal[0], normal[2]) > apart ||
                glm::dot(normal[1], normal[2]) > apart)
                continue;
            const std::optional<RevolutionSurface> surface = fitRevolution(at, normal);
            if (!surface || !plausible(*surface)) continue;
            const std::vector<uint32_t> on = verticesOn(*surface, judges, tolerance_);
            if (on.size() * 5 < judges.size()) continue;
            double area = 0;
            for (const uint32_t v : on) area += double(scene_.vertexSpacing[v]) * double(scene_.vertexSpacing[v]);
            area *= double(pool.size()) / double(judges.size());
            if (area > best.area) best = {*surface, area};
        }
        return best;
    }
    bool plausible(const RevolutionSurface& s) const {
        return s.radius > thinnest * double(scene_.diagonal) && s.radius < thickest * double(scene_.diagonal) &&
               std::abs(s.slope) < steepest;
    }
    std::vector<uint32_t> verticesOn(const RevolutionSurface& surface, const std::vector<uint32_t>& of,
                                     double tolerance) const {
        std::vector<uint32_t> on;
        for (const uint32_t v : of) {
            const DVec3 p(scene_.mesh.positions[v]);
            if (std::abs(surface.distance(p)) < tolerance &&
                glm::dot(surface.normalAt(p), DVec3(scene_.mesh.normals[v])) > facing)
                on.push_back(v);
        }
        return on;
    }

    const Scene& scene_;
    double tolerance_;
    std::vector<uint32_t> all_;
    FoundRevolution best_;
    double bestArea_ = 0;
};

}  // namespace

double RevolutionSurface::angle(const DVec3& p) const {
    const DVec3 from = p - centre;
    return std::atan2(glm::dot(from, glm::cross(axis, across)), glm::dot(from, across));
}

double RevolutionSurface::distance(const DVec3& p) const {
    const double h = height(p);
    return (glm::length(p - centre - h * axis) - radiusAt(h)) / std::sqrt(1 + slope * slope);
}

DVec3 RevolutionSurface::at(double height, double angle) const {
    return centre + height * axis +
           radiusAt(height) * (std::cos(angle) * across + std::sin(angle) * glm::cross(axis, across));
}

DVec3 RevolutionSurface::normal(double angle) const {
    return glm::normalize(std::cos(angle) * across + std::sin(angle) * glm::cross(axis, across) - slope * axis);
}

DVec3 RevolutionSurface::normalAt(const DVec3& p) const {
    const DVec3 away = p - centre - height(p) * axis;
    return glm::normalize(away / glm::length(away) - slope * axis);
}

std::optional<std::pair<double, double>> RevolutionSurface::meets(const DVec3& eye, const DVec3& direction) const {
    const DVec3 from = eye - centre;
    const double h = glm::dot(from, axis), dh = glm::dot(direction, axis);
    const double r = radiusAt(h), dr = slope * dh;
    const double a = 1 - dh * dh - dr * dr, b = glm::dot(from, direction) - h * dh - r * dr,
                 c = glm::dot(from, from) - h * h - r * r;
    const double inside = b * b - a * c;
    if (!(inside > 0) || a == 0) return {};
    const double root = std::sqrt(inside), first = (-b - root) / a, second = (-b + root) / a;
    return std::minmax({first, second});
}

std::optional<RevolutionSurface> fitRevolution(std::span<const DVec3> positions, std::span<const DVec3> normals) {
    const double count = double(positions.size());
    DVec3 mean(0);
    for (const DVec3& n : normals) mean += n / count;
    glm::dmat3 spread(0);
    for (const DVec3& n : normals) spread += glm::outerProduct(n - mean, n - mean);
    RevolutionSurface s;
    s.axis = leastDirection(spread);
    if (!isFinite(s.axis)) return {};
    s.across = glm::normalize(glm::cross(s.axis, std::abs(s.axis.x) < 0.7 ? DVec3(1, 0, 0) : DVec3(0, 1, 0)));
    const DVec3 other = glm::cross(s.axis, s.across);
    // Seen along the axis, lines along the normals meet in one point.
    glm::dmat2 q(0);
    glm::dvec2 c(0);
    for (size_t i = 0; i < positions.size(); ++i) {
        const glm::dvec2 p(glm::dot(positions[i] - positions[0], s.across),
                           glm::dot(positions[i] - positions[0], other));
        const glm::dvec2 along(glm::dot(normals[i], s.across), glm::dot(normals[i], other));
        const double length = glm::length(along);
        if (length < 0.2) continue;
        const glm::dvec2 off = glm::dvec2(-along.y, along.x) / length;
        q += glm::outerProduct(off, off);
        c += off * glm::dot(off, p);
    }
    if (!(glm::determinant(q) > 1e-4 * count * count)) return {};
    const glm::dvec2 centre = glm::inverse(q) * c;
    s.centre = positions[0] + s.across * centre.x + other * centre.y;
    double h = 0, r = 0, hh = 0, hr = 0;
    for (const DVec3& p : positions) {
        const double height = s.height(p), away = glm::length(p - s.centre - height * s.axis);
        h += height / count;
        r += away / count;
        hh += height * height / count;
        hr += height * away / count;
    }
    const double variance = hh - h * h;
    s.slope = variance > 1e-12 * r * r ? (hr - h * r) / variance : 0;
    s.radius = r - s.slope * h;
    if (!std::isfinite(s.radius) || !std::isfinite(s.slope)) return {};
    return s;
}

std::optional<FoundRevolution> findRevolution(const Scene& scene, const std::vector<uint8_t>& taken, float tolerance) {
    std::vector<uint8_t> refuted = taken;
    for (int attempt = 0; attempt < attempts; ++attempt) {
        Search search(scene, refuted, tolerance);
        search.tryAll();
        const std::vector<uint32_t> vertices = search.best();
        if (std::optional<FoundRevolution> found = std::move(search).refined()) return found;
        if (vertices.empty()) return {};
        for (const uint32_t v : vertices) refuted[v] = 1;
    }
    return {};
}

}  // namespace relamp
