#include "solve/registration/flat_outline.h"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>

#include "base/dense.h"
#include "base/statistics.h"

namespace relamp {
namespace {

using DVec2 = glm::dvec2;

constexpr int directions = 96;  ///< across the slab in which its shape is known
constexpr int unknowns = directions + 2;
constexpr int rounds = 15;          ///< of reweighting
constexpr double smoothness = 0.3;  ///< weight of a pixel of second difference of the shape
constexpr double thickness = 0.1;   ///< of the slab's extent: what front and back are expected to be apart
constexpr double depthPrior = 0.2;  ///< of the slab's extent: what they may be off by
constexpr double steepest = 0.34;   ///< sine of the least angle to the slab
constexpr size_t leastViews = 4;
constexpr double independentPoints = 3;  ///< of a view
constexpr int window = 3;                ///< pixels either way that tell a boundary's direction

/// A ray in the slab's axes: two across it, the third its normal.
struct SlabRay {
    DVec3 eye, along;

    DVec2 at(double depth) const {
        const double s = (depth - eye.z) / along.z;
        return {eye.x + along.x * s, eye.y + along.y * s};
    }
};

/// A point of an outline, and one half a pixel on along it.
struct BoundaryPoint {
    SlabRay ray, beside;
    double focal;
};

/// Outward direction of the boundary at a point: away from the emitter's pixels around it; 0 where they tell none.
Vec2 outward(const std::vector<uint8_t>& shows, int width, int height, const Vec2& at) {
    Vec2 sum(0);
    const int x = int(at.x), y = int(at.y);
    for (int py = std::max(0, y - window); py <= std::min(height - 1, y + window); ++py)
        for (int px = std::max(0, x - window); px <= std::min(width - 1, x + window); ++px) {
            const Vec2 off = Vec2(float(px) + 0.5f, float(py) + 0.5f) - at;
            if (shows[size_t(py) * size_t(width) + size_t(px)] && glm::length(off) <= float(window)) sum -= off;
        }
    const float length = glm::length(sum);
    return length > 0 ? sum / length : Vec2(0);
}

std::vector<BoundaryPoint> pointsOf(const Capture& capture, const std::vector<EmitterOutline>& outlines,
                                    const DVec3& place, const DVec3& normal, FlatOutline& found) {
    found.first = glm::normalize(glm::cross(normal, std::abs(normal.z) < 0.7 ? DVec3(0, 0, 1) : DVec3(1, 0, 0)));
    found.second = glm::cross(normal, found.first);
    const auto axes = [&](const DVec3& v) {
        return DVec3(glm::dot(v, found.first), glm::dot(v, found.second), glm::dot(v, normal));
    };
    std::vector<BoundaryPoint> points;
    for (const EmitterOutline& outline : outlines) {
        const Camera& camera = capture.views[outline.view].camera;
        const DVec3 eye = axes(camera.position() - place);
        if (!(eye.z > steepest * glm::length(eye))) continue;
        ++found.views;
        for (const Vec2& at : outline.boundary) {
            const Vec2 out = outward(outline.shows, camera.width, camera.height, at);
            const Vec2 on = at + 0.5f * Vec2(-out.y, out.x);
            const SlabRay ray{eye, axes(DVec3(camera.rayDirection(at)))},
                beside{eye, axes(DVec3(camera.rayDirection(on)))};
            if (out != Vec2(0) && ray.along.z < 0 && beside.along.z < 0)
                points.push_back({ray, beside, std::sqrt(camera.focalX * camera.focalY)});
        }
    }
    return points;
}

/// Between which of the directions an angle lies: the lower one, and the weight of the next.
std::pair<int, double> directionOf(double x, double y) {
    const double turns = std::atan2(y, x) / (2 * piD) + 1, place = (turns - std::floor(turns)) * directions;
    return {int(place) % directions, place - std::floor(place)};
}

/// What a point says: shape and depth that it asks for, linear about present depths.
struct SlabRow {
    int direction = 0;                ///< the point lies between this one and the next
    double next = 0;                  ///< weight of the next one
    double ofShape = 0, ofDepth = 0;  ///< pixels a metre
    bool back = false;
    double value = 0;  ///< pixels

