#include "texture/charts.h"

#include "texture/texels_inside.h"

namespace relamp {

std::vector<std::array<uint32_t, 3>> trianglesBeside(const Mesh& mesh) {
    struct Side {
        uint32_t low, high, triangle, edge;
    };
    std::vector<Side> sides;
    sides.reserve(mesh.triangles.size() * 3);
    for (uint32_t t = 0; t < mesh.triangles.size(); ++t)
        for (uint32_t k = 0; k < 3; ++k) {
            const uint32_t a = mesh.triangles[t][k], b = mesh.triangles[t][(k + 1) % 3];
            sides.push_back({std::min(a, b), std::max(a, b), t, k});
        }
    std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
        return std::tie(a.low, a.high, a.triangle, a.edge) < std::tie(b.low, b.high, b.triangle, b.edge);
    });
    std::vector<std::array<uint32_t, 3>> beside(mesh.triangles.size(), {noNeighbour, noNeighbour, noNeighbour});
    for (size_t i = 0; i < sides.size();) {
        size_t end = i + 1;
        while (end < sides.size() && sides[end].low == sides[i].low && sides[end].high == sides[i].high) ++end;
        if (end - i == 2) {
            beside[sides[i].triangle][sides[i].edge] = sides[i + 1].triangle;
            beside[sides[i + 1].triangle][sides[i + 1].edge] = sides[i].triangle;
        }
        i = end;
    }
    return beside;
}

namespace {

/// What of a chart's plane is taken, and how high above it the surface lies there.
class TakenPlane {
public:
    explicit TakenPlane(const Vec2& extent) {
        // Triangles may be smaller than texels: parts of texels, as far as memory goes.
        constexpr float mostCells = 3e7f;
        cells_ = std::clamp(std::sqrt(mostCells / ((extent.x + 2) * (extent.y + 2))), 1.0f, 4.0f);
        width_ = int((extent.x + 2) * cells_);
        height_ = int((extent.y + 2) * cells_);
        above_.assign(size_t(width_) * size_t(height_), free);
    }
    /// Takes the cells whose centres lie inside the triangle; false, and nothing is taken, where one is taken already,
    /// or where a texel beside it belongs to another layer of the surface. `above`: texels, of its corners.
    bool take(std::array<Vec2, 3> p, const Vec3& above) {
        for (Vec2& corner : p) corner *= cells_;
        const Vec2 a = p[1] - p[0], b = p[2] - p[0];
        const float area = crossOf(a, b);
        if (!(area > 0)) return true;
        const Vec2 slope = ((above.y - above.x) * Vec2(b.y, -b.x) + (above.z - above.x) * Vec2(-a.y, a.x)) / area;
        const Vec2 low = glm::min(p[0], glm::min(p[1], p[2])) - cells_,
                   high = glm::max(p[0], glm::max(p[1], p[2])) + cells_;
        inside_.clear();
        for (int y = std::max(0, int(low.y - 0.5f)); y <= std::min(height_ - 1, int(high.y) + 1); ++y)
            for (int x = std::max(0, int(low.x - 0.5f)); x <= std::min(width_ - 1, int(high.x) + 1); ++x) {
                const Vec2 centre(float(x) + 0.5f, float(y) + 0.5f);
                const size_t at = size_t(y) * size_t(width_) + size_t(x);
                const bool inside = isInside(p, area, centre);
                const float here = above.x + glm::dot(slope, centre - p[0]);
                if (above_[at] != free && (inside || std::abs(above_[at] - here) > layer)) return false;
                if (inside) inside_.emplace_back(at, here);
            }
        for (const auto& [at, here] : inside_) above_[at] = here;
        return true;
    }

private:
    static constexpr float free = 1e30f;
    static constexpr float layer = 8;  ///< texels: a surface as steep as a chart's may be rises less to the next one

    float cells_;  ///< a texel's side
    int width_, height_;
    std::vector<float> above_;
    std::vector<std::pair<size_t, float>> inside_;

    /// Centres on an edge belong to both sides and say nothing.
    static bool isInside(const std::array<Vec2, 3>& p, float area, const Vec2& c) {
        constexpr float inset = 1e-3f;
        for (size_t k = 0; k < 3; ++k)
            if (!(crossOf(p[(k + 1) % 3] - p[k], c - p[k]) > inset * area)) return false;
        return true;
    }
};

class ChartGrower {
public:
    ChartGrower(const Mesh& mesh, const std::vector<float>& density, const AtlasOptions& options)
        : mesh_(mesh),
          density_(density),
          options_(options),
          beside_(trianglesBeside(mesh)),
          done_(mesh.triangles.size(), 0) {
        for (size_t t = 0; t < mesh.triangles.size(); ++t) {
            const Triangle& c = mesh.triangles[t];
            const Vec3 sum = mesh.normals[c[0]] + mesh.normals[c[1]] + mesh.normals[c[2]];
            const float length = glm::length(sum);
            facing_.push_back(length > 0 ? sum / length : mesh.faceNormal(t));
            if (!(density[t] > 0)) done_[t] = 1;
        }
    }

    std::vector<Chart> grow(Progress& progress) {
        std::vector<Chart> charts;
        for (uint32_t t = 0; t < done_.size(); ++t) {
            if (t % 1024 == 0) progress.advance(std::min<size_t>(1024, done_.size() - t));
            // What a chart could not hold without covering itself starts again.
            while (!done_[t]) charts.push_back(chartFrom(t));
        }
        return charts;
    }

private:
    const Mesh& mesh_;
    const std::vector<float>& density_;
    const AtlasOptions& options_;
    std::vector<std::array<uint32_t, 3>> beside_;
    std::vector<uint8_t> done_;
    std::vector<Vec3> facing_;

