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

void BounceModel::take(const std::vector<uint32_t>& observed, const std::vector<Rgb>& radiance, size_t vertices,
                       const HiddenSenders& hidden) {
    outgoing.assign(vertices, Rgb(0));
    for (size_t i = 0; i < observed.size(); ++i) outgoing[observed[i]] = radiance[i];
    // Hidden surfaces light each other too.
    constexpr int rounds = 10;
    for (int round = 0; round < rounds && !hidden.albedo.empty(); ++round) {
        const std::vector<Rgb> bounced = gatherBounce(rays, outgoing);
        for (size_t i = 0; i < hidden.vertices.size(); ++i) {
            const uint32_t v = hidden.vertices[i];
            outgoing[v] = glm::clamp(hidden.albedo[i], Rgb(0), Rgb(0.95f)) * (hidden.direct[i] + bounced[v]);
        }
    }
    atVertex = gatherBounce(rays, outgoing);
    takeAtObservations(observed);
}

std::vector<Rgb> BounceModel::along(const BounceRays& others, const std::vector<uint32_t>& observed) const {
    const std::vector<Rgb> bounced = gatherBounce(others, outgoing);
    std::vector<Rgb> out;
    out.reserve(observed.size());
    for (const uint32_t v : observed) out.push_back(bounced[v]);
    return out;
}

void BounceModel::takeAtObservations(const std::vector<uint32_t>& observed) {
    atObservation.resize(observed.size());
    for (size_t i = 0; i < observed.size(); ++i) atObservation[i] = atVertex[observed[i]];
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
