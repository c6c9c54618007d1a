#include "clusters/emission_pattern.h"

#include "base/box.h"
#include "base/statistics.h"
#include "clusters/patches.h"
#include "scene/rim.h"

namespace relamp {
namespace {

constexpr int cubesAlong = 16;
constexpr float darkest = 0.02f, brightest = 50;
constexpr size_t fewestVertices = 24;
constexpr size_t mostPoints = 20000;  // a cube has more than a few of them then

/// The value at `corner` of the plane that fits the points around it; -1 where there are none.
float planeAt(const Vec3& corner, float cell, const std::vector<Vec3>& points, const std::vector<float>& levels) {
    glm::dmat4 products(0);
    glm::dvec4 moments(0);
    for (size_t i = 0; i < points.size(); ++i) {
        const Vec3 d = (points[i] - corner) / cell;
        const double squared = glm::dot(d, d);
        if (squared > 4) continue;
        const double weight = std::exp(-2 * squared);
        const glm::dvec4 terms(1, d.x, d.y, d.z);
        products += weight * glm::outerProduct(terms, terms);
        moments += weight * double(levels[i]) * terms;
    }
    if (!(products[0][0] > 0)) return -1;
    // Flat emitters and lone points do not tell the slope across or at all.
    for (int k = 1; k < 4; ++k) products[k][k] += 1e-2 * products[0][0];
    return float((glm::inverse(products) * moments).x);
}

/// Median distance of a point to the one next to it, of 64 of them.
float spacingOf(const std::vector<Vec3>& points) {
    std::vector<float> nearest;
    const size_t step = std::max<size_t>(1, points.size() / 64);
    for (size_t i = 0; i < points.size(); i += step) {
        float least = 1e30f;
        for (size_t k = 0; k < points.size(); ++k)
            if (k != i) least = std::min(least, glm::distance(points[i], points[k]));
        if (least < 1e30f) nearest.push_back(least);
    }
    return nearest.empty() ? 0.0f : medianOf(std::move(nearest));
}

/// Which of the cluster's vertices lie on it: position in `vertices`, or -1.
std::vector<int> placesOf(size_t count, const std::vector<uint32_t>& vertices) {
    std::vector<int> place(count, -1);
    for (size_t i = 0; i < vertices.size(); ++i) place[vertices[i]] = int(i);
    return place;
}

/// What is not known (below 0) becomes the mean of its neighbours, ring by ring.
void fillUnknown(const std::vector<std::vector<uint32_t>>& neighbours, std::vector<float>& level) {
    for (bool changed = true; changed;) {
        changed = false;
        const std::vector<float> before = level;
        for (size_t i = 0; i < level.size(); ++i) {
            if (before[i] >= 0) continue;
            float sum = 0, count = 0;
            for (const uint32_t j : neighbours[i])
                if (before[j] >= 0) sum += before[j], ++count;
            if (count > 0) level[i] = sum / count, changed = true;
        }
    }
    for (float& l : level)
        if (l < 0) l = 1;
}

/// What is not known (below 0) goes on from what lies within three edges as a plane does, by half to double at most.
void continueOutward(const Scene& scene, const std::vector<uint32_t>& vertices,
                     const std::vector<std::vector<uint32_t>>& neighbours, std::vector<float>& level) {
    const std::vector<float> known = level;
    std::vector<uint32_t> reached, met(level.size(), 0);  // met: by which vertex last, counted from 1
    std::vector<Vec3> points;
    std::vector<float> levels;
    for (size_t i = 0; i < level.size(); ++i) {
        if (known[i] >= 0) continue;
        reached.assign(1, uint32_t(i));
        met[i] = uint32_t(i + 1);
        for (size_t edge = 0, begin = 0; edge < 3; ++edge)
            for (const size_t end = reached.size(); begin < end; ++begin)
                for (const uint32_t k : neighbours[reached[begin]])
                    if (met[k] != i + 1) met[k] = uint32_t(i + 1), reached.push_back(k);
        points.clear();
        levels.clear();
        const Vec3 at = scene.mesh.positions[vertices[i]];
        float nearest = 1e30f, own = 1;
        for (const uint32_t k : reached) {
            if (known[k] < 0) continue;
            points.push_back(scene.mesh.positions[vertices[k]]);
            levels.push_back(known[k]);
            if (const float d = glm::distance(points.back(), at); d < nearest) nearest = d, own = known[k];
        }
        const float plane = planeAt(at, 1.5f * scene.vertexSpacing[vertices[i]], points, levels);
        if (plane >= 0) level[i] = std::clamp(plane, own / 2, own * 2);
    }
}

/// Over the triangles' area; `value` of the cluster's vertices.
float meanOverSurface(const Mesh& mesh, const EmitterCluster& cluster, const std::vector<int>& place,
                      const std::vector<float>& value) {
    double sum = 0, area = 0;
    for (const uint32_t t : cluster.triangles) {
        const double third = double(mesh.triangleArea(t)) / 3;
        for (const uint32_t v : mesh.triangles[t]) {
            if (place[v] < 0) continue;
            sum += third * double(value[size_t(place[v])]);
            area += third;
        }
    }
    return area > 0 ? float(sum / area) : 1.0f;
}

}  // namespace

EmissionPattern::EmissionPattern(std::vector<Vec3> points, std::vector<float> levels) {
    Box box;
    for (const Vec3& p : points) box.grow(p);
    level_.assign(1, 1.0f);
    if (points.empty()) return;
    if (const size_t step = points.size() / mostPoints + 1; step > 1) {
        size_t kept = 0;
        for (size_t i = 0; i < points.size(); i += step, ++kept) points[kept] = points[i], levels[kept] = levels[i];
        points.resize(kept);
        levels.resize(kept);
    }
    const Vec3 size = box.size();
    low_ = box.min;
    cell_ = std::max({maxChannel(size) / cubesAlong, spacingOf(points), 1e-12f});
    for (int a = 0; a < 3; ++a) corners_[size_t(a)] = std::max(1, int(std::ceil(size[a] / cell_ - 1e-3f)) + 1);
    level_.assign(size_t(corners_[0]) * size_t(corners_[1]) * size_t(corners_[2]), -1.0f);
    const auto index = [&](int x, int y, int z) { return size_t((z * corners_[1] + y) * corners_[0] + x); };
    const auto each = [&](auto&& visit) {
        for (int z = 0; z < corners_[2]; ++z)
            for (int y = 0; y < corners_[1]; ++y)
                for (int x = 0; x < corners_[0]; ++x) visit(x, y, z);
    };
    each([&](int x, int y, int z) {
        const float level = planeAt(low_ + cell_ * Vec3(x, y, z), cell_, points, levels);
        if (level >= 0) level_[index(x, y, z)] = std::clamp(level, darkest, brightest);
    });
    // Corners far from the surface, which points between others may need.
    std::vector<std::vector<uint32_t>> neighbours(level_.size());
    each([&](int x, int y, int z) {
        for (const auto& [dx, dy, dz] : {std::array{-1, 0, 0}, std::array{1, 0, 0}, std::array{0, -1, 0},
                                         std::array{0, 1, 0}, std::array{0, 0, -1}, std::array{0, 0, 1}})
            if (const int u = x + dx, v = y + dy, w = z + dz;
                u >= 0 && v >= 0 && w >= 0 && u < corners_[0] && v < corners_[1] && w < corners_[2])
                neighbours[index(x, y, z)].push_back(uint32_t(index(u, v, w)));
    });
    fillUnknown(neighbours, level_);
}

float EmissionPattern::corner(int x, int y, int z) const {
    return level_[size_t((std::min(z, corners_[2] - 1) * corners_[1] + std::min(y, corners_[1] - 1)) * corners_[0] +
                         std::min(x, corners_[0] - 1))];
}

float EmissionPattern::at(const Vec3& point) const {
    int i[3];
    float f[3];
    for (int a = 0; a < 3; ++a) {
        const float place = std::clamp((point[a] - low_[a]) / cell_, 0.0f, float(corners_[size_t(a)] - 1));
        i[a] = int(place);
        f[a] = place - float(i[a]);
    }
    const auto along = [&](int y, int z) { return (1 - f[0]) * corner(i[0], y, z) + f[0] * corner(i[0] + 1, y, z); };
    const auto over = [&](int z) { return (1 - f[1]) * along(i[1], z) + f[1] * along(i[1] + 1, z); };
    return (1 - f[2]) * over(i[2]) + f[2] * over(i[2] + 1);
}

void rebuildPattern(const Mesh& mesh, EmitterCluster& cluster) {
    cluster.pattern.reset();
    if (cluster.level.empty()) return;
    std::vector<Vec3> points;
    for (const uint32_t v : cluster.vertices) points.push_back(mesh.positions[v]);
    cluster.pattern = std::make_shared<const EmissionPattern>(points, cluster.level);
}

void takeEmissionPattern(const Scene& scene, const std::vector<VertexRadiance>& seen, EmitterCluster& cluster) {
    constexpr float evenWithin = 0.06f, clippedAtMost = 0.05f, stillDiffers = 0.05f;
    cluster.level.clear();
    cluster.pattern.reset();
    const float mean = luminance(cluster.radiance);
    if (cluster.unobserved || cluster.fitted || cluster.vertices.size() < fewestVertices || !(mean > 0) ||
        cluster.evidence.uniformity <= evenWithin || cluster.evidence.clippedFraction > clippedAtMost)
        return;
    const std::vector<int> place = placesOf(seen.size(), cluster.vertices);
    const size_t n = cluster.vertices.size();
    std::vector<std::vector<uint32_t>> neighbours(n);
    const std::vector<uint8_t> rim = rimVertices(scene.mesh);
    std::vector<uint8_t> border(n, 0);
    for (size_t i = 0; i < n; ++i) {
        border[i] = rim[cluster.vertices[i]];
        for (uint32_t e = scene.graph.start[cluster.vertices[i]]; e < scene.graph.start[cluster.vertices[i] + 1]; ++e) {
            const int j = place[scene.graph.to[e]];
            if (j >= 0) neighbours[i].push_back(uint32_t(j));
            else border[i] = 1;
        }
    }
    std::vector<float> level(n, -1);
    for (size_t i = 0; i < n; ++i)
        if (const VertexRadiance& s = seen[cluster.vertices[i]]; s.weight > 0.1f && !border[i])
            level[i] = std::clamp(luminance(s.radiance) / mean, darkest, brightest);
    if (size_t(std::count_if(level.begin(), level.end(), [](float l) { return l >= 0; })) < fewestVertices) return;
    continueOutward(scene, cluster.vertices, neighbours, level);
    fillUnknown(neighbours, level);
    const std::vector<float> raw = level;
    for (size_t i = 0; i < n; ++i) {
        if (neighbours[i].empty()) continue;
        float sum = 0;
        for (const uint32_t j : neighbours[i]) sum += raw[j];
        level[i] = 0.5f * raw[i] + 0.5f * sum / float(neighbours[i].size());
    }
    const float whole = meanOverSurface(scene.mesh, cluster, place, level);
    for (float& l : level) l /= whole;
    const float middle = medianOf(level);
    std::vector<float> off;
    for (const float l : level) off.push_back(std::abs(l - middle));
    if (1.4826f * medianOf(std::move(off)) < stillDiffers * middle) return;
    cluster.level = std::move(level);
    cluster.radiance *= whole;
    rebuildPattern(scene.mesh, cluster);
}

}  // namespace relamp
