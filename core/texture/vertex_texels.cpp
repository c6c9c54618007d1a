#include "texture/vertex_texels.h"

#include "texture/texels_inside.h"

namespace relamp {

std::vector<Rgb> texelsOfVertices(const Mesh& mesh, const std::vector<Rgb>& values, const AlbedoTexture& texture,
                                  std::vector<uint8_t>* inside) {
    const size_t count = size_t(texture.width) * size_t(texture.height);
    std::vector<Rgb> texels(count, Rgb(0));
    std::vector<uint8_t> covered(count, 0);
    trianglesByRows(texture, [&](uint32_t t, const TexelRows& rows) {
        const auto& p = texture.corners[t];
        const Vec2 low = glm::min(p[0], glm::min(p[1], p[2])), high = glm::max(p[0], glm::max(p[1], p[2]));
        const Vec2 a = p[1] - p[0], b = p[2] - p[0];
        const float area = a.x * b.y - a.y * b.x;
        const Triangle& v = mesh.triangles[t];
        for (int y = std::max(rows.begin, int(low.y - 1)); y <= std::min(rows.end - 1, int(high.y + 1)); ++y)
            for (int x = std::max(0, int(low.x - 1)); x <= std::min(texture.width - 1, int(high.x + 1)); ++x) {
                const Vec2 c = Vec2(float(x) + 0.5f, float(y) + 0.5f) - p[0];
                float b1 = 0, b2 = 0;
                if (area != 0) {  // mirrored charts, too
                    b1 = (c.x * b.y - c.y * b.x) / area;
                    b2 = (a.x * c.y - a.y * c.x) / area;
                }
                const bool on = b1 >= 0 && b2 >= 0 && b1 + b2 <= 1;
                const size_t at = size_t(y) * size_t(texture.width) + size_t(x);
                // A texel whose centre lies beside the triangle is read through bilinear blends all the same.
                if (covered[at] == 2 || (!on && covered[at])) continue;
                b1 = std::clamp(b1, 0.0f, 1.0f);
                b2 = std::clamp(b2, 0.0f, 1 - b1);
                texels[at] = (1 - b1 - b2) * values[v[0]] + b1 * values[v[1]] + b2 * values[v[2]];
                covered[at] = on ? 2 : 1;
            }
    });
    if (inside) {
        inside->resize(count);
        for (size_t i = 0; i < count; ++i) (*inside)[i] = covered[i] == 2;
    }
    return texels;
}

}  // namespace relamp
