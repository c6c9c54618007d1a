#include "solve/light/folded_gram.h"

#include <map>

#include "base/parallel.h"

namespace relamp {
namespace {

using Eigen::Index;

/// For each column, in its own 3 x 3 block of channels, the sum over folded rows of R'WR, R = what the shares do not
/// explain of the column. 6 numbers a column, as ChannelWeights orders them.
std::vector<std::array<double, 6>> leftOver(const FoldedColumns& fold, const InfluenceRows& rows,
                                            const ChannelWeights& weights, bool apart, Progress& progress) {
    constexpr size_t panel = 32;
    std::vector<size_t> size(fold.folded.columns, 0);
    for (const uint32_t g : fold.group)
        if (g != FoldedColumns::none) ++size[g];
    std::vector<uint32_t> columns;  // of groups of more than one
    for (uint32_t k = 0; k < rows.columns; ++k)
        if (fold.group[k] != FoldedColumns::none && size[fold.group[k]] > 1) columns.push_back(k);
    std::vector<std::array<double, 6>> left(rows.columns, std::array<double, 6>{});
    parallelFor((columns.size() + panel - 1) / panel, 1, [&](size_t task) {
        const size_t from = task * panel, width = std::min(panel, columns.size() - from), count = fold.folded.rows;
        std::vector<float> remainder(count * panel, 0.0f);
        for (size_t i = 0; i < count; ++i) {
            const float *row = rows.row(i), *sum = fold.folded.row(i);
            for (size_t j = 0; j < width; ++j) {
                const uint32_t k = columns[from + j];
                remainder[i * panel + j] = row[k] - float(fold.fraction(Index(k))) * sum[fold.group[k]];
            }
        }
        double sum[6][panel] = {};
        for (size_t i = 0; i < count; ++i) {
            if (i % 1024 == 0) progress.check();
            float weighted[6][panel] = {};
            for (uint32_t e = weights.start[i]; e < weights.start[i + 1]; ++e) {
                const float* partner = &remainder[weights.other[e] * panel];
                const std::array<float, 6>& w = weights.weight[e];
                for (size_t block = 0; block < 6; ++block)
                    for (size_t j = 0; j < panel; ++j) weighted[block][j] += w[block] * partner[j];
            }
            const float* own = &remainder[i * panel];
            for (size_t block = 0; block < 6; ++block)
                for (size_t j = 0; j < panel; ++j) sum[block][j] += double(own[j] * weighted[block][j]);
        }
        for (size_t j = 0; j < width; ++j)
            for (size_t block = 0; block < (apart ? 3u : 6u); ++block) left[columns[from + j]][block] = sum[block][j];
    });
    return left;
}

}  // namespace

FoldedColumns foldColumns(const InfluenceRows& rows, size_t count, std::vector<uint32_t> group) {
    const size_t n = rows.columns;
    if (group.empty())
        for (uint32_t k = 0; k < n; ++k) group.push_back(k);
    std::vector<uint8_t> any(n, 0);
    for (size_t i = 0; i < count; ++i) {
        const float* row = rows.row(i);
        for (size_t k = 0; k < n; ++k) any[k] |= row[k] != 0;
    }
    // Numbered anew, without gaps.
    FoldedColumns fold;
    fold.group.assign(n, FoldedColumns::none);
    std::map<uint32_t, uint32_t> numbers;
    for (size_t k = 0; k < n; ++k)
        if (any[k]) fold.group[k] = numbers.emplace(group[k], uint32_t(numbers.size())).first->second;
    fold.folded.rows = count;
    fold.folded.columns = numbers.size();
    fold.folded.values.assign(count * fold.folded.columns, 0.0f);
    std::vector<uint32_t> filled;
    for (uint32_t k = 0; k < n; ++k)
        if (any[k]) filled.push_back(k);
    parallelFor(count, 256, [&](size_t i) {
        const float* row = rows.row(i);
        float* sum = fold.folded.row(i);
        for (const uint32_t k : filled) sum[fold.group[k]] += row[k];
    });
    fold.fraction = Eigen::VectorXd::Zero(Index(n));
    Eigen::VectorXd square = Eigen::VectorXd::Zero(Index(fold.folded.columns));
    for (size_t i = 0; i < count; ++i) {
        const float *row = rows.row(i), *sum = fold.folded.row(i);
        for (const uint32_t k : filled) fold.fraction(Index(k)) += double(row[k]) * double(sum[fold.group[k]]);
        for (size_t g = 0; g < fold.folded.columns; ++g) square(Index(g)) += double(sum[g]) * double(sum[g]);
    }
    for (const uint32_t k : filled) fold.fraction(Index(k)) /= square(fold.group[k]);
    return fold;
}

Eigen::MatrixXd foldedGram(const FoldedColumns& fold, const InfluenceRows& rows, const ChannelWeights& weights,
                           bool apart, Progress& progress) {
    const Index n = Index(rows.columns), m = Index(fold.folded.columns);
    const Eigen::MatrixXd coarse = channelGram(fold.folded, weights, apart, progress);
    Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(3 * n, 3 * n);
    if (fold.folded.rows < rows.rows) {
        // The rows behind the folded ones.
        InfluenceMatrix rest;
        ChannelWeights restWeights;
        rest.columns = rows.columns;
        rest.rows = rows.rows - fold.folded.rows;
        for (size_t i = fold.folded.rows; i < rows.rows; ++i)
            rest.values.insert(rest.values.end(), rows.row(i), rows.row(i) + rows.columns);
        const uint32_t first = weights.start[fold.folded.rows];
        for (size_t i = fold.folded.rows; i <= rows.rows; ++i) restWeights.start.push_back(weights.start[i] - first);
        for (size_t e = first; e < weights.other.size(); ++e)
            restWeights.other.push_back(weights.other[e] - uint32_t(fold.folded.rows));
        restWeights.weight.assign(weights.weight.begin() + first, weights.weight.end());
        gram = channelGram(rest, restWeights, apart, progress);
    }
    const std::vector<std::array<double, 6>> left = leftOver(fold, rows, weights, apart, progress);
    std::vector<Index> filled;
    for (Index k = 0; k < n; ++k)
        if (fold.group[size_t(k)] != FoldedColumns::none) filled.push_back(k);
    parallelFor(filled.size(), 16, [&](size_t at) {
        const Index j = filled[at];
        for (Index d = 0; d < 3; ++d)
            for (Index c = 0; c < 3; ++c)
                for (const Index i : filled)
                    gram(c * n + i, d * n + j) += fold.fraction(i) * fold.fraction(j) *
                                                  coarse(c * m + fold.group[size_t(i)], d * m + fold.group[size_t(j)]);
        for (size_t block = 0; block < 6; ++block) {
            const auto [a, b] = ChannelWeights::blocks[block];
            gram(a * n + j, b * n + j) += left[size_t(j)][block];
            if (a != b) gram(b * n + j, a * n + j) += left[size_t(j)][block];
        }
    });
    return gram;
}

}  // namespace relamp
