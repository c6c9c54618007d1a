// B'WB of dense rows with one weight a row.
#pragma once
#include <Eigen/Core>
#include <functional>

#include "base/progress.h"
#include "transport/incident.h"

namespace relamp {

/// B'W B in double from float rows in fixed blocks, for W given as a sparse operator by rows: result = sum over i of
/// row_i' t_i with t = W B computed by `weighted(i, out)`. `symmetric`: W is, and half of the work will do.
Eigen::MatrixXd weightedGram(const InfluenceMatrix& influence, const std::function<void(size_t, float*)>& weighted,
                             Progress& progress, bool symmetric = true);

}  // namespace relamp
