// Emitters of a capture with several lighting states: found in each state by itself, joined, and measured in all.
#pragma once
#include "clusters/emitter_clusters.h"

namespace relamp {

/// clusterEmitters for a capture with several lighting states. Each state is searched alone, because an emitter that
/// is switched looks like a highlight otherwise. Of patches that overlap the brightest stays, as an emitter if it is
/// one in any state. EmitterCluster::inState follows from the photographs: the median ratio of a vertex's radiance to
/// that in the brightest state, 0 where the emitter is no brighter than 1.6 times the ordinary surfaces of that state
/// or the ratio varies by a fifth over it, -1 where no photograph of a state shows it, or clipped. An emitter that no
/// photograph shows is brightest where the surfaces it lights by its place are, beside the rest. With one state the
/// same bits as clusterEmitters. Cost: that of clusterEmitters for each state, and a copy of its photographs.
EmitterClusters clusterEmittersOfStates(const Scene& scene, const Capture& capture, const RadianceSamples& samples,
                                        const ClusterOptions& options, Progress& progress);

/// The emitters and candidates that shine in one state, with the radiance that they have there.
EmitterClusters clustersInState(const Scene& scene, const EmitterClusters& all, uint32_t state);

/// The state in which the emitters together are brightest; of equal ones that with the most observations. States
/// without an environment are passed over.
uint32_t brightestState(const EmitterClusters& clusters, const RadianceSamples& samples);

}  // namespace relamp
