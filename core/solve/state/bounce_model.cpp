#include "solve/state/bounce_model.h"

#include "base/log.h"
#include "base/random.h"

namespace relamp {

void BounceModel::trace(const SolveInput& in, uint32_t count) {
    BounceOptions options;
    options.seed = in.options.seed;
    options.rays = count;
    rays = traceBounce(in.scene, options, in.progress);
}

BounceRays BounceModel::otherRays(const SolveInput& in) {
    BounceOptions options;
    options.seed = mixBits(in.options.seed);
    options.rays = fewRays;
    return traceBounce(in.scene, options, in.progress);
}

std::vector<uint32_t> BounceModel::hiddenSenders(const std::vector<uint32_t>& observed,
                                                 const std::vector<uint8_t>& emits) const {
    std::vector<uint8_t> known = emits;  // an emitter's light is in N
    for (const uint32_t v : observed) known[v] = 1;
    std::vector<uint32_t> hidden;
    for (const uint32_t s : rays.sender)
        if (!known[s]) {
            known[s] = 1;
            hidden.push_back(s);
        }
    std::sort(hidden.begin(), hidden.end());
    return hidden;
}

void BounceModel::take(const MatteObservations& observed, const std::vector<Rgb>& radiance, size_t vertices,
                       const std::vector<HiddenSenders>& hidden) {
    outgoing.assign(vertices * observed.states(), Rgb(0));
    atVertex.clear();
    for (size_t s = 0; s < observed.states(); ++s) {
        std::vector<Rgb> sent(vertices, Rgb(0));
        for (size_t i = observed.beginOf(s); i < observed.endOf(s); ++i) sent[observed.vertices[i]] = radiance[i];
        // Hidden surfaces light each other too.
        constexpr int rounds = 10;
        for (int round = 0; round < rounds && s < hidden.size() && !hidden[s].albedo.empty(); ++round) {
            const std::vector<Rgb> bounced = gatherBounce(rays, sent);
            for (size_t i = 0; i < hidden[s].vertices.size(); ++i) {
                const uint32_t v = hidden[s].vertices[i];
                sent[v] = glm::clamp(hidden[s].albedo[i], Rgb(0), Rgb(0.95f)) * (hidden[s].direct[i] + bounced[v]);
            }
        }
        const std::vector<Rgb> bounced = gatherBounce(rays, sent);
        atVertex.insert(atVertex.end(), bounced.begin(), bounced.end());
        std::copy(sent.begin(), sent.end(), outgoing.begin() + ptrdiff_t(s * vertices));
    }
    takeAtObservations(observed);
}

std::vector<Rgb> BounceModel::along(const BounceRays& others, const MatteObservations& observed) const {
    const size_t vertices = outgoing.size() / observed.states();
    std::vector<Rgb> out;
    out.reserve(observed.vertices.size());
    for (size_t s = 0; s < observed.states(); ++s) {
        const auto sent = outgoing.begin() + ptrdiff_t(s * vertices);
        const std::vector<Rgb> bounced = gatherBounce(others, std::vector<Rgb>(sent, sent + ptrdiff_t(vertices)));
        for (size_t i = observed.beginOf(s); i < observed.endOf(s); ++i) out.push_back(bounced[observed.vertices[i]]);
    }
    return out;
}

void BounceModel::takeAtObservations(const MatteObservations& observed) {
    const size_t vertices = atVertex.size() / observed.states();
    atObservation.resize(observed.vertices.size());
    for (size_t s = 0; s < observed.states(); ++s)
        for (size_t i = observed.beginOf(s); i < observed.endOf(s); ++i)
            atObservation[i] = atVertex[s * vertices + observed.vertices[i]];
}

void BounceModel::withdraw() {
    atObservation.clear();
    atVertex.clear();
    outgoing.clear();
}

void BounceModel::forget(std::string why) {
    logInfo("bounced light is left out: {}", why);
    absentBecause = std::move(why);
    rays = {};
    withdraw();
}

}  // namespace relamp
