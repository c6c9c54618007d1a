// Curvature of many rows over fine leaves, computed on the coarser leaves that those rows can tell apart.
#pragma once
#include "solve/ratio/pair_gram.h"

namespace relamp {

/// Columns that the first `folded.rows` rows hardly tell apart: column k is about share(k) times the sum of its group.
struct FoldedColumns {
    static constexpr uint32_t none = ~0u;
    std::vector<uint32_t> group;  ///< per column; none: the rows hold nothing but zeros there
    Eigen::VectorXd fraction;     ///< per column: least squares over the rows; sums to 1 in a group
    InfluenceMatrix folded;       ///< rows x groups: sums over the columns of each group
};

/// Folds the first `count` rows by `group`, one number per column; empty: every column by itself, so that only empty
/// ones are left out. Cost: a few passes over those rows.
FoldedColumns foldColumns(const InfluenceRows& rows, size_t count, std::vector<uint32_t> group);

/// About channelGram: S'(C'WC)S for the folded rows, C = their folded columns and S the shares, and beside it, per
/// column, what the folding left out of its own block of channels (R'WR of the remainder R = B - CS), so that the
/// result is positive semidefinite and no column is softer than it is. Rows behind the folded ones are taken as they
/// are; no weight may stand between the two kinds. For the curvature of a step whose slope is exact: it changes the
/// way, not the end. Cost: 9 rows groups^2 multiplications for the folded rows instead of 9 rows columns^2.
Eigen::MatrixXd foldedGram(const FoldedColumns& fold, const InfluenceRows& rows, const ChannelWeights& weights,
                           bool apart, Progress& progress);

}  // namespace relamp
