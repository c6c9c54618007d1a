// The normal equations of pairs: what a sparse weight between rows and channels makes of the rows of the light.
#pragma once
#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "base/progress.h"
#include "solve/ratio/influence_rows.h"

namespace relamp {

/// W between the rows of three channels, in compressed rows: row i holds other[start[i]] ... other[start[i + 1] - 1]. W
/// is symmetric as a whole, so the six blocks at and below its diagonal say all: weight[e] = W of channels (0,0),
/// (1,1), (2,2), (1,0), (2,0), (2,1).
struct ChannelWeights {
    static constexpr std::array<std::pair<int, int>, 6> blocks{{{0, 0}, {1, 1}, {2, 2}, {1, 0}, {2, 0}, {2, 1}}};
    std::vector<uint32_t> start, other;
    std::vector<std::array<float, 6>> weight;
};

/// B'WB, 3n x 3n for n columns, channel after channel, in double from float products (equation 5). `apart`: only the
/// blocks of one channel are wanted, the others are 0. Rows are read in blocks of 512 and every element is summed over
/// them in order, so that nothing is held beside the result and bits do not depend on threads. Cost: 9 rows n^2
/// multiplications (3 when apart) and one pass over each row's partners.
Eigen::MatrixXd channelGram(const InfluenceRows& rows, const ChannelWeights& weights, bool apart, Progress& progress);

}  // namespace relamp
