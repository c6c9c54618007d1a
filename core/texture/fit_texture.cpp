#include "texture/fit_texture.h"

#include <atomic>
#include <map>

#include "base/log.h"
#include "base/parallel.h"
#include "base/random.h"
#include "base/statistics.h"
#include "texture/own_charts.h"
#include "texture/photograph_geometry.h"
#include "texture/seams.h"
#include "texture/texels_inside.h"
#include "texture/vertex_texels.h"

namespace relamp {
namespace {

constexpr double mostSamples = 1.2e7;  // positions in pixels that a pass looks at
constexpr float priorWeight = 0.01f;   // of the vertices' albedo, in pixels
constexpr float robustScale =
    0.12f;                    // relative difference to what the other views say, beyond which a pixel counts less
constexpr float step = 1.5f;  // of a pass; below 2

/// Sums that atomic integers add up: in any order the same bits.
class TexelSums {
public:
    TexelSums(size_t texels, float samplesPerTexel)
        : unit_(32768 / std::max(1.0f, samplesPerTexel / 100)), sums_(texels * 4, 0) {}
    void clear() { std::fill(sums_.begin(), sums_.end(), 0); }
    void add(size_t texel, float weight, const Rgb& difference) {
        put(texel * 4, weight);
        for (int c = 0; c < 3; ++c) put(texel * 4 + 1 + size_t(c), weight * difference[c]);
    }
    float weight(size_t texel) const { return float(sums_[texel * 4]) / unit_; }
    Rgb difference(size_t texel) const {
        return Rgb(float(sums_[texel * 4 + 1]), float(sums_[texel * 4 + 2]), float(sums_[texel * 4 + 3])) / unit_;
    }

private:
    float unit_;
    std::vector<int32_t> sums_;
    void put(size_t at, float value) {
        std::atomic_ref<int32_t>(sums_[at]).fetch_add(int32_t(std::lround(value * unit_)), std::memory_order_relaxed);
    }
};

/// What one position in a pixel sees.
struct TexelSample {
    Vec2 place;
    Rgb light{0};
};

/// A pixel that sees one surface, lit by light that is known.
struct TracedPixel {
    uint32_t view = 0;
    int x = 0, y = 0;
    Rgb light{0}, coating{0};  ///< mean of its positions
    Rgb byVertices{0};         ///< radiance without coating, from the vertices' albedo
    float weight = 0;          ///< trust in the pixel and in its light, in [0, 1]
    uint32_t triangle = 0;     ///< that its first position meets
    std::array<TexelSample, 4> samples;
};

/// On one chart: squares of what vertices miss in pixels, of what texels add, and their product. Roots of radiance.
struct DetailEvidence {
    double missing = 0, both = 0, detail = 0;
    DetailEvidence& operator+=(const DetailEvidence& other) {
        missing += other.missing;
        both += other.both;
        detail += other.detail;
        return *this;
    }
    /// Squared error where `fraction` of the detail is kept.
    double errorWith(double fraction) const { return missing - 2 * fraction * both + fraction * fraction * detail; }
};

/// The fraction of its detail that each chart is right to keep, by what predicts left-out views best; charts that these
/// show little of follow the others. The gain of it all. The left-out view has a pose error of its own, which lowers
/// its fraction as much as that of the others does: three quarters count as all, one quarter as nothing.
std::vector<float> fractionsOf(const std::vector<DetailEvidence>& charts, TextureGain& gain) {
    DetailEvidence all;
    for (const DetailEvidence& e : charts) all += e;
    const double usual = all.detail > 0 ? std::clamp(all.both / all.detail, 0.0, 1.0) : 0,
                 prior = all.detail / double(std::max<size_t>(1, charts.size()));
    std::vector<float> fractions;
    for (const DetailEvidence& e : charts) {
        const double weight = e.detail + prior;
        const double best = weight > 0 ? (e.both + prior * usual) / weight : usual;
        fractions.push_back(float(std::clamp(2 * best - 0.5, 0.0, 1.0)));
        gain += {e.missing, e.errorWith(double(fractions.back()))};
    }
    return fractions;
}

class TextureSolver {
public:
    TextureSolver(const Capture& capture, const Scene& scene, const Estimate& estimate, AlbedoTexture& texture,
                  const std::vector<uint8_t>& inside, const std::vector<PhotographGeometry>& geometry,
                  Progress& progress)
        : capture_(capture),
          scene_(scene),
          estimate_(estimate),
          texture_(texture),
          inside_(inside),
          geometry_(geometry) {
        double pixels = 0;
        for (const PhotographGeometry& g : geometry) pixels += double(g.surfacePixels);
        across_ = 4 * pixels <= mostSamples ? 2 : 1;
        const double samples = pixels * across_ * across_;
        turns_ = uint32_t(std::max(1.0, std::ceil(samples / mostSamples)));
        samplesPerTexel_ = float(samples / turns_ / double(std::max<size_t>(1, texture.texels.size())));
        std::vector<float> brightness;
        for (const Rgb& e : estimate.surfaceLight.white)
            if (e.y > 0) brightness.push_back(luminance(e));
        dark_ = 0.05f * medianOf(std::move(brightness));
        start_ = texture.texels;
        if (turns_ > 1) return;
        for (uint32_t view = 0; view < capture.views.size(); ++view) {
            const int height = capture.views[view].camera.height;
            std::vector<std::vector<TracedPixel>> rows(static_cast<size_t>(height));
            parallelFor(rows.size(), 4, [&](size_t y) {
                progress.check();
                TracedPixel p;
                for (int x = 0; x < capture_.views[view].camera.width; ++x)
                    if (trace(view, x, int(y), p)) rows[y].push_back(p);
            });
            traced_.emplace_back();
            for (const std::vector<TracedPixel>& row : rows)
                traced_.back().insert(traced_.back().end(), row.begin(), row.end());
            progress.advance();
        }
    }

