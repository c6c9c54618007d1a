#include "relight/distant_sampler.h"

namespace relamp {

DistantSampler::DistantSampler(const DistantLight& light) : light_(light) {
    const DirectionGrid fine = light.grid();
    coarse_.side = std::min(32, fine.side);
    fineSide_ = fine.side / coarse_.side;
    const size_t n = size_t(coarse_.cells());
    order_.resize(n);
    placeOf_.resize(n);
    direction_.resize(n);
    energy_.assign(n, 0);
    const size_t inside = size_t(fineSide_) * size_t(fineSide_);
    fineCumulative_.resize(n * inside);
    fineCell_.resize(n * inside);
    for (uint32_t code = 0; code < n; ++code) {
        uint32_t x = 0, y = 0;
        for (int bit = 0; bit < 16; ++bit) {
            x |= (code >> (2 * bit) & 1) << bit;
            y |= (code >> (2 * bit + 1) & 1) << bit;
        }
        const uint32_t cell = y * uint32_t(coarse_.side) + x;
        order_[code] = cell;
        placeOf_[cell] = code;
        direction_[code] = coarse_.direction(int(cell));
        double sum = 0;
        for (size_t k = 0; k < inside; ++k) {
            // Boustrophedon rows keep neighbouring numbers in neighbouring cells.
            const uint32_t row = uint32_t(k) / uint32_t(fineSide_), along = uint32_t(k) % uint32_t(fineSide_);
            const uint32_t column = row % 2 ? uint32_t(fineSide_) - 1 - along : along;
            const uint32_t f = (y * uint32_t(fineSide_) + row) * uint32_t(fine.side) + x * uint32_t(fineSide_) + column;
            const Rgb& c = light.cells()[f];
            const float w = (c.x + c.y + c.z) / 3;
            sum += w > 0 && std::isfinite(w) ? double(w) : 0.0;
            fineCumulative_[code * inside + k] = float(sum);
            fineCell_[code * inside + k] = f;
        }
        energy_[code] = float(sum);
    }
}

bool DistantSampler::prepare(const Vec3& normal, Proposal& p) const {
    if (glm::dot(normal, p.normal) > 0.9994f && glm::dot(p.normal, p.normal) < 2) return p.total > 0;
    const size_t n = energy_.size();
    p.normal = normal;
    p.weight.resize(n);
    p.cumulative.resize(n);
    // A cell across the horizon counts with the mean of its cosine above it; its half width, and the 2 degrees the
    // normal may be off.
    const float half = 1.8f / float(coarse_.side) + 0.035f;
    for (size_t i = 0; i < n; ++i) {
        const float c = glm::dot(normal, direction_[i]);
        p.weight[i] = energy_[i] * (c >= half ? c : c <= -half ? 0.0f : (c + half) * (c + half) / (4 * half));
    }
    float sum = 0;
    for (size_t i = 0; i < n; ++i) {
        sum += p.weight[i];
        p.cumulative[i] = sum;
    }
    p.total = sum;
    return sum > 0;
}

Vec3 DistantSampler::sample(const Proposal& p, const Vec2& u) const {
    const float pick = u.x * p.total;
    const size_t place =
        std::min(size_t(std::upper_bound(p.cumulative.begin(), p.cumulative.end(), pick) - p.cumulative.begin()),
                 p.cumulative.size() - 1);
    const float below = place ? p.cumulative[place - 1] : 0.0f, width = p.cumulative[place] - below;
    const float inside = width > 0 ? std::clamp((pick - below) / width, 0.0f, 0.999999f) : 0.5f;
    const size_t count = size_t(fineSide_) * size_t(fineSide_);
    const float* begin = &fineCumulative_[place * count];
    const float finePick = inside * begin[count - 1];
    const size_t k = std::min(size_t(std::upper_bound(begin, begin + count, finePick) - begin), count - 1);
    const float fineBelow = k ? begin[k - 1] : 0.0f, fineWidth = begin[k] - fineBelow;
    return light_.grid().direction(
        int(fineCell_[place * count + k]),
        Vec2(fineWidth > 0 ? std::clamp((finePick - fineBelow) / fineWidth, 0.0f, 0.9999f) : 0.5f, u.y));
}

float DistantSampler::density(const Proposal& p, const Vec3& direction) const {
    const int f = light_.grid().cellOf(direction);
    const int side = light_.grid().side;
    const size_t place = placeOf_[size_t(f / side / fineSide_) * size_t(coarse_.side) + size_t(f % side / fineSide_)];
    if (!(energy_[place] > 0) || !(p.total > 0)) return 0;
    const Rgb& c = light_.cells()[size_t(f)];
    return p.weight[place] / p.total * ((c.x + c.y + c.z) / 3) / energy_[place] / light_.grid().cellSolidAngle();
}

}  // namespace relamp
