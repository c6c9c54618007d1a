#include "capture/camera.h"

namespace relamp {
namespace {

using DVec2 = glm::dvec2;
using Coefs = std::array<double, 8>;

struct Name {
    LensModel model;
    const char* name;
};
constexpr Name names[] = {
    {LensModel::simplePinhole, "SIMPLE_PINHOLE"},
    {LensModel::pinhole, "PINHOLE"},
    {LensModel::simpleRadial, "SIMPLE_RADIAL"},
    {LensModel::radial, "RADIAL"},
    {LensModel::openCv, "OPENCV"},
    {LensModel::openCvFisheye, "OPENCV_FISHEYE"},
    {LensModel::fullOpenCv, "FULL_OPENCV"},
    {LensModel::fov, "FOV"},
    {LensModel::simpleRadialFisheye, "SIMPLE_RADIAL_FISHEYE"},
    {LensModel::radialFisheye, "RADIAL_FISHEYE"},
    {LensModel::thinPrismFisheye, "THIN_PRISM_FISHEYE"},
    {LensModel::brown, "BROWN"},
};

bool isFisheye(LensModel model) {
    return model == LensModel::openCvFisheye || model == LensModel::simpleRadialFisheye ||
           model == LensModel::radialFisheye || model == LensModel::thinPrismFisheye;
}

/// The radial part of a lens: distorted radius = r N(r^2) / D(r^2), where r is tan(angle) or, for a fisheye, the angle.
struct Radial {
    std::array<double, 5> n{1, 0, 0, 0, 0}, d{1, 0, 0, 0, 0};
    bool plain = true;