    /// One pass over the pixels of the views that `used` marks; of very many pixels, over every so many of them.
    void pass(const std::vector<uint8_t>& used, int index, TexelSums& sums, Progress& progress) {
        constexpr int plainPasses = 2;  // texture is no contradiction between views
        sums.clear();
        const auto add = [&](const TracedPixel& p) {
            const Rgb predicted = byTexture(p) / p.light,
                      measured = glm::max(capture_.views[p.view].image.at(p.x, p.y) - p.coating, Rgb(0)) / p.light,
                      difference = glm::clamp(measured - predicted, Rgb(-2), Rgb(2));
            float weight = p.weight;
            if (index >= plainPasses) {
                const float off =
                    luminance(glm::abs(difference)) / (robustScale * std::max(luminance(predicted), 0.03f));
                weight /= 1 + off * off;
            }
            const int count = across_ * across_;
            for (int i = 0; i < count; ++i) {
                const TexelBlend blend = texture_.blendAt(p.samples[size_t(i)].place);
                for (size_t k = 0; k < 4; ++k)
                    if (blend.weight[k] > 0.01f)
                        sums.add(blend.texel[k], weight / float(count) * blend.weight[k], difference);
            }
        };
        for (uint32_t view = 0; view < used.size(); ++view) {
            progress.advance();
            if (!used[view]) continue;
            if (turns_ == 1) {
                parallelFor(traced_[view].size(), 1024, [&](size_t i) { add(traced_[view][i]); });
                continue;
            }
            const Camera& camera = capture_.views[view].camera;
            parallelFor(size_t(camera.height), 4, [&](size_t y) {
                progress.check();
                TracedPixel p;
                for (int x = 0; x < camera.width; ++x)
                    if ((mixBits(y * 65536 + size_t(x)) + uint64_t(index)) % turns_ == 0 && trace(view, x, int(y), p))
                        add(p);
            });
        }
        parallelFor(texture_.texels.size(), 4096, [&](size_t i) {
            const float weight = sums.weight(i);
            if (!(weight > 0)) return;
            const Rgb change = sums.difference(i) + priorWeight * (start_[i] - texture_.texels[i]);
            texture_.texels[i] =
                glm::clamp(texture_.texels[i] + step / (weight + priorWeight) * change, Rgb(0), Rgb(2));
        });
        followInside(sums);
    }

