#include "relight/denoise.h"

#include <bit>

#include "base/parallel.h"

namespace relamp {
namespace {

constexpr int reach = 5;  // of the window
constexpr int tileSide = 32;
constexpr int border = reach + 1;  // and of the patches
constexpr int side = tileSide + 2 * border;
constexpr int varianceReach = 3;
static_assert(denoiseMargin >= border + varianceReach);
/// Differences that count as one standard deviation of the noise, squared.
constexpr float tolerance = 0.45f * 0.45f;
/// Normals apart by 8 degrees, and surfaces apart by a pixel, count as much.
constexpr float normalScale = 1 / 0.01f;

/// exp(-x) for x >= 0 within 2e-3, without a table; compilers make vectors of it.
inline float expMinus(float x) {
    const float t = std::max(-126.0f, x * -1.44269504f), whole = std::floor(t), f = t - whole;
    const float fraction = 1 + f * (0.6951f + f * (0.2275f + f * 0.0774f));
    return fraction * std::bit_cast<float>((int(whole) + 127) << 23);
}

/// One value a pixel of a tile and its border.
using Plane = std::array<float, size_t(side) * side>;

struct TileGuide {
    std::array<Plane, 3> normal, position;
    Plane perFootprint;  ///< 0 where there is nothing to filter
};
struct TileLight {
    std::array<std::array<Plane, 3>, 2> light;  ///< half, channel
    std::array<Plane, 3> variance;              ///< of one half
};

/// Variance of a half's light: half the squared difference of the halves, mean over 7 x 7 pixels.
std::vector<Rgb> varianceOf(const SurfaceGuide& guide, const HalfLight& light) {
    const int w = guide.width, h = guide.height;
    std::vector<Rgb> across(guide.footprint.size()), out(across.size());
    std::vector<float> count(across.size());
    parallelFor(size_t(h), 8, [&](size_t y) {
        for (int x = 0; x < w; ++x) {
            Rgb sum(0);
            float n = 0;
            for (int k = std::max(0, x - varianceReach); k <= std::min(w - 1, x + varianceReach); ++k) {
                const size_t q = y * size_t(w) + size_t(k);
                if (!(guide.footprint[q] > 0)) continue;
                const Rgb d = light[0][q] - light[1][q];
                sum += 0.5f * d * d;
                ++n;
            }
            across[y * size_t(w) + size_t(x)] = sum;
            count[y * size_t(w) + size_t(x)] = n;
        }
    });
    parallelFor(size_t(h), 8, [&](size_t y) {
        for (int x = 0; x < w; ++x) {
            Rgb sum(0);
            float n = 0;
            const int from = std::max(0, int(y) - varianceReach), to = std::min(h - 1, int(y) + varianceReach);
            for (int k = from; k <= to; ++k) {
                const size_t q = size_t(k) * size_t(w) + size_t(x);
                sum += across[q];
                n += count[q];
            }
            out[y * size_t(w) + size_t(x)] = sum / std::max(1.0f, n);
        }
    });
    return out;
}

/// A tile's window into the image; pixels outside have no surface.
template <class Take>
void fillTile(const SurfaceGuide& guide, int x0, int y0, const Take& take) {
    for (int y = 0; y < side; ++y)
        for (int x = 0; x < side; ++x) {
            const int column = x0 - border + x, row = y0 - border + y;
            const bool inside = column >= 0 && row >= 0 && column < guide.width && row < guide.height;
            take(size_t(y) * side + size_t(x), inside ? size_t(row) * size_t(guide.width) + size_t(column) : SIZE_MAX);
        }
}

class TileFilter {
public:
    TileFilter(const SurfaceGuide& guide, const std::vector<const HalfLight*>& light,
               const std::vector<const std::vector<Rgb>*>& variance, int x0, int y0)
        : groups_(light.size()), sums_(light.size()) {
        fillTile(guide, x0, y0, [&](size_t at, size_t pixel) {
            const bool there = pixel != SIZE_MAX && guide.footprint[pixel] > 0;
            guide_.perFootprint[at] = there ? 1 / guide.footprint[pixel] : 0.0f;
            for (int c = 0; c < 3; ++c) {
                guide_.normal[size_t(c)][at] = there ? guide.normal[pixel][c] : 0.0f;
                guide_.position[size_t(c)][at] = there ? guide.position[pixel][c] : 0.0f;
            }
        });
        for (size_t g = 0; g < light.size(); ++g)
            fillTile(guide, x0, y0, [&](size_t at, size_t pixel) {
                for (size_t c = 0; c < 3; ++c) {
                    for (size_t h = 0; h < 2; ++h)
                        groups_[g].light[h][c][at] = pixel == SIZE_MAX ? 0.0f : (*light[g])[h][pixel][int(c)];
                    groups_[g].variance[c][at] = pixel == SIZE_MAX ? 0.0f : (*variance[g])[pixel][int(c)];
                }
            });
        for (auto& s : sums_) s = {};
    }

