#include "clusters/emitter_sphere.h"

#include <algorithm>

#include "base/random.h"
#include "base/statistics.h"
#include "clusters/emitter_pixels.h"
#include "clusters/outline_pixels.h"

namespace relamp {
namespace {

constexpr size_t leastPixels = 8, mostBoundary = 400;
constexpr float mostOfOthers = 0.03f;  ///< of an outline's pixels

struct PixelBox {
    int left = 1 << 30, top = 1 << 30, right = -1, bottom = -1;  // inclusive
    void grow(int x, int y) {
        left = std::min(left, x);
        right = std::max(right, x);
        top = std::min(top, y);
        bottom = std::max(bottom, y);
    }
    bool empty() const { return right < left; }
    void widen(int by, int width, int height) {
        left = std::max(0, left - by);
        top = std::max(0, top - by);
        right = std::min(width - 1, right + by);
        bottom = std::min(height - 1, bottom + by);
    }
};

/// Where the cluster's vertices fall; a few pixels wider, because the mesh is off.
PixelBox projectionOf(const Scene& scene, const EmitterCluster& cluster, const Camera& camera) {
    PixelBox box;
    for (const uint32_t v : cluster.vertices)
        if (const auto pixel = camera.project(DVec3(scene.mesh.positions[v])))
            if (std::abs(pixel->x) < 1e6f && std::abs(pixel->y) < 1e6f) box.grow(int(pixel->x), int(pixel->y));
    if (!box.empty()) box.widen(2, camera.width, camera.height);
    return box;
}

/// Leaves in `shows` only pixels connected with one inside `box`. False if they reach the image's border.
bool keepConnected(const PixelBox& box, int width, int height, std::vector<uint8_t>& shows) {
    std::vector<uint8_t> kept(shows.size(), 0);
    std::vector<size_t> stack;
    bool inside = true;
    for (int y = box.top; y <= box.bottom; ++y)
        for (int x = box.left; x <= box.right; ++x) {
            const size_t p = size_t(y) * size_t(width) + size_t(x);
            if (!shows[p] || kept[p]) continue;
            kept[p] = 1;
            stack.push_back(p);
            while (!stack.empty()) {
                const int px = int(stack.back() % size_t(width)), py = int(stack.back() / size_t(width));
                stack.pop_back();
                inside &= px > 0 && py > 0 && px + 1 < width && py + 1 < height;
                for (int dy = -1; dy <= 1; ++dy)
                    for (int dx = -1; dx <= 1; ++dx) {
                        const int qx = px + dx, qy = py + dy;
                        if (qx < 0 || qy < 0 || qx >= width || qy >= height) continue;
                        const size_t q = size_t(qy) * size_t(width) + size_t(qx);
                        if (!shows[q] || kept[q]) continue;
                        kept[q] = 1;
                        stack.push_back(q);
                    }
            }
        }
    shows.swap(kept);
    return inside;
}

/// Middles of the sides between a pixel that shows the emitter and one where no light shows.
std::vector<Vec2> boundaryOf(const std::vector<uint8_t>& shows, const std::vector<uint8_t>& light, int width,
                             int height, size_t& length) {
    std::vector<Vec2> all;
    for (int y = 1; y + 1 < height; ++y)
        for (int x = 1; x + 1 < width; ++x) {
            const size_t p = size_t(y) * size_t(width) + size_t(x);
            if (!shows[p]) continue;
            if (!light[p - 1]) all.emplace_back(x, y + 0.5f);
            if (!light[p + 1]) all.emplace_back(x + 1, y + 0.5f);
            if (!light[p - size_t(width)]) all.emplace_back(x + 0.5f, y);
            if (!light[p + size_t(width)]) all.emplace_back(x + 0.5f, y + 1);
        }
    length = all.size();
    std::vector<Vec2> some;
    const size_t step = all.size() / mostBoundary + 1;
    for (size_t i = 0; i < all.size(); i += step) some.push_back(all[i]);
    return some;
}

/// Pixels of the outline that the mesh says show another emitter.
size_t pixelsOfOthers(const ViewGeometry& geometry, const EmitterClusters& clusters, const EmitterCluster& cluster,
                      const std::vector<uint8_t>& shows) {
    size_t count = 0;
    for (size_t p = 0; p < shows.size(); ++p) {
        const uint32_t t = geometry.triangle[p];
        count += shows[p] && t != Hit::none && clusters.emitterOfTriangle[t] >= 0 &&
                 !std::binary_search(cluster.triangles.begin(), cluster.triangles.end(), t);
    }
    return count;
}

/// A boundary point as a ray, and how many pixels a radian has there.
struct BoundaryRay {
    DVec3 eye, direction;
    double pixels;
};

void addBoundary(const EmitterOutline& outline, const Camera& camera, std::vector<BoundaryRay>& rays) {
    const double focal = std::sqrt(camera.focalX * camera.focalY);
    for (const Vec2& q : outline.boundary) rays.push_back({camera.position(), DVec3(camera.rayDirection(q)), focal});
}

/// Where the rays meet best.
DVec3 meetingPoint(const std::vector<BoundaryRay>& rays) {
    glm::dmat3 across(0);
    DVec3 sum(0);
    for (const BoundaryRay& r : rays) {
        const glm::dmat3 plane = glm::dmat3(1) - glm::outerProduct(r.direction, r.direction);
        across += plane;
        sum += plane * r.eye;
    }
    return glm::inverse(across) * sum;
}

/// Centre and radius.
using Ball = glm::dvec4;

bool isFinite(const Ball& ball) { return std::isfinite(ball.x + ball.y + ball.z + ball.w); }

/// Angle between a boundary's ray and the ball's rim, pixels.
double residualOf(const BoundaryRay& r, const Ball& ball) {
    const DVec3 to = DVec3(ball) - r.eye;
    const double distance = glm::length(to);
    const double away = std::acos(std::clamp(glm::dot(to, r.direction) / distance, -1.0, 1.0));
    return r.pixels * (away - std::asin(std::clamp(ball.w / distance, 0.0, 1.0)));
}

/// Robust Gauss-Newton from a loose scale to one of a pixel.
Ball followBoundaries(const std::vector<BoundaryRay>& rays, Ball ball, double looseScale) {
    constexpr int steps = 40;
    for (int i = 0; i < steps; ++i) {
        const double scale = std::max(0.75, looseScale * std::pow(0.8, i));
        glm::dmat4 q(0);
        Ball c(0);
        for (const BoundaryRay& r : rays) {
            const double e = residualOf(r, ball), weight = 1 / (1 + e * e / (scale * scale));
            Ball slope;
            for (int k = 0; k < 4; ++k) {
                Ball moved = ball;
                const double h = 1e-4 * ball.w;
                moved[k] += h;
                slope[k] = (residualOf(r, moved) - e) / h;
            }
            q += weight * glm::outerProduct(slope, slope);
            c -= weight * e * slope;
        }
        for (int k = 0; k < 4; ++k) q[k][k] *= 1 + 1e-9;
        const Ball step = glm::inverse(q) * c;
        if (!isFinite(step)) return ball;
        const double most = 0.5 * ball.w, size = glm::length(step);
        ball += size > most ? step * (most / size) : step;
        if (!(ball.w > 0)) return Ball(std::nan(""));
    }
    return ball;
}

/// First hit of the ball along a ray; below 0: none.
double hitOf(const DVec3& eye, const DVec3& direction, const EmitterSphere& ball) {
    const DVec3 to = ball.centre - eye;
    const double along = glm::dot(to, direction), squared = glm::dot(to, to) - along * along,
                 inside = ball.radius * ball.radius - squared;
    return inside > 0 ? along - std::sqrt(inside) : -1;
}

void judge(const Scene& scene, const Capture& capture, const RadianceSamples& samples,
           const std::vector<EmitterOutline>& outlines, EmitterSphere& ball) {
    std::vector<float> reach;
    for (const EmitterOutline& o : outlines) reach.push_back(8 * std::sqrt(float(o.pixels)));
    const OutlineOverlap found = outlineOverlap(
        pixelsAbout(capture, samples, outlines, {}, reach), std::max(ball.radius, 0.01 * double(scene.diagonal)),
        [&](const DVec3& eye, const DVec3& direction) { return hitOf(eye, direction, ball); });
    ball.overlap = found.overlap();
    ball.mostSeen = found.mostSeen;
    ball.nextSeen = found.nextSeen;
}

/// Angle between a ray and a ball's middle over the ball's angular radius.
double radiiFrom(const EmitterSphere& ball, const DVec3& eye, const DVec3& direction) {
    const DVec3 to = ball.centre - eye;
    const double distance = glm::length(to);
    if (!(distance > ball.radius)) return 1e9;
    return std::acos(std::clamp(glm::dot(to, direction) / distance, -1.0, 1.0)) / std::asin(ball.radius / distance);
}

/// Whether the frame holds all of the ball.
bool framed(const EmitterSphere& ball, const Camera& camera) {
    const std::optional<Vec2> middle = camera.project(ball.centre);
    const double distance = glm::length(ball.centre - camera.position());
    if (!middle || !(distance > ball.radius)) return false;
    const float reach = float(1.1 * std::max(camera.focalX, camera.focalY) * ball.radius / distance) + 1;
    return middle->x > reach && middle->y > reach && middle->x + reach < float(camera.width) &&
           middle->y + reach < float(camera.height);
}

/// The part of a view's light that each ball explains best, or has in its disc (the boundary is of the former).
std::vector<EmitterOutline> partsOf(const View& view, size_t index, const std::vector<uint8_t>& light,
                                    const std::vector<EmitterSphere>& balls) {
    constexpr double farthest = 2;  // radii
    const Camera& camera = view.camera;
    const DVec3 eye = camera.position();
    std::vector<std::vector<uint8_t>> nearest(balls.size(), std::vector<uint8_t>(light.size(), 0)), inside = nearest;
    std::vector<DVec3> sums(balls.size(), DVec3(0));
    for (size_t p = 0; p < light.size(); ++p) {
        if (!light[p]) continue;
        const Vec2 pixel(float(p % size_t(camera.width)) + 0.5f, float(p / size_t(camera.width)) + 0.5f);
        const DVec3 direction(camera.rayDirection(pixel));
        size_t best = balls.size();
        double least = farthest;
        for (size_t k = 0; k < balls.size(); ++k) {
            const double radii = radiiFrom(balls[k], eye, direction);
            inside[k][p] = radii < 1;
            if (radii < least) {
                least = radii;
                best = k;
            }
        }
        if (best == balls.size()) continue;
        nearest[best][p] = inside[best][p] = 1;
        sums[best] += DVec3(pixel, 1);
    }
    std::vector<EmitterOutline> parts(balls.size());
    for (size_t k = 0; k < balls.size(); ++k) {
        EmitterOutline& part = parts[k];
        part.view = index;
        part.pixels = size_t(sums[k].z);
        if (part.pixels < leastPixels || !framed(balls[k], camera)) {
            part.pixels = 0;
            continue;
        }
        part.centre = Vec2(float(sums[k].x / sums[k].z), float(sums[k].y / sums[k].z));
        part.boundary = boundaryOf(nearest[k], light, camera.width, camera.height, part.boundaryLength);
        part.shows = std::move(inside[k]);
    }
    return parts;
}

}  // namespace

std::vector<EmitterOutline> emitterOutlines(const Scene& scene, const Capture& capture, const RadianceSamples& samples,
                                            const EmitterClusters& clusters, const EmitterCluster& cluster,
                                            bool cutToo) {
    std::vector<EmitterOutline> result;
    for (size_t i = 0; i < capture.views.size(); ++i) {
        const Camera& camera = capture.views[i].camera;
        const PixelBox box = projectionOf(scene, cluster, camera);
        if (box.empty() || box.left > box.right || box.top > box.bottom) continue;
        EmitterOutline outline;
        outline.view = i;
        outline.shows = emittingPixels(capture.views[i], cluster.radiance, pixelTolerance(cluster));
        outline.cut = !keepConnected(box, camera.width, camera.height, outline.shows);
        if (outline.cut && !cutToo) continue;
        DVec3 sum(0);
        for (int y = 0; y < camera.height; ++y)
            for (int x = 0; x < camera.width; ++x)
                if (outline.shows[size_t(y) * size_t(camera.width) + size_t(x)]) sum += DVec3(x + 0.5, y + 0.5, 1);
        outline.pixels = size_t(sum.z);
        if (outline.pixels < leastPixels) continue;
        const size_t others = pixelsOfOthers(samples.geometry[i], clusters, cluster, outline.shows);
        if (float(others) > mostOfOthers * float(outline.pixels)) continue;
        outline.centre = Vec2(float(sum.x / sum.z), float(sum.y / sum.z));
        outline.boundary =
            boundaryOf(outline.shows, outline.shows, camera.width, camera.height, outline.boundaryLength);
        result.push_back(std::move(outline));
    }
    return result;
}

std::optional<EmitterSphere> fitSphere(const Scene& scene, const Capture& capture, const RadianceSamples& samples,
                                       const std::vector<EmitterOutline>& outlines) {
    std::vector<BoundaryRay> centres, boundary;
    std::vector<double> radii;
    for (const EmitterOutline& outline : outlines) {
        const Camera& camera = capture.views[outline.view].camera;
        const double focal = std::sqrt(camera.focalX * camera.focalY);
        centres.push_back({camera.position(), DVec3(camera.rayDirection(outline.centre)), focal});
        addBoundary(outline, camera, boundary);
    }
    double widest = 1;
    for (const BoundaryRay& a : centres)
        for (const BoundaryRay& b : centres) widest = std::min(widest, glm::dot(a.direction, b.direction));
    if (widest > 0.985) return {};
    const DVec3 centre = meetingPoint(centres);
    double largest = 0;
    for (size_t i = 0; i < centres.size(); ++i) {
        const double pixels = std::sqrt(double(outlines[i].pixels) / piD);
        radii.push_back(pixels / centres[i].pixels * glm::length(centre - centres[i].eye));
        largest = std::max(largest, pixels);
    }
    std::sort(radii.begin(), radii.end());
    // Occluded outlines are smaller than the ball.
    const Ball start(centre, radii[radii.size() * 3 / 4]);
    if (!(start.w > 0) || !isFinite(start)) return {};
    const Ball found = followBoundaries(boundary, start, 0.5 * largest);
    if (!isFinite(found)) return {};
    EmitterSphere ball{DVec3(found), found.w};
    judge(scene, capture, samples, outlines, ball);
    return ball;
}

BallsTogether fitSpheresTogether(const Scene& scene, const Capture& capture, const RadianceSamples& samples,
                                 const EmitterCluster& light, std::vector<EmitterSphere> balls) {
    constexpr int rounds = 4;
    std::vector<std::vector<uint8_t>> shows;
    for (const View& view : capture.views) shows.push_back(emittingPixels(view, light.radiance, pixelTolerance(light)));
    BallsTogether found;
    for (int round = 0; round <= rounds; ++round) {
        found.outlines.assign(balls.size(), {});
        for (size_t i = 0; i < capture.views.size(); ++i) {
            std::vector<EmitterOutline> parts = partsOf(capture.views[i], i, shows[i], balls);
            for (size_t k = 0; k < balls.size(); ++k)
                if (parts[k].pixels) found.outlines[k].push_back(std::move(parts[k]));
        }
        if (round == rounds) break;
        for (size_t k = 0; k < balls.size(); ++k) {
            std::vector<BoundaryRay> boundary;
            double largest = 0;
            for (const EmitterOutline& outline : found.outlines[k]) {
                addBoundary(outline, capture.views[outline.view].camera, boundary);
                largest = std::max(largest, std::sqrt(double(outline.pixels) / piD));
            }
            if (found.outlines[k].size() < 2) continue;
            const Ball ball = followBoundaries(boundary, Ball(balls[k].centre, balls[k].radius), 0.5 * largest);
            if (isFinite(ball)) balls[k] = {DVec3(ball), ball.w};
        }
    }
    for (size_t k = 0; k < balls.size(); ++k) judge(scene, capture, samples, found.outlines[k], balls[k]);
    found.balls = std::move(balls);
    return found;
}

bool shownInOnePiece(const Scene& scene, const Capture& capture, const RadianceSamples& samples,
                     const EmitterCluster& first, const EmitterCluster& second) {
    size_t together = 0, apart = 0, same = 0, others = 0;
    for (size_t i = 0; i < capture.views.size(); ++i) {
        const Camera& camera = capture.views[i].camera;
        const PixelBox box = projectionOf(scene, first, camera), otherBox = projectionOf(scene, second, camera);
        const auto empty = [](const PixelBox& b) { return b.empty() || b.left > b.right || b.top > b.bottom; };
        if (empty(box) || empty(otherBox)) continue;
        const std::vector<uint8_t> all = emittingPixels(capture.views[i], first.radiance, pixelTolerance(first));
        std::vector<uint8_t> piece = all, otherPiece = all;
        keepConnected(box, camera.width, camera.height, piece);
        keepConnected(otherBox, camera.width, camera.height, otherPiece);
        size_t ofFirst = 0, ofSecond = 0, inPiece = 0, pixels = 0, otherPixels = 0;
        for (size_t p = 0; p < all.size(); ++p) {
            pixels += piece[p];
            otherPixels += otherPiece[p];
            const uint32_t t = samples.geometry[i].triangle[p];
            if (t == Hit::none || !all[p]) continue;
            ofFirst += std::binary_search(first.triangles.begin(), first.triangles.end(), t);
            const bool other = std::binary_search(second.triangles.begin(), second.triangles.end(), t);
            ofSecond += other;
            inPiece += other && piece[p];
        }
        if (std::min(pixels, otherPixels) >= leastPixels) ++(piece == otherPiece ? same : others);
        if (ofFirst < leastPixels || ofSecond < leastPixels) continue;
        ++(2 * inPiece > ofSecond ? together : apart);
    }
    return (together >= 3 && together > 4 * apart) || (same >= 3 && others == 0 && apart == 0);
}

float meshOverlap(const RadianceSamples& samples, const EmitterCluster& cluster,
                  const std::vector<EmitterOutline>& outlines) {
    size_t both = 0, either = 0;
    for (const EmitterOutline& outline : outlines) {
        const std::vector<uint32_t>& hit = samples.geometry[outline.view].triangle;
        for (size_t p = 0; p < hit.size(); ++p) {
            const bool covers =
                hit[p] != Hit::none && std::binary_search(cluster.triangles.begin(), cluster.triangles.end(), hit[p]);
            either += covers || outline.shows[p];
            both += covers && outline.shows[p];
        }
    }
    return either ? float(both) / float(either) : 1;
}

}  // namespace relamp