    /// What texels say beside vertices in a view that they were not made from, added to the evidence on each chart.
    void judge(uint32_t view, const Atlas& atlas, std::vector<DetailEvidence>& charts) const {
        const Camera& camera = capture_.views[view].camera;
        constexpr size_t block = 32;
        std::vector<std::map<uint32_t, DetailEvidence>> found((size_t(camera.height) + block - 1) / block);
        parallelBlocks(size_t(camera.height), block, [&](size_t begin, size_t end) {
            TracedPixel p;
            for (size_t y = begin; y < end; ++y)
                for (int x = 0; x < camera.width; ++x) {
                    if (turns_ > 1 && mixBits(y * 65536 + size_t(x)) % turns_ != 0) continue;
                    if (!trace(view, x, int(y), p)) continue;
                    const Rgb vertex = glm::sqrt(p.byVertices + p.coating),
                              detail = glm::sqrt(byTexture(p) + p.coating) - vertex,
                              missing = glm::sqrt(glm::max(capture_.views[view].image.at(x, int(y)), Rgb(0))) - vertex;
                    found[begin / block][atlas.chartOf[p.triangle]] +=
                        {double(glm::dot(missing, missing)), double(glm::dot(missing, detail)),
                         double(glm::dot(detail, detail))};
                }
        });
        for (const auto& rows : found)
            for (const auto& [chart, evidence] : rows) charts[chart] += evidence;
    }

    /// Keeps in `texture` that fraction of what the texels of each chart say beside the vertices.
    void keepDetail(const Atlas& atlas, const std::vector<float>& fraction, AlbedoTexture& texture) const {
        std::vector<float> keep(texture.texels.size(), 0);
        for (uint32_t t = 0; t < atlas.corners.size(); ++t) {
            if (!texture.has(t)) continue;
            const auto& p = atlas.corners[t];
            const Vec2 low = glm::min(p[0], glm::min(p[1], p[2])), high = glm::max(p[0], glm::max(p[1], p[2]));
            for (int y = std::max(0, int(low.y) - 1); y <= std::min(atlas.height - 1, int(high.y) + 1); ++y)
                for (int x = std::max(0, int(low.x) - 1); x <= std::min(atlas.width - 1, int(high.x) + 1); ++x)
                    keep[size_t(y) * size_t(atlas.width) + size_t(x)] = fraction[atlas.chartOf[t]];
        }
        // Charts of the mesh's own lie in one another's rectangles.
        for (uint32_t t = 0; t < atlas.corners.size(); ++t)
            if (texture.has(t))
                texelsInside(atlas.corners[t], atlas.width, [&](size_t at) {
                    keep[at] = fraction[atlas.chartOf[t]];
                    return true;
                });
        parallelFor(keep.size(), 1 << 14,
                    [&](size_t i) { texture.texels[i] = start_[i] + keep[i] * (texture.texels[i] - start_[i]); });
    }

    float samplesPerTexel() const { return samplesPerTexel_; }

private:
    const Capture& capture_;
    const Scene& scene_;
    const Estimate& estimate_;
    AlbedoTexture& texture_;
    const std::vector<uint8_t>& inside_;
    const std::vector<PhotographGeometry>& geometry_;
    std::vector<Rgb> start_;
    std::vector<std::vector<TracedPixel>> traced_;  // per view, where all fit into memory
    int across_ = 1;                                // positions along a pixel's side
    uint32_t turns_ = 1;                            // passes until every pixel has had its turn
    float samplesPerTexel_ = 1, dark_ = 0;

