#include "clusters/follow_outlines.h"

#include <algorithm>
#include <array>

#include "base/parallel.h"

namespace relamp {
namespace {

constexpr int followSteps = 24;
constexpr double loosest = 3, tightest = 0.75;  ///< pixels: scale of the robust weights, first and last
constexpr size_t mostUnknowns = 9;

using Row = std::array<double, mostUnknowns>;

/// Corners of a box; points on the rims of a tube or cone.
std::vector<DVec3> cornersOf(const EmitterBody& body) {
    std::vector<DVec3> corners;
    constexpr int around = 24;
    for (const double x : {-1.0, 1.0}) {
        if (body.round)
            for (int k = 0; k < around; ++k) {
                const double a = 2 * piD * k / around;
                const double r = body.radiusAt(x * body.half.x);
                corners.push_back({x * body.half.x, r * std::cos(a), r * std::sin(a)});
            }
        else
            for (const double y : {-1.0, 1.0})
                for (const double z : {-1.0, 1.0}) corners.push_back(DVec3(x, y, z) * body.half);
    }
    for (DVec3& c : corners) c = body.centre + body.axes * c;
    return corners;
}

double turnOf(const Vec2& a, const Vec2& b, const Vec2& c) {
    return double(b.x - a.x) * double(c.y - a.y) - double(b.y - a.y) * double(c.x - a.x);
}

/// Convex hull, in the order in which its inside lies to the left.
std::vector<Vec2> hullOf(std::vector<Vec2> points) {
    std::sort(points.begin(), points.end(),
              [](const Vec2& a, const Vec2& b) { return a.x < b.x || (a.x == b.x && a.y < b.y); });
    std::vector<Vec2> hull(2 * points.size());
    size_t count = 0;
    const auto add = [&](const Vec2& p, size_t floor) {
        while (count >= floor && turnOf(hull[count - 2], hull[count - 1], p) <= 0) --count;
        hull[count++] = p;
    };
    for (const Vec2& p : points) add(p, 2);
    const size_t lower = count + 1;
    for (size_t i = points.size() - 1; i-- > 0;) add(points[i], lower);
    hull.resize(count > 0 ? count - 1 : 0);
    return hull;
}

/// Distances of boundary points from the silhouette, pixels, above 0 outside; empty if a corner is behind the camera.
std::vector<double> residualsOf(const Capture& capture, const EmitterOutline& outline, const EmitterBody& body) {
    const Camera& camera = capture.views[outline.view].camera;
    std::vector<Vec2> corners;
    for (const DVec3& c : cornersOf(body)) {
        const auto at = camera.project(c);
        if (!at) return {};
        corners.push_back(*at);
    }
    const std::vector<Vec2> hull = hullOf(std::move(corners));
    if (hull.size() < 3) return {};
    std::vector<double> residuals;
    for (const Vec2& p : outline.boundary) {
        double most = -1e30;
        for (size_t k = 0; k < hull.size(); ++k) {
            const Vec2 &a = hull[k], &b = hull[(k + 1) % hull.size()];
            const double length = double(glm::distance(a, b));
            if (length > 0) most = std::max(most, -turnOf(a, b, p) / length);
        }
        residuals.push_back(most);
    }
    return residuals;
}

/// The body with one unknown changed by about `size` metres at its surface.
EmitterBody changed(EmitterBody body, size_t unknown, double size, double least) {
    const size_t k = unknown % 3, a = (k + 1) % 3, b = (k + 2) % 3;
    if (unknown < 3) body.centre += size * body.axes[int(k)];
    if (unknown >= 3 && unknown < 6) {
        const double angle = size / std::max(body.half[int(a)], body.half[int(b)]);
        const DVec3 u = body.axes[int(a)], w = body.axes[int(b)];
        body.axes[int(a)] = std::cos(angle) * u + std::sin(angle) * w;
        body.axes[int(b)] = std::cos(angle) * w - std::sin(angle) * u;
    }
    if (body.round && unknown == 8) {
        body.taper = std::clamp(body.taper + size / body.half.y, -EmitterBody::steepest, EmitterBody::steepest);
        return body;
    }
    if (unknown >= 6) {
        body.half[int(k)] = std::max(least, body.half[int(k)] + size);
        if (body.round && k > 0) body.half[1] = body.half[2] = body.half[int(k)];
    }
    return body;
}

/// Solves m x = y by elimination; m is positive definite.
Row solved(std::array<Row, mostUnknowns> m, Row y, size_t count) {
    for (size_t i = 0; i < count; ++i)
        for (size_t j = i + 1; j < count; ++j) {
            const double f = m[j][i] / m[i][i];
            for (size_t k = i; k < count; ++k) m[j][k] -= f * m[i][k];
            y[j] -= f * y[i];
        }
    for (size_t i = count; i-- > 0;) {
        for (size_t k = i + 1; k < count; ++k) y[i] -= m[i][k] * y[k];
        y[i] /= m[i][i];
    }
    return y;
}

double robustCost(const std::vector<std::vector<double>>& residuals, double scale) {
    double cost = 0;
    for (const std::vector<double>& view : residuals)
        for (const double e : view) cost += std::log1p(e * e / (scale * scale));
    return cost;
}

}  // namespace

EmitterBody followOutlines(const Capture& capture, const std::vector<EmitterOutline>& outlines, EmitterBody body,
                           double unit, double least, bool conical) {
    // A tube's roll is no unknown; in its second radius' place a cone has its taper.
    std::vector<size_t> unknowns{0, 1, 2, 4, 5, 6, 7};
    if (conical) unknowns.push_back(8);
    if (!body.round) unknowns = {0, 1, 2, 3, 4, 5, 6, 7, 8};
    const auto residualsAt = [&](const EmitterBody& at) {
        std::vector<std::vector<double>> all(outlines.size());
        parallelFor(outlines.size(), 1, [&](size_t i) { all[i] = residualsOf(capture, outlines[i], at); });
        return all;
    };
    double damping = 1e-3;
    for (int step = 0; step < followSteps; ++step) {
        const double scale = std::max(tightest, loosest * std::pow(0.85, step)), h = 0.05 * unit;
        const std::vector<std::vector<double>> now = residualsAt(body);
        std::vector<std::vector<std::vector<double>>> moved;
        for (const size_t u : unknowns) moved.push_back(residualsAt(changed(body, u, h, least)));
        std::array<Row, mostUnknowns> normal{};
        Row right{};
        for (size_t i = 0; i < now.size(); ++i)
            for (size_t p = 0; p < now[i].size(); ++p) {
                const double weight = 1 / (1 + now[i][p] * now[i][p] / (scale * scale));
                Row slope{};
                bool whole = true;
                for (size_t u = 0; u < unknowns.size(); ++u) {
                    whole = whole && moved[u][i].size() == now[i].size();
                    if (whole) slope[u] = (moved[u][i][p] - now[i][p]) / h;
                }
                if (!whole) continue;
                for (size_t u = 0; u < unknowns.size(); ++u) {
                    right[u] -= weight * slope[u] * now[i][p];
                    for (size_t v = 0; v < unknowns.size(); ++v) normal[u][v] += weight * slope[u] * slope[v];
                }
            }
        for (size_t u = 0; u < unknowns.size(); ++u) normal[u][u] = normal[u][u] * (1 + damping) + 1e-9 / (unit * unit);
        const Row change = solved(normal, right, unknowns.size());
        EmitterBody next = body;
        for (size_t u = 0; u < unknowns.size(); ++u) {
            if (!std::isfinite(change[u])) return body;
            next = changed(next, unknowns[u], std::clamp(change[u], -4 * unit, 4 * unit), least);
        }
        const bool better = robustCost(residualsAt(next), scale) < robustCost(now, scale);
        damping = std::clamp(better ? 0.3 * damping : 10 * damping, 1e-6, 1e3);
        if (better) body = next;
    }
    return body;
}

}  // namespace relamp
