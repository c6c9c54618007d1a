// A made scene for scans: a wall and a ball before it, two cameras and a projector, photographed in closed form.
#pragma once
#include "base/random.h"
#include "scan/scan.h"

namespace relamp::test {

/// A camera at `eye` that looks at `target`, Y up.
inline Camera scanCameraAt(const DVec3& eye, const DVec3& target, int width, int height, double focal) {
    Camera camera;
    camera.width = width;
    camera.height = height;
    camera.focalX = camera.focalY = focal;
    camera.centreX = 0.5 * width;
    camera.centreY = 0.5 * height;
    const DVec3 back = glm::normalize(eye - target), right = glm::normalize(glm::cross(DVec3(0, 1, 0), back));
    camera.worldFromCamera =
        DMat4(glm::dvec4(right, 0), glm::dvec4(glm::cross(back, right), 0), glm::dvec4(back, 0), glm::dvec4(eye, 1));
    return camera;
}

struct PaintedScan {
    static constexpr double radius = 0.12;
    DVec3 ball{0, 0, 0.1};  ///< before the wall z = 0
    ScanBits bits{7, 6};
    Camera projector = scanCameraAt({0.05, 0.25, 0.9}, {0, 0, 0}, 128, 64, 190);
    ScanCalibration calibration;
    float ambient = 0.05f, global = 0.1f, noise = 0.005f;
    std::vector<size_t> absent;  ///< places that the second camera lacks

    PaintedScan() {
        calibration.cameras.push_back({"left", {}, scanCameraAt({-0.3, 0, 1}, {0, 0, 0.05}, 160, 120, 260)});
        calibration.cameras.push_back({"right", {}, scanCameraAt({0.3, 0.05, 1}, {0, 0, 0.05}, 160, 120, 260)});
    }

    /// Distance along a ray; 0 where it meets nothing.
    double distance(const DVec3& origin, const DVec3& direction) const {
        const DVec3 off = origin - ball;
        const double b = glm::dot(off, direction), c = glm::dot(off, off) - radius * radius, inside = b * b - c;
        if (inside > 0 && -b - std::sqrt(inside) > 0) return -b - std::sqrt(inside);
        return direction.z < 0 ? -origin.z / direction.z : 0;
    }
    /// How far a point lies from the surface, metres.
    double offSurface(const DVec3& point) const {
        return std::min(std::abs(point.z), std::abs(glm::distance(point, ball) - radius));
    }

    /// Where on the projector each of 3 x 3 samples of a pixel is lit from; NaN in shadow.
    std::vector<Vec2> litFrom(size_t camera) const {
        const Camera& c = calibration.cameras[camera].camera;
        std::vector<Vec2> places;
        for (int y = 0; y < c.height; ++y)
            for (int x = 0; x < c.width; ++x)
                for (int k = 0; k < 9; ++k) {
                    const Vec2 pixel(float(x) + (float(k % 3) + 0.5f) / 3, float(y) + (float(k / 3) + 0.5f) / 3);
                    const DVec3 toward(c.rayDirection(pixel));
                    const DVec3 point = c.position() + distance(c.position(), toward) * toward;
                    const DVec3 away = point - projector.position();
                    const double apart = glm::length(away);
                    const auto at = projector.project(point);
                    const bool lit = at && at->x >= 0 && at->y >= 0 && at->x < 128 && at->y < 64 &&
                                     distance(projector.position(), away / apart) > apart - 1e-6;
                    places.push_back(lit ? *at : Vec2(NAN));
                }
        return places;
    }

    GreyImage photograph(size_t camera, size_t place, const std::vector<Vec2>& places) const {
        const Camera& c = calibration.cameras[camera].camera;
        GreyImage image{c.width, c.height, std::vector<float>(places.size() / 9)};
        for (size_t i = 0; i < image.values.size(); ++i) {
            float direct = 0, covered = 0;
            for (size_t k = 0; k < 9; ++k) {
                const Vec2& at = places[9 * i + k];
                if (std::isnan(at.x)) continue;
                covered += 1.0f / 9;
                direct += on(place, at) ? 1.0f / 9 : 0.0f;
            }
            // Half of all pixels are lit by a pattern, so half of the indirect light is there.
            const float indirect = place == 0 ? global : place == 1 ? 0 : 0.5f * global;
            const float albedo = 0.3f + 0.4f * unitFloat(mixBits(i / 7));
            const uint64_t seed = mixBits(mixBits(camera * 1000 + place) ^ i);
            const float jitter = noise * (unitFloat(seed) + unitFloat(mixBits(seed)) - 1) * 2.45f;
            image.values[i] = ambient + albedo * (direct * 0.8f + indirect * covered) + jitter;
        }
        return image;
    }

    ScanInput input() const {
        ScanInput stacks;
        for (size_t camera = 0; camera < calibration.cameras.size(); ++camera) {
            PatternStack stack;
            stack.bits = bits;
            stack.there.assign(2 + 2 * size_t(bits[0] + bits[1]), 1);
            if (camera == 1)
                for (size_t place : absent) stack.there[place] = 0;
            stack.read = [this, camera, places = litFrom(camera)](size_t place) {
                return photograph(camera, place, places);
            };
            stacks.push_back(std::move(stack));
        }
        return stacks;
    }

private:
    bool on(size_t place, const Vec2& at) const {
        if (place < 2) return place == 0;
        const bool second = place >= patternPlace(bits, 1, 0);
        const size_t within = place - patternPlace(bits, second ? 1 : 0, 0);
        const int bit = bits[second ? 1 : 0] - 1 - int(within / 2);
        const bool lit = grayOf(uint32_t(second ? at.y : at.x)) >> bit & 1;
        return lit != (within % 2 == 1);
    }
};

}  // namespace relamp::test