    /// Texels beside a chart that hardly any pixel reaches differ from the vertices as their neighbours on the chart
    /// do.
    void followInside(const TexelSums& sums) {
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

    Rgb byTexture(const TracedPixel& p) const {
        const int count = across_ * across_;
        Rgb sum(0);
        for (int i = 0; i < count; ++i) sum += p.samples[size_t(i)].light * texture_.at(p.samples[size_t(i)].place);
        return sum / float(count);
    }

    /// False where a position sees no surface, an emitter, or one whose light is not known.
    bool trace(uint32_t view, int x, int y, TracedPixel& p) const {
        p.weight = geometry_[view].weight(x, y);
        if (!(p.weight > 0)) return false;
        const Camera& camera = capture_.views[view].camera;
        const Vec3 origin(camera.position());
        Ray rays[4];
        Hit hits[4];
        const int count = across_ * across_;
        for (int i = 0; i < count; ++i)
            rays[i] = {origin,
                       camera.rayDirection(Vec2(float(x) + (float(i % across_) + 0.5f) / float(across_),
                                                float(y) + (float(i / across_) + 0.5f) / float(across_))),
                       0, 1e30f};
        scene_.cameraTracer->closest8({rays, size_t(count)}, {hits, size_t(count)});
        p.view = view;
        p.triangle = hits[0].triangle;
        p.x = x;
        p.y = y;
        p.light = p.coating = p.byVertices = Rgb(0);
        float trust = 1;
        const float part = 1 / float(count);
        const std::vector<Rgb>&albedo = estimate_.reflectance.weight[0], &white = estimate_.surfaceLight.white;
        for (int i = 0; i < count; ++i) {
            if (!hits[i] || !texture_.has(hits[i].triangle)) return false;
            const Triangle& t = scene_.mesh.triangles[hits[i].triangle];
            const Vec2 b = hits[i].barycentric;
            const float corner[3] = {1 - b.x - b.y, b.x, b.y};
            Rgb light(0), vertexAlbedo(0);
            float least = 1e30f, most = 0;
            for (size_t k = 0; k < 3; ++k) {
                least = std::min(least, luminance(white[t[k]]));
                most = std::max(most, luminance(white[t[k]]));
                light += corner[k] * white[t[k]];
                vertexAlbedo += corner[k] * albedo[t[k]];
                p.coating += part * corner[k] * estimate_.surfaceLight.coating[t[k]];
            }
            if (!(least > 0)) return false;
            // Where light changes inside a triangle (edges of shadows) it is not known at its texels.
            const float change = (most - least) / (most + least) / 0.08f, bright = most / (most + dark_);
            trust = std::min(trust, bright * bright / (1 + change * change));
            p.samples[size_t(i)] = {texture_.place(hits[i].triangle, b), light};
            p.light += part * light;
            p.byVertices += part * light * vertexAlbedo;
        }
        p.weight *= trust;
        return p.light.x > 0 && p.light.y > 0 && p.light.z > 0;
    }
};

/// Texels a metre on each triangle. `vertex`: pixels a metre at the vertices.
std::vector<float> densityOf(const Scene& scene, const Estimate& estimate, const std::vector<float>& vertex,
                             float texelsPerPixel) {
    const Mesh& mesh = scene.mesh;
    std::vector<float> density(mesh.triangles.size(), 0);
    for (uint32_t t = 0; t < density.size(); ++t) {
        const Triangle& c = mesh.triangles[t];
        if (estimate.emitters.emitterOfTriangle[t] >= 0) continue;
        float albedo = 0;
        for (uint32_t v : c) albedo += maxChannel(estimate.reflectance.weight[0][v]);
        if (!(albedo > 0)) continue;  // a metal
        density[t] = texelsPerPixel * std::max(vertex[c[0]], std::max(vertex[c[1]], vertex[c[2]]));
        // Unobserved: as fine as its vertices.
        if (!(density[t] > 0)) density[t] = 1.5f / std::max(scene.vertexSpacing[c[0]], 1e-6f * scene.diagonal);
    }
    return density;
}

}  // namespace

double textureSeconds(double pixels, const TextureOptions& options) {
    // Positions that do not fit into memory are traced anew in each pass, and their texels are as wide as pixels.
    const bool kept = 4 * pixels <= mostSamples;
    const double looks = kept ? 4 * pixels * 1.5 * options.passes * 1.2e-7 : mostSamples * options.passes * 5.4e-7;
    return 0.5 + 2.5e-7 * pixels + looks;
}

double textureMib(double pixels, const TextureOptions& options) {
    const double texels = std::min(double(options.mostSide) * options.mostSide, 0.5 * pixels);
    return (44 * texels + std::min(4 * pixels, mostSamples) / 4 * sizeof(TracedPixel)) / (1 << 20);
}

namespace {

/// By the mesh's own texture coordinates where it has some that are fit for it, else by charts of our making.
Atlas atlasFor(const Capture& capture, const Mesh& mesh, const std::vector<float>& texelsPerMetre,
               const AtlasOptions& options, TextureFit& fit, Progress& progress) {
    if (capture.texcoords) {
        OwnCharts own = ownCharts(mesh, *capture.texcoords);
        if (own.why.empty())
            if (Atlas atlas = layOutOwn(mesh, own, texelsPerMetre, options); atlas.width > 0) {
                fit.own = true;
                return atlas;
            }
        fit.whyNotOwn = own.why;
    }
    return layOut(mesh, texelsPerMetre, options, progress);
}

}  // namespace

TextureFit fitTexture(const Capture& capture, const Scene& scene, const Estimate& estimate,
                      const TextureOptions& options, Progress& progress) {
    TextureFit fit;
    if (estimate.surfaceLight.empty() || capture.views.empty() || capture.views[0].image.pixels.empty()) {
        fit.why = "no surface is matte";
        return fit;
    }
    std::vector<float> pixelsPerMetre;
    const std::vector<PhotographGeometry> geometry =
        photographGeometry(capture, scene, estimate.emitters.emitterOfTriangle, pixelsPerMetre, progress);
    AtlasOptions layout;
    layout.mostSide = options.mostSide;
    const Atlas atlas = atlasFor(
        capture, scene.mesh, densityOf(scene, estimate, pixelsPerMetre, options.texelsPerPixel), layout, fit, progress);
    if (atlas.width == 0) {
        fit.why = "no surface is matte";
        return fit;
    }
    fit.charts = atlas.charts;
    fit.scale = atlas.scale;
    AlbedoTexture texture{atlas.width, atlas.height, atlas.corners, {}};
    std::vector<uint8_t> inside;
    texture.texels = texelsOfVertices(scene.mesh, estimate.reflectance.weight[0], texture, &inside);
    // Texels that are wider than pixels have nothing to sharpen.
    const int passes = atlas.scale * options.texelsPerPixel < 1 ? (2 * options.passes + 2) / 3 : options.passes;
    const size_t views = capture.views.size();
    progress.begin("Albedo per texel", views * size_t(passes + passes / 2 + 1));
    TextureSolver solver(capture, scene, estimate, texture, inside, geometry, progress);
    TexelSums sums(texture.texels.size(), solver.samplesPerTexel());
    std::vector<uint8_t> used(views, 1);
    std::vector<uint32_t> left;
    if (views >= 4) left = {uint32_t(views / 3), uint32_t(2 * views / 3)};
    for (const uint32_t view : left) used[view] = 0;
    for (int k = 0; k < passes; ++k) solver.pass(used, k, sums, progress);
    if (!left.empty()) {
        std::vector<DetailEvidence> evidence(atlas.charts);
        for (const uint32_t view : left) solver.judge(view, atlas, evidence);
        const std::vector<float> fractions = fractionsOf(evidence, fit.gain);
        if (!fit.gain.better() && !options.always) {
            fit.why = fmt::format("views left out are explained {:.1f} % better with it, which is too little",
                                  fit.gain.percent());
            return fit;
        }
        AlbedoTexture without = texture;
        if (!options.always) solver.keepDetail(atlas, fractions, without);
        fit.without = std::make_shared<const AlbedoTexture>(std::move(without));
        used.assign(views, 1);
        for (int k = passes / 2; k < passes; ++k) solver.pass(used, k, sums, progress);
        if (!options.always) solver.keepDetail(atlas, fractions, texture);
    }
    constexpr int levelling = 24;
    levelSeams(seamPoints(scene.mesh, texture), levelling, texture);
    fit.texture = std::make_shared<const AlbedoTexture>(std::move(texture));
    return fit;
}

}  // namespace relamp
