#include "texture/fit_texture.h"

#include "base/log.h"
#include "radiance/state_parts.h"
#include "texture/coarser_texels.h"
#include "texture/own_charts.h"
#include "texture/photograph_geometry.h"
#include "texture/seams.h"
#include "texture/texture_solver.h"
#include "texture/vertex_texels.h"

namespace relamp {
namespace {

constexpr double mostTrianglesKept = 1e8;  // pixels, 4 B each

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

namespace {

double texelsOf(double pixels, const TextureOptions& options) {
    return std::min(double(options.mostSide) * options.mostSide, 0.5 * pixels);
}

}  // namespace

double textureSeconds(double pixels, const TextureOptions& options) {
    // Half as many passes again follow those without the views left out.
    const double passes = 1.5 * options.passes,
                 looks = keepsSamples(pixels) ? 4 * pixels * 5e-8 : std::min(pixels, mostTexelSamples) * 1e-7;
    return 0.5 + 1.5e-7 * pixels + 2e-7 * texelsOf(pixels, options) + looks * passes;
}

double textureMib(double pixels, const TextureOptions& options) {
    const double kept = keepsSamples(pixels) ? pixels * sizeof(TracedPixel) : 1.5 * pixels;
    return (56 * texelsOf(pixels, options) + kept) / (1 << 20);
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
    double pixels = 0;
    for (const View& view : capture.views) pixels += double(view.camera.width) * double(view.camera.height);
    std::vector<float> pixelsPerMetre;
    const std::vector<PhotographGeometry> geometry =
        photographGeometry(capture, scene, estimate.emitters.emitterOfTriangle,
                           !keepsSamples(pixels) && pixels <= mostTrianglesKept, pixelsPerMetre, progress);
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
    AlbedoTexture texture{atlas.width, atlas.height, atlas.corners, {}, {}, {}, {}};
    std::vector<uint8_t> inside;
    texture.texels = texelsOfVertices(scene.mesh, estimate.reflectance.weight[0], texture, &inside);
    // Texels that are wider than pixels have nothing to sharpen.
    const int passes = atlas.scale * options.texelsPerPixel < 1 ? (2 * options.passes + 2) / 3 : options.passes;
    const size_t views = capture.views.size();
    progress.begin("Albedo per texel", views * size_t(passes + passes / 2 + 1));
    TextureSolver solver(capture, scene, estimate, texture, inside, geometry, progress);
    std::optional<TexelSums> sums(std::in_place, texture.texels.size(), solver.samplesPerTexel());
    std::vector<uint8_t> used(views, 1);
    std::vector<uint32_t> left;
    std::vector<float> fractions;
    std::vector<uint32_t> ofState;
    for (uint32_t v = 0; v < views; ++v)
        if (capture.views[v].state == estimate.surfaceLight.state) ofState.push_back(v);
    if (const size_t n = ofState.size(); n >= 4)
        for (const uint32_t view : {ofState[n / 3], ofState[2 * n / 3]})
            for (const uint32_t alike : viewsTakenFrom(capture, view)) left.push_back(alike);
    for (const uint32_t view : left) used[view] = 0;
    for (int k = 0; k < passes; ++k) solver.pass(used, k, *sums, progress);
    if (!left.empty()) {
        std::vector<DetailEvidence> evidence(atlas.charts);
        for (const uint32_t view : left) solver.judge(view, atlas, evidence);
        fractions = fractionsOf(evidence, fit.gain);
        if (!fit.gain.better() && !options.always) {
            fit.why = fmt::format("views left out are explained {:.1f} % better with it, which is too little",
                                  fit.gain.percent());
            return fit;
        }
        sums.reset();  // room for a copy
        AlbedoTexture without = texture;
        if (!options.always) solver.keepDetail(atlas, fractions, without);
        fit.without = std::make_shared<const AlbedoTexture>(std::move(without));
        used.assign(views, 1);
        sums.emplace(texture.texels.size(), solver.samplesPerTexel());
        for (int k = passes / 2; k < passes; ++k) solver.pass(used, k, *sums, progress);
        sums.reset();
        if (!options.always) solver.keepDetail(atlas, fractions, texture);
    }
    sums.reset();
    texture.confidence = solver.confidence(atlas, options.always ? std::vector<float>{} : fractions);
    constexpr float perTexel = 5;
    levelSeams(seamPoints(scene.mesh, texture, perTexel), texture);
    addCoarser(texture);
    fit.texture = std::make_shared<const AlbedoTexture>(std::move(texture));
    return fit;
}

}  // namespace relamp
