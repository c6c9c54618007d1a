#include "relight/emission_profile.h"

#include <algorithm>
#include <cmath>

#include "base/random.h"

namespace relamp {
namespace {

/// Beyond this a gobo's plane runs to infinity.
constexpr float widestGobo = 80;

/// Bilinear; (0, 0) is the image's upper left corner, (1, 1) its lower right one. Black outside.
Rgb imageAt(const Image& image, const Vec2& place) {
    if (!(place.x >= 0 && place.x <= 1 && place.y >= 0 && place.y <= 1)) return Rgb(0);
    const float x = std::clamp(place.x * float(image.width) - 0.5f, 0.0f, float(image.width - 1)),
                y = std::clamp(place.y * float(image.height) - 0.5f, 0.0f, float(image.height - 1));
    const int x0 = int(x), y0 = int(y), x1 = std::min(x0 + 1, image.width - 1), y1 = std::min(y0 + 1, image.height - 1);
    const float fx = x - float(x0), fy = y - float(y0);
    return (1 - fy) * ((1 - fx) * image.at(x0, y0) + fx * image.at(x1, y0)) +
           fy * ((1 - fx) * image.at(x0, y1) + fx * image.at(x1, y1));
}

float smoothStep(float t) { return t * t * (3 - 2 * t); }

}  // namespace

ShapedEmission::ShapedEmission(const LightShaping& shaping, const Mat4& matrix, const Vec2& size, bool flat)
    : shaping_(shaping), toSurface_(glm::inverse(matrix)), size_(size), flat_(flat) {
    // The axis is where the surface faces, whatever the scale is; the others are turned about it.
    const Vec3 z = glm::normalize(glm::transpose(glm::inverse(Mat3(matrix))) * Vec3(0, 0, 1));
    Vec3 x = Vec3(matrix[0]);
    x = glm::normalize(x - z * glm::dot(z, x));
    Vec3 y = glm::cross(z, x);
    if (glm::dot(y, Vec3(matrix[1])) < 0) y = -y;
    toWorld_ = Mat3(x, y, z);
    doors_ = flat && shaping.doors();
    middle_ = Vec3(matrix[3]);
    half_ = size / 2.0f * Vec2(glm::length(Vec3(matrix[0])), glm::length(Vec3(matrix[1])));
    innerDegrees_ = shaping.coneDegrees * (1 - shaping.coneSoftness);
    if (!shaping.iesFile.empty()) ies_ = iesOf(shaping.iesFile);
    if (!shaping.goboFile.empty()) {
        goboImage_ = shapingImageOf(shaping.goboFile);
        gobo_ = 1 / std::tan(std::min(shaping.coneDegrees, widestGobo) * (pi / 180));
    }
    if (!shaping.surfaceFile.empty() && flat) surface_ = shapingImageOf(shaping.surfaceFile);
}

ShapedEmission::ShapedEmission(std::shared_ptr<const EmissionPattern> pattern, const Mat4& matrix,
                               const EmissionLobe& lobe, bool flat)
    : toSurface_(glm::inverse(matrix)), flat_(flat), pattern_(std::move(pattern)) {
    if (lobe.even()) return;
    shaping_.focus = lobe.power;
    toWorld_ = frameAround(-glm::normalize(Mat3(matrix) * lobe.axis));
}

Rgb ShapedEmission::byDirection(const Vec3& local) const {
    Rgb factor(1);
    const float cosine = std::clamp(-local.z, -1.0f, 1.0f);
    if (shaping_.coneDegrees < 180) {
        const float angle = std::acos(cosine) * (180 / pi);
        if (angle >= shaping_.coneDegrees) return Rgb(0);
        if (angle > innerDegrees_)
            factor *= smoothStep((shaping_.coneDegrees - angle) / (shaping_.coneDegrees - innerDegrees_));
    }
    if (shaping_.focus > 0) factor *= cosine > 0 ? std::pow(cosine, shaping_.focus) : 0.0f;
    if (ies_) factor *= ies_->at(local);
    if (goboImage_) {
        if (cosine < 1e-3f) return Rgb(0);
        // Seen from the light, up is +Y and right is +X, as its axis is -Z.
        const Vec2 place = Vec2(local) * (gobo_ / cosine);
        factor *= imageAt(goboImage_->image, {0.5f + 0.5f * place.x, 0.5f - 0.5f * place.y});
    }
    return factor;
}

bool ShapedEmission::pastDoors(const Vec3& local, const Vec2& point) const {
    const float forward = -local.z;
    for (const BarnDoor& door : barnDoors) {
        const float degrees = shaping_.*door.degrees;
        if (degrees >= 90) continue;
        // In the plane across the hinge: light that leaves at a wider angle than the door's end is seen under is
        // stopped.
        const float half = half_[door.axis], turned = degrees * (pi / 180);
        const float end = half + 2 * half * std::sin(turned) - door.side * point[door.axis];
        if (door.side * local[door.axis] * 2 * half * std::cos(turned) > end * forward) return false;
    }
    return true;
}

Rgb ShapedEmission::factor(const Vec3& away, const Vec3& point) const {
    if (doors_ && !pastDoors(away * toWorld_, fromMiddle(point))) return Rgb(0);
    Rgb factor = patternAt(point) * byDirection(away * toWorld_);
    if (surface_ && maxChannel(factor) > 0) {
        // Seen from its front, along +Z with +Y up, +X lies to the left.
        const Vec3 own(toSurface_ * Vec4(point, 1));
        factor *= imageAt(surface_->image, {0.5f - own.x / size_.x, 0.5f - own.y / size_.y});
    }
    return factor;
}

Rgb ShapedEmission::mean() const {
    constexpr uint32_t directions = 4096;
    Rgb sum(0);
    for (uint32_t i = 0; i < directions; ++i) {
        const Vec2 u = r2Point(i, Vec2(0.5f));
        if (flat_) {
            Vec3 local = cosineHemisphere(u);
            local.z = -local.z;
            const Vec2 on(unitFloat(mixBits(2 * i)), unitFloat(mixBits(2 * i + 1)));
            if (!doors_ || pastDoors(local, (2.0f * on - 1.0f) * half_)) sum += byDirection(local);
        } else {
            // A closed convex surface shows the same area to all directions.
            const float z = 2 * u.x - 1, r = std::sqrt(std::max(0.0f, 1 - z * z));
            sum += byDirection({r * std::cos(2 * pi * u.y), r * std::sin(2 * pi * u.y), z});
        }
    }
    return sum / float(directions) * (surface_ ? surface_->mean : Rgb(1));
}

}  // namespace relamp
