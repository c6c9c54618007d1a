#include "texture/atlas.h"

#include <numeric>

#include "base/error.h"
#include "base/log.h"
#include "texture/charts.h"

#define STB_RECT_PACK_IMPLEMENTATION
#define STBRP_STATIC
#include <stb/stb_rect_pack.h>

namespace relamp {
namespace {

/// Places of the charts in a square, if they fit.
bool packed(const std::vector<Chart>& charts, float scale, int gutter, int side, std::vector<stbrp_rect>& rects) {
    rects.clear();
    for (size_t i = 0; i < charts.size(); ++i) {
        const Vec2 size = charts[i].extent * scale;
        stbrp_rect rect{};
        rect.id = int(i);
        rect.w = int(std::ceil(size.x)) + 1 + 2 * gutter;
        rect.h = int(std::ceil(size.y)) + 1 + 2 * gutter;
        if (rect.w > side || rect.h > side) return false;
        rects.push_back(rect);
    }
    stbrp_context context;
    std::vector<stbrp_node> nodes(static_cast<size_t>(side));
    stbrp_init_target(&context, side, side, nodes.data(), side);
    return stbrp_pack_rects(&context, rects.data(), int(rects.size())) == 1;
}

/// Texels that rectangles ask for at a scale, with their gutters.
double texelsAsked(const std::vector<Chart>& charts, float scale, int gutter) {
    double sum = 0;
    for (const Chart& c : charts)
        sum += double(std::ceil(c.extent.x * scale) + 1 + float(2 * gutter)) *
               double(std::ceil(c.extent.y * scale) + 1 + float(2 * gutter));
    return sum;
}

}  // namespace

Atlas layOut(const Mesh& mesh, const std::vector<float>& texelsPerMetre, const AtlasOptions& options,
             Progress& progress) {
    Atlas atlas;
    atlas.corners.assign(mesh.triangles.size(), {Vec2(-1), Vec2(-1), Vec2(-1)});
    atlas.chartOf.assign(mesh.triangles.size(), 0);
    // Resolution that leaves room for rectangles and gutters.
    constexpr double usualFill = 0.6;
    double asked = 0;
    for (size_t t = 0; t < mesh.triangles.size(); ++t)
        asked += double(mesh.triangleArea(t)) * double(texelsPerMetre[t]) * double(texelsPerMetre[t]);
    if (!(asked > 0)) return atlas;
    const double room = usualFill * double(options.mostSide) * double(options.mostSide);
    atlas.scale = float(std::min(1.0, std::sqrt(room / asked)));
    std::vector<float> density = texelsPerMetre;
    for (float& d : density) d *= atlas.scale;
    const std::vector<Chart> charts = growCharts(mesh, density, options, progress);
    atlas.charts = charts.size();
    std::vector<stbrp_rect> rects;
    float scale = 1;
    int side = 0;
    const auto sideFor = [&](float s) {
        return std::max(16, (int(std::sqrt(texelsAsked(charts, s, options.gutter) * 1.08)) + 15) / 16 * 16);
    };
    for (side = sideFor(scale); !packed(charts, scale, options.gutter, std::min(side, options.mostSide), rects);) {
        progress.check();
        if (side < options.mostSide) {
            side += std::max(16, side / 256 * 16);
            continue;
        }
        scale *= 0.93f;
        if (scale < 0.01f)
            throw Error("{} charts do not fit into a texture of {} x {}", charts.size(), options.mostSide,
                        options.mostSide);
    }
    side = std::min(side, options.mostSide);
    atlas.scale *= scale;
    atlas.width = atlas.height = side;
    for (const stbrp_rect& rect : rects) {
        const Chart& chart = charts[size_t(rect.id)];
        const Vec2 at(float(rect.x + options.gutter) + 0.5f, float(rect.y + options.gutter) + 0.5f);
        for (size_t i = 0; i < chart.triangles.size(); ++i) {
            atlas.chartOf[chart.triangles[i]] = uint32_t(rect.id);
            for (size_t k = 0; k < 3; ++k) atlas.corners[chart.triangles[i]][k] = at + chart.corners[i][k] * scale;
        }
    }
    return atlas;
}

}  // namespace relamp
