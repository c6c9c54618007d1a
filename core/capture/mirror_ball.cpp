#include "capture/mirror_ball.h"

#include "base/error.h"
#include "base/parallel.h"
#include "base/random.h"
#include "base/statistics.h"
#include "image/environment_map.h"

namespace relamp {
namespace {

constexpr int searchSide = 400;       // longest side of the image that circles are sought in
constexpr float leastRadius = 0.04f;  // of that side
constexpr int sectors = 72;
constexpr float enoughSupport = 0.4f;
constexpr float aboveChance = 0.25f;
constexpr float mostOff = 0.9f;    // pixels, of the edges from the rim
constexpr float leastPixels = 8;   // of a ball's radius
constexpr float rimPixels = 1.5f;  // soft edge of a ball
constexpr float mostPerPixel = 5;  // degrees of the mirrored world in one pixel
constexpr float radiansADegree = pi / 180;

/// One number a pixel: log luminance, where edges do not depend on exposure.
struct LogLuminance {
    int width = 0, height = 0;
    std::vector<float> values;

    float at(int x, int y) const {
        return values[size_t(std::clamp(y, 0, height - 1)) * size_t(width) + size_t(std::clamp(x, 0, width - 1))];
    }
    /// Bilinear, pixel (0, 0) centred at (0.5, 0.5).
    float at(Vec2 p) const {
        p -= Vec2(0.5f);
        const Vec2 low = glm::floor(p), f = p - low;
        const int x = int(low.x), y = int(low.y);
        return (at(x, y) * (1 - f.x) + at(x + 1, y) * f.x) * (1 - f.y) +
               (at(x, y + 1) * (1 - f.x) + at(x + 1, y + 1) * f.x) * f.y;
    }
};

LogLuminance logLuminanceOf(const Image& image, int factor) {
    LogLuminance log{std::max(1, image.width / factor), std::max(1, image.height / factor), {}};
    log.values.resize(size_t(log.width) * size_t(log.height));
    std::vector<float> all;
    for (size_t i = 0; i < image.pixels.size(); i += std::max<size_t>(1, image.pixels.size() / 20000))
        all.push_back(luminance(image.pixels[i]));
    const float dark = std::max(0.02f * medianOf(std::move(all)), 1e-9f);
    parallelFor(size_t(log.height), 16, [&](size_t y) {
        for (int x = 0; x < log.width; ++x) {
            float sum = 0;
            for (int k = 0; k < factor * factor; ++k)
                sum += luminance(image.at(x * factor + k % factor, int(y) * factor + k / factor));
            log.values[y * size_t(log.width) + size_t(x)] = std::log(sum / float(factor * factor) + dark);
        }
    });
    return log;
}

struct EdgePoint {
    Vec2 place, normal;
};

std::vector<EdgePoint> edgesOf(const LogLuminance& log) {
    std::vector<EdgePoint> points;
    std::vector<float> strengths;
    const auto gradient = [&](int x, int y) {
        return Vec2(log.at(x + 1, y) - log.at(x - 1, y), log.at(x, y + 1) - log.at(x, y - 1)) * 0.5f;
    };
    for (int y = 1; y + 1 < log.height; ++y)
        for (int x = 1; x + 1 < log.width; ++x) strengths.push_back(glm::length(gradient(x, y)));
    const float least = std::max(0.04f, quantileOf(std::move(strengths), 0.8));
    for (int y = 2; y + 2 < log.height; ++y)
        for (int x = 2; x + 2 < log.width; ++x) {
            const Vec2 g = gradient(x, y);
            const float strength = glm::length(g);
            if (strength < least) continue;
            const Vec2 n = g / strength;
            const int dx = int(std::lround(n.x)), dy = int(std::lround(n.y));
            if (strength < glm::length(gradient(x + dx, y + dy)) || strength < glm::length(gradient(x - dx, y - dy)))
                continue;
            points.push_back({Vec2(x, y) + 0.5f, n});
        }
    return points;
}

/// Fraction of the circle that has an edge along it.
float supportOf(const std::vector<EdgePoint>& edges, const BallHint& circle) {
    std::array<uint8_t, sectors> seen{};
    for (const EdgePoint& e : edges) {
        const Vec2 out = e.place - circle.centre;
        const float r = glm::length(out);
        if (std::abs(r - circle.radius) > 1.5f || std::abs(glm::dot(out, e.normal)) < 0.94f * r) continue;
        seen[size_t((std::atan2(out.y, out.x) / (2 * pi) + 0.5f) * (sectors - 0.001f))] = 1;
    }
    return float(std::count(seen.begin(), seen.end(), 1)) / sectors;
}

/// The circle with most edges along it: every edge votes for the centres along its normal; at the best centres every
/// radius is tried. Larger circles win a near tie, because a ball mirrors rings inside its rim.
std::optional<BallHint> searchCircle(const LogLuminance& log) {
    const std::vector<EdgePoint> edges = edgesOf(log);
    const int side = std::max(log.width, log.height);
    const float least = std::max(4.0f, leastRadius * float(side)), most = 0.6f * float(side);
    std::vector<float> votes(size_t(log.width) * size_t(log.height), 0);
    for (const EdgePoint& e : edges)
        for (int sign = -1; sign <= 1; sign += 2)
            for (float r = least; r <= most; ++r) {
                const Vec2 c = e.place + float(sign) * r * e.normal;
                if (c.x < 0 || c.y < 0 || c.x >= float(log.width) || c.y >= float(log.height)) break;
                votes[size_t(c.y) * size_t(log.width) + size_t(c.x)] += 1 / std::sqrt(r);
            }
    std::vector<std::pair<float, size_t>> peaks;
    for (int y = 1; y + 1 < log.height; ++y)
        for (int x = 1; x + 1 < log.width; ++x) {
            float sum = 0;
            for (int k = 0; k < 9; ++k) sum += votes[size_t(y + k / 3 - 1) * size_t(log.width) + size_t(x + k % 3 - 1)];
            peaks.emplace_back(-sum, size_t(y) * size_t(log.width) + size_t(x));
        }
    constexpr size_t tried = 60;
    if (peaks.empty()) return {};
    std::partial_sort(peaks.begin(), peaks.begin() + ptrdiff_t(std::min(tried, peaks.size())), peaks.end());
    std::optional<BallHint> best;
    float bestScore = 0;
    for (size_t k = 0; k < std::min(tried, peaks.size()); ++k) {
        const Vec2 centre = Vec2(peaks[k].second % size_t(log.width), peaks[k].second / size_t(log.width)) + 0.5f;
        // Edges by radius first: only radii that many of them have are looked at closely.
        std::vector<int> count(size_t(most) + 3, 0);
        for (const EdgePoint& e : edges) {
            const float r = glm::distance(e.place, centre);
            if (r < most && std::abs(glm::dot(e.place - centre, e.normal)) > 0.94f * r) ++count[size_t(r)];
        }
        for (float r = least; r < most; ++r) {
            const size_t i = size_t(r);
            if (float(count[i] + count[i + 1] + (i ? count[i - 1] : 0)) < 0.3f * 2 * pi * r) continue;
            const BallHint circle{centre, r + 0.5f};
            const float score = supportOf(edges, circle) * std::pow(r, 0.15f);
            if (score > bestScore) {
                bestScore = score;
                best = circle;
            }
        }
    }
    return best;
}

/// A cone through unit rays: axis . ray = cos(half angle), least squares with the given weights.
BallRim coneThrough(const std::vector<Vec3>& rays, const std::vector<double>& weights) {
    // m . ray = 1 with m = axis / cos(half angle).
    glm::dmat3 q(0);
    DVec3 moment(0);
    for (size_t i = 0; i < rays.size(); ++i) {
        const DVec3 r(rays[i]);
        q += weights[i] * glm::outerProduct(r, r);
        moment += weights[i] * r;
    }
    const DVec3 m = glm::inverse(q) * moment;
    BallRim rim;
    rim.axis = Vec3(glm::normalize(m));
    rim.halfAngle = float(std::acos(std::clamp(1 / glm::length(m), -1.0, 1.0)));
    return rim;
}

/// Pixel of the rim at angle `turn` about the axis.
std::optional<Vec2> rimPixel(const Camera& camera, const BallRim& rim, float halfAngle, float turn) {
    const Vec3 side = glm::normalize(glm::cross(rim.axis, std::abs(rim.axis.z) < 0.9f ? Vec3(0, 0, 1) : Vec3(1, 0, 0))),
               up = glm::cross(side, rim.axis);
    const Vec3 ray =
        std::cos(halfAngle) * rim.axis + std::sin(halfAngle) * (std::cos(turn) * side + std::sin(turn) * up);
    return camera.project(camera.position() + DVec3(ray));
}

/// Where edges cross the line from `at` along `out`, `reach` pixels either way: local maxima of the step over two
/// pixels, between samples by a parabola.
std::vector<float> edgesAcross(const LogLuminance& log, const Vec2& at, const Vec2& out, float reach) {
    constexpr float step = 0.5f, least = 0.08f, across = 0.7f;
    std::vector<float> slope, edges;
    for (float r = -reach; r <= reach; r += step)
        slope.push_back(std::abs(log.at(at + (r + 1) * out) - log.at(at + (r - 1) * out)));
    for (size_t k = 1; k + 1 < slope.size(); ++k) {
        const float before = slope[k - 1], here = slope[k], after = slope[k + 1], bend = before - 2 * here + after;
        if (here < least || here < before || here <= after) continue;
        const float r = -reach + step * (float(k) + (bend < 0 ? 0.5f * (before - after) / bend : 0.0f));
        // An edge that lies along the line is none across it.
        const Vec2 place = at + r * out, aside(-out.y, out.x);
        if (std::abs(log.at(place + aside) - log.at(place - aside)) < across * here) edges.push_back(r);
    }
    return edges;
}

/// The edges about a rim, by angle.
struct RimEdges {
    static constexpr int turns = 360;
    std::vector<std::vector<Vec3>> rays;  ///< of each angle that was looked at
    double pixel = 1;                     ///< radians

