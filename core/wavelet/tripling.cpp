#include "wavelet/tripling.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <span>

#include "base/error.h"
#include "wavelet/haar.h"

namespace relamp {
namespace {

/// What the layout of haar.h says of an index. Types: 0 scaling, 1 horizontal, 2 vertical, 3 diagonal (bit 0: the sign
/// changes along x, bit 1: along y), so the three types of a square are t, and two others whose xor is t.
struct Place {
    uint32_t level = 0, i = 0, j = 0, type = 0;

    Place() = default;
    Place(uint32_t index, uint32_t side) {
        const uint32_t x = index & (side - 1), y = index / side, longer = std::max(x, y);
        if (longer == 0) return;
        level = uint32_t(std::bit_width(longer)) - 1;
        const uint32_t n = 1u << level;
        type = (x >= n ? 1u : 0u) | (y >= n ? 2u : 0u);
        i = x & (n - 1);
        j = y & (n - 1);
    }
    uint32_t index(uint32_t wanted, uint32_t side) const {
        const uint32_t n = 1u << level;
        return (wanted & 2 ? n + j : j) * side + (wanted & 1 ? n + i : i);
    }
    bool sameSquare(const Place& other) const { return level == other.level && i == other.i && j == other.j; }
};

/// The sign of a wavelet of type `type` on the quarter of its square with column bit i and row bit j.
float signOn(uint32_t type, uint32_t i, uint32_t j) { return ((type & i & 1) ^ ((type >> 1) & j & 1)) ? -1.0f : 1.0f; }

/// Sum over the scaling function and the strict ancestors of a square of coefficient x value there: the average of the
/// function over the square, for a domain of unit area.
double parentSum(const float* dense, const Place& square, uint32_t side) {
    double sum = dense[0];
    uint32_t i = square.i, j = square.j;
    for (uint32_t level = square.level; level-- > 0; i >>= 1, j >>= 1) {
        const uint32_t n = 1u << level, column = i >> 1, row = j >> 1;
        const float h = dense[row * side + n + column], v = dense[(n + row) * side + column];
        const float d = dense[(n + row) * side + n + column];
        sum += double(n) * (double(signOn(1, i, j) * h) + double(signOn(2, i, j) * v) + double(signOn(3, i, j) * d));
    }
    return sum;
}

/// A sparse vector spread out for observations; all zero again afterwards, so only the non-zeros cost time.
class Spread {
public:
    Spread(std::vector<float>& scratch, const SparseCoefs& coefs, size_t cells) : scratch_(scratch), coefs_(coefs) {
        if (coefs_.size() > 0 && coefs_.index.back() >= cells)
            throw Error("tripling: coefficient {} of a square of {} cells", coefs_.index.back(), cells);
        if (scratch_.size() < cells) scratch_.resize(cells, 0.0f);
        for (size_t t = 0; t < coefs_.size(); ++t) scratch_[coefs_.index[t]] = coefs_.value[t];
    }
    ~Spread() {
        for (const uint32_t k : coefs_.index) scratch_[k] = 0;
    }
    Spread(const Spread&) = delete;
    Spread& operator=(const Spread&) = delete;
    const float* get() const { return scratch_.data(); }

private:
    std::vector<float>& scratch_;
    const SparseCoefs& coefs_;
};

}  // namespace

float triplingCoefficient(uint32_t k, uint32_t l, uint32_t m, int side, float domainArea) {
    const float unit = 1 / std::sqrt(domainArea);
    if (k == 0 && l == 0 && m == 0) return unit;
    if (l == m) std::swap(k, m);  // two equal indices come first
    else if (k == m) std::swap(l, m);
    const Place first(k, uint32_t(side)), second(l, uint32_t(side)), third(m, uint32_t(side));
    if (first.type == 0 || second.type == 0) return 0;
    if (k == l) {
        if (third.type == 0) return unit;
        if (third.level >= first.level) return 0;
        const uint32_t up = first.level - third.level - 1;
        const uint32_t i = first.i >> up, j = first.j >> up;
        if ((i >> 1) != third.i || (j >> 1) != third.j) return 0;
        return unit * float(1u << third.level) * signOn(third.type, i, j);
    }
    const bool oneEach = (first.type ^ second.type) == third.type && third.type != 0;
    return oneEach && first.sameSquare(second) && first.sameSquare(third) ? unit * float(1u << first.level) : 0;
}

float tripleProduct(const SparseCoefs& a, const SparseCoefs& b, const SparseCoefs& c, int side, float domainArea) {
    thread_local std::vector<float> scratch[3];
    const uint32_t s = uint32_t(side);
    const size_t cells = size_t(side) * size_t(side);
    const Spread spreadA(scratch[0], a, cells), spreadB(scratch[1], b, cells), spreadC(scratch[2], c, cells);
    const float *denseA = spreadA.get(), *denseB = spreadB.get(), *denseC = spreadC.get();

    double sum = double(denseA[0]) * double(denseB[0]) * double(denseC[0]);  // case 1 of the theorem
    for (size_t t = 0; t < a.size(); ++t) {
        const uint32_t k = a.index[t];
        if (k == 0) continue;
        const Place place(k, s);
        // Case 3: this wavelet of a with the two other types of its square in b and c, both ways round.
        const uint32_t p = place.index(place.type == 1 ? 2 : 1, s), q = place.index(place.type == 3 ? 2 : 3, s);
        const double crossed = double(denseB[p]) * double(denseC[q]) + double(denseB[q]) * double(denseC[p]);
        double inner = double(1u << place.level) * crossed;
        // Case 2 where the equal pair is (a, b) or (a, c).
        if (denseB[k] != 0) inner += double(denseB[k]) * parentSum(denseC, place, s);
        if (denseC[k] != 0) inner += double(denseC[k]) * parentSum(denseB, place, s);
        sum += double(a.value[t]) * inner;
    }
    for (size_t t = 0; t < b.size(); ++t) {  // case 2 where the equal pair is (b, c)
        const uint32_t k = b.index[t];
        if (k == 0 || denseC[k] == 0) continue;
        sum += double(b.value[t]) * double(denseC[k]) * parentSum(denseA, Place(k, s), s);
    }
    return float(sum / std::sqrt(double(domainArea)));
}

std::vector<float> productCoefs(const SparseCoefs& a, const SparseCoefs& b, int side, float domainArea) {
    const size_t cells = size_t(side) * size_t(side);
    std::vector<float> product(cells), other(cells);
    scatter(a, product);
    scatter(b, other);
    haarInverse(product, side);
    haarInverse(other, side);
    // The transform works on value x sqrt(cell area); the product has that root once too often.
    const float unscale = float(side) / std::sqrt(domainArea);
    for (size_t k = 0; k < cells; ++k) product[k] *= other[k] * unscale;
    haarForward(product, side);
    return product;
}

}  // namespace relamp
