#include "pipeline/reproduction.h"

#include <algorithm>

#include "base/log.h"
#include "base/parallel.h"
#include "base/random.h"
#include "base/statistics.h"
#include "clusters/state_emitters.h"
#include "display/display_image.h"
#include "radiance/agreement.h"
#include "radiance/state_parts.h"
#include "relight/frame.h"
#include "relight/state_look.h"

namespace relamp {
namespace {

/// Pixels of a view that see the mesh and no emitter, as their neighbours do, in the order of a low-discrepancy
/// sequence, and what brings the photograph to display values.
struct ComparedPixels {
    std::vector<PixelAt> at;
    float exposure = 1;
};

ComparedPixels comparedPixels(const View& view, const Scene& scene, const std::vector<int>& emitterOfTriangle,
                              size_t wanted) {
    // A look at many more than are rendered, because the exposure is a percentile.
    constexpr size_t candidates = 12000, block = 256;
    const Camera& camera = view.camera;
    const Vec3 origin(camera.position());
    const size_t count = std::min(candidates, size_t(camera.width) * size_t(camera.height));
    std::vector<PixelAt> at(count);
    enum : uint8_t { nothing, surface, inside };
    std::vector<uint8_t> seen(count, nothing);
    const auto seesSurface = [&](int x, int y) {
        const Hit hit = scene.cameraTracer->closest(
            {origin, camera.rayDirection(Vec2(float(x) + 0.5f, float(y) + 0.5f)), 0, 1e30f});
        return hit && emitterOfTriangle[hit.triangle] < 0;
    };
    parallelFor(count, block, [&](size_t i) {
        const Vec2 p = r2Point(uint32_t(i), Vec2(0.5f));
        const int x = std::min(camera.width - 1, int(p.x * float(camera.width))),
                  y = std::min(camera.height - 1, int(p.y * float(camera.height)));
        at[i] = {x, y};
        if (!view.image.usableAt(x, y) || !seesSurface(x, y)) return;
        // At the rim of a surface a pixel shows what lies behind it as well.
        bool within = true;
        for (int k = 0; k < 9 && within; ++k) within = k == 4 || seesSurface(x + k % 3 - 1, y + k / 3 - 1);
        seen[i] = within ? inside : surface;
    });
    ComparedPixels result;
    std::vector<float> brightness;
    for (size_t i = 0; i < count; ++i) {
        if (seen[i] == nothing) continue;
        brightness.push_back(luminance(view.image.at(at[i].x, at[i].y)));
        if (seen[i] == inside && result.at.size() < wanted) result.at.push_back(at[i]);
    }
    if (const float top = selectQuantile(brightness, 0.995); top > 0) result.exposure = 1 / top;
    return result;
}

/// What the plain median of each vertex's observations shows at the pixels, against the photograph.
double observedPsnr(const View& view, const ComparedPixels& pixels, const Scene& solved,
                    const RadianceSamples& samples) {
    const Vec3 origin(view.camera.position());
    std::vector<double> squares(pixels.at.size(), -1);
    parallelFor(pixels.at.size(), 256, [&](size_t i) {
        const PixelAt p = pixels.at[i];
        const Hit hit = solved.cameraTracer->closest(
            {origin, view.camera.rayDirection(Vec2(float(p.x) + 0.5f, float(p.y) + 0.5f)), 0, 1e30f});
        if (!hit) return;
        const Triangle& t = solved.mesh.triangles[hit.triangle];
        const float corner[3] = {1 - hit.barycentric.x - hit.barycentric.y, hit.barycentric.x, hit.barycentric.y};
        Rgb sum(0);
        float weight = 0;
        for (size_t k = 0; k < 3; ++k)
            if (const std::optional<Rgb> median = medianObservation(samples, t[k])) {
                sum += corner[k] * *median;
                weight += corner[k];
            }
        if (weight > 1e-3f) squares[i] = squaredDisplayStep(sum / weight, view.image.at(p.x, p.y), pixels.exposure);
    });
    DisplayError error;
    for (double s : squares)
        if (s >= 0) error.squares += s, ++error.pixels;
    return error.psnr();
}

/// Squared display step that the photograph's own noise makes at a pixel of radiance `y`: no model is to explain that.
double squaredNoiseStep(const Rgb& y, const RadianceSamples& samples, float exposure) {
    Rgb noise;
    for (int c = 0; c < 3; ++c) noise[c] = samples.sigmaOfPixel(y[c]);
    return 0.5 * (squaredDisplayStep(y + noise, y, exposure) + squaredDisplayStep(y - noise, y, exposure));
}

double framePsnr(const View& view, const ComparedPixels& pixels, const RadianceSamples& samples,
                 const FrameRenderer& renderer, Progress& progress) {
    const std::vector<Rgb> frame = renderer.pixels(view.camera, pixels.at, progress);
    DisplayError error;
    double noise = 0;
    for (size_t i = 0; i < frame.size(); ++i, ++error.pixels) {
        const Rgb photograph = view.image.at(pixels.at[i].x, pixels.at[i].y);
        error.squares += squaredDisplayStep(frame[i], photograph, pixels.exposure);
        noise += squaredNoiseStep(photograph, samples, pixels.exposure);
    }
    // Noise is taken off as far as it is known: fine texture passes for noise as well.
    constexpr double most = 0.5;
    error.squares -= std::min(noise, most * error.squares);
    return error.psnr();
}

std::string percentOf(float logGain) { return fmt::format("{:.0f} %", 100 * (std::exp(std::abs(logGain)) - 1)); }

/// The likeliest cause of a poor reproduction, from how the photographs agree with each other on the mesh.
void explainMisfit(const Estimate& estimate, const PhotographAgreement& agreement, Reproduction& r) {
    std::vector<double> correlations, gains, spreads;
    for (const ViewAgreement& v : agreement.views) {
        if (v.vertices < 20) continue;
        correlations.push_back(v.correlation);
        gains.push_back(std::abs(v.gain));
        spreads.push_back(v.spread);
    }
    const double correlation = meanMedianOf(correlations), gain = meanMedianOf(gains), spread = meanMedianOf(spreads);
    std::vector<std::string> bad;
    for (const ViewReproduction& v : r.views)
        if (v.pixels && v.psnr < r.median - 6) bad.push_back(v.name);
    if (agreement.movingLight.found()) {
        r.cause = MisfitCause::movingLight;
        r.advice =
            "The light moves with the camera (a flash, a ring light, or an object that turned before a fixed camera): "
            "no light that stands still explains these photographs. "
            "Photograph again with the light and the object at rest, and only the camera moving.";
    } else if (correlations.empty() || correlation < 0.4) {
        r.cause = MisfitCause::poses;
        r.advice =
            "The photographs show different things at the same place of the mesh: the cameras' poses or the mesh do "
            "not belong to them. "
            "Check that poses and photographs are in the same order and that the mesh is of the same reconstruction "
            "(`relamp check`).";
    } else if (gain > 0.15 && gain > 0.7 * spread) {
        r.cause = MisfitCause::exposures;
        r.advice = fmt::format(
            "The photographs differ in brightness by {} at the same places: exposure or white balance was automatic. "
            "Photograph with both fixed, or bring the photographs to one exposure first.",
            percentOf(float(gain)));
    } else if (r.observed > r.median + 3) {
        r.cause = MisfitCause::model;
        r.advice = fmt::format(
            "The photographs agree with each other ({:.1f} dB), but the light and surfaces found do not explain them: "
            "the scene may shine in ways relamp does not know, "
            "or the time was too short. Try --quality standard without a time budget, or --basis wide.",
            r.observed);
    } else if (!bad.empty() && bad.size() * 3 <= r.views.size()) {
        r.cause = MisfitCause::someViews;
        r.advice = fmt::format(
            "{} of the photographs ({}{}) do not fit the others: their poses or exposures are off. Leave them out.",
            bad.size(), bad[0], bad.size() > 1 ? ", ..." : "");
    } else {
        r.cause = MisfitCause::shape;
        r.advice = fmt::format(
            "The photographs disagree on the mesh itself ({:.1f} dB is the most it allows without any light model): "
            "hollows that are filled, holes, or poses a few pixels off. "
            "Make the mesh from more photographs or at a finer level.",
            r.observed);
    }
    if (estimate.mode == "distant-only" && r.cause == MisfitCause::model)
        r.advice += " Distant light alone was asked for: lights in the scene are not explained by it.";
}

/// The light of the photographs' lighting states.
struct LitState {
    std::unique_ptr<const RelitScene> relit;
    std::unique_ptr<const FrameRenderer> renderer;
    std::shared_ptr<const RadianceSamples> samples;
};

std::vector<LitState> litStates(const Capture& capture, const Scene& scene, const Estimate& estimate,
                                const RadianceSamples& samples, const FrameOptions& frame, Progress& progress) {
    std::vector<LitState> states(std::max<size_t>(1, capture.states.size()));
    for (size_t s = 0; s < states.size(); ++s) {
        Look look;
        if (states.size() > 1) look = inState({}, estimate, s);
        states[s].relit = std::make_unique<const RelitScene>(applyLook(scene, estimate, look, progress));
        states[s].renderer = std::make_unique<const FrameRenderer>(*states[s].relit, capture.views[0].camera, frame);
        states[s].samples = states.size() == 1
                                ? std::shared_ptr<const RadianceSamples>(&samples, [](const RadianceSamples*) {})
                                : std::make_shared<const RadianceSamples>(samplesOfState(samples, uint32_t(s)));
    }
    return states;
}

}  // namespace

Reproduction measureReproduction(const Capture& capture, const Scene& scene, const Estimate& estimate,
                                 const Scene& solved, const RadianceSamples& samples,
                                 const ReproductionOptions& options, Progress& progress) {
    Reproduction result;
    if (capture.views.empty() || capture.views[0].image.pixels.empty()) return result;
    const FrameOptions frame;
    const std::vector<LitState> states = litStates(capture, scene, estimate, samples, frame, progress);
    progress.begin("How well are the photographs explained?", capture.views.size());
    std::vector<ComparedPixels> pixels;
    for (const View& view : capture.views) {
        pixels.push_back(comparedPixels(view, scene, estimate.emitters.emitterOfTriangle, options.pixels));
        ViewReproduction v{view.name};
        v.pixels = pixels.back().at.size();
        if (v.pixels) {
            const LitState& state = states[view.state];
            v.psnr = framePsnr(view, pixels.back(), samples, *state.renderer, progress);
            if (options.diagnose) v.observed = observedPsnr(view, pixels.back(), solved, *state.samples);
        }
        result.views.push_back(std::move(v));
        progress.advance();
    }
    std::vector<double> psnr, observed, heldOut;
    for (const ViewReproduction& v : result.views) {
        if (!v.pixels) continue;
        psnr.push_back(v.psnr);
        observed.push_back(v.observed);
    }
    if (psnr.empty()) {
        result.views.clear();
        return result;
    }
    std::erase_if(result.views, [](const ViewReproduction& v) { return v.pixels == 0; });
    result.median = meanMedianOf(psnr);
    if (!options.diagnose) return result;
    result.observed = meanMedianOf(observed);
    for (const HeldOutAlbedo& held : estimate.heldOut) {
        const View& view = capture.views[held.view];
        const auto at = std::find_if(result.views.begin(), result.views.end(),
                                     [&](const ViewReproduction& v) { return v.name == view.name; });
        if (at == result.views.end()) continue;
        RelitScene without = *states[view.state].relit;
        without.weight[0] = held.albedo;
        without.texture = estimate.heldOutTexture;
        at->heldOut = framePsnr(view, pixels[held.view], samples, FrameRenderer(without, view.camera, frame), progress);
        heldOut.push_back(at->heldOut);
    }
    for (double h : heldOut) result.heldOut += h / double(heldOut.size());
    if (result.poor()) {
        const LitState& brightest = states[estimate.states.size() > 1 ? brightestState(estimate.emitters, samples) : 0];
        explainMisfit(estimate, photographAgreement(capture, solved, *brightest.samples, progress), result);
    }
    return result;
}

std::string toText(const Reproduction& r) {
    const ViewReproduction& worst = r.views[r.worst()];
    std::string text = fmt::format("photographs reproduced at {:.1f} dB (median of {} views; worst {:.1f} dB, {})",
                                   r.median, r.views.size(), worst.psnr, worst.name);
    if (r.heldOut > 0) text += fmt::format("; views left out are predicted at {:.1f} dB", r.heldOut);
    return text;
}

}  // namespace relamp
