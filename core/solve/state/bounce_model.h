// Light that surfaces send each other (docs/method.md 8). What a surface sends is in the photographs, so the light that
// arrives from other surfaces is a sum of known radiances, with all its bounces, whatever the albedos are [Yu99]: an
// offset b in y = albedo (B x + b).
#pragma once
#include <string>

#include "solve/state/solve_input.h"
#include "transport/bounce.h"

namespace relamp {

struct BounceModel {
    static constexpr uint32_t fewRays = 64;  ///< for a first answer

    BounceRays rays;                 ///< empty: bounced light plays no part
    std::vector<Rgb> outgoing;       ///< radiance of the surfaces, per vertex; empty likewise
    std::vector<Rgb> atVertex;       ///< bounced light per vertex, empty likewise
    std::vector<Rgb> atObservation;  ///< and per observation; empty while a fit goes without it
    float fraction = 0;              ///< of the light on the observations
    std::string absentBecause = "nothing was matte";

    bool traced() const { return rays.rays > 0; }
    bool joined() const { return !atObservation.empty(); }
    const std::vector<Rgb>* offset() const { return joined() ? &atObservation : nullptr; }
    /// `count` rays from each vertex.
    void trace(const SolveInput& in, uint32_t count);
    static BounceRays otherRays(const SolveInput& in);
    /// Takes over what the surfaces send: shown radiance where a photograph shows it, albedo times light elsewhere.
    /// `hidden`: the senders that no photograph shows, with their albedo and their direct light, in one order.
    struct HiddenSenders {
        std::vector<uint32_t> vertices;
        std::vector<Rgb> albedo, direct;
    };
    void take(const std::vector<uint32_t>& observed, const std::vector<Rgb>& radiance, size_t vertices,
              const HiddenSenders& hidden);
    /// Senders that are not among the observed vertices and not marked in `emits`, in order.
    std::vector<uint32_t> hiddenSenders(const std::vector<uint32_t>& observed, const std::vector<uint8_t>& emits) const;
    /// What the same surfaces send to the observations along other rays, which differs by the noise of rays alone.
    std::vector<Rgb> along(const BounceRays& others, const std::vector<uint32_t>& observed) const;
    /// atObservation from atVertex.
    void takeAtObservations(const std::vector<uint32_t>& observed);
    /// The rays stay; what they carried goes.
    void withdraw();
    void forget(std::string why);
};

}  // namespace relamp
