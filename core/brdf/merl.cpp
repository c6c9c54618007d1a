#include "brdf/merl.h"

#include <bit>
#include <cstring>

#include "base/atomic_file.h"
#include "base/error.h"

namespace relamp {
namespace {

constexpr double channelScale[3] = {1.0 / 1500, 1.15 / 1500, 1.66 / 1500};

/// The two cells around a place on an axis, and the fraction of the second.
struct Between {
    int low, high;
    double fraction;
};

Between clamped(double place, int steps) {
    const double p = std::clamp(place, 0.0, double(steps - 1));
    const int low = std::min(int(p), steps - 2);
    return {low, low + 1, p - low};
}

}  // namespace

HalfAngles halfAngles(const Vec3& towardLight, const Vec3& towardEye) {
    const DVec3 light(towardLight), eye(towardEye);
    const DVec3 sum = light + eye;
    const double length = glm::length(sum);
    if (!(length > 1e-12)) return {0.5 * piD, 0.5 * piD, 0};
    const DVec3 h = sum / length;
    HalfAngles angles;
    const double across = std::hypot(h.x, h.y);
    angles.half = std::atan2(across, h.z);
    // The light in the frame whose +Z is the half vector and whose X lies in the plane of the normal: turned by -phi_h,
    // then -theta_h.
    const double cosPhi = across > 1e-12 ? h.x / across : 1, sinPhi = across > 1e-12 ? h.y / across : 0;
    const DVec3 turned(cosPhi * light.x + sinPhi * light.y, -sinPhi * light.x + cosPhi * light.y, light.z);
    const DVec3 d(h.z * turned.x - across * turned.z, turned.y, across * turned.x + h.z * turned.z);
    angles.difference = std::atan2(std::hypot(d.x, d.y), d.z);
    angles.azimuth = std::atan2(d.y, d.x);
    // Exchanging the two directions adds half a turn.
    if (angles.azimuth < 0) angles.azimuth += piD;
    if (angles.azimuth >= piD) angles.azimuth -= piD;
    return angles;
}

std::array<MerlCorner, 8> merlCorners(const Vec3& towardLight, const Vec3& towardEye) {
    constexpr int halfSteps = MeasuredBrdf::halfSteps, differenceSteps = MeasuredBrdf::differenceSteps,
                  azimuthSteps = MeasuredBrdf::azimuthSteps;
    const HalfAngles angles = halfAngles(towardLight, towardEye);
    const Between h = clamped(std::sqrt(angles.half / (0.5 * piD)) * halfSteps, halfSteps);
    const Between d = clamped(angles.difference / (0.5 * piD) * differenceSteps, differenceSteps);
    const double azimuth = angles.azimuth / piD * azimuthSteps;
    const int first = int(azimuth) % azimuthSteps;
    const Between a{first, (first + 1) % azimuthSteps, azimuth - std::floor(azimuth)};
    std::array<MerlCorner, 8> corners;
    for (size_t corner = 0; corner < 8; ++corner) {
        const bool i = corner & 1, j = corner & 2, k = corner & 4;
        corners[corner] = {
            MeasuredBrdf::index(i ? h.high : h.low, j ? d.high : d.low, k ? a.high : a.low),
            (i ? h.fraction : 1 - h.fraction) * (j ? d.fraction : 1 - d.fraction) * (k ? a.fraction : 1 - a.fraction)};
    }
    return corners;
}

Rgb MeasuredBrdf::evaluate(const Vec3& towardLight, const Vec3& towardEye) const {
    if (!(towardLight.z > 0 && towardEye.z > 0)) return Rgb(0);
    glm::dvec3 sum(0);
    double weights = 0;
    for (const MerlCorner& corner : merlCorners(towardLight, towardEye)) {
        const Rgb& value = cells[corner.cell];
        if (!(corner.weight > 0) || value.x < 0 || value.y < 0 || value.z < 0) continue;
        sum += corner.weight * glm::dvec3(value);
        weights += corner.weight;
    }
    return weights > 0 ? Rgb(sum / weights) : Rgb(0);
}

MeasuredBrdf readMerl(const std::filesystem::path& file) {
    static_assert(std::endian::native == std::endian::little,
                  "MERL's files are little-endian and are read as they are");
    constexpr size_t cellCount =
        size_t(MeasuredBrdf::halfSteps) * MeasuredBrdf::differenceSteps * MeasuredBrdf::azimuthSteps;
    constexpr size_t expected = 12 + cellCount * 3 * sizeof(double);
    std::error_code failed;
    const auto size = std::filesystem::file_size(file, failed);
    if (failed) throw Error("{}: cannot be read", file.string());
    if (size != expected) throw Error("{}: is {} bytes long, a MERL file has {}", file.string(), size, expected);
    const std::string bytes = readBytes(file, expected);
    int32_t counts[3];
    std::memcpy(counts, bytes.data(), sizeof counts);
    if (counts[0] != 90 || counts[1] != 90 || counts[2] != 180)
        throw Error("{}: its first numbers are {} {} {}, expected 90 90 180", file.string(), counts[0], counts[1],
                    counts[2]);
    MeasuredBrdf brdf;
    brdf.name = file.stem().string();
    brdf.cells.resize(cellCount);
    for (size_t i = 0; i < cellCount; ++i) {
        Rgb value(0);
        bool below = false;
        for (size_t c = 0; c < 3; ++c) {
            double stored;
            std::memcpy(&stored, bytes.data() + 12 + (c * cellCount + i) * sizeof stored, sizeof stored);
            if (!std::isfinite(stored) || stored > 1e12)
                throw Error("{}: cell {} of channel {} is {}, expected a finite number", file.string(), i, c, stored);
            below |= stored < 0;
            value[int(c)] = float(stored * channelScale[c]);
        }
        if (below) {
            value = Rgb(-1);
            ++brdf.missing;
        }
        brdf.cells[i] = value;
    }
    if (brdf.missing == cellCount) throw Error("{}: holds no measurement, every cell is negative", file.string());
    return brdf;
}

}  // namespace relamp
