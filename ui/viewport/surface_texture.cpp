#include "viewport/surface_texture.h"

#include "base/parallel.h"
#include "display/vertex_images.h"
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

constexpr int mostSideInPlace = 2048;

SurfaceDetail shrunk(SurfaceDetail detail, int mostSide) {
    while (std::max(detail.width, detail.height) > mostSide) detail = halved(detail);
    return detail;
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
    return shrunk(std::move(detail), mostSide);
}

SurfaceDetail confidenceDetail(const Estimate& estimate) {
    const AlbedoTexture& texture = *estimate.reflectance.texture;
    if (texture.confidence.empty()) return {};
    SurfaceDetail detail{texture.width, texture.height, std::vector<Vec4>(texture.confidence.size())};
    parallelFor(detail.factor.size(), 1 << 14,
                [&](size_t i) { detail.factor[i] = Vec4(confidenceColour(float(texture.confidence[i]) / 255), 1); });
    return shrunk(std::move(detail), mostSideInPlace);
}

SurfaceDetail correctionDetail(const Estimate& estimate, const Mesh& captured) {
    const AlbedoTexture& texture = *estimate.reflectance.texture;
    std::vector<Rgb> gloss = albedoColours(estimate);  // without the matte part
    for (size_t v = 0; v < gloss.size(); ++v) gloss[v] -= estimate.reflectance.lobe(0)[v];
    const std::vector<Rgb> between = texelsOfVertices(captured, gloss, texture);
    SurfaceDetail detail{texture.width, texture.height, std::vector<Vec4>(texture.texels.size())};
    parallelFor(detail.factor.size(), 1 << 14,
                [&](size_t i) { detail.factor[i] = Vec4(tintOf(texture.texels[i] + between[i]), 1); });
    return shrunk(std::move(detail), mostSideInPlace);
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
