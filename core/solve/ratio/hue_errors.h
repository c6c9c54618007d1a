// What errors of the model do to the hue of the light at a point: too much of one light, whose hue is not that of the
// others there. Errors of shape, visibility and distance are of that kind (errors in variables).
#pragma once
#include <Eigen/Core>
#include <array>
#include <vector>

#include "solve/ratio/influence_rows.h"

namespace relamp {

/// Per row of `influence`, the covariance over the channels of the relative irradiance if what each emitter gives, and
/// what all other light gives, is off by `error` on its own: less what the channels have in common, which is an error
/// of brightness. Entries as in ChannelWeights. `light`: per channel leaves, then emitters; `irradiance`: per channel,
/// of the rows, all light included. O(rows x emitters).
std::vector<std::array<float, 6>> hueErrors(const InfluenceRows& influence, size_t leaves,
                                            const std::array<Eigen::VectorXd, 3>& light,
                                            const std::array<Eigen::VectorXf, 3>& irradiance, float error);

}  // namespace relamp
