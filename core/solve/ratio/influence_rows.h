// Rows of two matrices read as one: those of matte points, and behind them those that metals add for one fit.
#pragma once
#include "transport/incident.h"

namespace relamp {

/// A view: the matrices must outlive it and have the same columns.
class InfluenceRows {
public:
    InfluenceRows(const InfluenceMatrix& all) : rows(all.rows), columns(all.columns), first_(&all) {}
    InfluenceRows(const InfluenceMatrix& first, const InfluenceMatrix& second)
        : rows(first.rows + second.rows), columns(first.columns), first_(&first), second_(&second) {}

    const float* row(size_t r) const { return r < first_->rows ? first_->row(r) : second_->row(r - first_->rows); }
    /// `count` consecutive rows from `begin`, row-major. They are copied to `scratch` only where both matrices hold
    /// some of them, so that products over fixed blocks of rows do not depend on where the first one ends.
    const float* block(size_t begin, size_t count, std::vector<float>& scratch) const {
        if (begin + count <= first_->rows || begin >= first_->rows) return row(begin);
        const size_t own = first_->rows - begin;
        scratch.assign(first_->row(begin), first_->row(begin) + own * columns);
        scratch.insert(scratch.end(), second_->row(0), second_->row(0) + (count - own) * columns);
        return scratch.data();
    }

    const size_t rows, columns;

private:
    const InfluenceMatrix *first_, *second_ = nullptr;
};

}  // namespace relamp