    double at(double s) const { return evaluate(n, s) / evaluate(d, s); }
    /// Sign of the derivative of r N / D by r.
    bool grows(double s) const {
        const double denominator = evaluate(d, s);
        if (!(denominator > 0)) return false;
        return (evaluate(n, s) + 2 * s * slope(n, s)) * denominator - 2 * s * evaluate(n, s) * slope(d, s) > 0;
    }
    /// Whether the distortion grows all the way from the axis to r^2 = s.
    bool growsUpTo(double s) const {
        if (plain || surelyGrowsUpTo(s)) return true;
        constexpr int steps = 24;
        for (int i = steps; i >= 1; --i)
            if (!grows(s * i / steps)) return false;
        return true;
    }

private:
    /// Terms that shrink the slope are largest at s. For a polynomial alone.
    bool surelyGrowsUpTo(double s) const {
        double least = 1, power = 1;
        for (size_t i = 1; i < 5; ++i) {
            if (d[i] != 0) return false;
            power *= s;
            least += std::min(0.0, double(2 * i + 1) * n[i] * power);
        }
        return least > 1e-6;
    }
    static double evaluate(const std::array<double, 5>& p, double s) {
        return p[0] + s * (p[1] + s * (p[2] + s * (p[3] + s * p[4])));
    }
    static double slope(const std::array<double, 5>& p, double s) {
        return p[1] + s * (2 * p[2] + s * (3 * p[3] + s * 4 * p[4]));
    }
};

Radial radialOf(LensModel model, const Coefs& k) {
    Radial r;
    switch (model) {
        case LensModel::simplePinhole:
        case LensModel::pinhole:
        case LensModel::fov: break;  // FOV is no polynomial, and grows everywhere
        case LensModel::simpleRadial:
        case LensModel::simpleRadialFisheye: r.n = {1, k[0], 0, 0, 0}; break;
        case LensModel::radial:
        case LensModel::radialFisheye:
        case LensModel::openCv: r.n = {1, k[0], k[1], 0, 0}; break;
        case LensModel::openCvFisheye: r.n = {1, k[0], k[1], k[2], k[3]}; break;
        case LensModel::fullOpenCv:
            r.n = {1, k[0], k[1], k[4], 0};
            r.d = {1, k[5], k[6], k[7], 0};
            break;
        case LensModel::brown:
        case LensModel::thinPrismFisheye: r.n = {1, k[0], k[1], k[4], k[5]}; break;
    }
    for (size_t i = 1; i < 5; ++i) r.plain = r.plain && r.n[i] >= 0 && r.d[i] == 0;
    return r;
}

/// Below this FOV's omega or radius the closed forms lose their digits.
constexpr double smallFov = 1e-4;

/// Distorted over undistorted radius of the FOV lens: atan(2 r tan(omega / 2)) / (r omega).
double fovFactor(double omega, double r) {
    if (std::abs(omega) < smallFov) return 1 + omega * omega * (r * r / -3 + 1.0 / 12);
    const double slope = 2 * std::tan(0.5 * omega);
    if (r < smallFov) return slope / omega * (1 - slope * slope * r * r / 3);
    return std::atan(r * slope) / (r * omega);
}

/// Undistorted over distorted radius; beyond the lens's widest angle, that angle's edge.
double fovInverse(double omega, double r) {
    if (std::abs(omega) < smallFov || r < 1e-12) return 1 / fovFactor(omega, r);
    const double angle = std::min(r * std::abs(omega), 0.4999 * piD);
    return std::tan(angle) / (2 * std::tan(0.5 * std::abs(omega)) * r);
}

/// From the undistorted plane (tan(angle), or the angle of a fisheye, times the direction around the axis) to the
/// distorted one. The formulas are COLMAP's; brown is that of the Metashape manual.
DVec2 distort(LensModel model, const Radial& radial, const Coefs& k, const DVec2& q) {
    const double s = q.x * q.x + q.y * q.y;
    if (model == LensModel::fov) return q * fovFactor(k[0], std::sqrt(s));
    const double factor = radial.at(s);
    DVec2 out = q * factor;
    if (model == LensModel::openCv || model == LensModel::fullOpenCv || model == LensModel::thinPrismFisheye ||
        model == LensModel::brown) {
        const double p1 = k[2], p2 = k[3], xy = q.x * q.y;
        out.x += 2 * p1 * xy + p2 * (s + 2 * q.x * q.x);
        out.y += 2 * p2 * xy + p1 * (s + 2 * q.y * q.y);
    }
    if (model == LensModel::thinPrismFisheye) out += DVec2(k[6], k[7]) * s;
    if (model == LensModel::brown) out.x += k[6] * out.y;
    return out;
}

/// The radius that the radial part alone sends to `wanted`; the edge of the valid field when it is never reached.
double invertRadial(const Radial& radial, double wanted, double limit) {
    double low = 0, high = 0;
    // March outwards while the distortion grows, then bisect.
    constexpr int steps = 256;
    for (int i = 1; i <= steps; ++i) {
        const double r = limit * i / steps;
        if (!radial.grows(r * r)) break;
        high = r;
        if (r * radial.at(r * r) >= wanted) break;
        low = r;
    }
    for (int i = 0; i < 60 && high > low; ++i) {
        const double middle = 0.5 * (low + high);
        (middle * radial.at(middle * middle) < wanted ? low : high) = middle;
    }
    return 0.5 * (low + high);
}

/// Inverse of distort: Newton steps from the distorted point; where they fail, from the radial inverse.
DVec2 undistort(LensModel model, const Radial& radial, const Coefs& k, const DVec2& wanted) {
    if (model == LensModel::fov) return wanted * fovInverse(k[0], glm::length(wanted));
    const auto newton = [&](DVec2 q, bool& found) {
        found = false;
        for (int step = 0; step < 20; ++step) {
            const DVec2 miss = distort(model, radial, k, q) - wanted;
            if (!std::isfinite(miss.x) || !std::isfinite(miss.y)) return q;
            if (std::abs(miss.x) + std::abs(miss.y) < 1e-10) {
                found = radial.growsUpTo(glm::dot(q, q));
                return q;
            }
            const double h = 1e-6 * (1 + std::abs(q.x) + std::abs(q.y));
            const DVec2 dx =
                (distort(model, radial, k, q + DVec2(h, 0)) - distort(model, radial, k, q - DVec2(h, 0))) / (2 * h);
            const DVec2 dy =
                (distort(model, radial, k, q + DVec2(0, h)) - distort(model, radial, k, q - DVec2(0, h))) / (2 * h);
            const double determinant = dx.x * dy.y - dx.y * dy.x;
            if (!(std::abs(determinant) > 1e-12)) return q;
            q -= DVec2(dy.y * miss.x - dy.x * miss.y, dx.x * miss.y - dx.y * miss.x) / determinant;
        }
        return q;
    };
    bool found = false;
    DVec2 q = newton(wanted, found);
    if (found) return q;
    const double length = glm::length(wanted);
    if (!(length > 0)) return DVec2(0);
    const double limit = isFisheye(model) ? piD : std::max(8.0, 2 * length);
    const DVec2 start = wanted * (invertRadial(radial, length, limit) / length);
    q = newton(start, found);
    return found ? q : start;
}

}  // namespace

std::optional<LensModel> lensModelFromName(const std::string& name) {
    for (const Name& n : names)
        if (name == n.name) return n.model;
    return std::nullopt;
}

std::string lensModelName(LensModel model) {
    for (const Name& n : names)
        if (model == n.model) return n.name;
    return "";
}

namespace {

/// A world point on the plane that the lens distorts; none behind the camera.
std::optional<DVec2> onLensPlane(const Camera& camera, const DVec3& world) {
    const DVec3 offset = world - camera.position();
    // Columns of a rotation are its axes; image axes have y down and look along +z.
    const double x = glm::dot(DVec3(camera.worldFromCamera[0]), offset);
    const double y = -glm::dot(DVec3(camera.worldFromCamera[1]), offset);
    const double z = -glm::dot(DVec3(camera.worldFromCamera[2]), offset);
    if (!(z > 0)) return std::nullopt;
    if (!isFisheye(camera.model)) return DVec2(x, y) / z;
    const double r = std::hypot(x, y);
    return r > 0 ? DVec2(x, y) * (std::atan2(r, z) / r) : DVec2(0);
}

}  // namespace

bool Camera::isDistorted() const {
    return model != LensModel::simplePinhole && model != LensModel::pinhole &&
           std::any_of(distortion.begin(), distortion.end(), [](double k) { return k != 0; });
}

std::optional<Vec2> Camera::project(const DVec3& world) const {
    const std::optional<DVec2> plane = onLensPlane(*this, world);
    if (!plane) return std::nullopt;
    DVec2 q = *plane;
    if (isDistorted()) {
        const Radial radial = radialOf(model, distortion);
        if (!radial.growsUpTo(glm::dot(q, q))) return std::nullopt;
        q = distort(model, radial, distortion, q);
    }
    const Vec2 pixel(float(focalX * q.x + centreX), float(focalY * q.y + centreY));
    if (!std::isfinite(pixel.x) || !std::isfinite(pixel.y)) return std::nullopt;
    return pixel;
}

std::optional<glm::dvec2> Camera::projectByFormula(const DVec3& world) const {
    const std::optional<DVec2> plane = onLensPlane(*this, world);
    if (!plane) return std::nullopt;
    const DVec2 q = distort(model, radialOf(model, distortion), distortion, *plane);
    return DVec2(focalX * q.x + centreX, focalY * q.y + centreY);
}

Vec3 Camera::rayDirection(const Vec2& pixel) const {
    DVec2 q((pixel.x - centreX) / focalX, (pixel.y - centreY) / focalY);
    if (isDistorted()) {
        const Radial radial = radialOf(model, distortion);
        q = undistort(model, radial, distortion, q);
    }
    DVec3 ray(q.x, q.y, 1);
    if (isFisheye(model)) {
        const double angle = glm::length(q);
        const double factor = angle > 1e-12 ? std::sin(angle) / angle : 1.0;
        ray = DVec3(q.x * factor, q.y * factor, std::cos(angle));
    }
    const DVec3 world = glm::normalize(DVec3(worldFromCamera[0]) * ray.x - DVec3(worldFromCamera[1]) * ray.y -
                                       DVec3(worldFromCamera[2]) * ray.z);
    // Coefficients of a lens can be such that a pixel has no direction.
    return Vec3(std::isfinite(world.x + world.y + world.z) ? world : forward());
}

double Camera::depthOf(const DVec3& world) const { return glm::dot(forward(), world - position()); }

}  // namespace relamp