    RimEdges(const LogLuminance& log, const Camera& camera, const BallRim& start, float reach)
        : pixel(1 / std::max(1.0, 0.5 * (camera.focalX + camera.focalY))) {
        for (int k = 0; k < turns; ++k) {
            const float turn = 2 * pi * float(k) / turns;
            const auto at = rimPixel(camera, start, start.halfAngle, turn),
                       outer = rimPixel(camera, start, start.halfAngle * 1.05f, turn);
            if (!at || !outer || at->x < reach || at->y < reach || at->x > float(log.width) - reach ||
                at->y > float(log.height) - reach)
                continue;
            const Vec2 out = glm::normalize(*outer - *at);
            rays.emplace_back();
            for (const float r : edgesAcross(log, *at, out, reach))
                rays.back().push_back(camera.rayDirection(*at + r * out));
        }
    }
    bool enough() const {
        return rays.size() >= turns / 3 &&
               std::count_if(rays.begin(), rays.end(), [](const auto& edges) { return !edges.empty(); }) >= 24;
    }
    /// Distance of a ray from the rim, pixels.
    double off(const BallRim& rim, const Vec3& ray) const {
        const double angle = std::acos(std::clamp(double(glm::dot(ray, rim.axis)), -1.0, 1.0));
        return std::abs(angle - double(rim.halfAngle)) / pixel;
    }
    /// The edge of an angle that lies nearest to the rim; null where it has none.
    const Vec3* nearest(const BallRim& rim, size_t angle) const {
        const Vec3* best = nullptr;
        for (const Vec3& ray : rays[angle])
            if (!best || off(rim, ray) < off(rim, *best)) best = &ray;
        return best;
    }
    /// Fraction of every `step`th angle with an edge within a pixel of the rim.
    float support(const BallRim& rim, size_t step = 1) const {
        size_t near = 0, count = 0;
        for (size_t k = 0; k < rays.size(); k += step, ++count)
            if (const Vec3* ray = nearest(rim, k)) near += off(rim, *ray) < 1;
        return float(near) / float(count);
    }
};

/// Which of the edges are the rim: of cones through three of them at random, the one with most edges along it. What the
/// ball mirrors beside its rim lies along it, too, but within: of nearly equals the wider one.
BallRim consensusRim(const RimEdges& edges, const BallRim& start) {
    constexpr int trials = 20000;
    constexpr size_t few = 6;  // of the angles, at first sight
    BallRim best = start;
    float bestScore = 0;
    uint64_t state = 1;
    const size_t third = edges.rays.size() / 3;
    for (int trial = 0; trial < trials; ++trial) {
        std::vector<Vec3> rays;
        for (size_t k = 0; k < 3; ++k) {
            state = mixBits(state + 1);
            const std::vector<Vec3>& some = edges.rays[k * third + state % third];
            if (!some.empty()) rays.push_back(some[(state >> 32) % some.size()]);
        }
        if (rays.size() < 3) continue;
        BallRim cone = coneThrough(rays, {1, 1, 1});
        const float wider = cone.halfAngle / start.halfAngle;
        if (!(wider > 0.5f && wider < 2) || glm::distance(cone.axis, start.axis) > start.halfAngle) continue;
        if (edges.support(cone, few) * std::sqrt(wider) < 0.8f * bestScore) continue;
        cone.support = edges.support(cone);
        if (const float score = cone.support * std::sqrt(wider); score > bestScore) {
            bestScore = score;
            best = cone;
        }
    }
    return best;
}

/// The cone through the edges nearest to the rim, robust.
BallRim refinedRim(const RimEdges& edges, const BallRim& start) {
    BallRim rim = start;
    for (int round = 0; round < 12; ++round) {
        std::vector<Vec3> rays;
        std::vector<float> off;
        for (size_t k = 0; k < edges.rays.size(); ++k)
            if (const Vec3* ray = edges.nearest(rim, k)) {
                rays.push_back(*ray);
                off.push_back(float(edges.off(rim, *ray)));
            }
        rim.offPixels = 1.4826f * medianOf(off);
        const double scale = std::max(0.3, double(rim.offPixels));
        std::vector<double> weights(rays.size());
        for (size_t i = 0; i < rays.size(); ++i) weights[i] = 1 / std::pow(1 + std::pow(double(off[i]) / scale, 2), 2);
        const BallRim fitted = coneThrough(rays, weights);
        rim.axis = fitted.axis;
        rim.halfAngle = fitted.halfAngle;
    }
    rim.support = edges.support(rim);
    return rim;
}

/// Angle between axis and mirrored ray for a camera ray at `theta` from the axis of a ball of `halfAngle`.
double mirroredAngle(double theta, double halfAngle) {
    const double radius = std::sin(halfAngle), across = std::min(1.0, std::sin(theta) / radius);
    // At the ball the ray meets the normal at asin(across); it is turned by twice what is left of a right angle.
    return piD - 2 * std::asin(across) + theta;
}

}  // namespace

BallRim findBallRim(const Image& photograph, const Camera& camera, const std::optional<BallHint>& hint) {
    const int factor = std::max(1, (std::max(photograph.width, photograph.height) + searchSide - 1) / searchSide);
    std::optional<BallHint> circle = hint;
    if (!circle) {
        circle = searchCircle(logLuminanceOf(photograph, factor));
        if (circle) circle = BallHint{circle->centre * float(factor), circle->radius * float(factor)};
    }
    if (!circle) throw Error("no ball was found in it: say about where it is");
    const LogLuminance log = logLuminanceOf(photograph, 1);
    std::vector<Vec3> rays;
    for (int k = 0; k < 36; ++k) {
        const float turn = 2 * pi * float(k) / 36;
        rays.push_back(camera.rayDirection(circle->centre + circle->radius * Vec2(std::cos(turn), std::sin(turn))));
    }
    BallRim rim = coneThrough(rays, std::vector<double>(rays.size(), 1));
    const float reach = hint ? std::max(6.0f, 0.15f * circle->radius) : 3.0f * float(factor) + 3;
    constexpr float fine = 3;
    if (const RimEdges wide(log, camera, rim, reach); wide.enough()) {
        rim = consensusRim(wide, rim);
        float chance = 0;  // edges that any rim beside this one has along it
        for (const float beside : {-0.6f, -0.4f, 0.4f, 0.6f}) {
            BallRim other = rim;
            other.halfAngle += beside * reach * float(wide.pixel);
            chance += wide.support(other) / 4;
        }
        if (rim.support < chance + aboveChance) rim.support = 0;
        for (int round = 0; round < 2 && rim.support > 0; ++round)
            if (const RimEdges near(log, camera, rim, fine); near.enough()) rim = refinedRim(near, rim);
    }
    if (rim.support < enoughSupport || rim.offPixels > mostOff || !(rim.halfAngle > 1e-4f && rim.halfAngle < 1.4f))
        throw Error(
            "no ball was found in it: along {:.0f} % of the best circle's rim there is an edge, expected {:.0f}; say "
            "about where the ball is",
            100 * rim.support, 100 * enoughSupport);
    if (const double pixels = double(rim.halfAngle) * 0.5 * (camera.focalX + camera.focalY); pixels < leastPixels)
        throw Error("the ball has a radius of {:.0f} pixels, expected {:.0f}", pixels, leastPixels);
    return rim;
}

Image unwrapMirrorBall(const Image& photograph, const Camera& camera, const BallRim& rim, float clip) {
    const double pixel = 1 / std::max(1.0, 0.5 * (camera.focalX + camera.focalY)), halfAngle = rim.halfAngle;
    // Angles of the mirrored world by the camera ray's, falling.
    constexpr int steps = 4096;
    std::vector<double> mirrored(steps + 1);
    for (int k = 0; k <= steps; ++k) mirrored[size_t(k)] = mirroredAngle(halfAngle * k / steps, halfAngle);
    int width = 128;
    while (width < 1024 && width < 4 * halfAngle / pixel) width *= 2;
    Image latLong(width, width / 2);
    latLong.usable.assign(latLong.pixels.size(), 0);
    const double last = halfAngle - double(rimPixels) * pixel;  // beyond is the soft edge
    parallelFor(size_t(latLong.height), 4, [&](size_t y) {
        for (int x = 0; x < width; ++x) {
            const Vec3 direction =
                directionFromLatLong({(float(x) + 0.5f) / float(width), (float(y) + 0.5f) / float(latLong.height)});
            const double angle = std::acos(std::clamp(double(glm::dot(direction, rim.axis)), -1.0, 1.0));
            const auto after = std::lower_bound(mirrored.begin(), mirrored.end(), angle, std::greater<>());
            if (after == mirrored.end()) continue;
            const size_t k = size_t(after - mirrored.begin());
            const double before = k > 0 ? mirrored[k - 1] : piD,
                         part = k > 0 && before > *after ? (before - angle) / (before - *after) : 0.0,
                         theta = halfAngle * (double(k) - 1 + part) / steps;
            if (k > 0 && theta > last) continue;
            const double perPixel = k > 0 ? (before - *after) / (halfAngle / steps) * pixel : 0;
            if (perPixel > double(mostPerPixel * radiansADegree)) continue;
            Vec3 across = direction - float(std::cos(angle)) * rim.axis;
            const float length = glm::length(across);
            across = length > 1e-6f ? across / length : Vec3(0);
            const double t = std::max(0.0, theta);
            const Vec3 ray = float(std::cos(t)) * rim.axis + float(std::sin(t)) * across;
            const auto p = camera.project(camera.position() + DVec3(ray));
            if (!p) continue;
            const Vec2 at = *p - 0.5f, low = glm::floor(at), f = at - low;
            Rgb sum(0);
            bool good = true;
            for (int corner = 0; corner < 4 && good; ++corner) {
                const int px = int(low.x) + corner % 2, py = int(low.y) + corner / 2;
                good = px >= 0 && py >= 0 && px < photograph.width && py < photograph.height &&
                       photograph.usableAt(px, py) && (clip <= 0 || maxChannel(photograph.at(px, py)) < clip);
                if (good) sum += (corner % 2 ? f.x : 1 - f.x) * (corner / 2 ? f.y : 1 - f.y) * photograph.at(px, py);
            }
            if (!good) continue;
            latLong.at(x, int(y)) = sum;
            latLong.usable[y * size_t(width) + size_t(x)] = 1;
        }
    });
    return latLong;
}

void maskBall(const Camera& camera, const BallRim& rim, Image& photograph) {
    if (photograph.usable.empty()) photograph.usable.assign(photograph.pixels.size(), 1);
    const double pixel = 1 / std::max(1.0, 0.5 * (camera.focalX + camera.focalY));
    const float least = float(std::cos(std::min(1.5, double(rim.halfAngle) + 3 * pixel)));
    parallelFor(size_t(photograph.height), 16, [&](size_t y) {
        for (int x = 0; x < photograph.width; ++x)
            if (glm::dot(camera.rayDirection(Vec2(x, y) + 0.5f), rim.axis) > least)
                photograph.usable[y * size_t(photograph.width) + size_t(x)] = 0;
    });
}

}  // namespace relamp
