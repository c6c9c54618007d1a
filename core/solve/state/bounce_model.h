// Light that surfaces send each other (docs/method.md 8). What a surface sends is in the photographs, so the light that
// arrives from other surfaces is a sum of known radiances, with all its bounces, whatever the albedos are [Yu99]: an
// offset b in y = albedo (B x + b).
#pragma once
#include <string>

#include "solve/gloss/matte.h"
#include "solve/state/solve_input.h"
#include "transport/bounce.h"

namespace relamp {

struct BounceModel {
    static constexpr uint32_t fewRays = 64;  ///< for a first answer

    BounceRays rays;  ///< empty: bounced light plays no part
    /// Radiance of the surfaces, per vertex, lighting states one after the other; empty likewise.
    std::vector<Rgb> outgoing;
    std::vector<Rgb> atVertex;       ///< bounced light per vertex in the same order, empty likewise
    std::vector<Rgb> atObservation;  ///< and per observation; empty while a fit goes without it
    float fraction = 0;              ///< of the light on the observations
    std::string absentBecause = "nothing was matte";

    bool traced() const { return rays.rays > 0; }
    bool joined() const { return !atObservation.empty(); }
    const std::vector<Rgb>* offset() const { return joined() ? &atObservation : nullptr; }
    /// `count` rays from each vertex.
    void trace(const SolveInput& in, uint32_t count);
    static BounceRays otherRays(const SolveInput& in);
    /// Takes over what the surfaces send: the observations' radiance where photographs show them, albedo times light
    /// elsewhere. `hidden`: per lighting state the senders that none of its photographs shows, with their albedo and
    /// their direct light, in one order.
    struct HiddenSenders {
        std::vector<uint32_t> vertices;
        std::vector<Rgb> albedo, direct;
    };
    void take(const MatteObservations& observed, const std::vector<Rgb>& radiance, size_t vertices,
              const std::vector<HiddenSenders>& hidden);
    /// Senders that are not among the observed vertices and not marked in `emits`, in order.
    std::vector<uint32_t> hiddenSenders(const std::vector<uint32_t>& observed, const std::vector<uint8_t>& emits) const;
    /// What the same surfaces send to the observations along other rays, which differs by the noise of rays alone.
    std::vector<Rgb> along(const BounceRays& others, const MatteObservations& observed) const;
    /// atObservation from atVertex.
    void takeAtObservations(const MatteObservations& observed);
    /// The rays stay; what they carried goes.
    void withdraw();
    void forget(std::string why);
};

}  // namespace relamp
