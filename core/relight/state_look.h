// The light of a lighting state of the photographs, as edits of the recovered emitters.
#pragma once
#include "clusters/emitter_clusters.h"
#include "relight/look.h"
#include "solve/estimate.h"

namespace relamp {

/// The light of a lighting state under what `look`, and its keys, make of it: powers of recovered emitters are
/// multiplied by their levels, and a recovered environment of no state becomes that of the state.
Look inState(Look look, const Estimate& estimate, size_t state);

/// Whether states differ in their environment: then looks name the state whose environment they have.
bool environmentsDiffer(const Estimate& estimate);

/// Multiplies the power of each recovered emitter in `look`, and in its keys, by its level; 1 leaves it as it is.
Look withLevels(Look look, const std::vector<EmitterCluster>& emitters, const std::vector<float>& levels);

/// The levels of the emitters in a state; all 1 without states.
std::vector<float> levelsInState(const std::vector<EmitterCluster>& emitters, size_t state);

/// Those of a mix of two states; `fraction`: of the second, 0 to 1.
std::vector<float> levelsBetween(const std::vector<EmitterCluster>& emitters, size_t first, size_t second,
                                 float fraction);

}  // namespace relamp
