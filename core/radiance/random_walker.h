// Random walker segmentation: a soft label for each vertex from what some say and from how alike neighbours look.
#pragma once
#include <vector>

#include "scene/mesh.h"

namespace relamp {

/// A label that a vertex is drawn to.
struct LabelPrior {
    float label = 0;   ///< in [0, 1]
    float weight = 0;  ///< against that of an edge between alike neighbours, 1; infinite: the label is fixed
};

/// Labels x that minimise  sum over edges of w (x_v - x_w)^2  +  sum over vertices of p (x_v - label_v)^2  [Grady
/// 2005]. `edgeWeight`: one for each entry of graph.to, the same in both directions, positive. Vertices that reach no
/// prior stay at 0.5. Conjugate gradients, at most 400 steps; O(steps x edges).
std::vector<float> randomWalkerLabels(const VertexGraph& graph, const std::vector<float>& edgeWeight,
                                      const std::vector<LabelPrior>& priors);

}  // namespace relamp