    void run() {
        for (int dy = -reach; dy <= reach; ++dy)
            for (int dx = -reach; dx <= reach; ++dx) {
                const std::ptrdiff_t step = std::ptrdiff_t(dy) * side + dx;
                for (int y = reach; y < side - reach; ++y) compareSurfaces(rowFrom(y, reach), step);
                sumOfNine(surface_, surfaces_);
                for (size_t g = 0; g < groups_.size(); ++g)
                    for (size_t h = 0; h < 2; ++h) {
                        const TileLight& t = groups_[g];
                        for (int y = reach; y < side - reach; ++y)
                            compareLight(t.light[h], t.variance, rowFrom(y, reach), step);
                        sumOfNine(difference_, differences_);
                        for (int y = border; y < side - border; ++y)
                            add(t.light[1 - h], rowFrom(y, border), step, sums_[g][1 - h]);
                    }
            }
    }

    /// Of a pixel of the tile.
    Rgb mean(size_t group, int x, int y) const {
        const size_t at = size_t(y + border) * side + size_t(x + border);
        Rgb sum(0);
        for (size_t h = 0; h < 2; ++h)
            for (size_t c = 0; c < 3; ++c) sum[int(c)] += 0.5f * sums_[group][h][c][at] / sums_[group][h][3][at];
        return sum;
    }

private:
    TileGuide guide_;
    std::vector<TileLight> groups_;
    std::vector<std::array<std::array<Plane, 4>, 2>> sums_;  // half: three channels, weights
    Plane surface_{}, surfaces_{}, difference_{}, differences_{}, across_{};

    static size_t rowFrom(int y, int x) { return size_t(y) * side + size_t(x); }

    /// Sums over 3 x 3 pixels.
    void sumOfNine(const Plane& in, Plane& out) {
        for (int y = reach; y < side - reach; ++y) {
            const float* from = &in[rowFrom(y, border)];
            float* to = &across_[rowFrom(y, border)];
            for (int x = 0; x < tileSide; ++x) to[x] = from[x - 1] + from[x] + from[x + 1];
        }
        for (int y = border; y < side - border; ++y) {
            const float* from = &across_[rowFrom(y, border)];
            float* to = &out[rowFrom(y, border)];
            for (int x = 0; x < tileSide; ++x) to[x] = from[x - side] + from[x] + from[x + side];
        }
    }

    /// A row of surface_: how much a pixel and the one a step away show the same surface.
    void compareSurfaces(size_t row, std::ptrdiff_t step) {
        const auto at = [&](const Plane& p, std::ptrdiff_t by) { return p.data() + std::ptrdiff_t(row) + by; };
        const float *nx = at(guide_.normal[0], 0), *ny = at(guide_.normal[1], 0), *nz = at(guide_.normal[2], 0);
        const float *mx = at(guide_.normal[0], step), *my = at(guide_.normal[1], step),
                    *mz = at(guide_.normal[2], step);
        const float *px = at(guide_.position[0], 0), *py = at(guide_.position[1], 0), *pz = at(guide_.position[2], 0);
        const float *qx = at(guide_.position[0], step), *qy = at(guide_.position[1], step),
                    *qz = at(guide_.position[2], step);
        const float *mine = at(guide_.perFootprint, 0), *other = at(guide_.perFootprint, step);
        float* out = surface_.data() + row;
        for (int x = 0; x < side - 2 * reach; ++x) {
            const float dx = qx[x] - px[x], dy = qy[x] - py[x], dz = qz[x] - pz[x];
            const float turned = 1 - (nx[x] * mx[x] + ny[x] * my[x] + nz[x] * mz[x]);
            const float here = dx * nx[x] + dy * ny[x] + dz * nz[x], there = dx * mx[x] + dy * my[x] + dz * mz[x];
            const float apart = std::max(std::abs(here), std::abs(there)) * mine[x];
            const float both = mine[x] * other[x] > 0 ? 1.0f : 0.0f;
            out[x] = both * expMinus(std::max(0.0f, turned) * normalScale + apart * apart);
        }
    }

