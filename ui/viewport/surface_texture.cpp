#include "viewport/surface_texture.h"

#include "base/parallel.h"
#include "texture/vertex_texels.h"

namespace relamp::ui {

namespace {

SurfaceDetail halved(const SurfaceDetail& whole) {
    SurfaceDetail half{whole.width / 2, whole.height / 2, {}};
    half.factor.resize(size_t(half.width) * size_t(half.height));
    parallelFor(size_t(half.height), 16, [&](size_t y) {
        for (size_t x = 0; x < size_t(half.width); ++x) {
            const size_t at = 2 * y * size_t(whole.width) + 2 * x, below = at + size_t(whole.width);
            half.factor[y * size_t(half.width) + x] =
                0.25f * (whole.factor[at] + whole.factor[at + 1] + whole.factor[below] + whole.factor[below + 1]);
        }
    });
    return half;
}

}  // namespace

SurfaceDetail detailOf(const Estimate& estimate, const Mesh& captured) {
    const AlbedoTexture& texture = *estimate.reflectance.texture;
    const std::vector<Rgb> between = texelsOfVertices(captured, estimate.reflectance.lobe(0), texture);
    constexpr float dark = 1e-3f, most = 50;
    SurfaceDetail detail{texture.width, texture.height, std::vector<Vec4>(texture.texels.size(), Vec4(1))};
    parallelFor(detail.factor.size(), 1 << 14, [&](size_t i) {
        for (int c = 0; c < 3; ++c)
            if (between[i][c] > 0)
                detail.factor[i][c] = std::min(most, texture.texels[i][c] / std::max(between[i][c], dark));
    });
    constexpr int mostSide = 4096;
    while (std::max(detail.width, detail.height) > mostSide) detail = halved(detail);
    return detail;
}

std::vector<FaceTexcoords> texcoordsDrawn(const AlbedoTexture& texture, const Mesh& mesh, const Mesh& captured,
                                          const std::vector<uint32_t>* origin, const std::vector<uint8_t>& visible) {
    const Vec2 size(float(texture.width), float(texture.height));
    std::vector<FaceTexcoords> result;
    result.reserve(mesh.triangles.size());
    for (uint32_t t = 0; t < mesh.triangles.size(); ++t) {
        if (!visible.empty() && !visible[t]) continue;
        FaceTexcoords place{Vec2(-1), Vec2(-1), Vec2(-1)};
        if (t < captured.triangles.size() && texture.has(t))
            // Corners of mirrored parts have changed places.
            for (size_t k = 0; k < 3; ++k) {
                const uint32_t v = mesh.triangles[t][k], stands = origin ? (*origin)[v] : v;
                for (size_t i = 0; i < 3; ++i)
                    if (captured.triangles[t][i] == stands) place[k] = texture.corners[t][i] / size;
            }
        result.push_back(place);
    }
    return result;
}

}  // namespace relamp::ui
