#include "solve/registration/rim_circle.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "base/log.h"
#include "base/statistics.h"
#include "solve/registration/step_edge.h"

namespace relamp {
namespace {

constexpr int circlePlaces = 128;
constexpr int circleRounds = 12;
constexpr size_t leastCircleSteps = 40, leastOfEdge = 20;
constexpr float circleNoise = 0.03f;     ///< of a profile's value, relative to its mean
constexpr float circleHiddenBy = 0.02f;  ///< of the diagonal: what lies so much before the rim hides it
constexpr double looksIn = 0.1;          ///< cosine between the axis and the line to the eye
constexpr double facesEye = 0.2;         ///< cosine between the outer side's normal and the line to the eye
constexpr float mostBend = 0.1f;         ///< pixels that the rim's image leaves its tangent after one pixel
constexpr double circleSigma = 0.3;      ///< pixels: of a step's place
constexpr double circleHuber = 0.5;      ///< pixels
constexpr double circleSettled = 0.02;   ///< pixels of the largest move
constexpr double shiftPrior = 0.005;     ///< of the diagonal, standard deviation
constexpr double tiltPrior = 0.07;       ///< radians
constexpr double radiusPrior = 0.0015;   ///< of the diagonal
constexpr double circleAgreement = 1;    ///< pixels: median distance
constexpr int unknowns = 7;              ///< shifts across and along the axis, two tilts, inner and outer radius

using Vector = Eigen::Matrix<double, unknowns, 1>;
using Matrix = Eigen::Matrix<double, unknowns, unknowns>;

/// One step of a photograph: pixels from the circle, and their change with each unknown.
struct RimStep {
    double pixels = 0;
    bool inner = false;  ///< edge that it tells of
    Vector change;
};

class CircleFit {
public:
    CircleFit(const Capture& capture, const Scene& scene, const RimCircle& start, bool low, float floor)
        : capture_(capture), scene_(scene), floor_(floor), low_(low), circle_(start) {}

    std::optional<RimCircle> run() {
        const double diagonal = double(scene_.diagonal);
        Vector off = Vector::Zero(), trust;
        const double shift = shiftPrior * diagonal, radius = radiusPrior * diagonal;
        trust << shift, shift, shift, tiltPrior, tiltPrior, radius, radius;
        const Vector prior = trust.cwiseAbs2().cwiseInverse();
        double before = -1;
        for (int round = 0; round < circleRounds; ++round) {
            const std::vector<RimStep> steps = allSteps();
            if (steps.size() < leastCircleSteps) return {};
            const double median = medianDistance(steps);
            if (before < 0) before = median;
            Matrix sum = Matrix::Zero();
            sum.diagonal() = prior * circleSigma * circleSigma;
            Vector right = -(prior * circleSigma * circleSigma).cwiseProduct(off);
            for (const RimStep& s : steps) {
                const double weight = std::min(1.0, circleHuber / std::max(std::abs(s.pixels), 1e-9));
                sum += weight * s.change * s.change.transpose();
                right += weight * s.pixels * s.change;
            }
            const Vector move = sum.ldlt().solve(right);
            if (!move.allFinite()) return {};
            double largest = 0;
            for (const RimStep& s : steps) largest = std::max(largest, std::abs(s.change.dot(move)));
            off += move;
            apply(move);
            if (!(circle_.inner > 0 && circle_.outer > 0)) return {};
            if (largest < circleSettled) break;
        }
        const std::vector<RimStep> steps = allSteps();
        if (steps.size() < leastCircleSteps) return {};
        const double after = medianDistance(steps);
        logInfo(
            "circle of a rim: {} steps, {:.2f} pixels from it ({:.2f} before); shifted {:.2f} mm across, {:.2f} mm "
            "along, tilted {:.2f} degrees, radii {:.2f} and {:.2f} mm more",
            steps.size(), after, before, 1000 * std::hypot(off[0], off[1]), 1000 * off[2],
            std::hypot(off[3], off[4]) * 180 / piD, 1000 * off[5], 1000 * off[6]);
        if (!(after < before && after < circleAgreement)) return {};
        const auto ofInner = size_t(std::count_if(steps.begin(), steps.end(), [](const auto& s) { return s.inner; }));
        if (ofInner < leastOfEdge) circle_.inner = 0;
        if (steps.size() - ofInner < leastOfEdge) circle_.outer = 0;
        return circle_;
    }

private:
    /// Changes of the circle by the unknowns, the tilts about the rim's middle.
    void apply(const Vector& move) {
        RevolutionSurface& s = circle_.surface;
        const DVec3 u = s.across, v = glm::cross(s.axis, s.across), w = s.axis;
        const DVec3 middle = s.centre + circle_.height * w + move[0] * u + move[1] * v + move[2] * w;
        const DVec3 turn = move[3] * u + move[4] * v;
        s.axis = glm::normalize(w + glm::cross(turn, w));
        s.across = glm::normalize(u + glm::cross(turn, u));
        s.across = glm::normalize(s.across - glm::dot(s.across, s.axis) * s.axis);
        s.centre = middle - circle_.height * s.axis;
        circle_.inner += move[5];
        circle_.outer += move[6];
    }

