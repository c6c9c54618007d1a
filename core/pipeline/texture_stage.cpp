#include "pipeline/texture_stage.h"

#include "base/log.h"
#include "base/parallel.h"
#include "base/statistics.h"
#include "texture/background_panorama.h"
#include "texture/own_charts.h"

namespace relamp {
namespace {

constexpr float fineEnough = 0.7f;  // pixels between vertices, below which texels show nothing that vertices do not

/// Pixels between neighbouring vertices, where photographs see them: the middle of all observations.
float pixelsBetweenVertices(const Capture& capture, const Scene& scene, const RadianceSamples& samples) {
    std::vector<float> pixels;
    for (uint32_t v = 0; v < scene.mesh.vertexCount(); ++v)
        for (uint32_t k = samples.start[v]; k < samples.start[v + 1]; ++k) {
            const Camera& camera = capture.views[samples.samples[k].view].camera;
            const float distance = glm::length(Vec3(camera.position()) - scene.mesh.positions[v]);
            pixels.push_back(scene.vertexSpacing[v] * float(std::min(camera.focalX, camera.focalY)) / distance);
        }
    return medianOf(std::move(pixels));
}

bool leftOut(const SolvePlan& plan) {
    return std::any_of(plan.leftOut.begin(), plan.leftOut.end(),
                       [](const PlannedOmission& o) { return o.what == Omission::texture; });
}

/// The number that the photographs' lighting states give to an environment of the estimate, which counts from that of
/// the brightest one (RadianceSamples::environmentOf).
int photographedAs(const Estimate& estimate, const RadianceSamples& samples, int environment) {
    for (size_t state = 0; state < estimate.states.size(); ++state)
        if (estimate.states[state].environment == environment) return samples.environmentOf(uint32_t(state));
    return environment;
}

}  // namespace

void planTexture(const Capture& capture, const Scene& scene, const RadianceSamples& samples, std::optional<int> side,
                 bool everything, SolvePlan& plan) {
    double pixels = 0;
    for (const View& view : capture.views) pixels += double(view.camera.width) * double(view.camera.height);
    const double seconds = textureSeconds(pixels, {}) / availableThreads(), mib = textureMib(pixels, {});
    const auto without = [&](const std::string& why, double saved) {
        plan.leftOut.push_back({Omission::texture, why, saved, saved > 0 ? mib : 0.0});
    };
    if (side == 0) return without("as asked for", 0);
    const float apart = pixelsBetweenVertices(capture, scene, samples);
    if (!side && !everything && apart < fineEnough)
        return without(
            fmt::format("the mesh is as fine as the photographs: its vertices lie {:.1f} pixels apart", apart),
            seconds);
    plan.stages.push_back({Stage::texture, seconds, -1, mib, -1});
    if (!capture.texcoords) return;
    if (const OwnCharts own = ownCharts(capture.mesh, *capture.texcoords); !own.why.empty())
        plan.leftOut.push_back({Omission::ownTexcoords, own.why, 0, 0});
}

void addTexture(const Capture& capture, const Scene& scene, std::optional<int> side, Estimate& estimate,
                Progress& progress) {
    if (side != 0 && !leftOut(estimate.plan)) try {
            if (progress.outOfTime()) throw OutOfTime{};
            const Progress::Dispensable mayEnd(progress);
            TextureOptions options;
            if (side) options.mostSide = *side;
            options.always = side.has_value();
            TextureFit fit = fitTexture(capture, scene, estimate, options, progress);
            if (!fit.whyNotOwn.empty()) estimate.leftOut.push_back({Omission::ownTexcoords, fit.whyNotOwn});
            if (fit.texture)
                logInfo(
                    "texture of {} x {}, {} charts{}, {:.0f} % of the photographs' resolution; squared error of views "
                    "left "
                    "out {:+.0f} %",
                    fit.texture->width, fit.texture->height, fit.charts,
                    fit.own ? " by the mesh's own texture coordinates" : "", 100 * fit.scale, -fit.gain.percent());
            else estimate.leftOut.push_back({Omission::texture, fit.why});
            estimate.reflectance.texture = std::move(fit.texture);
            estimate.heldOutTexture = std::move(fit.without);
        } catch (const OutOfTime&) { estimate.leftOut.push_back({Omission::texture, "the time was used up"}); }
    estimate.surfaceLight = {};
}

void addBackgrounds(const Capture& capture, const RadianceSamples& samples, Estimate& estimate, Progress& progress) {
    if (progress.outOfTime()) return;
    const DirectionGrid grid{estimate.environmentSide};
    estimate.background = backgroundPanorama(capture, samples, photographedAs(estimate, samples, 0),
                                             estimate.environment, grid, progress);
    for (size_t k = 0; k < estimate.otherEnvironments.size(); ++k) {
        StateLight& other = estimate.otherEnvironments[k];
        const int environment = photographedAs(estimate, samples, int(k) + 1);
        other.background = backgroundPanorama(capture, samples, environment, other.environment, grid, progress);
    }
}

}  // namespace relamp
