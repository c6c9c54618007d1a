#include "radiance/footprint.h"

#include <algorithm>
#include <cmath>

namespace relamp {
namespace {

constexpr int widest = 6;  ///< pixels from the middle of a footprint to its end
constexpr int windowSide = 2 * widest + 6;
constexpr float coneVariance = 0.15f;  ///< of a cone of radius 1 along one axis: linear interpolation around a vertex
constexpr float pixelVariance = 0.1f;  ///< of a pixel, pixels squared
constexpr float cutAt = 4;             ///< squared standard deviations at which the Gaussian is cut
constexpr float besideEdge = 0.03f;    ///< weight of a pixel that an edge may cut
constexpr float meanWithin = 2.5f;     ///< standard errors: the mean over the views
constexpr float viewWithin = 4;        ///< one view
constexpr float notNoise = 0.003f;     ///< of log radiance: no difference
constexpr float scaleOf[VertexLook::scales] = {0, 0.5f, 1};

/// Symmetric 2 x 2.
struct Covariance {
    float xx = pixelVariance, xy = 0, yy = pixelVariance;
};

/// Covariance of a footprint in pixels, shrunk to what the window holds; none where it has no bounds.
std::optional<Covariance> covarianceOf(const Camera& camera, const Vec3& position, const Vec3& normal, float radius,
                                       const Vec2& pixel) {
    // Along the photograph, because finite steps must not depend on the world's axes.
    const Vec3 right(camera.worldFromCamera[0]), up(camera.worldFromCamera[1]);
    const Vec3 a = glm::normalize(glm::cross(normal, std::abs(glm::dot(normal, right)) < 0.7f ? right : up)),
               b = glm::cross(normal, a);
    const float step = 0.5f * radius;
    const auto alongA = camera.project(DVec3(position + step * a)), alongB = camera.project(DVec3(position + step * b));
    if (!(step > 0) || !alongA || !alongB) return std::nullopt;
    const Vec2 p = (Vec2(*alongA) - pixel) * (radius / step), q = (Vec2(*alongB) - pixel) * (radius / step);
    Covariance c;
    c.xx = coneVariance * (p.x * p.x + q.x * q.x);
    c.xy = coneVariance * (p.x * p.y + q.x * q.y);
    c.yy = coneVariance * (p.y * p.y + q.y * q.y);
    const float most = std::max(c.xx, c.yy) * cutAt, room = float(widest * widest);
    if (!(std::abs(c.xy) < 1e30f && most < 1e30f)) return std::nullopt;
    const float shrink = most > room ? room / most : 1;
    c.xx *= shrink, c.xy *= shrink, c.yy *= shrink;
    return c;
}

/// Of the footprint at a scale, with the pixel's own.
Covariance inverseOf(const Covariance& of, float scale) {
    const float a = scale * scale;
    const Covariance c{a * of.xx + pixelVariance, a * of.xy, a * of.yy + pixelVariance};
    const float determinant = c.xx * c.yy - c.xy * c.xy;
    return {c.yy / determinant, -c.xy / determinant, c.xx / determinant};
}

/// Pixels around a vertex's place in a photograph, ends included.
struct Window {
    int left, top, right, bottom;
};

/// Which pixels of a window see the vertex's own surface: not one behind or before it, nor one past a crease.
class OwnPixels {
public:
    OwnPixels(const View& view, const ViewGeometry& g, const Scene& scene, std::span<const Vec3> faceNormals,
              uint32_t v, const Window& window)
        : g_(g),
          faceNormals_(faceNormals),
          eye_(view.camera.position()),
          position_(scene.mesh.positions[v]),
          normal_(scene.mesh.normals[v]),
          window_(window),
          perColumn_(1 / float(window.right - window.left)),
          perRow_(1 / float(window.bottom - window.top)) {
        for (int k = 0; k < 4; ++k)
            corners_[k] = view.camera.rayDirection(Vec2(float(k % 2 ? window.right : window.left) + 0.5f,
                                                        float(k / 2 ? window.bottom : window.top) + 0.5f));
    }

    /// Up to `reach` metres off the tangent plane, and `far` from the vertex. Pixels outside the photograph are those
    /// at its edge.
    bool operator()(int x, int y, float reach, float far) const {
        x = std::clamp(x, 0, g_.width - 1), y = std::clamp(y, 0, g_.height - 1);
        const size_t i = size_t(y) * size_t(g_.width) + size_t(x);
        if (g_.triangle[i] == Hit::none) return false;
        const Vec3 seen = eye_ + rayThrough(x, y) * g_.depth[i] - position_;
        if (std::abs(glm::dot(seen, normal_)) > reach || glm::length(seen) > far) return false;
        return glm::dot(faceNormals_[g_.triangle[i]], normal_) > 0.6f;
    }

private:
    /// Between those of the window's corners: lenses bend little within it.
    Vec3 rayThrough(int x, int y) const {
        const float u = float(x - window_.left) * perColumn_, w = float(y - window_.top) * perRow_;
        return glm::mix(glm::mix(corners_[0], corners_[1], u), glm::mix(corners_[2], corners_[3], u), w);
    }

