#include "solve/chart.h"

#include "base/error.h"
#include "image/image_io.h"

namespace relamp {
namespace {

/// Linear reflectance in Rec.709 of the 24 patches, row by row from dark skin, from the published sRGB codes of the
/// ColorChecker Classic, which hold under D65.
constexpr int chartCodes[24][3] = {{115, 82, 68},   {194, 150, 130}, {98, 122, 157}, {87, 108, 67},   {133, 128, 177},
                                   {103, 189, 170}, {214, 126, 44},  {80, 91, 166},  {193, 90, 99},   {94, 60, 108},
                                   {157, 188, 64},  {224, 163, 46},  {56, 61, 150},  {70, 148, 73},   {175, 54, 60},
                                   {231, 199, 31},  {187, 86, 149},  {8, 133, 161},  {243, 243, 242}, {200, 200, 200},
                                   {160, 160, 160}, {122, 122, 121}, {85, 85, 85},   {52, 52, 52}};
constexpr size_t firstGrey = 18;
constexpr float greyNoise = 0.03f, colourNoise = 0.15f;  // a camera's channels are not the chart's
constexpr float ofSpacing = 0.25f;                       // radius of what is looked at in a patch

}  // namespace

std::vector<KnownPatch> chartPatches(size_t view, const std::array<Vec2, 4>& corners) {
    std::vector<KnownPatch> patches;
    const auto point = [&](size_t k) { return DVec3(corners[k].x, corners[k].y, 1); };
    const DVec3 a = point(0), b = point(1), c = point(2), d = point(3);  // a b over d c
    // A projective map of the unit square.
    const DVec3 lines = glm::inverse(glm::dmat3(a, b, d)) * c;
    if (!(lines.x < 0 && lines.y > 0 && lines.z > 0))
        throw Error(
            "the four middles of a chart's corner patches are no convex shape: expected dark skin, bluish green, "
            "black, white, round the chart");
    const glm::dmat3 basis(-lines.x * a, lines.y * b, lines.z * d);
    const auto at = [&](double x, double y) {
        const DVec3 p = basis[0] * (1 - x - y) + basis[1] * x + basis[2] * y;
        return Vec2(float(p.x / p.z), float(p.y / p.z));
    };
    for (int k = 0; k < 24; ++k) {
        const double x = (k % 6) / 5.0, y = (k / 6) / 3.0;
        KnownPatch patch;
        patch.name = fmt::format("chart in view {}, patch {}", view, k + 1);
        patch.view = view;
        patch.centre = at(x, y);
        patch.radius = ofSpacing * std::min(glm::distance(patch.centre, at(x < 1 ? x + 0.2 : x - 0.2, y)),
                                            glm::distance(patch.centre, at(x, y < 1 ? y + 1.0 / 3 : y - 1.0 / 3)));
        for (int channel = 0; channel < 3; ++channel)
            patch.albedo[channel] = srgbDecode(float(chartCodes[k][channel]) / 255);
        patch.noise = size_t(k) >= firstGrey ? greyNoise : colourNoise;
        patches.push_back(patch);
    }
    return patches;
}

}  // namespace relamp
