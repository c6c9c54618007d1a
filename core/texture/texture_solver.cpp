#include "texture/texture_solver.h"

#include <map>

#include "base/parallel.h"
#include "base/random.h"
#include "base/statistics.h"
#include "texture/texels_inside.h"

namespace relamp {
namespace {

constexpr float priorWeight = 0.01f;  // of the vertices' albedo, in pixels
constexpr float robustScale =
    0.12f;                         // relative difference to what the other views say, beyond which a pixel counts less
constexpr float step = 1.5f;       // of a pass; below 2
constexpr float seenUnit = 64;     // of TextureSolver::seen_
constexpr float halfKnown = 0.1f;  // pixels, by which half of a texel's albedo is its own

}  // namespace

TextureSolver::TextureSolver(const Capture& capture, const Scene& scene, const Estimate& estimate,
                             AlbedoTexture& texture, const std::vector<uint8_t>& inside,
                             const std::vector<PhotographGeometry>& geometry, Progress& progress)
    : capture_(capture), scene_(scene), estimate_(estimate), texture_(texture), inside_(inside), geometry_(geometry) {
    double pixels = 0;
    for (const PhotographGeometry& g : geometry) pixels += double(g.surfacePixels);
    across_ = keepsSamples(pixels) ? 2 : 1;
    const double samples = pixels * across_ * across_;
    turns_ = uint32_t(std::max(1.0, std::ceil(samples / mostTexelSamples)));
    samplesPerTexel_ = float(samples / turns_ / double(std::max<size_t>(1, texture.texels.size())));
    std::vector<float> brightness;
    for (const std::vector<Rgb>& ofState : estimate.surfaceLight.white)
        for (const Rgb& e : ofState)
            if (e.y > 0) brightness.push_back(luminance(e));
    dark_ = 0.05f * medianOf(std::move(brightness));
    start_ = texture.texels;
    seen_.assign(start_.size(), 0);
    if (across_ == 1) return;
    for (uint32_t view = 0; view < capture.views.size(); ++view) {
        const int height = capture.views[view].camera.height;
        std::vector<std::vector<TracedPixel>> rows(static_cast<size_t>(height));
        parallelFor(rows.size(), 4, [&](size_t y) {
            progress.check();
            TracedPixel p;
            TracedRow row(geometry_[view], int(y));
            for (int x = 0; x < capture_.views[view].camera.width; ++x)
                if (trace(view, x, row, p)) rows[y].push_back(p);
        });
        traced_.emplace_back();
        size_t seen = 0;
        for (const std::vector<TracedPixel>& row : rows) seen += row.size();
        traced_.back().reserve(seen);
        for (const std::vector<TracedPixel>& row : rows)
            traced_.back().insert(traced_.back().end(), row.begin(), row.end());
        progress.advance();
    }
}

void TextureSolver::pass(const std::vector<uint8_t>& used, int index, TexelSums& sums, Progress& progress) {
    constexpr int plainPasses = 2;  // texture is no contradiction between views
    sums.clear();
    const int count = across_ * across_;
    const auto add = [&](const TracedPixel& p, std::array<TexelBlend, 4>& blends) {
        const Rgb predicted = byTexture(p, blends) / p.light,
                  measured = glm::max(capture_.views[p.view].image.at(p.x, p.y) - p.coating, Rgb(0)) / p.light,
                  difference = glm::clamp(measured - predicted, Rgb(-2), Rgb(2));
        float weight = p.weight;
        if (index >= plainPasses) {
            const float off = luminance(glm::abs(difference)) / (robustScale * std::max(luminance(predicted), 0.03f));
            weight /= 1 + off * off;
        }
        for (int i = 0; i < count; ++i) {
            const TexelBlend& blend = blends[size_t(i)];
            for (size_t k = 0; k < 4; ++k)
                if (blend.weight[k] > 0.01f)
                    sums.add(blend.texel[k], weight / float(count) * blend.weight[k], difference);
        }
    };
    for (uint32_t view = 0; view < used.size(); ++view) {
        progress.advance();
        if (!used[view]) continue;
        if (!traced_.empty()) {
            parallelFor(traced_[view].size(), 1024, [&](size_t i) {
                std::array<TexelBlend, 4> blends;
                blend(traced_[view][i], blends);
                add(traced_[view][i], blends);
            });
            continue;
        }
        const Camera& camera = capture_.views[view].camera;
        parallelFor(size_t(camera.height), 4, [&](size_t y) {
            progress.check();
            // Texels far apart are slow to reach: a few pixels ask for theirs before the first one uses them.
            constexpr size_t few = 32;
            std::array<TracedPixel, few> pixels;
            std::array<std::array<TexelBlend, 4>, few> blends;
            size_t filled = 0;
            const auto addAll = [&] {
                for (size_t i = 0; i < filled; ++i) add(pixels[i], blends[i]);
                filled = 0;
            };
            TracedRow row(geometry_[view], int(y));
            for (int x = firstOf(int(y), index); x < camera.width; x += int(turns_)) {
                if (!trace(view, x, row, pixels[filled])) continue;
                blend(pixels[filled], blends[filled]);
                for (int i = 0; i < count; ++i)
                    for (const size_t k : {0, 2}) {
                        const size_t texel = blends[filled][size_t(i)].texel[k];
                        __builtin_prefetch(&texture_.texels[texel]);
                        sums.prefetch(texel);
                    }
                if (++filled == few) addAll();
            }
            addAll();
        });
    }
    ++passes_;
    parallelFor(texture_.texels.size(), 4096, [&](size_t i) {
        const float weight = sums.weight(i);
        if (!(weight > 0)) return;
        seen_[i] = uint16_t(std::min(65535L, seen_[i] + std::lround(seenUnit * weight)));
        const Rgb change = sums.difference(i) + priorWeight * (start_[i] - texture_.texels[i]);
        texture_.texels[i] = glm::clamp(texture_.texels[i] + step / (weight + priorWeight) * change, Rgb(0), Rgb(2));
    });
    followInside(sums);
}

void TextureSolver::judge(uint32_t view, const Atlas& atlas, std::vector<DetailEvidence>& charts) const {
    const Camera& camera = capture_.views[view].camera;
    constexpr size_t block = 32;
    std::vector<std::map<uint32_t, DetailEvidence>> found((size_t(camera.height) + block - 1) / block);
    parallelBlocks(size_t(camera.height), block, [&](size_t begin, size_t end) {
        TracedPixel p;
        std::array<TexelBlend, 4> blends;
        for (size_t y = begin; y < end; ++y) {
            TracedRow row(geometry_[view], int(y));
            for (int x = firstOf(int(y), 0); x < camera.width; x += int(turns_)) {
                if (!trace(view, x, row, p)) continue;
                blend(p, blends);
                const Rgb vertex = glm::sqrt(p.byVertices + p.coating),
                          detail = glm::sqrt(byTexture(p, blends) + p.coating) - vertex,
                          missing = glm::sqrt(glm::max(capture_.views[view].image.at(x, int(y)), Rgb(0))) - vertex;
                found[begin / block][atlas.chartOf[p.triangle]] +=
                    {double(glm::dot(missing, missing)), double(glm::dot(missing, detail)),
                     double(glm::dot(detail, detail))};
            }
        }
    });
    for (const auto& rows : found)
        for (const auto& [chart, evidence] : rows) charts[chart] += evidence;
}

void TextureSolver::keepDetail(const Atlas& atlas, const std::vector<float>& fraction, AlbedoTexture& texture) const {
    std::vector<float> keep(texture.texels.size(), 0);
    trianglesByRows(texture, [&](uint32_t t, const TexelRows& rows) {
        const auto& p = atlas.corners[t];
        const Vec2 low = glm::min(p[0], glm::min(p[1], p[2])), high = glm::max(p[0], glm::max(p[1], p[2]));
        for (int y = std::max(rows.begin, int(low.y) - 1); y <= std::min(rows.end - 1, int(high.y) + 1); ++y)
            for (int x = std::max(0, int(low.x) - 1); x <= std::min(atlas.width - 1, int(high.x) + 1); ++x)
                keep[size_t(y) * size_t(atlas.width) + size_t(x)] = fraction[atlas.chartOf[t]];
    });
    // Charts of the mesh's own lie in one another's rectangles.
    trianglesByRows(texture, [&](uint32_t t, const TexelRows& rows) {
        texelsInside(atlas.corners[t], atlas.width, rows, [&](size_t at) {
            keep[at] = fraction[atlas.chartOf[t]];
            return true;
        });
    });
    parallelFor(keep.size(), 1 << 14,
                [&](size_t i) { texture.texels[i] = start_[i] + keep[i] * (texture.texels[i] - start_[i]); });
}

/// Texels beside a chart that hardly any pixel reaches differ from the vertices as their neighbours on the chart
/// do.
void TextureSolver::followInside(const TexelSums& sums) {
    constexpr float enough = 0.15f;  // pixels
    const int width = texture_.width, height = texture_.height;
    parallelFor(size_t(height), 16, [&](size_t row) {
        for (int x = 0; x < width; ++x) {
            const size_t at = row * size_t(width) + size_t(x);
            if (inside_[at] || sums.weight(at) > enough) continue;
            Rgb detail(0);
            float count = 0;
            for (int k = 0; k < 9; ++k) {
                const int nx = x + k % 3 - 1, ny = int(row) + k / 3 - 1;
                if (nx < 0 || ny < 0 || nx >= width || ny >= height) continue;
                const size_t n = size_t(ny) * size_t(width) + size_t(nx);
                if (!inside_[n]) continue;
                detail += texture_.texels[n] - start_[n];
                ++count;
            }
            if (count > 0) texture_.texels[at] = glm::max(start_[at] + detail / count, Rgb(0));
        }
    });
}

void TextureSolver::blend(const TracedPixel& p, std::array<TexelBlend, 4>& blends) const {
    for (size_t i = 0; i < size_t(across_) * size_t(across_); ++i) blends[i] = texture_.blendAt(p.samples[i].place);
}

Rgb TextureSolver::byTexture(const TracedPixel& p, const std::array<TexelBlend, 4>& blends) const {
    const size_t count = size_t(across_) * size_t(across_);
    Rgb sum(0);
    for (size_t i = 0; i < count; ++i) {
        Rgb albedo(0);
        for (size_t k = 0; k < 4; ++k) albedo += blends[i].weight[k] * texture_.texels[blends[i].texel[k]];
        sum += p.samples[i].light * albedo;
    }
    return sum / float(count);
}

TextureSolver::TracedRow::TracedRow(const PhotographGeometry& geometry, int row) : y(row) {
    if (!geometry.triangles.empty()) known.emplace(geometry.triangles, row);
}

/// The first pixel of a row whose turn it is; the others follow at equal steps.
int TextureSolver::firstOf(int y, int turn) const { return int((mixBits(uint64_t(y)) + uint64_t(turn)) % turns_); }

void TextureSolver::look(uint32_t view, uint32_t triangle, LitTriangle& seen) const {
    seen.triangle = triangle;
    seen.trust = 0;
    if (!texture_.has(triangle)) return;
    const size_t state = std::min<size_t>(capture_.views[view].state, estimate_.surfaceLight.white.size() - 1);
    float least = 1e30f, most = 0;
    for (size_t k = 0; k < 3; ++k) {
        const uint32_t v = scene_.mesh.triangles[triangle][k];
        seen.corners[k] = scene_.mesh.positions[v];
        seen.white[k] = estimate_.surfaceLight.white[state][v];
        seen.coating[k] = estimate_.surfaceLight.coating[state][v];
        seen.albedo[k] = estimate_.reflectance.weight[0][v];
        least = std::min(least, luminance(seen.white[k]));
        most = std::max(most, luminance(seen.white[k]));
    }
    if (!(least > 0)) return;
    // Where light changes inside a triangle (edges of shadows) it is not known at its texels.
    const float change = (most - least) / (most + least) / 0.08f, bright = most / (most + dark_);
    seen.trust = bright * bright / (1 + change * change);
}

/// What the pixel's positions meet; false where one meets nothing.
bool TextureSolver::hits(uint32_t view, int x, TracedRow& row, Hit* found) const {
    const Camera& camera = capture_.views[view].camera;
    const Vec3 origin(camera.position());
    if (across_ == 1 && row.known) {
        // The ray met this triangle before: where, needs no search.
        const uint32_t triangle = row.known->triangleAt(x);
        if (triangle == Hit::none) return false;
        if (triangle != row.seen.triangle) look(view, triangle, row.seen);
        if (!(row.seen.trust > 0)) return false;
        const Vec3 d = camera.rayDirection(Vec2(float(x) + 0.5f, float(row.y) + 0.5f));
        const Vec3 first = row.seen.corners[0], a = row.seen.corners[1] - first, b = row.seen.corners[2] - first,
                   p = glm::cross(d, b), from = origin - first, q = glm::cross(from, a);
        const float determinant = glm::dot(a, p);
        if (determinant == 0) return false;
        const float u = std::clamp(glm::dot(from, p) / determinant, 0.0f, 1.0f);
        found[0].triangle = triangle;
        found[0].barycentric = Vec2(u, std::clamp(glm::dot(d, q) / determinant, 0.0f, 1 - u));
        return true;
    }
    Ray rays[4];
    const size_t count = size_t(across_) * size_t(across_);
    for (int i = 0; i < int(count); ++i)
        rays[i] = {origin,
                   camera.rayDirection(Vec2(float(x) + (float(i % across_) + 0.5f) / float(across_),
                                            float(row.y) + (float(i / across_) + 0.5f) / float(across_))),
                   0, 1e30f};
    scene_.cameraTracer->closest8({rays, count}, {found, count});
    return std::all_of(found, found + count, [](const Hit& hit) { return bool(hit); });
}

/// False where a position sees no surface, an emitter, or one whose light is not known.
bool TextureSolver::trace(uint32_t view, int x, TracedRow& row, TracedPixel& p) const {
    p.weight = geometry_[view].weight(x, row.y);
    if (!(p.weight > 0)) return false;
    Hit found[4];
    if (!hits(view, x, row, found)) return false;
    const int count = across_ * across_;
    p.view = view;
    p.triangle = found[0].triangle;
    p.x = x;
    p.y = row.y;
    p.light = p.coating = p.byVertices = Rgb(0);
    float trust = 1;
    const float part = 1 / float(count);
    LitTriangle& seen = row.seen;
    for (int i = 0; i < count; ++i) {
        if (found[i].triangle != seen.triangle) look(view, found[i].triangle, seen);
        if (!(seen.trust > 0)) return false;
        const Vec2 b = found[i].barycentric;
        const float corner[3] = {1 - b.x - b.y, b.x, b.y};
        Rgb light(0), vertexAlbedo(0);
        for (size_t k = 0; k < 3; ++k) {
            light += corner[k] * seen.white[k];
            vertexAlbedo += corner[k] * seen.albedo[k];
            p.coating += part * corner[k] * seen.coating[k];
        }
        trust = std::min(trust, seen.trust);
        p.samples[size_t(i)] = {texture_.place(found[i].triangle, b), light};
        p.light += part * light;
        p.byVertices += part * light * vertexAlbedo;
    }
    p.weight *= trust;
    return p.light.x > 0 && p.light.y > 0 && p.light.z > 0;
}

std::vector<uint8_t> TextureSolver::confidence(const Atlas& atlas, const std::vector<float>& fraction) const {
    std::vector<uint8_t> result(texture_.texels.size(), 0), found(result);
    const std::vector<float>& ofVertex = estimate_.reflectance.confidence;
    const float pixels = float(turns_) / (seenUnit * float(std::max(1, passes_)));
    trianglesByRows(texture_, [&](uint32_t t, const TexelRows& rows) {
        float vertices = 0;
        for (const uint32_t v : scene_.mesh.triangles[t]) vertices += ofVertex.empty() ? 1.0f / 3 : ofVertex[v] / 3;
        texelsInside(atlas.corners[t], atlas.width, rows, [&](size_t at) {
            const float seen = float(seen_[at]) * pixels;
            const float own = seen / (seen + halfKnown) * (fraction.empty() ? 1 : fraction[atlas.chartOf[t]]);
            result[at] = uint8_t(std::lround(255 * std::min(1.0f, own + (1 - own) * 0.5f * vertices)));
            found[at] = 1;
            return true;
        });
    });
    // Beside charts, and where centres lie on an edge, as inside: bilinear blends meet these texels.
    const std::vector<uint8_t> known = result;
    const int width = texture_.width, height = texture_.height;
    parallelFor(size_t(height), 16, [&](size_t row) {
        for (int x = 0; x < width; ++x) {
            const size_t at = row * size_t(width) + size_t(x);
            if (found[at]) continue;
            int sum = 0, count = 0;
            for (int k = 0; k < 9; ++k) {
                const int nx = x + k % 3 - 1, ny = int(row) + k / 3 - 1;
                if (nx < 0 || ny < 0 || nx >= width || ny >= height) continue;
                const size_t n = size_t(ny) * size_t(width) + size_t(nx);
                if (found[n]) sum += known[n], ++count;
            }
            if (count > 0) result[at] = uint8_t((sum + count / 2) / count);
        }
    });
    return result;
}

}  // namespace relamp
