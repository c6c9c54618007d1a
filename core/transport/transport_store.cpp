#include "transport/transport_store.h"

#include <atomic>
#include <cstring>
#include <numeric>

#include "base/parallel.h"
#include "wavelet/haar.h"

namespace relamp {
namespace {

/// Where a vertex gets less than this fraction of what an open one gets under constant light, errors are measured
/// against it.
constexpr float darkest = 0.1f;
/// The sun is a harder test than any environment of images, and it is moved about: its error may be larger.
constexpr float sunSlack = 4;

/// A vector of lanes; g++ splits it where the machine has narrower registers.
typedef float Lanes __attribute__((vector_size(4 * transportLanes)));
typedef int16_t ShortLanes __attribute__((vector_size(2 * transportLanes)));

uint64_t nextVersion() {
    static std::atomic<uint64_t> last{0};
    return ++last;
}

}  // namespace

std::vector<float> environmentHaar(std::span<const float> cells, int side) {
    std::vector<float> coefs(cells.begin(), cells.end());
    const float scale = std::sqrt(4 * pi) / float(side);
    for (float& c : coefs) c *= scale;
    haarForward(coefs, side);
    return coefs;
}

TermTests::TermTests(int side, const std::vector<std::vector<float>>& environments) : side_(side) {
    const size_t n = size_t(side) * size_t(side);
    // A sun in any cell, as bright as the sky: its coefficients have the same mean square at every scale, 4 pi / 4 pi.
    spread_.assign(n, 1);
    for (const std::vector<float>& cells : environments) {
        const double mean = std::accumulate(cells.begin(), cells.end(), 0.0) / double(n);
        if (!(mean > 0)) continue;
        std::vector<float> scaled(n);
        for (size_t c = 0; c < n; ++c) scaled[c] = float(double(cells[c]) / mean);
        coefs_.push_back(environmentHaar(scaled, side));
        for (size_t i = 0; i < n; ++i) spread_[i] += coefs_.back()[i] * coefs_.back()[i];
    }
    for (float& s : spread_) s = std::sqrt(s);
}

TransportBlock packTransport(std::span<float> cells, const TermTests& tests, float error) {
    const int side = tests.side();
    const size_t n = size_t(side) * size_t(side), count = tests.coefs().size();
    TransportBlock block;
    // Cell integrals become coefficients by 1 / sqrt(cell solid angle).
    const float toDensity = float(side) / std::sqrt(4 * pi);
    float light[transportLanes];
    for (size_t lane = 0; lane < transportLanes; ++lane) {
        const std::span<float> own = cells.subspan(lane * n, n);
        for (float& c : own) c *= toDensity;
        haarForward(own, side);
        light[lane] = std::max(own[0] * std::sqrt(4 * pi), darkest);
        float largest = 0;
        for (float c : own) largest = std::max(largest, std::abs(c));
        block.scale[lane] = largest / 32767;
    }
    std::vector<float> importance(n, 0);
    for (size_t lane = 0; lane < transportLanes; ++lane) {
        const float* own = &cells[lane * n];
        const float fraction = 1 / light[lane];
        for (size_t i = 0; i < n; ++i) importance[i] = std::max(importance[i], std::abs(own[i]) * fraction);
    }
    for (size_t i = 0; i < n; ++i) importance[i] *= tests.spread()[i];
    std::vector<uint16_t> order(n);
    std::iota(order.begin(), order.end(), uint16_t(0));
    std::sort(order.begin() + 1, order.end(), [&](uint16_t a, uint16_t b) {
        return importance[a] != importance[b] ? importance[a] < importance[b] : a < b;
    });
    // Drop from the least important on, until a test would notice. The constant term is never dropped: constant light
    // stays exact.
    std::vector<float> residual(count * transportLanes, 0), bound(count * transportLanes), lost(transportLanes, 0);
    for (size_t j = 0; j < count; ++j)
        for (size_t lane = 0; lane < transportLanes; ++lane) {
            const float* own = &cells[lane * n];
            float sum = 0;
            for (size_t i = 0; i < n; ++i) sum += own[i] * tests.coefs()[j][i];
            bound[j * transportLanes + lane] = error * std::max(sum, darkest);
        }
    size_t dropped = 1;
    for (; dropped < n; ++dropped) {
        const size_t i = order[dropped];
        bool noticed = false;
        for (size_t lane = 0; lane < transportLanes; ++lane) {
            const float a = cells[lane * n + i];
            lost[lane] += a * a;
            const float allowed = sunSlack * error * light[lane];
            noticed |= 4 * pi * lost[lane] > allowed * allowed;
            for (size_t j = 0; j < count; ++j) {
                float& r = residual[j * transportLanes + lane];
                r += a * tests.coefs()[j][i];
                noticed |= std::abs(r) > bound[j * transportLanes + lane];
            }
        }
        if (noticed) break;
    }
    block.index.push_back(0);
    block.index.insert(block.index.end(), order.begin() + long(dropped), order.end());
    std::sort(block.index.begin(), block.index.end());
    block.value.reserve(block.index.size() * transportLanes);
    for (uint16_t i : block.index)
        for (size_t lane = 0; lane < transportLanes; ++lane)
            block.value.push_back(block.scale[lane] > 0 ? int16_t(std::lround(cells[lane * n + i] / block.scale[lane]))
                                                        : int16_t(0));
    return block;
}

TransportStore::TransportStore(std::vector<TransportBlock> blocks) : version_(nextVersion()) {
    size_t terms = 0;
    for (const TransportBlock& b : blocks) terms += b.index.size();
    index_.reserve(terms);
    value_.reserve(terms * transportLanes);
    for (TransportBlock& b : blocks) {
        index_.insert(index_.end(), b.index.begin(), b.index.end());
        value_.insert(value_.end(), b.value.begin(), b.value.end());
        start_.push_back(uint32_t(index_.size()));
        scale_.push_back(b.scale);
        b = TransportBlock();
    }
}

void TransportStore::replace(const std::vector<std::pair<uint32_t, TransportBlock>>& blocks) {
    std::vector<const TransportBlock*> fresh(scale_.size(), nullptr);
    for (const auto& [at, block] : blocks) fresh[at] = &block;
    std::vector<uint32_t> start{0};
    std::vector<uint16_t> index;
    std::vector<int16_t> value;
    index.reserve(index_.size());
    value.reserve(value_.size());
    for (size_t b = 0; b < scale_.size(); ++b) {
        if (fresh[b]) {
            index.insert(index.end(), fresh[b]->index.begin(), fresh[b]->index.end());
            value.insert(value.end(), fresh[b]->value.begin(), fresh[b]->value.end());
            scale_[b] = fresh[b]->scale;
        } else {
            index.insert(index.end(), index_.begin() + start_[b], index_.begin() + start_[b + 1]);
            value.insert(value.end(), value_.begin() + long(start_[b] * transportLanes),
                         value_.begin() + long(start_[b + 1] * transportLanes));
        }
        start.push_back(uint32_t(index.size()));
    }
    start_.swap(start);
    index_.swap(index);
    value_.swap(value);
    version_ = nextVersion();
}

size_t TransportStore::bytes() const {
    return index_.size() * sizeof(uint16_t) + value_.size() * sizeof(int16_t) + start_.size() * sizeof(uint32_t) +
           scale_.size() * sizeof(scale_[0]);
}

void TransportStore::apply(const std::array<std::vector<float>, 3>& coefs, std::span<Rgb> out) const {
    parallelBlocks(scale_.size(), 32, [&](size_t begin, size_t end) {
        const float *red = coefs[0].data(), *green = coefs[1].data(), *blue = coefs[2].data();
        for (size_t b = begin; b < end; ++b) {
            Lanes r{}, g{}, bl{};
            const int16_t* value = &value_[size_t(start_[b]) * transportLanes];
            for (uint32_t t = start_[b]; t < start_[b + 1]; ++t, value += transportLanes) {
                ShortLanes packed;
                std::memcpy(&packed, value, sizeof packed);
                const Lanes a = __builtin_convertvector(packed, Lanes);
                const uint16_t i = index_[t];
                r += a * red[i];
                g += a * green[i];
                bl += a * blue[i];
            }
            Rgb* place = &out[b * transportLanes];
            for (size_t lane = 0; lane < transportLanes; ++lane)
                place[lane] = scale_[b][lane] * Rgb(r[lane], g[lane], bl[lane]);
        }
    });
}

std::vector<float> TransportStore::coefsOf(size_t vertex, int side) const {
    std::vector<float> dense(size_t(side) * size_t(side), 0.0f);
    const size_t b = vertex / transportLanes, lane = vertex % transportLanes;
    for (uint32_t t = start_[b]; t < start_[b + 1]; ++t)
        dense[index_[t]] = float(value_[size_t(t) * transportLanes + lane]) * scale_[b][lane];
    return dense;
}

}  // namespace relamp