    const ViewGeometry& g_;
    std::span<const Vec3> faceNormals_;
    Vec3 eye_, position_, normal_, corners_[4];
    Window window_;
    float perColumn_, perRow_;
};

/// The window that holds the 2 x 2 pixels around a place and the footprint, and one pixel more on each side.
Window windowAround(const Vec2& place, const std::optional<Covariance>& footprint, int x0, int y0) {
    const Window block{x0 - 1, y0 - 1, x0 + 2, y0 + 2};
    if (!footprint) return block;
    const auto halfOf = [](float variance) { return int(std::sqrt(cutAt * (variance + pixelVariance)) + 0.5f) + 1; };
    const int x = int(std::lround(place.x)), y = int(std::lround(place.y));
    const int halfX = halfOf(footprint->xx), halfY = halfOf(footprint->yy);
    return {std::min(block.left, x - halfX), std::min(block.top, y - halfY), std::max(block.right, x + halfX),
            std::max(block.bottom, y + halfY)};
}

/// Weighted means of pixels at all scales.
class Means {
public:
    using Weights = std::array<float, VertexLook::scales>;

    void add(const Weights& weights, const Rgb& value, bool clipped) {
        for (size_t s = 0; s < weights.size(); ++s) {
            sum_[s] += weights[s] * value;
            kept_[s] += weights[s];
            if (weights[s] > 0 && clipped) clipped_[s] = true;
        }
        weights_[count_++] = weights;
    }
    /// Fills in all but the sample's view and weight. False: no pixel tells anything.
    bool into(VertexLook& look) const {
        if (kept_[0] < 0.01f) return false;
        look.sample.radiance = look.radiance[0] = sum_[0] / kept_[0];
        look.sample.clipped = clipped_[0];
        for (size_t s = 1; s < sum_.size() && kept_[s] > 0 && !clipped_[s]; ++s, ++look.known)
            look.radiance[s] = sum_[s] / kept_[s];
        for (size_t k = 0; k < count_; ++k)
            for (size_t s = 0; s < look.known; ++s) {
                const float w = weights_[k][s] / kept_[s];
                look.variance[s] += w * w;
                for (size_t t = 0; t < s; ++t) {
                    const float apart = w - weights_[k][t] / kept_[t];
                    look.difference[t][s] += apart * apart;
                }
            }
        return true;
    }

private:
    std::array<Rgb, VertexLook::scales> sum_{};
    Weights kept_{};
    std::array<bool, VertexLook::scales> clipped_{};
    std::array<Weights, size_t(windowSide* windowSide)> weights_;
    size_t count_ = 0;
};

/// How well noise explains how far all looks at one scale are from those at another, one by one and in their mean:
/// 1 at four fifths of what it may be at most, 0 at six fifths. Continuous: rounding must not decide.
float agreement(std::span<const VertexLook> looks, size_t fine, size_t coarse, float pixelNoise, float noiseFloor) {
    Rgb total(0);
    float variance = 0, apart = 0;
    size_t count = 0;
    for (const VertexLook& look : looks) {
        if (look.known <= coarse) continue;
        const Rgb a = look.radiance[fine], b = look.radiance[coarse];
        const float sigma = pixelNoise * std::sqrt(look.difference[fine][coarse]);
        for (int c = 0; c < 3; ++c) {
            const float off = std::log(std::max(b[c], noiseFloor) / std::max(a[c], noiseFloor));
            apart = std::max(apart, std::abs(off) / (viewWithin * sigma + notNoise));
            total[c] += off;
        }
        variance += sigma * sigma;
        ++count;
    }
    if (count == 0) return 0;
    apart = std::max(apart, maxChannel(glm::abs(total)) / (meanWithin * std::sqrt(variance) + notNoise * float(count)));
    return std::clamp(3 - 2.5f * apart, 0.0f, 1.0f);
}

}  // namespace

std::optional<VertexLook> lookUpVertex(const View& view, const ViewGeometry& g, const Scene& scene,
                                       std::span<const Vec3> faceNormals, uint32_t v, float radius,
                                       const GatherOptions& options) {
    const Vec3 position = scene.mesh.positions[v], normal = scene.mesh.normals[v];
    const Vec3 eye(view.camera.position());
    const float distance = glm::length(eye - position);
    if (!(distance > 0)) return std::nullopt;
    const Vec3 towardEye = (eye - position) / distance;
    const float cosine = glm::dot(normal, towardEye);
    if (cosine < options.grazingCosine) return std::nullopt;
    const auto pixel = view.camera.project(DVec3(position));
    if (!pixel || pixel->x < 0.5f || pixel->y < 0.5f || pixel->x >= float(g.width) - 0.5f ||
        pixel->y >= float(g.height) - 0.5f)
        return std::nullopt;
    const float offset = scene.tracer->surfaceOffset();
    const Ray ray{position + normal * offset * 4.0f, towardEye, offset, distance - offset};
    if (scene.cameraTracer->occluded(ray)) return std::nullopt;

    const Vec2 place = *pixel - 0.5f;
    const int x0 = std::min(int(place.x), g.width - 2), y0 = std::min(int(place.y), g.height - 2);
    const float fx = place.x - float(x0), fy = place.y - float(y0);
    const auto footprint = covarianceOf(view.camera, position, normal, radius, *pixel);
    const Window window = windowAround(place, footprint, x0, y0);
    const float pixelSize = distance / float(std::min(view.camera.focalX, view.camera.focalY));  // metres
    const float reach = pixelSize / std::max(cosine, 0.2f);
    const OwnPixels isOwn(view, g, scene, faceNormals, v, window);
    bool own[windowSide][windowSide];
    for (int y = window.top; y <= window.bottom; ++y)
        for (int x = window.left; x <= window.right; ++x)
            own[y - window.top][x - window.left] = isOwn(x, y, 1.5f * reach, std::max(6 * reach, 2 * radius));

    const size_t asked = footprint ? VertexLook::scales : 1;
    std::array<Covariance, VertexLook::scales> inverse;
    for (size_t s = 1; s < asked; ++s) inverse[s] = inverseOf(*footprint, scaleOf[s]);
    Means means;
    float pure = 0;
    for (int y = std::max(0, window.top + 1); y < std::min(window.bottom, g.height); ++y)
        for (int x = std::max(0, window.left + 1); x < std::min(window.right, g.width); ++x) {
            const int oy = y - window.top, ox = x - window.left;
            if (!own[oy][ox] || !view.image.usableAt(x, y)) continue;
            // A pixel whose neighbour sees something else may be cut by the edge between them: it mixes both.
            bool whole = true;
            for (int k = 0; k < 9; ++k) whole &= own[oy - 1 + k / 3][ox - 1 + k % 3];
            Means::Weights w{};
            if (x >= x0 && x <= x0 + 1 && y >= y0 && y <= y0 + 1)
                w[0] = (x > x0 ? fx : 1 - fx) * (y > y0 ? fy : 1 - fy);
            if (whole) pure += w[0];
            const float dx = float(x) - place.x, dy = float(y) - place.y;
            for (size_t s = 1; s < asked; ++s) {
                const Covariance& i = inverse[s];
                const float q = i.xx * dx * dx + 2 * i.xy * dx * dy + i.yy * dy * dy;
                if (q < cutAt) w[s] = std::exp(-0.5f * q);
            }
            if (!whole)
                for (float& one : w) one *= besideEdge;
            const Rgb value = view.image.at(x, y);
            means.add(w, value, view.saturation > 0 && maxChannel(value) >= view.saturation);
        }
    VertexLook look;
    if (!means.into(look)) return std::nullopt;
    look.sample.weight = std::min(1.0f, cosine * 2) * std::max(0.04f, std::min(1.0f, 1.5f * pure));
    return look;
}

ScaleWeights scaleWeights(std::span<const VertexLook> looks, float pixelNoise, float noiseFloor) {
    ScaleWeights weights{1};
    float reached = 1;
    for (size_t coarse = 1; coarse < VertexLook::scales; ++coarse) {
        for (size_t fine = 0; fine < coarse; ++fine)
            reached = std::min(reached, agreement(looks, fine, coarse, pixelNoise, noiseFloor));
        for (size_t s = 0; s < coarse; ++s) weights[s] *= 1 - reached;
        weights[coarse] = reached;
    }
    return weights;
}

std::pair<Rgb, float> VertexLook::at(const ScaleWeights& weights) const {
    Rgb sum(0);
    float spread = 0;
    for (size_t s = 0; s < scales; ++s) {
        const size_t k = std::min(s, known - 1);
        sum += weights[s] * radiance[k];
        spread += weights[s] * variance[k];
    }
    return {sum, spread};
}

}  // namespace relamp