    double residual(const Eigen::VectorXd& x) const {
        return ofDepth * x[directions + back] -
               ofShape * ((1 - next) * x[direction] + next * x[(direction + 1) % directions]) - value;
    }
};

SlabRow rowOf(const BoundaryPoint& point, const std::array<double, 2>& depths) {
    SlabRow row;
    DVec2 at, across;
    for (int i = 0; i < 2; ++i) {
        const double depth = depths[row.back];
        at = point.ray.at(depth);
        const DVec2 on = point.beside.at(depth) - at;
        across = DVec2(on.y, -on.x) / std::max(1e-30, glm::length(on));
        if (glm::dot(across, at) < 0) across = -across;
        row.back = glm::dot(across, DVec2(point.ray.eye)) > glm::dot(across, at);
    }
    const double depth = depths[row.back], distance = glm::length(at);
    std::tie(row.direction, row.next) = directionOf(at.x, at.y);
    const double pixel = glm::length(DVec3(at, depth) - point.ray.eye) / point.focal;
    row.ofShape = glm::dot(across, at) / std::max(1e-30, distance) / pixel;
    row.ofDepth = glm::dot(across, DVec2(point.ray.along)) / point.ray.along.z / pixel;
    row.value = row.ofDepth * depth - row.ofShape * distance;
    return row;
}

}  // namespace

double FlatOutline::edgeTowards(double x, double y) const {
    const auto [direction, next] = directionOf(x, y);
    return (1 - next) * shape[size_t(direction)] + next * shape[size_t(direction + 1) % shape.size()];
}

std::optional<FlatOutline> fitFlatOutline(const Capture& capture, const std::vector<EmitterOutline>& outlines,
                                          const DVec3& place, const DVec3& normal) {
    FlatOutline found;
    const std::vector<BoundaryPoint> points = pointsOf(capture, outlines, place, normal, found);
    if (found.views < leastViews || points.size() < 2 * size_t(unknowns)) return {};
    std::array<double, 2> depths{0, 0};
    std::vector<double> weights(points.size(), 1), sizes(points.size());
    std::vector<SlabRow> rows(points.size());
    Eigen::MatrixXd gram;
    Eigen::VectorXd shape;
    double spread = 1;
    for (int round = 0; round < rounds; ++round) {
        gram = Eigen::MatrixXd::Zero(unknowns, unknowns);
        Eigen::VectorXd right = Eigen::VectorXd::Zero(unknowns);
        double extent = 0, perPixel = 0;
        for (size_t i = 0; i < points.size(); ++i) {
            const SlabRow& row = rows[i] = rowOf(points[i], depths);
            const std::array<int, 3> columns{row.direction, (row.direction + 1) % directions, directions + row.back};
            const std::array<double, 3> slopes{-row.ofShape * (1 - row.next), -row.ofShape * row.next, row.ofDepth};
            for (size_t a = 0; a < 3; ++a) {
                right[columns[a]] += weights[i] * slopes[a] * row.value;
                for (size_t b = 0; b < 3; ++b) gram(columns[a], columns[b]) += weights[i] * slopes[a] * slopes[b];
            }
            extent += glm::length(points[i].ray.at(0)) / double(points.size());
            perPixel += points[i].focal / glm::length(points[i].ray.eye) / double(points.size());
        }
        const double bend = smoothness * smoothness * perPixel * perPixel;
        for (int k = 0; k < directions; ++k) {
            const std::array<int, 3> at{(k + directions - 1) % directions, k, (k + 1) % directions};
            const std::array<double, 3> slope{-1, 2, -1};
            for (size_t a = 0; a < 3; ++a)
                for (size_t b = 0; b < 3; ++b) gram(at[a], at[b]) += bend * slope[a] * slope[b];
        }
        // Thin beside its extent, and about where it is thought to be.
        const double thin = 1 / (thickness * extent * thickness * extent),
                     there = 1 / (depthPrior * extent * depthPrior * extent);
        for (int k = 0; k < 2; ++k) {
            gram(directions + k, directions + k) += thin + there;
            gram(directions + k, directions + 1 - k) -= thin;
        }
        const Eigen::VectorXd x = solveSymmetric(gram, right);
        if (!x.allFinite()) return {};
        for (size_t i = 0; i < rows.size(); ++i) sizes[i] = std::abs(rows[i].residual(x));
        found.residual = medianOf(sizes);
        spread = std::max(0.3, 1.4826 * found.residual);
        for (size_t i = 0; i < rows.size(); ++i) {
            const double r = sizes[i] / (1.5 * spread);
            weights[i] = 1 / (1 + r * r);
        }
        depths = {x[directions], x[directions + 1]};
        shape = x;
    }
    const double repeated = double(points.size()) / (independentPoints * double(found.views));
    const Eigen::VectorXd unit = Eigen::VectorXd::Unit(unknowns, directions);
    found.deviation = spread * std::sqrt(std::max(1.0, repeated) * solveSymmetric(gram, unit)[directions]);
    found.front = depths[0];
    found.back = depths[1];
    found.shape.assign(shape.data(), shape.data() + directions);
    return found;
}

}  // namespace relamp
