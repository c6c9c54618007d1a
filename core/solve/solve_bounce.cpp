// Light that surfaces send each other (docs/method.md 8). What a surface sends is in the photographs, so the light that
// arrives from other surfaces is a sum of known radiances, with all its bounces, whatever the albedos are [Yu99]: an
// offset b in y = albedo (B x + b).
#include "base/log.h"
#include "base/parallel.h"
#include "solve/solve_state.h"

namespace relamp {

namespace {
constexpr uint32_t fewBounceRays = 64;  // for a first answer
}

std::vector<Rgb> SolveState::directAt(const std::vector<uint32_t>& vertices) {
    std::vector<Rgb> out;
    constexpr size_t block = 2048;  // rows are as wide as there are leaves: not all at once
    for (size_t begin = 0; begin < vertices.size(); begin += block) {
        const std::vector<uint32_t> some(vertices.begin() + ptrdiff_t(begin),
                                         vertices.begin() + ptrdiff_t(std::min(vertices.size(), begin + block)));
        const InfluenceMatrix rows = rowsOf(some);
        for (size_t i = 0; i < some.size(); ++i) out.push_back(lightOfRow(rows.row(i), lighting_));
    }
    return out;
}

void SolveState::updateBounce() {
    if (bounceRays_.rays == 0) return;
    computeLit();
    updateAlbedo();
    const size_t n = scene_.mesh.vertexCount();
    std::vector<Rgb>& outgoing = outgoing_;
    outgoing.assign(n, Rgb(0));
    std::vector<uint8_t> shown(n, 0), asked(n, 0);
    for (size_t i = 0; i < matte_.vertices.size(); ++i) {
        outgoing[matte_.vertices[i]] = matte_.radiance[i];
        shown[matte_.vertices[i]] = 1;
    }
    // An emitter's light is in N.
    for (size_t v = 0; v < n; ++v) shown[v] |= clusters_.emitterOfVertex[v] >= 0;
    std::vector<uint32_t> hidden;
    for (uint32_t s : bounceRays_.sender)
        if (!shown[s] && !asked[s]) {
            asked[s] = 1;
            hidden.push_back(s);
        }
    std::sort(hidden.begin(), hidden.end());
    if (!albedo_.albedo.empty()) {
        const std::vector<Rgb> direct = directAt(hidden);
        // Hidden surfaces light each other too.
        for (int round = 0; round < 10; ++round) {
            const std::vector<Rgb> bounced = gatherBounce(bounceRays_, outgoing);
            for (size_t i = 0; i < hidden.size(); ++i)
                outgoing[hidden[i]] =
                    glm::clamp(albedo_.albedo[hidden[i]], Rgb(0), Rgb(0.95f)) * (direct[i] + bounced[hidden[i]]);
        }
    }
    vertexBounce_ = gatherBounce(bounceRays_, outgoing);
    takeVertexBounce();
}

void SolveState::takeVertexBounce() {
    bounce_.resize(matte_.vertices.size());
    for (size_t i = 0; i < bounce_.size(); ++i) bounce_[i] = vertexBounce_[matte_.vertices[i]];
}

float SolveState::bouncedFractionOf() const {
    double bounced = 0, all = 0;
    for (size_t i = 0; i < bounce_.size(); ++i) {
        bounced += luminance(bounce_[i]);
        all += luminance(lit_[i]);
    }
    return all > 0 ? float(bounced / all) : 0.0f;
}

void SolveState::traceBounceRays(uint32_t rays) {
    BounceOptions rayOptions;
    rayOptions.seed = options_.seed;
    rayOptions.rays = rays;
    bounceRays_ = traceBounce(scene_, rayOptions, progress_);
}

void SolveState::forgetBounce(std::string why) {
    logInfo("bounced light is left out: {}", why);
    noBounceBecause_ = std::move(why);
    bounceRays_ = {};
    bounce_.clear();
    vertexBounce_.clear();
    outgoing_.clear();
}

void SolveState::joinLikelyBounce() {
    if (options_.bounce != SolveOptions::Bounce::automatic || !plan_.choices.bounce || !plan_.choices.bounceLikely)
        return;
    const std::optional<Stage> stage = meter_.current();
    meter_.begin(Stage::bouncedLight);
    if (bounceRays_.rays == 0) traceBounceRays(fewBounceRays);
    updateBounce();
    meter_.begin(stage);
}

void SolveState::decideBounce(bool coarse) {
    using Bounce = SolveOptions::Bounce;
    if (options_.bounce == Bounce::off) {
        noBounceBecause_ = "it was switched off";
        return;
    }
    if (options_.bounce == Bounce::automatic && !plan_.choices.bounce) {
        for (const PlannedOmission& o : plan_.leftOut)
            if (o.what == Omission::interreflection) noBounceBecause_ = o.reason;
        return;
    }
    if (coarse && (options_.bounce != Bounce::automatic || plan_.choices.lateBounce || !bounce_.empty())) return;
    meter_.begin(Stage::bouncedLight);
    constexpr uint32_t rays = BounceOptions{}.rays;
    if (bounceRays_.rays == 0 || (!bounce_.empty() && bounceRays_.rays < rays)) traceBounceRays(rays);
    double enclosure = 0;
    for (uint32_t v : matte_.vertices) enclosure += bounceRays_.enclosure(v);
    enclosure /= double(matte_.vertices.size());
    if (options_.bounce == Bounce::automatic && enclosure < 0.01) {
        forgetBounce(fmt::format("other surfaces fill only {:.1f} % of what a surface sees", 100 * enclosure));
        return;
    }
    // Where bounced light has joined already, the light without it is fitted anew.
    Lighting start = lighting_;
    const bool joined = !bounce_.empty();
    std::vector<Rgb>().swap(bounce_);
    const AlbedoFreeReport alone = runAlbedoFree(coarse ? "light from ratios, coarse" : "light from ratios",
                                                 joined ? options_.startIterations : 1, nullptr);
    const double before = alone.objective;
    const Lighting without = joined ? lighting_ : start;
    lighting_ = std::move(start);
    // Several rounds: what hidden surfaces send rests on the light.
    double after = 0;
    for (int round = 0; round < (coarse || joined ? 2 : 4) && !stopped(); ++round) {
        updateBounce();
        const double earlier = after;
        after = runAlbedoFree(coarse ? "light from ratios and bounces, coarse" : "light from ratios and bounces",
                              round == 0 ? 8 : options_.startIterations, nullptr, nullptr, alone.chroma)
                    .objective;
        if (options_.bounce == Bounce::automatic && after > 1.05 * before) break;  // far from it
        // What a round still gains falls from one to the next: ten times the last gain is out of reach, twenty times
        // surely.
        const double reach = plan_.choices.lateBounce ? 20 : 10;
        if (options_.bounce == Bounce::automatic && !plan_.choices.lastDigits && round > 0 &&
            after - before > reach * (earlier - after))
            break;
    }
    if (stopped()) throw OutOfTime{};
    computeLit();
    bouncedFraction_ = bouncedFractionOf();
    logInfo("bounced light: enclosure {:.1f} %, share {:.1f} %, objective {:.5g} without, {:.5g} with", 100 * enclosure,
            100 * bouncedFraction_, before, after);
    if (coarse && after < 1.03 * before) {  // coarse visibility alone can make as much of a difference
        // Finer light is to judge.
        lighting_ = without;
        bounce_.clear();
        vertexBounce_.clear();
        outgoing_.clear();
        return;
    }
    if (options_.bounce == Bounce::on || after < before) {
        updateBounce();
        return;
    }
    lighting_ = without;
    forgetBounce(fmt::format("ratios of radiance are explained better without it (misfit {:.4g}, with it {:.4g})",
                             before, after));
    if (!coarse) return;
    plan_.choices.bounce = false;
    plan_.leftOut.push_back({Omission::interreflection, noBounceBecause_, 0, 0});
}

}  // namespace relamp
