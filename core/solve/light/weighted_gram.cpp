#include "solve/light/weighted_gram.h"

#include "base/parallel.h"

namespace relamp {

using RowMajor = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using RowMap = Eigen::Map<const RowMajor>;

Eigen::MatrixXd weightedGram(const InfluenceMatrix& influence, const std::function<void(size_t, float*)>& weighted,
                             Progress& progress, bool symmetric) {
    const size_t n = influence.columns;
    constexpr size_t block = 512;
    constexpr Eigen::Index panel = 64;
    const size_t blocks = (influence.rows + block - 1) / block;
    if (influence.rows == 0) return Eigen::MatrixXd::Zero(Eigen::Index(n), Eigen::Index(n));
    // A fixed number of partial sums, each over its own run of blocks: the same bits whatever the thread count.
    constexpr size_t lanes = 8;
    std::vector<Eigen::MatrixXd> partial(lanes);
    parallelFor(lanes, 1, [&](size_t lane) {
        partial[lane] = Eigen::MatrixXd::Zero(Eigen::Index(n), Eigen::Index(n));
        RowMajor t{Eigen::Index(block), Eigen::Index(n)}, product{Eigen::Index(n), panel};
        for (size_t b = lane; b < blocks; b += lanes) {
            progress.check();
            const size_t begin = b * block, count = std::min(block, influence.rows - begin);
            for (size_t i = 0; i < count; ++i) weighted(begin + i, t.row(Eigen::Index(i)).data());
            const RowMap rows(influence.row(begin), Eigen::Index(count), Eigen::Index(n));
            // By panels of columns, each from its diagonal down where the rest is its mirror.
            for (Eigen::Index j = 0; j < Eigen::Index(n); j += panel) {
                const Eigen::Index w = std::min(panel, Eigen::Index(n) - j), from = symmetric ? j : 0,
                                   down = Eigen::Index(n) - from;
                product.topRows(down).leftCols(w).noalias() =
                    rows.rightCols(down).transpose() * t.topRows(Eigen::Index(count)).middleCols(j, w);
                partial[lane].block(from, j, down, w) += product.topRows(down).leftCols(w).cast<double>();
            }
        }
    });
    Eigen::MatrixXd gram = partial[0];
    for (size_t lane = 1; lane < lanes; ++lane) gram += partial[lane];
    if (!symmetric) return gram;
    return gram.selfadjointView<Eigen::Lower>();
}

}  // namespace relamp
