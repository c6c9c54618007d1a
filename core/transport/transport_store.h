// What vertices take from distant light, stored for the eye of a cache line: Haar coefficients of visibility x cosine /
// pi on the direction square ([Ng04] double products), 16 vertices side by side. docs/method.md 7.
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "base/math.h"

namespace relamp {

/// Vertices of one block. They share their list of terms, so that one index is read for all of them and the sums run in
/// vector lanes.
inline constexpr size_t transportLanes = 16;

/// Against which environments terms are chosen. Energy kept is a poor promise: a sun sees one cell.
class TermTests {
public:
    /// `environments`: mean radiance per cell of the square of the given side. A constant one and a sun that may stand
    /// in any cell and gives as much light as a constant sky are always among the tests.
    TermTests(int side, const std::vector<std::vector<float>>& environments);
    int side() const { return side_; }
    const std::vector<std::vector<float>>& coefs() const { return coefs_; }  ///< Haar, of environments scaled to mean 1
    const std::vector<float>& spread() const {
        return spread_;
    }  ///< per coefficient: how much light the tests put there

private:
    int side_;
    std::vector<std::vector<float>> coefs_;
    std::vector<float> spread_;
};

/// The terms of one block, quantised: coefficient = value x scale of its lane.
struct TransportBlock {
    std::vector<uint16_t> index;  ///< ascending, in the layout of haar.h
    std::vector<int16_t> value;   ///< term after term, transportLanes values each
    std::array<float, transportLanes> scale{};
};

/// Drops terms while no vertex of the block is off by more than `error` of its light (or of a tenth of what an open
/// horizontal vertex gets, where it has less) under any test; under the sun, root mean square over where it stands, by
/// 4 x error. `cells`: transportLanes x side^2 integrals of visibility x cosine / pi over each cell, lane after lane;
/// overwritten by their coefficients. Cost: about 60 us.
TransportBlock packTransport(std::span<float> cells, const TermTests& tests, float error);

/// All blocks of a scene, streamed once for each change of the environment.
class TransportStore {
public:
    TransportStore() = default;
    explicit TransportStore(std::vector<TransportBlock> blocks);  ///< blocks are freed as they are taken over
    /// Puts new blocks in the place of old ones. Cost: one copy of the store.
    void replace(const std::vector<std::pair<uint32_t, TransportBlock>>& blocks);

    size_t blocks() const { return scale_.size(); }
    size_t terms() const { return index_.size(); }  ///< of all blocks; each stands for transportLanes coefficients
    size_t bytes() const;
    /// Another number for every other content in this process; 0: empty.
    uint64_t version() const { return version_; }
    std::span<const uint32_t> start() const { return start_; }  ///< per block: its first term; one more at the end
    std::span<const uint16_t> index() const { return index_; }  ///< per term
    std::span<const int16_t> value() const { return value_; }   ///< per term: transportLanes values
    std::span<const std::array<float, transportLanes>> scale() const { return scale_; }
    /// The light each vertex takes: `out` has blocks() x transportLanes places. `coefs`: Haar coefficients of the
    /// environment per channel, side^2 each (cell means x sqrt of the cell's solid angle). Cost: one pass over bytes().
    void apply(const std::array<std::vector<float>, 3>& coefs, std::span<Rgb> out) const;
    /// The coefficients of one vertex, side^2 values.
    std::vector<float> coefsOf(size_t vertex, int side) const;

private:
    uint64_t version_ = 0;
    std::vector<uint32_t> start_{0};  // per block: its first term
    std::vector<uint16_t> index_;
    std::vector<int16_t> value_;
    std::vector<std::array<float, transportLanes>> scale_;
};

/// Environment coefficients as apply() and the tests take them.
std::vector<float> environmentHaar(std::span<const float> cells, int side);

}  // namespace relamp
