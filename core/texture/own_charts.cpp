#include "texture/own_charts.h"

#include <fmt/format.h>

#include <numeric>

#include "scene/texcoords.h"
#include "texture/texels_inside.h"

namespace relamp {
namespace {

constexpr uint32_t noChart = ~0u;

std::array<Vec2, 3> onImage(const FaceTexcoords& places, int side) {
    std::array<Vec2, 3> p;
    for (size_t k = 0; k < 3; ++k) p[k] = Vec2(places[k].x, 1 - places[k].y) * float(side);
    return p;
}

float areaOf(const FaceTexcoords& places) {
    return 0.5f * std::abs(crossOf(places[1] - places[0], places[2] - places[0]));
}

/// Inside the image, up to rounding; then clamped to it.
bool isInside(FaceTexcoords& places) {
    constexpr float rounding = 1e-4f;
    for (Vec2& p : places) {
        if (!(p.x >= -rounding && p.x <= 1 + rounding && p.y >= -rounding && p.y <= 1 + rounding)) return false;
        p = glm::clamp(p, Vec2(0), Vec2(1));
    }
    return true;
}

/// Charts by the edges that triangles share on the image; noChart for triangles without coordinates.
std::vector<uint32_t> chartsOf(const std::vector<FaceTexcoords>& places, size_t& count) {
    struct Edge {
        std::array<float, 4> ends;
        uint32_t triangle;
    };
    std::vector<uint32_t> root(places.size());
    std::iota(root.begin(), root.end(), 0u);
    const auto rootOf = [&](uint32_t t) {
        while (root[t] != t) t = root[t] = root[root[t]];
        return t;
    };
    std::vector<Edge> edges;
    for (uint32_t t = 0; t < places.size(); ++t) {
        if (places[t] == FaceTexcoords{}) continue;
        for (size_t k = 0; k < 3; ++k) {
            std::array<float, 2> a{places[t][k].x, places[t][k].y},
                b{places[t][(k + 1) % 3].x, places[t][(k + 1) % 3].y};
            if (b < a) std::swap(a, b);
            edges.push_back({{a[0], a[1], b[0], b[1]}, t});
        }
    }
    std::sort(edges.begin(), edges.end(),
              [](const Edge& a, const Edge& b) { return std::tie(a.ends, a.triangle) < std::tie(b.ends, b.triangle); });
    for (size_t i = 1; i < edges.size(); ++i) {
        if (edges[i].ends != edges[i - 1].ends) continue;
        const uint32_t a = rootOf(edges[i].triangle), b = rootOf(edges[i - 1].triangle);
        root[std::max(a, b)] = std::min(a, b);
    }
    std::vector<uint32_t> charts(places.size(), noChart);
    count = 0;
    for (uint32_t t = 0; t < places.size(); ++t) {
        if (places[t] == FaceTexcoords{}) continue;
        const uint32_t r = rootOf(t);
        charts[t] = r == t ? uint32_t(count++) : charts[r];
    }
    return charts;
}

/// The fraction of the covered image that is of no use to a chart: texels beside one of another chart, and charts that
/// hold no texel at all.
double disputedFraction(const std::vector<FaceTexcoords>& places, const std::vector<uint32_t>& charts, size_t count,
                        int side) {
    std::vector<uint32_t> owner(size_t(side) * size_t(side), noChart);
    std::vector<uint8_t> hasTexels(count, 0);
    for (size_t t = 0; t < places.size(); ++t)
        if (charts[t] != noChart)
            texelsInside(onImage(places[t], side), side, [&](size_t at) {
                owner[at] = charts[t];
                return hasTexels[charts[t]] = true;
            });
    double covered = 0, disputed = 0;
    for (size_t t = 0; t < places.size(); ++t)
        if (charts[t] != noChart && !hasTexels[charts[t]]) {
            const double texels = double(areaOf(places[t])) * side * side;
            covered += texels;
            disputed += texels;
        }
    for (int y = 0; y < side; ++y)
        for (int x = 0; x < side; ++x) {
            const uint32_t own = owner[size_t(y) * size_t(side) + size_t(x)];
            if (own == noChart) continue;
            bool beside = false;
            for (int k = 0; k < 9 && !beside; ++k) {
                const int nx = x + k % 3 - 1, ny = y + k / 3 - 1;
                if (nx < 0 || ny < 0 || nx >= side || ny >= side) continue;
                const uint32_t other = owner[size_t(ny) * size_t(side) + size_t(nx)];
                beside = other != noChart && other != own;
            }
            covered += 1;
            disputed += beside;
        }
    return covered > 0 ? disputed / covered : 1;
}

}  // namespace

OwnCharts ownCharts(const Mesh& mesh, const std::vector<TexturedFace>& faces) {
    constexpr double mostMissing = 0.05, mostShared = 0.002;
    OwnCharts own;
    own.places = texcoordsOf(faces, mesh.triangles);
    double all = 0, missing = 0, outside = 0;
    for (size_t t = 0; t < own.places.size(); ++t) {
        const double area = mesh.triangleArea(t);
        all += area;
        const bool inside = isInside(own.places[t]);
        if (!inside) outside += area;
        if (inside && areaOf(own.places[t]) > 0) continue;
        missing += area;
        own.places[t] = {};
    }
    if (!(missing <= mostMissing * all)) {
        own.why = outside > 0.5 * missing
                      ? fmt::format("{:.0f} % of the surface lies outside the image, as tiles do", 100 * outside / all)
                      : fmt::format("{:.0f} % of the surface has none", 100 * missing / all);
        own.places.clear();
        return own;
    }
    constexpr int side = 2048;
    std::vector<uint8_t> taken(size_t(side) * side, 0);
    size_t covered = 0, shared = 0;
    constexpr double grace = 64;  // texels, of images that cover few
    // Files whose triangles all lie in one place would take forever.
    constexpr size_t enough = size_t(side) * side;
    for (size_t t = 0; t < own.places.size() && shared < enough; ++t)
        texelsInside(onImage(own.places[t], side), side, [&](size_t at) {
            shared += taken[at];
            covered += !taken[at];
            taken[at] = 1;
            return true;
        });
    if (double(shared) > grace + mostShared * double(covered)) {
        own.why = "triangles lie on one another in the image";
        own.places.clear();
    }
    return own;
}

Atlas layOutOwn(const Mesh& mesh, OwnCharts& own, const std::vector<float>& texelsPerMetre,
                const AtlasOptions& options) {
    constexpr double mostDisputed = 0.1, usualFill = 0.6;
    constexpr float wanted = 0.75f;  // of the texels asked for, by which the resolution is chosen
    Atlas atlas;
    std::vector<std::pair<double, double>> sides;  // that a triangle asks for, and how many texels
    double asked = 0;
    for (size_t t = 0; t < own.places.size(); ++t) {
        const double texels = double(mesh.triangleArea(t)) * double(texelsPerMetre[t]) * double(texelsPerMetre[t]);
        if (!(texels > 0) || own.places[t] == FaceTexcoords{}) continue;
        sides.emplace_back(std::sqrt(texels / double(areaOf(own.places[t]))), texels);
        asked += texels;
    }
    if (!(asked > 0)) return atlas;
    std::sort(sides.begin(), sides.end());
    const auto sideOf = [&](double fraction) {
        double sum = 0;
        for (const auto& [side, texels] : sides)
            if ((sum += texels) >= fraction * asked) return side;
        return sides.back().first;
    };
    // An image that is mostly empty is not worth the memory of all its texels.
    const double most = std::min(double(options.mostSide), 2 * std::sqrt(asked)),
                 side = std::min(sideOf(double(wanted)), most);
    const int texels = std::max(16, std::min(options.mostSide / 16 * 16, int(std::ceil(side / 16)) * 16));
    atlas.scale = float(std::min(1.0, texels / sideOf(0.5)));
    const double room = usualFill * double(options.mostSide) * double(options.mostSide);
    if (double(atlas.scale) < 0.5 * std::min(1.0, std::sqrt(room / asked))) {
        own.why = fmt::format("an image of {0} x {0} by them would have {1:.0f} % of the photographs' resolution",
                              texels, 100 * double(atlas.scale));
        return atlas;
    }
    atlas.chartOf = chartsOf(own.places, atlas.charts);
    if (const double disputed = disputedFraction(own.places, atlas.chartOf, atlas.charts, texels);
        disputed > mostDisputed) {
        own.why = fmt::format("their charts lie closer together than the texels of an image of {0} x {0}", texels);
        return atlas;
    }
    atlas.width = atlas.height = texels;
    atlas.corners.assign(mesh.triangles.size(), {Vec2(-1), Vec2(-1), Vec2(-1)});
    for (size_t t = 0; t < own.places.size(); ++t) {
        if (atlas.chartOf[t] == noChart) atlas.chartOf[t] = 0;
        else if (texelsPerMetre[t] > 0) atlas.corners[t] = onImage(own.places[t], texels);
    }
    return atlas;
}

}  // namespace relamp
