// The scale of light against albedo: what fixes it, and how well that is known.
#include "base/log.h"
#include "solve/solve_state.h"

namespace relamp {

LightUncertainty SolveState::uncertainty(bool scaleOnly) {
    UncertaintyOptions options;
    options.bounced = !bounce_.empty();
    options.scaleOnly = scaleOnly;
    std::vector<std::string> names;
    for (const EmitterCluster& e : clusters_.emitters) names.push_back(e.id);
    LightUncertainty light = lightUncertainty(information_, influence_, lit_, lighting_, names, options, progress_);
    logInfo("scale known to {:.1f} {:.1f} {:.1f} %", 100 * light.scaleSigma.x, 100 * light.scaleSigma.y, 100 * light.scaleSigma.z);
    if (!scaleOnly && !light.weakest.empty()) logInfo("least known: {} ({:.1f} %)", light.weakest, 100 * light.weakestSigma);
    return light;
}

void SolveState::assessUncertainty(const LightUncertainty& light, Estimate& estimate) const {
    estimate.stability.weakest = light.weakest;
    estimate.stability.weakestSigma = light.weakestSigma;
    if (!(light.scaleSigma.y > 0)) return;
    // Albedo: the light on the vertex, its own look-ups, and what its neighbours tell of it where those are weak or there are none.
    constexpr float fromNeighbours = 0.06f, unseen = 0.15f, background = 0.02f, most = 10;
    double mean = 0;
    for (const Rgb& s : light.litSigma) mean += double(s.x + s.y + s.z) / 3;
    const float typical = light.litSigma.empty() ? 0.0f : float(mean / double(light.litSigma.size()));
    std::vector<float>& sigma = estimate.reflectance.sigma;
    sigma.assign(scene_.mesh.vertexCount(), std::hypot(typical, unseen));
    for (size_t i = 0; i < matte_.vertices.size(); ++i) {
        const uint32_t v = matte_.vertices[i];
        const float own = albedo_.confidence[v];
        float sum = 0;
        for (int c = 0; c < 3; ++c) {
            // Bounded, because nothing times infinity is not a number.
            const float look = std::min(most, matte_.sigma[i][c] / std::max(matte_.radiance[i][c], 1e-20f)), edge = std::min(most, litSigma_[i][c] / std::max(lit_[i][c], 1e-20f));
            const float variance = light.litSigma[i][c] * light.litSigma[i][c] + own * (look * look + edge * edge) + (1 - own) * fromNeighbours * fromNeighbours;
            sum += std::min(std::sqrt(variance), most);
        }
        sigma[v] = sum / 3;
    }
    for (size_t e = 0; e < clusters_.emitters.size(); ++e)
        if (clusters_.emitters[e].unseen && e < light.emitterSigma.size()) estimate.emitterSigma[e] = estimate.lighting.emitterRadiance[e] * light.emitterSigma[e];
    const DirectionGrid fine{estimate.environmentSide};
    const std::vector<uint32_t> leafOf = lighting_.leaves.leafOfCells(fine);
    estimate.environmentSigma.resize(size_t(fine.cells()));
    for (size_t c = 0; c < estimate.environmentSigma.size(); ++c) {
        const uint32_t leaf = leafOf[c];
        const Rgb relative = estimate.environment[c] == lighting_.leafRadiance[leaf] ? light.leafSigma[leaf] : Rgb(background);
        estimate.environmentSigma[c] = relative * estimate.environment[c];
    }
}

void SolveState::applyGauge(const LightUncertainty& light, Estimate& estimate) {
    GaugeReport& gauge = estimate.gauge;
    Rgb scale(1);
    // How much of the light on the surfaces comes from where the background is seen: only that much ties the scale down.
    double seenLight = 0, allLight = 0;
    for (size_t r = 0; r < influence_.rows; ++r)
        for (size_t i = 0; scene_.rank[matte_.vertices[r]] % 7 == 0 && i < lighting_.leaves.size(); ++i) {
            const double given = double(influence_.row(r)[i]) * luminance(lighting_.leafRadiance[i]);
            seenLight += given * anchors_.leaves[i].coverage;
            allLight += given;
        }
    const bool assessed = light.scaleSigma.x > 0 && light.scaleSigma.y > 0 && light.scaleSigma.z > 0;
    constexpr float enoughSigma = 0.25f;  // what taking the brightest surfaces for white is off by
    const double seenShare = allLight > 0 ? seenLight / allLight : 0;
    const GaugeChoice& choice = options_.gauge;
    bool unclipped = false;
    for (uint8_t clipped : anchors_.emitterClipped) unclipped |= !clipped;
    const auto meanAlbedo = [&] {
        Rgb sum(0);
        float n = 0;
        for (uint32_t v : matte_.vertices) {
            sum += albedo_.albedo[v];
            ++n;
        }
        return sum / std::max(n, 1.0f);
    };
    if (choice.kind == GaugeChoice::Kind::whitePatch) {
        const View& view = capture_.views[size_t(choice.view)];
        const Hit hit = scene_.tracer->closest({Vec3(view.camera.position()), view.camera.rayDirection(choice.pixel), 0, 1e30f});
        if (!hit) throw Error("--gauge white-patch: pixel {:.0f},{:.0f} of view {} sees no surface", choice.pixel.x, choice.pixel.y, choice.view);
        const Triangle& t = scene_.mesh.triangles[hit.triangle];
        const Rgb here = (albedo_.albedo[t[0]] + albedo_.albedo[t[1]] + albedo_.albedo[t[2]]) / 3.0f;
        scale = here / choice.whiteAlbedo;
        gauge.kind = "white-patch";
        gauge.evidence = fmt::format("the surface at pixel {:.0f},{:.0f} of view {} was declared white", choice.pixel.x, choice.pixel.y, choice.view);
    } else if (choice.kind == GaugeChoice::Kind::emitter) {
        bool found = false;
        for (size_t e = 0; e < clusters_.emitters.size(); ++e)
            if (clusters_.emitters[e].id == choice.emitter) {
                scale = choice.radiance / glm::max(lighting_.emitterRadiance[e], Rgb(1e-20f));
                found = true;
            }
        if (!found) throw Error("--gauge emitter={}: no such emitter was found", choice.emitter);
        gauge.kind = "emitter";
        gauge.evidence = fmt::format("the radiance of {} was given", choice.emitter);
    } else if (choice.kind == GaugeChoice::Kind::albedo) {
        scale = meanAlbedo() / choice.albedo;
        gauge.kind = "albedo";
        gauge.evidence = "the mean albedo was given";
    } else if (unclipped) {
        gauge.kind = "emitter";
        gauge.evidence = fmt::format("{} lamp(s) are seen directly and unclipped; their light varies over the scene", clusters_.emitters.size());
    } else if (assessed && luminance(light.scaleSigma) < enoughSigma) {
        const float gloss = luminance(light.fromGloss), bounced = luminance(light.fromBounces);
        if (bounced > gloss && bounced > luminance(light.fromBackground)) {
            gauge.kind = "bounced light";
            gauge.evidence = fmt::format("{:.0f} % of the light on the surfaces comes from other surfaces, whose brightness the photographs show", 100 * bouncedShare_);
        } else {
            gauge.kind = "background";
            gauge.evidence = fmt::format("background that is seen directly gives {:.0f} % of the light on the surfaces{}", 100 * seenShare,
                                         metalsJoined_ ? ", and metal mirrors it beside the rest" : "");
        }
    } else if (!assessed && seenShare > 0.35) {
        gauge.kind = "background";
        gauge.evidence = fmt::format("{:.0f} % of the light on the surfaces comes from background that is seen directly", 100 * seenShare);
    } else {
        // Nothing ties light to albedo: brightest surfaces are taken for white, grey on average.
        gauge.kind = "assumed";
        gauge.evidence = fmt::format("only {:.0f} % of the light is seen directly: the brightest surfaces were taken for an albedo of 0.75; tell a white patch to be sure", 100 * seenShare);
        std::vector<float> values;
        for (uint32_t v : matte_.vertices) values.push_back(maxChannel(albedo_.albedo[v]));
        std::nth_element(values.begin(), values.begin() + ptrdiff_t(values.size() * 95 / 100), values.end());
        scale = Rgb(values[values.size() * 95 / 100] / 0.75f);
    }
    const bool told = gauge.kind == "white-patch" || gauge.kind == "albedo" || gauge.kind == "assumed";
    if (assessed && !told) {
        gauge.sigma = light.scaleSigma;
        gauge.fromEmitters = light.fromEmitters;
        gauge.fromBackground = light.fromBackground;
        gauge.fromGloss = light.fromGloss;
        gauge.fromBounces = light.fromBounces;
    }
    for (int c = 0; c < 3; ++c)
        if (!(scale[c] > 0) || !std::isfinite(scale[c])) scale[c] = 1;
    gauge.scale = scale;
    for (Rgb& l : estimate.lighting.leafRadiance) l *= scale;
    for (Rgb& l : estimate.lighting.emitterRadiance) l *= scale;
    for (Rgb& l : estimate.environment) l *= scale;
    for (Rgb& sigma : estimate.environmentSigma) sigma *= scale;
    for (Rgb& sigma : estimate.emitterSigma) sigma *= scale;
    for (auto& lobe : estimate.reflectance.weight)
        for (Rgb& w : lobe) w /= scale;
    for (PaletteColour& colour : estimate.palette) colour.albedo /= scale;
    // No surface sends back more than it gets; where light was missed an albedo stands in for it, and would glow under another light.
    if (gauge.kind != "assumed")
        for (Rgb& albedo : estimate.reflectance.weight[0]) albedo = glm::min(albedo, Rgb(1));
}

}  // namespace relamp