    std::vector<RimStep> allSteps() const {
        std::vector<RimStep> found;
        for (const View& view : capture_.views)
            for (int k = 0; k < circlePlaces; ++k)
                if (const auto step = stepAt(view, 2 * piD * k / circlePlaces)) found.push_back(*step);
        return found;
    }

    std::optional<RimStep> stepAt(const View& view, double angle) const {
        const RevolutionSurface& s = circle_.surface;
        const DVec3 u = s.across, v = glm::cross(s.axis, s.across), w = s.axis;
        const DVec3 out = std::cos(angle) * u + std::sin(angle) * v, middle = s.centre + circle_.height * w;
        const DVec3 eye = view.camera.position();
        const double opening = glm::dot(glm::normalize(eye - middle), low_ ? -w : w);
        const bool inside = opening > looksIn;
        const double radius = inside ? circle_.inner : circle_.outer;
        const DVec3 rim = middle + radius * out;
        const double distance = glm::length(rim - eye);
        if (!inside && (opening > -looksIn || glm::dot(out, (eye - rim) / distance) < facesEye)) return {};
        const Hit hit = scene_.cameraTracer->closest({Vec3(eye), Vec3((rim - eye) / distance)});
        if (hit && hit.distance < float(distance) - circleHiddenBy * scene_.diagonal) return {};
        const DVec3 ahead = -std::sin(angle) * u + std::cos(angle) * v;
        // Beside it on the circle, which leaves its tangent by `bow`.
        const double piece = 0.002 * double(scene_.diagonal), bow = piece * piece / (2 * radius);
        const auto at = view.camera.project(rim), next = view.camera.project(rim + piece * ahead - bow * out),
                   last = view.camera.project(rim - piece * ahead - bow * out);
        if (!at || !next || !last) return {};
        const Vec2 tangent = 0.5f * (*next - *last), bend = 0.5f * (*next + *last) - *at;
        const float length = glm::length(tangent);
        if (!(length > 0) || glm::length(bend) > mostBend * length * length) return {};
        const Vec2 across(tangent.y / length, -tangent.x / length);
        const auto profile = profileAcross(view, *at, across, floor_);
        if (!profile) return {};
        const std::optional<float> step = findStep(*profile, circleNoise);
        if (!step) return {};
        const auto change = [&](const DVec3& direction) {
            const auto moved = view.camera.project(rim + piece * direction);
            return moved ? double(glm::dot(*moved - *at, across)) / piece : 0.0;
        };
        const double byAxis = change(w), byOut = change(out);
        RimStep found{double(*step), inside, Vector::Zero()};
        found.change << change(u), change(v), byAxis, radius * std::sin(angle) * byAxis,
            -radius * std::cos(angle) * byAxis, inside ? byOut : 0.0, inside ? 0.0 : byOut;
        return found;
    }

    static double medianDistance(const std::vector<RimStep>& steps) {
        std::vector<double> distances;
        for (const RimStep& s : steps) distances.push_back(std::abs(s.pixels));
        return medianOf(std::move(distances));
    }

    const Capture& capture_;
    const Scene& scene_;
    float floor_;
    bool low_;
    RimCircle circle_;
};

}  // namespace

std::optional<RimCircle> fitRimCircle(const Capture& capture, const Scene& scene, const RimCircle& start, bool low,
                                      float floor) {
    return CircleFit(capture, scene, start, low, floor).run();
}

}  // namespace relamp
