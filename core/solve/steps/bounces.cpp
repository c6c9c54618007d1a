// Do the photographs hold light bounced between surfaces?
#include "base/log.h"
#include "solve/albedo/above_white.h"
#include "solve/ratio/pair_misfit.h"
#include "solve/steps/steps.h"

namespace relamp {

void updateBounce(SolveRun& s) {
    if (!s.bounce.traced()) return;
    Irradiance irradiance = s.irradiance();
    updateAlbedo(s, irradiance);
    std::vector<Rgb> lit = std::move(irradiance.value);
    const std::vector<Rgb>& albedo = s.surfaces.albedo.albedo;
    const MatteObservations& matte = s.observed.matte;
    std::vector<BounceModel::HiddenSenders> hidden(matte.states());
    for (size_t state = 0; state < matte.states(); ++state) {
        const std::vector<uint32_t> shown(matte.vertices.begin() + ptrdiff_t(matte.beginOf(state)),
                                          matte.vertices.begin() + ptrdiff_t(matte.endOf(state)));
        BounceModel::HiddenSenders& senders = hidden[state];
        senders.vertices = s.bounce.hiddenSenders(shown, s.emitters.skip());
        if (albedo.empty()) continue;
        for (const uint32_t v : senders.vertices) senders.albedo.push_back(albedo[v]);
        senders.direct = s.light.directAt(s.in, s.emitters, senders.vertices, state);
    }
    for (size_t i = 0; i < s.bounce.atObservation.size(); ++i) lit[i] -= s.bounce.atObservation[i];
    s.bounce.take(matte, matte.radiance, s.in.scene.mesh.vertexCount(), hidden);
    if (!mayShowEmitters(s)) return;
    for (size_t i = 0; i < lit.size(); ++i) lit[i] += s.bounce.atObservation[i];
    s.bounce.take(matte, reflectedAtMost(matte, lit, s.in.scene.material), s.in.scene.mesh.vertexCount(), hidden);
}

void joinLikelyBounce(SolveRun& s) {
    if (s.in.options.bounce != SolveOptions::Bounce::automatic || !s.in.choices.bounce || !s.in.choices.bounceLikely)
        return;
    const std::optional<Stage> stage = s.meter.current();
    s.meter.begin(Stage::bouncedLight);
    if (!s.bounce.traced()) s.bounce.trace(s.in, BounceModel::fewRays);
    updateBounce(s);
    s.meter.begin(stage);
}

namespace {

/// Misfit of the pairs under the present light, bounced light and the noise of its rays left aside.
double bouncedMisfit(const SolveRun& s, const BounceRays& others) {
    const std::vector<Rgb> lit = s.irradiance().value;
    std::vector<Rgb> again = s.bounce.along(others, s.observed.matte);
    for (size_t i = 0; i < again.size(); ++i) again[i] += lit[i] - s.bounce.atObservation[i];
    return pairMisfit(s.observed.matte, s.observed.pairs, lit, again);
}

}  // namespace

double mostLeftByBounce(float fraction, float predicted, bool anchored) {
    // Textures lower it by chance (0.1 to 0.2 % on scenes without bounced light); where there is bounced light it falls
    // by 6 to 20 %.
    constexpr double usual = 0.99;
    // Light that outgrows what is known of it leaves hardly any to bounced light, which then stands for other errors
    // (1 % on a mesh that was off, with light ten times as strong).
    constexpr double outgrown = 0.97;
    return anchored && fraction < predicted / 3 ? outgrown : usual;
}

void decideBounce(SolveRun& s, bool coarse) {
    using Bounce = SolveOptions::Bounce;
    if (s.in.options.bounce == Bounce::off) {
        s.bounce.absentBecause = "it was switched off";
        return;
    }
    if (s.in.options.bounce == Bounce::automatic && !s.in.choices.bounce) {
        for (const PlannedOmission& o : s.plan.leftOut)
            if (o.what == Omission::interreflection) s.bounce.absentBecause = o.reason;
        return;
    }
    if (coarse && (s.in.options.bounce != Bounce::automatic || s.in.choices.lateBounce || s.bounce.joined())) return;
    s.meter.begin(Stage::bouncedLight);
    constexpr uint32_t rays = BounceOptions{}.rays;
    if (!s.bounce.traced() || (s.bounce.joined() && s.bounce.rays.rays < rays)) s.bounce.trace(s.in, rays);
    double enclosure = 0;
    for (uint32_t v : s.observed.matte.vertices) enclosure += s.bounce.rays.enclosure(v);
    enclosure /= double(s.observed.matte.vertices.size());
    if (s.in.options.bounce == Bounce::automatic && enclosure < 0.01) {
        s.bounce.forget(fmt::format("other surfaces fill only {:.1f} % of what a surface sees", 100 * enclosure));
        return;
    }
    // Where bounced light has joined already, the light without it is fitted anew.
    Lighting start = s.light.lighting;
    const bool joined = s.bounce.joined();
    std::vector<Rgb>().swap(s.bounce.atObservation);
    RatioFitRequest withoutBounce{coarse ? "light from ratios, coarse" : "light from ratios",
                                  joined ? s.in.options.startIterations : 1};
    withoutBounce.mayRefuteBackground = !coarse;
    const AlbedoFreeReport alone = fitLight(s, withoutBounce);
    const Irradiance lit = s.irradiance();
    const double before = pairMisfit(s.observed.matte, s.observed.pairs, lit.value, lit.value);
    const Lighting without = joined ? s.light.lighting : start;
    s.light.lighting = std::move(start);
    const BounceRays others = BounceModel::otherRays(s.in);
    // Several rounds: what hidden surfaces send rests on the light.
    double after = 0;
    for (int round = 0; round < (coarse || joined ? 2 : 4) && !s.stopped(); ++round) {
        updateBounce(s);
        const double earlier = after;
        RatioFitRequest request{coarse ? "light from ratios and bounces, coarse" : "light from ratios and bounces",
                                round == 0 ? 8 : s.in.options.startIterations};
        request.chroma = alone.chroma;
        fitLight(s, request);
        after = bouncedMisfit(s, others);
        if (s.in.options.bounce == Bounce::automatic && after > 1.05 * before) break;  // far from it
        // What a round still gains falls from one to the next: ten times the last gain is out of reach, twenty times
        // surely.
        const double reach = s.in.choices.lateBounce ? 20 : 10;
        if (s.in.options.bounce == Bounce::automatic && !s.in.choices.lastDigits && round > 0 &&
            after - before > reach * (earlier - after))
            break;
    }
    if (s.stopped()) throw OutOfTime{};
    s.bounce.fraction = bouncedFractionOf(s.bounce.atObservation, s.irradiance());
    logInfo("bounced light: enclosure {:.1f} %, fraction {:.1f} %, misfit {:.5g} without, {:.5g} with", 100 * enclosure,
            100 * s.bounce.fraction, before, after);
    if (coarse && after < 1.03 * before) {  // coarse visibility alone can make as much of a difference
        // Finer light is to judge.
        s.light.lighting = without;
        s.bounce.withdraw();
        return;
    }
    const double left = mostLeftByBounce(s.bounce.fraction, bouncedFractionOf(s.bounce.atObservation, lit),
                                         tiesScale(s.light.anchors, s.light.prior.darkness));
    if (s.in.options.bounce == Bounce::on || after < left * before) {
        updateBounce(s);
        return;
    }
    s.light.lighting = without;
    s.bounce.forget(
        fmt::format("with it ratios of radiance are not explained clearly better (misfit {:.4g}, without it {:.4g})",
                    after, before));
    if (!coarse) return;
    s.plan.choices.bounce = false;
    s.plan.leftOut.push_back({Omission::interreflection, s.bounce.absentBecause, 0, 0});
}

}  // namespace relamp
