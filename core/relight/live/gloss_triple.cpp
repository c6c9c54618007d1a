#include "relight/live/gloss_triple.h"

#include "relight/live/environment.h"
#include "transport/transport_store.h"
#include "wavelet/tripling.h"

namespace relamp {

TripleGloss::TripleGloss(const LiveGrid& grid, const DistantLight& distant, const TripleTerms& terms)
    : grid_(grid), terms_(terms), side_(2 * grid.grid().side) {
    LiveLight fine = liveLight(distant, side_);
    cells_ = std::move(fine.cells);
    for (size_t k = 0; k < 3; ++k) environment_[k] = sparsify(fine.coefs[k], 1, terms.environment);
}

size_t TripleGloss::quarterOf(int cell) const {
    const int x = cell % side_, y = cell / side_;
    return size_t(y / 2 * grid_.grid().side + x / 2) * 4 + size_t(y % 2 * 2 + x % 2);
}

SparseCoefs TripleGloss::visibility(const uint8_t* masks) const {
    std::vector<float> seen(cells_.size());
    for (int c = 0; c < side_ * side_; ++c) {
        const size_t q = quarterOf(c);
        seen[size_t(c)] = float(nibbleOf(masks, q / 4) >> (q % 4) & 1);
    }
    return sparsify(environmentHaar(seen, side_), 1, terms_.visibility);
}

SparseCoefs TripleGloss::reflectance(const Lobe& lobe, const Mat3& toWorld, const Vec3& eye) const {
    std::vector<float> value(cells_.size());
    const Mat3 toLocal = glm::transpose(toWorld);
    for (int c = 0; c < side_ * side_; ++c) {
        const size_t q = quarterOf(c);
        const Vec3 light = toLocal * grid_.quarter(q / 4, int(q % 4));
        value[size_t(c)] = light.z > 0 ? evaluateLobe(lobe, light, eye) * light.z : 0.0f;
    }
    return sparsify(environmentHaar(value, side_), 1, terms_.reflectance);
}

Rgb TripleGloss::light(const SparseCoefs& visibility, const SparseCoefs& reflectance) const {
    Rgb sum(0);
    for (int k = 0; k < 3; ++k) sum[k] = tripleProduct(reflectance, visibility, environment_[size_t(k)], side_, 4 * pi);
    return sum;
}

Rgb TripleGloss::onGrid(const BrdfBasis& basis, std::span<const LobeWeight> lobes, const Mat3& toWorld, const Vec3& eye,
                        const uint8_t* masks) const {
    const Mat3 toLocal = glm::transpose(toWorld);
    Rgb sum(0);
    for (int c = 0; c < side_ * side_; ++c) {
        const size_t q = quarterOf(c);
        if (!(nibbleOf(masks, q / 4) >> (q % 4) & 1)) continue;
        const Vec3 light = toLocal * grid_.quarter(q / 4, int(q % 4));
        if (light.z <= 0) continue;
        Rgb value(0);
        for (const LobeWeight& l : lobes) value += l.weight * evaluateLobe(basis.lobes[l.lobe], light, eye);
        sum += value * light.z * cells_[size_t(c)];
    }
    return sum * (4 * pi / float(cells_.size()));
}

}  // namespace relamp
