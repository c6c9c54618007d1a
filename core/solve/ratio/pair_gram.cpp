#include "solve/ratio/pair_gram.h"

#include "base/parallel.h"

namespace relamp {
namespace {

using Eigen::Index;
using RowMajor = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
constexpr size_t block = 512;
constexpr int panel = 32;  ///< columns a task computes: two registers of sixteen floats for each block of channels

using RowPointers = std::vector<const float*>;

/// Rows begin ... begin + count of W B for `Blocks` blocks of channels, columns from ... from + panel: all of them in
/// one pass over the partners.
template <int Blocks>
void weightRows(const RowPointers& rows, const ChannelWeights& weights, size_t begin, size_t count, size_t from,
                RowMajor& out) {
    for (size_t i = 0; i < count; ++i) {
        float sum[Blocks][panel] = {};
        for (uint32_t e = weights.start[begin + i]; e < weights.start[begin + i + 1]; ++e) {
            const float* partner = rows[weights.other[e]] + from;
            const std::array<float, 6>& w = weights.weight[e];
            for (int k = 0; k < Blocks; ++k)
                for (int j = 0; j < panel; ++j) sum[k][j] += w[size_t(k)] * partner[j];
        }
        std::copy(&sum[0][0], &sum[0][0] + Blocks * panel, out.row(Index(i)).data());
    }
}

/// The last columns, fewer than a panel: the others stay 0.
void weightLastRows(const RowPointers& rows, const ChannelWeights& weights, size_t begin, size_t count, size_t from,
                    int width, int blocks, RowMajor& out) {
    out.topRows(Index(count)).setZero();
    for (size_t i = 0; i < count; ++i)
        for (uint32_t e = weights.start[begin + i]; e < weights.start[begin + i + 1]; ++e) {
            const float* partner = rows[weights.other[e]] + from;
            for (int k = 0; k < blocks; ++k)
                for (int j = 0; j < width; ++j)
                    out(Index(i), k * panel + j) += weights.weight[e][size_t(k)] * partner[j];
        }
}

}  // namespace

Eigen::MatrixXd channelGram(const InfluenceRows& rows, const ChannelWeights& weights, bool apart, Progress& progress) {
    const Index n = Index(rows.columns);
    const int blocks = apart ? 3 : 6;
    Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(3 * n, 3 * n);
    RowPointers pointers(rows.rows);
    for (size_t i = 0; i < rows.rows; ++i) pointers[i] = rows.row(i);
    parallelFor((size_t(n) + panel - 1) / panel, 1, [&](size_t task) {
        const Index from = Index(task) * panel, width = std::min<Index>(panel, n - from), down = n - from;
        RowMajor weighted{Index(block), Index(blocks * panel)};
        Eigen::MatrixXf product{n, Index(3 * panel)};
        std::vector<float> scratch;
        for (size_t begin = 0; begin < rows.rows; begin += block) {
            progress.check();
            const size_t count = std::min(block, rows.rows - begin);
            if (width < panel)
                weightLastRows(pointers, weights, begin, count, size_t(from), int(width), blocks, weighted);
            else if (apart) weightRows<3>(pointers, weights, begin, count, size_t(from), weighted);
            else weightRows<6>(pointers, weights, begin, count, size_t(from), weighted);
            const Eigen::Map<const RowMajor> b(rows.block(begin, count, scratch), Index(count), n);
            // Within a channel W is symmetric: from the diagonal down, the rest is its mirror. Between channels it is
            // not.
            product.topRows(down).noalias() =
                b.rightCols(down).transpose() * weighted.topRows(Index(count)).leftCols(3 * panel);
            for (Index c = 0; c < 3; ++c)
                gram.block(c * n + from, c * n + from, down, width) +=
                    product.block(0, c * panel, down, width).cast<double>();
            if (apart) continue;
            product.noalias() = b.transpose() * weighted.topRows(Index(count)).rightCols(3 * panel);
            for (size_t k = 3; k < 6; ++k) {
                const auto [c, d] = ChannelWeights::blocks[k];
                gram.block(c * n, d * n + from, n, width) +=
                    product.block(0, Index(k - 3) * panel, n, width).cast<double>();
            }
        }
    });
    gram.triangularView<Eigen::StrictlyUpper>() = gram.transpose();
    return gram;
}

}  // namespace relamp
