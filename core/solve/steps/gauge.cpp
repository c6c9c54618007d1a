// The scale of light against albedo: what fixes it, and how well that is known.
#include "base/log.h"
#include "base/printable.h"
#include "solve/steps/steps.h"

namespace relamp {
namespace {

constexpr float enoughSigma = 0.25f;     // what taking the brightest surfaces for white is off by
constexpr float assumedSigma = 0.35f;    // plausible mean albedos of an object lie between .3 and .8
constexpr double modelError = 0.02;      // of the light on the surfaces, relative
constexpr float refutedFraction = 0.1f;  // of the surfaces that would have to send back more light than they get

float quantileOf(std::vector<float> values, double q) {
    if (values.empty()) return 0;
    const auto at = values.begin() + ptrdiff_t(q * double(values.size() - 1));
    std::nth_element(values.begin(), at, values.end());
    return *at;
}

/// Fraction of the light on the surfaces that comes from background seen directly. `backdrop`: what is seen is black or
/// masked.
struct SeenLight {
    double fraction = 0;
    bool backdrop = false;
};

SeenLight seenLight(const SolveRun& s) {
    double seen = 0, all = 0;
    for (size_t r = 0; r < s.light.influence.rows; ++r)
        for (size_t i = 0; s.in.scene.rank[s.observed.matte.vertices[r]] % 7 == 0 && i < s.light.lighting.leaves.size();
             ++i) {
            const double given = double(s.light.influence.row(r)[i]) * luminance(s.light.lighting.leafRadiance[i]);
            seen += given * s.light.anchors.leaves[i].coverage;
            all += given;
        }
    return {all > 0 ? seen / all : 0, !tiesScale(s.light.anchors, s.light.prior.darkness)};
}

/// What light is to be multiplied with, by the artist's word.
Rgb givenGauge(const SolveRun& s, GaugeReport& gauge) {
    const GaugeChoice& choice = s.in.options.gauge;
    if (choice.kind == GaugeChoice::Kind::whitePatch) {
        const View& view = s.in.capture.views[size_t(choice.view)];
        const Hit hit = s.in.scene.cameraTracer->closest(
            {Vec3(view.camera.position()), view.camera.rayDirection(choice.pixel), 0, 1e30f});
        if (!hit)
            throw Error("--gauge white-patch: pixel {:.0f},{:.0f} of view {} sees no surface", choice.pixel.x,
                        choice.pixel.y, choice.view);
        const Triangle& t = s.in.scene.mesh.triangles[hit.triangle];
        gauge.kind = "white-patch";
        gauge.evidence = fmt::format("the surface at pixel {:.0f},{:.0f} of view {} was declared white", choice.pixel.x,
                                     choice.pixel.y, choice.view);
        return (s.surfaces.albedo.albedo[t[0]] + s.surfaces.albedo.albedo[t[1]] + s.surfaces.albedo.albedo[t[2]]) /
               3.0f / choice.whiteAlbedo;
    }
    if (choice.kind == GaugeChoice::Kind::emitter) {
        for (size_t e = 0; e < s.emitters.clusters.emitters.size(); ++e)
            if (s.emitters.clusters.emitters[e].id == choice.emitter) {
                gauge.kind = "emitter";
                gauge.evidence = fmt::format("the radiance of {} was given", choice.emitter);
                return choice.radiance / glm::max(s.light.lighting.emitterRadiance[e], Rgb(1e-20f));
            }
        throw Error("--gauge emitter={}: no such emitter was found", choice.emitter);
    }
    gauge.kind = "albedo";
    gauge.evidence = "the mean albedo was given";
    Rgb sum(0);
    for (uint32_t v : s.observed.matte.vertices) sum += s.surfaces.albedo.albedo[v];
    return sum / std::max(float(s.observed.matte.vertices.size()), 1.0f) / choice.albedo;
}

/// The same by what is usual, where nothing tells.
Rgb assumedGauge(const SolveRun& s, const Irradiance& irradiance, const SeenLight& seen, GaugeReport& gauge) {
    gauge.kind = "assumed";
    // Photographs are balanced so that light is white; the little that is seen of it does not tell its hue better.
    constexpr double littleSeen = 0.2;
    const bool white = seen.backdrop || (seen.fraction < littleSeen && s.emitters.clusters.emitters.empty());
    Rgb scale(1);
    DVec3 light(0);
    for (const Rgb& lit : irradiance.value) light += DVec3(lit);
    for (int c = 0; white && c < 3; ++c)
        if (light[c] > 0) scale[c] = float(luminance(Rgb(light)) / light[c]);
    if (!seen.backdrop) {
        // Brightest surfaces are taken for white.
        if (gauge.evidence.empty())
            gauge.evidence = fmt::format(
                "only {:.0f} % of the light is seen directly: the brightest surfaces were taken for an albedo of "
                "0.75{}; tell a white patch to be sure",
                100 * seen.fraction, white ? " under white light" : "");
        std::vector<float> brightest;
        for (uint32_t v : s.observed.matte.vertices)
            brightest.push_back(maxChannel(s.surfaces.albedo.albedo[v] / scale));
        return scale * (quantileOf(brightest, 0.95) / 0.75f);
    }
    // An object before a backdrop or a mask: nothing of its light is seen.
    gauge.evidence =
        "nothing of the light is seen (the background is black or masked, so the light comes from elsewhere): a mean "
        "albedo of 0.5 and white light were assumed; tell a white patch to be sure";
    std::vector<float> albedo;
    for (uint32_t v : s.observed.matte.vertices) albedo.push_back(luminance(s.surfaces.albedo.albedo[v] / scale));
    scale *= quantileOf(albedo, 0.5) / 0.5f;
    // A channel in which bright surfaces would be more than white is one in which the light is brighter.
    for (int c = 0; c < 3; ++c) {
        for (size_t i = 0; i < albedo.size(); ++i)
            albedo[i] = s.surfaces.albedo.albedo[s.observed.matte.vertices[i]][c] / scale[c];
        scale[c] *= std::max(1.0f, quantileOf(albedo, 0.9));
    }
    return scale;
}

/// Fraction of the surfaces that need an albedo above 1 when light is multiplied by `scale`; `upper`: the 95th
/// percentile of what they need.
float fractionAboveOne(const SolveRun& s, const Rgb& scale, float& upper) {
    std::vector<float> needed;
    for (size_t i = 0; i < s.observed.matte.vertices.size(); ++i) {
        const uint32_t v = s.observed.matte.vertices[i];
        if (s.surfaces.albedo.confidence[v] < 0.3f) continue;
        needed.push_back(maxChannel(s.surfaces.albedo.albedo[v] / scale));
    }
    upper = quantileOf(needed, 0.95);
    const size_t above = size_t(std::count_if(needed.begin(), needed.end(), [](float a) { return a > 1.02f; }));
    return needed.empty() ? 0 : float(above) / float(needed.size());
}

/// Cuts albedo at 1; where the photographs would be explained clearly worse, higher, at 2 at most.
void boundAlbedo(const SolveRun& s, const Irradiance& irradiance, const Rgb& scale, Estimate& estimate) {
    // No surface sends back more than it gets: where light was missed an albedo stands in for it, and would glow under
    // another light. But where much of the surface would be cut it is the scale that is off, and the bound would cost
    // the photographs.
    std::vector<float> bright;
    for (const Rgb& y : s.observed.matte.radiance) bright.push_back(luminance(y));
    const float exposure = 1 / std::max(quantileOf(bright, 0.995), 1e-20f);
    double own = 0, bounded = 0;
    for (size_t i = 0; i < s.observed.matte.vertices.size(); ++i) {
        const uint32_t v = s.observed.matte.vertices[i];
        const Rgb white = irradiance.value[i] * scale,
                  coating = s.observed.withCoatings.vertices.empty()
                                ? Rgb(0)
                                : glm::max(s.observed.withCoatings.radiance[i] - s.observed.matte.radiance[i], Rgb(0));
        const Rgb free = s.surfaces.albedo.albedo[v] / scale * white + coating,
                  cut = glm::min(s.surfaces.albedo.albedo[v] / scale, Rgb(1)) * white + coating;
        const size_t state = s.observed.matte.stateOf(i);
        for (uint32_t k = s.in.samples.start[v]; k < s.in.samples.start[v + 1]; ++k)
            for (int c = 0; c < 3 && s.in.samples.stateOf(s.in.samples.samples[k].view) == state; ++c) {
                const auto display = [&](float y) { return std::pow(std::clamp(y * exposure, 0.0f, 1.0f), 1 / 2.2f); };
                const double y = display(s.in.samples.samples[k].radiance[c]);
                own += std::pow(display(free[c]) - y, 2);
                bounded += std::pow(display(cut[c]) - y, 2);
            }
    }
    constexpr double dearly = 1.005;  // a fiftieth of a decibel
    float upper = 1;
    if (bounded > dearly * own) {
        // A few wild ones (the rim of an emitter, a hole) are cut all the same.
        std::vector<float> needed;
        for (uint32_t v : s.observed.matte.vertices) needed.push_back(maxChannel(s.surfaces.albedo.albedo[v] / scale));
        upper = std::clamp(quantileOf(std::move(needed), 0.98), 1.0f, 2.0f);
        logInfo("albedo is cut at {:.2f} where it was seen: at 1 the photographs would be explained {:.1f} dB worse",
                upper, 10 * std::log10(bounded / own));
    }
    for (size_t v = 0; v < s.in.scene.mesh.vertexCount(); ++v) {
        const Rgb most(s.in.samples.countOf(uint32_t(v)) > 0 ? upper : 1.0f);
        estimate.reflectance.weight[0][v] = glm::min(estimate.reflectance.weight[0][v], most);
        for (HeldOutAlbedo& held : estimate.heldOut) held.albedo[v] = glm::min(held.albedo[v], most);
    }
}

}  // namespace

float scaleSigmaByModel(double seen, double bounced) {
    return float(modelError / std::max(std::hypot(seen, bounced), 1e-3));
}

bool restsOnPartOfLight(const LightUncertainty& light, bool metal) {
    return luminance(light.fromBounces + (metal ? Rgb(0) : light.fromBackground)) > 0.5f;
}

Rgb widenedByModel(const SolveRun& s, const LightUncertainty& light, Rgb sigma) {
    if (!restsOnPartOfLight(light, s.gloss.joined)) return sigma;
    const float best = scaleSigmaByModel(seenLight(s).fraction, s.bounce.fraction);
    return glm::sqrt(sigma * sigma + best * best);
}

bool glossAlone(const LightUncertainty& light, bool backdrop) {
    return backdrop && luminance(light.fromGloss) > std::max(luminance(light.fromBounces), luminance(light.fromProbes));
}

void applyGauge(const SolveRun& s, const Irradiance& irradiance, const LightUncertainty& light, Estimate& estimate) {
    GaugeReport& gauge = estimate.gauge;
    Rgb scale(1);
    // How much of the light on the surfaces comes from where the background is seen: only that much ties the scale
    // down.
    const SeenLight seen = seenLight(s);
    const bool assessed = light.scaleSigma.x > 0 && light.scaleSigma.y > 0 && light.scaleSigma.z > 0;
    const Rgb scaleSigma = widenedByModel(s, light, light.scaleSigma);
    float upper = 0;
    const float above = fractionAboveOne(s, scale, upper);
    // Light so weak that much of the surface would have to be more than white is not what lights it.
    const bool refuted = above > refutedFraction;
    const bool unclipped = std::any_of(s.light.anchors.emitterClipped.begin(), s.light.anchors.emitterClipped.end(),
                                       [](uint8_t clipped) { return !clipped; });
    if (s.in.options.gauge.kind != GaugeChoice::Kind::automatic) {
        scale = givenGauge(s, gauge);
    } else if (patchesTakePart(s) && assessed) {
        gauge.kind = "known albedo";
        const size_t used = s.patchUsed.empty() ? s.in.options.patches.size()
                                                : size_t(std::count(s.patchUsed.begin(), s.patchUsed.end(), 1));
        gauge.evidence = fmt::format("the albedo of {} was told{}", counted(used, "patch"),
                                     unclipped ? ", and light is seen directly and unclipped beside it" : "");
    } else if (unclipped) {
        gauge.kind = "emitter";
        const size_t count = s.emitters.clusters.emitters.size();
        gauge.evidence = count == 1 ? "1 light is seen directly and unclipped; its light varies over the scene"
                                    : fmt::format(
                                          "{} lights are seen directly and unclipped; their light varies over "
                                          "the scene",
                                          count);
    } else if (!refuted && assessed && !glossAlone(light, seen.backdrop) && luminance(scaleSigma) < enoughSigma) {
        const float gloss = luminance(light.fromGloss), bounced = luminance(light.fromBounces);
        const float probes = luminance(light.fromProbes);
        if (probes > std::max({gloss, bounced, luminance(light.fromBackground)})) {
            gauge.kind = "light probe";
            gauge.evidence = fmt::format(
                "a light probe holds all of the light, and background that photographs show of it tells its exposure "
                "({:.0f} % of the light on the surfaces is seen directly)",
                100 * seen.fraction);
        } else if (bounced > gloss && bounced > luminance(light.fromBackground)) {
            gauge.kind = "bounced light";
            gauge.evidence = fmt::format(
                "{:.0f} % of the light on the surfaces comes from other surfaces, whose brightness the photographs "
                "show",
                100 * s.bounce.fraction);
        } else {
            gauge.kind = "background";
            gauge.evidence =
                fmt::format("background that is seen directly gives {:.0f} % of the light on the surfaces{}",
                            100 * seen.fraction, s.gloss.joined ? ", and metal mirrors it beside the rest" : "");
        }
    } else if (!refuted && !assessed && !seen.backdrop && seen.fraction > 0.35) {
        gauge.kind = "background";
        gauge.evidence = fmt::format(
            "{:.0f} % of the light on the surfaces comes from background that is seen directly", 100 * seen.fraction);
    } else {
        // Nothing ties light to albedo.
        if (refuted && !seen.backdrop)
            gauge.evidence = fmt::format(
                "what is seen of the light is refuted: {:.0f} % of the surfaces would need an albedo above 1; the "
                "brightest surfaces were taken for an albedo of 0.75; tell a white patch to be sure",
                100 * above);
        scale = assumedGauge(s, irradiance, seen, gauge);
        gauge.sigma = Rgb(assumedSigma);
    }
    const bool evidence = gauge.kind == "emitter" || gauge.kind == "background" || gauge.kind == "bounced light" ||
                          gauge.kind == "light probe" || gauge.kind == "known albedo";
    if (assessed && evidence) {
        gauge.sigma = scaleSigma;
        gauge.fromEmitters = light.fromEmitters;
        gauge.fromBackground = light.fromBackground;
        gauge.fromGloss = light.fromGloss;
        gauge.fromBounces = light.fromBounces;
        gauge.fromProbes = light.fromProbes;
        gauge.fromPatches = light.fromPatches;
        // Surfaces that would be more than white are evidence too.
        if (upper > 1) gauge.sigma = glm::max(gauge.sigma, Rgb(std::min(upper - 1, 1.0f)));
    }
    for (int c = 0; c < 3; ++c)
        if (!(scale[c] > 0) || !std::isfinite(scale[c])) scale[c] = 1;
    gauge.scale = scale;
    for (Rgb& l : estimate.lighting.leafRadiance) l *= scale;
    for (Rgb& l : estimate.lighting.emitterRadiance) l *= scale;
    for (Rgb& l : estimate.environment) l *= scale;
    for (StateLight& other : estimate.otherEnvironments) {
        for (Rgb& l : other.environment) l *= scale;
        for (Rgb& sigma : other.sigma) sigma *= scale;
    }
    for (ProbeFit& probe : estimate.probes) probe.gain *= scale;
    for (Rgb& sigma : estimate.environmentSigma) sigma *= scale;
    for (Rgb& sigma : estimate.emitterSigma) sigma *= scale;
    for (auto& lobe : estimate.reflectance.weight)
        for (Rgb& w : lobe) w /= scale;
    for (PaletteColour& colour : estimate.palette) colour.albedo /= scale;
    for (HeldOutAlbedo& held : estimate.heldOut)
        for (Rgb& albedo : held.albedo) albedo /= scale;
    boundAlbedo(s, irradiance, scale, estimate);
}

}  // namespace relamp