    /// Mean direction of the nearest triangles: one triangle's own is noisy.
    Vec3 axisAround(uint32_t seed) const {
        constexpr size_t most = 60;
        std::vector<uint32_t> near{seed};
        Vec3 sum(0);
        for (size_t i = 0; i < near.size(); ++i) {
            sum += facing_[near[i]] * std::max(mesh_.triangleArea(near[i]), 1e-12f);
            for (uint32_t n : beside_[near[i]])
                if (near.size() < most && n != noNeighbour && !done_[n] && glm::dot(facing_[n], facing_[seed]) > 0.5f &&
                    std::find(near.begin(), near.end(), n) == near.end())
                    near.push_back(n);
        }
        const float length = glm::length(sum);
        const Vec3 axis = length > 0 ? sum / length : facing_[seed];
        return glm::dot(axis, mesh_.faceNormal(seed)) > 0.1f ? axis : mesh_.faceNormal(seed);
    }

    Chart chartFrom(uint32_t seed) {
        const Vec3 axis = axisAround(seed);
        const float cosine = std::cos(options_.mostTurn * pi / 180);
        // No chart is wider than the image.
        const Vec3 centre = mesh_.positions[mesh_.triangles[seed][0]];
        const float reach = 0.45f * float(options_.mostSide) / (density_[seed] * options_.mostDensityRatio);
        std::vector<uint32_t> grown{seed};
        done_[seed] = 1;
        for (size_t i = 0; i < grown.size(); ++i)
            for (uint32_t n : beside_[grown[i]]) {
                if (n == noNeighbour || done_[n] || glm::dot(facing_[n], axis) < cosine ||
                    glm::dot(mesh_.faceNormal(n), axis) < 0.15f ||
                    density_[n] > options_.mostDensityRatio * density_[seed] ||
                    density_[n] * options_.mostDensityRatio < density_[seed] ||
                    glm::length(mesh_.positions[mesh_.triangles[n][0]] - centre) > reach)
                    continue;
                done_[n] = 1;
                grown.push_back(n);
            }
        return flattened(std::move(grown), axis);
    }

    /// Puts the triangles on their plane, turned so that the rectangle around them is small.
    Chart flattened(std::vector<uint32_t>&& grown, const Vec3& axis) {
        Chart chart;
        double weighted = 0, area = 0;
        for (uint32_t t : grown) {
            const double a = std::max(double(mesh_.triangleArea(t)), 1e-12);
            weighted += a * double(density_[t]);
            area += a;
        }
        chart.density = float(weighted / area);
        const Mat3 frame = frameAround(axis);
        Vec2 mean(0);
        const auto onPlane = [&](uint32_t v) {
            const Vec3 p = (mesh_.positions[v] - mesh_.positions[mesh_.triangles[grown[0]][0]]) * chart.density;
            return Vec2(glm::dot(p, frame[0]), glm::dot(p, frame[1]));
        };
        for (uint32_t t : grown)
            for (uint32_t v : mesh_.triangles[t]) mean += onPlane(v) / float(3 * grown.size());
        glm::mat2 spread(0);
        for (uint32_t t : grown)
            for (uint32_t v : mesh_.triangles[t]) {
                const Vec2 d = onPlane(v) - mean;
                spread += glm::outerProduct(d, d);
            }
        const float angle = 0.5f * std::atan2(2 * spread[0][1], spread[0][0] - spread[1][1]);
        const Vec2 along(std::cos(angle), std::sin(angle)), across(-along.y, along.x);
        Vec2 low(1e30f), high(-1e30f);
        std::vector<std::array<Vec2, 3>> corners;
        for (uint32_t t : grown) {
            std::array<Vec2, 3> p;
            for (size_t k = 0; k < 3; ++k) {
                const Vec2 q = onPlane(mesh_.triangles[t][k]);
                p[k] = Vec2(glm::dot(q, along), glm::dot(q, across));
                low = glm::min(low, p[k]);
                high = glm::max(high, p[k]);
            }
            corners.push_back(p);
        }
        for (auto& c : corners)
            for (Vec2& p : c) p -= low;
        const Vec3 origin = mesh_.positions[mesh_.triangles[grown[0]][0]];
        const auto heightOf = [&](uint32_t v) { return glm::dot(mesh_.positions[v] - origin, axis) * chart.density; };
        TakenPlane taken(high - low);
        const auto above = [&](uint32_t t) {
            const Triangle& c = mesh_.triangles[t];
            return Vec3(heightOf(c[0]), heightOf(c[1]), heightOf(c[2]));
        };
        for (size_t i = 0; i < grown.size(); ++i) {
            if (!taken.take(corners[i], above(grown[i])) && i > 0) {
                done_[grown[i]] = 0;
                continue;
            }
            chart.triangles.push_back(grown[i]);
            chart.corners.push_back(corners[i]);
            for (const Vec2& p : corners[i]) chart.extent = glm::max(chart.extent, p);
        }
        return chart;
    }
};

}  // namespace

std::vector<Chart> growCharts(const Mesh& mesh, const std::vector<float>& texelsPerMetre, const AtlasOptions& options,
                              Progress& progress) {
    progress.begin("Charts of the surface", mesh.triangles.size());
    return ChartGrower(mesh, texelsPerMetre, options).grow(progress);
}

}  // namespace relamp
