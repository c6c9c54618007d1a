#include "texture/coarser_texels.h"

#include "base/parallel.h"
#include "texture/texels_inside.h"

namespace relamp {
namespace {

constexpr int mostCopies = 4;

/// Cells of a copy that no chart covers have the mean of those beside them: bilinear blends meet them.
void fillBeside(CoarserTexels& copy, std::vector<float>& weight) {
    const std::vector<float> covered = weight;
    parallelFor(size_t(copy.height), 16, [&](size_t row) {
        for (int x = 0; x < copy.width; ++x) {
            const size_t at = row * size_t(copy.width) + size_t(x);
            if (covered[at] > 0) continue;
            Rgb sum(0);
            float all = 0;
            for (int k = 0; k < 9; ++k) {
                const int nx = x + k % 3 - 1, ny = int(row) + k / 3 - 1;
                if (nx < 0 || ny < 0 || nx >= copy.width || ny >= copy.height) continue;
                const size_t n = size_t(ny) * size_t(copy.width) + size_t(nx);
                if (!(covered[n] > 0)) continue;
                sum += covered[n] * copy.texels[n];
                all += covered[n];
            }
            if (all > 0) copy.texels[at] = sum / all;
        }
    });
}

/// Texels whose centres lie on an edge between two triangles are inside neither of them.
void closeEdges(std::vector<float>& inside, int width, int height) {
    const std::vector<float> before = inside;
    parallelFor(size_t(height), 16, [&](size_t row) {
        for (int x = 0; x < width; ++x) {
            const size_t at = row * size_t(width) + size_t(x);
            const bool between = x > 0 && x + 1 < width && before[at - 1] > 0 && before[at + 1] > 0;
            const bool amid =
                row > 0 && row + 1 < size_t(height) && before[at - size_t(width)] > 0 && before[at + size_t(width)] > 0;
            if (between || amid) inside[at] = 1;
        }
    });
}

}  // namespace

void addCoarser(AlbedoTexture& texture) {
    texture.coarser.clear();
    texture.ofTriangle.assign(texture.corners.size(), Rgb(0));
    std::vector<float> weight(texture.texels.size(), 0);
    parallelFor(texture.corners.size(), 1024, [&](size_t t) {
        if (!texture.has(uint32_t(t))) return;
        Rgb sum(0);
        float count = 0;
        texelsInside(texture.corners[t], texture.width, texture.height, [&](size_t at) {
            sum += texture.texels[at];
            ++count;
            return true;
        });
        const std::array<Vec2, 3>& c = texture.corners[t];
        texture.ofTriangle[t] = count > 0 ? sum / count : texture.at((c[0] + c[1] + c[2]) / 3.0f);
    });
    trianglesByRows(texture, [&](uint32_t t, const TexelRows& rows) {
        texelsInside(texture.corners[t], texture.width, rows, [&](size_t at) {
            weight[at] = 1;
            return true;
        });
    });
    closeEdges(weight, texture.width, texture.height);
    const std::vector<Rgb>* finer = &texture.texels;
    int width = texture.width, height = texture.height;
    while (int(texture.coarser.size()) < mostCopies && std::min(width, height) >= 4) {
        CoarserTexels copy{(width + 1) / 2, (height + 1) / 2, {}};
        copy.texels.assign(size_t(copy.width) * size_t(copy.height), Rgb(0));
        std::vector<float> own(copy.texels.size(), 0);
        parallelFor(size_t(copy.height), 16, [&](size_t row) {
            for (size_t x = 0; x < size_t(copy.width); ++x) {
                const size_t at = row * size_t(copy.width) + x;
                for (size_t k = 0; k < 4; ++k) {
                    const size_t fx = 2 * x + k % 2, fy = 2 * row + k / 2;
                    if (fx >= size_t(width) || fy >= size_t(height)) continue;
                    const size_t from = fy * size_t(width) + fx;
                    copy.texels[at] += weight[from] * (*finer)[from];
                    own[at] += weight[from];
                }
                if (own[at] > 0) copy.texels[at] /= own[at];
            }
        });
        fillBeside(copy, own);
        texture.coarser.push_back(std::move(copy));
        finer = &texture.coarser.back().texels;
        weight = std::move(own);
        width = texture.coarser.back().width, height = texture.coarser.back().height;
    }
}

}  // namespace relamp