    /// A row of difference_: squared difference over that of the noise, times surface_.
    void compareLight(const std::array<Plane, 3>& light, const std::array<Plane, 3>& variance, size_t row,
                      std::ptrdiff_t step) {
        float* out = difference_.data() + row;
        const float* surface = surface_.data() + row;
        float sum[side - 2 * reach] = {}, noise[side - 2 * reach] = {};
        for (size_t c = 0; c < 3; ++c) {
            const float *a = light[c].data() + row, *b = a + step, *va = variance[c].data() + row, *vb = va + step;
            for (int x = 0; x < side - 2 * reach; ++x) {
                const float d = a[x] - b[x];
                sum[x] += d * d - (va[x] + std::min(va[x], vb[x]));
                noise[x] += va[x] + vb[x];
            }
        }
        for (int x = 0; x < side - 2 * reach; ++x)
            out[x] = surface[x] * std::min(sum[x] / (tolerance * noise[x] + 1e-20f), 1e4f);
    }

    void add(const std::array<Plane, 3>& light, size_t row, std::ptrdiff_t step, std::array<Plane, 4>& sums) const {
        const float *surface = surface_.data() + row, *surfaces = surfaces_.data() + row,
                    *differences = differences_.data() + row;
        float w[tileSide];
        for (int x = 0; x < tileSide; ++x)
            w[x] = surface[x] * expMinus(std::max(0.0f, differences[x] / (surfaces[x] + 1e-20f)));
        for (size_t c = 0; c < 3; ++c) {
            const float* from = light[c].data() + std::ptrdiff_t(row) + step;
            float* to = sums[c].data() + row;
            for (int x = 0; x < tileSide; ++x) to[x] += w[x] * from[x];
        }
        float* to = sums[3].data() + row;
        for (int x = 0; x < tileSide; ++x) to[x] += w[x];
    }
};

}  // namespace

std::vector<std::vector<Rgb>> denoisedLight(const SurfaceGuide& guide, const std::vector<HalfLight>& groups,
                                            int firstRow, int rows) {
    const size_t w = size_t(guide.width), from = size_t(firstRow) * w;
    std::vector<std::vector<Rgb>> out(groups.size());
    std::vector<const HalfLight*> light;
    std::vector<std::vector<Rgb>> variances;
    std::vector<size_t> lit;
    for (size_t g = 0; g < groups.size(); ++g) {
        out[g].resize(size_t(rows) * w);
        for (size_t p = 0; p < out[g].size(); ++p) out[g][p] = 0.5f * (groups[g][0][from + p] + groups[g][1][from + p]);
        variances.push_back(varianceOf(guide, groups[g]));
        bool any = false;
        for (const Rgb& v : variances.back()) any |= maxChannel(v) > 0;
        if (!any) {
            variances.pop_back();
            continue;
        }
        lit.push_back(g);
        light.push_back(&groups[g]);
    }
    std::vector<const std::vector<Rgb>*> variance;
    variance.reserve(variances.size());
    for (const auto& v : variances) variance.push_back(&v);
    const size_t across = (w + tileSide - 1) / tileSide, down = size_t(rows + tileSide - 1) / tileSide;
    parallelFor(across * down, 1, [&](size_t tile) {
        const int x0 = int(tile % across) * tileSide, y0 = firstRow + int(tile / across) * tileSide;
        const auto filter = std::make_unique<TileFilter>(guide, light, variance, x0, y0);
        filter->run();
        for (int y = y0; y < std::min(y0 + tileSide, firstRow + rows); ++y)
            for (int x = x0; x < std::min(x0 + tileSide, guide.width); ++x) {
                const size_t p = size_t(y) * w + size_t(x);
                if (!(guide.footprint[p] > 0)) continue;
                for (size_t g = 0; g < lit.size(); ++g) out[lit[g]][p - from] = filter->mean(g, x - x0, y - y0);
            }
    });
    return out;
}

}  // namespace relamp
