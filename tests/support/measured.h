// Measured reflectance made of a function, as MERL's files hold it.
#pragma once
#include <cstring>
#include <functional>
#include <string>

#include "brdf/merl.h"

namespace relamp::test {

using Material = std::function<Rgb(const Vec3& towardLight, const Vec3& towardEye)>;

/// The pair of directions in the middle of a cell.
inline std::pair<Vec3, Vec3> pairOfCell(int half, int difference, int azimuth) {
    const double th = half * half / 8100.0 * piD / 2, td = difference / 90.0 * piD / 2, pd = azimuth / 180.0 * piD;
    const DVec3 local(std::sin(td) * std::cos(pd), std::sin(td) * std::sin(pd), std::cos(td));
    const auto turned = [&](const DVec3& v) {
        return Vec3(DVec3(std::cos(th) * v.x + std::sin(th) * v.z, v.y, -std::sin(th) * v.x + std::cos(th) * v.z));
    };
    return {turned(local), turned({-local.x, -local.y, local.z})};
}

inline MeasuredBrdf measuredOf(const Material& material) {
    MeasuredBrdf brdf;
    for (int h = 0; h < 90; ++h)
        for (int d = 0; d < 90; ++d)
            for (int p = 0; p < 180; ++p) {
                const auto [light, eye] = pairOfCell(h, d, p);
                const bool above = light.z > 0 && eye.z > 0;
                brdf.cells.push_back(above ? material(light, eye) : Rgb(-1));
                brdf.missing += !above;
            }
    return brdf;
}

/// The same as a .binary file.
inline std::string merlBytes(const Material& material) {
    const MeasuredBrdf brdf = measuredOf(material);
    const size_t cells = brdf.cells.size();
    std::string bytes(12 + cells * 24, '\0');
    const int32_t counts[3] = {90, 90, 180};
    std::memcpy(bytes.data(), counts, 12);
    const double scale[3] = {1500, 1500 / 1.15, 1500 / 1.66};
    for (size_t c = 0; c < 3; ++c)
        for (size_t i = 0; i < cells; ++i) {
            const double stored = double(brdf.cells[i][int(c)]) * scale[c];
            std::memcpy(&bytes[12 + (c * cells + i) * 8], &stored, 8);
        }
    return bytes;
}

}  // namespace relamp::test
