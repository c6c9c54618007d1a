// Which bright patches are emitters. Candidates take part as emitters until a light fit has judged them.
#pragma once
#include <functional>

#include "solve/state/solve_input.h"
#include "transport/incident.h"

namespace relamp {

struct EmitterDecision {
    EmitterClusters clusters;              ///< emitters and candidates together, strongest first; what was rejected
    std::vector<uint8_t> suspect;          ///< per emitter: 1 = only a light fit can decide
    std::vector<EmitterSurface> surfaces;  ///< of the emitters, in their order
    EmitterLevels levels;                  ///< of the emitters in each lighting state; empty: there is one

    /// `nearField` false: nothing stands in the scene.
    static EmitterDecision of(const Scene& scene, const EmitterClusters& found, bool nearField);
    /// As an earlier solve left them. Throws Error when they name what the mesh does not have.
    static EmitterDecision of(const Scene& scene, EmitterClusters clusters, std::vector<uint8_t> suspect);
    /// Per vertex 1 where an emitter lies.
    std::vector<uint8_t> skip() const;
    /// The light of a lighting state under `lighting`, which has emitters as bright as they get and all environments.
    Lighting inState(Lighting lighting, size_t state) const;
    /// A row of direct light of everything becomes that of a lighting state: its environment, and emitters times their
    /// levels.
    void dim(float* row, const LightLeaves& leaves, size_t state) const;
    /// Re-fit test: a suspect that needs an albedo below 1.5 under the light of everything else is a surface, others
    /// are emitters. `rowsOf`: influence of leaves and emitters on vertices. True when the set changed; surfaces and
    /// near-field transport are then those of before.
    bool judge(const SolveInput& in, const Lighting& lighting,
               const std::function<InfluenceMatrix(const std::vector<uint32_t>&)>& rowsOf);
};

}  // namespace relamp
