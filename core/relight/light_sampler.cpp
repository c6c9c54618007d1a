#include "relight/light_sampler.h"

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

EmitterSampler::EmitterSampler(const EmitterSurface& surface) : surface_(surface) {
    const size_t n = surface.areas.size();
    order_.resize(n);
    groupOf_.assign(n, 0);
    for (uint32_t i = 0; i < n; ++i) order_[i] = i;
    if (n == 0) return;
    // Halve the triangles along the wider of position and orientation until there are 64 groups.
    std::vector<std::pair<uint32_t, uint32_t>> runs{{0, uint32_t(n)}};
    while (runs.size() < 64) {
        std::vector<std::pair<uint32_t, uint32_t>> next;
        for (const auto& [begin, end] : runs) {
            if (end - begin < 2) {
                next.emplace_back(begin, end);
                continue;
            }
            float low[6], high[6];
            std::fill(low, low + 6, 1e30f);
            std::fill(high, high + 6, -1e30f);
            const auto key = [&](uint32_t t, int axis) {
                return axis < 3 ? surface.centres[t][axis] / std::max(surface.radius, 1e-20f)
                                : surface.normals[t][axis - 3];
            };
            for (uint32_t i = begin; i < end; ++i)
                for (int a = 0; a < 6; ++a) {
                    low[a] = std::min(low[a], key(order_[i], a));
                    high[a] = std::max(high[a], key(order_[i], a));
                }
            int axis = 0;
            for (int a = 1; a < 6; ++a)
                if (high[a] - low[a] > high[axis] - low[axis]) axis = a;
            const uint32_t middle = (begin + end) / 2;
            std::nth_element(order_.begin() + begin, order_.begin() + middle, order_.begin() + end,
                             [&](uint32_t x, uint32_t y) {
                                 return key(x, axis) != key(y, axis) ? key(x, axis) < key(y, axis) : x < y;
                             });
            next.emplace_back(begin, middle);
            next.emplace_back(middle, end);
        }
        if (next.size() == runs.size()) break;
        runs.swap(next);
    }
    cumulativeArea_.resize(n);
    for (const auto& [begin, end] : runs) {
        Group g;
        g.begin = begin;
        g.end = end;
        for (uint32_t i = begin; i < end; ++i) {
            const uint32_t t = order_[i];
            g.area += surface.areas[t];
            cumulativeArea_[i] = g.area;
            g.centre += surface.areas[t] * surface.centres[t];
            g.axis += surface.areas[t] * surface.normals[t];
            groupOf_[t] = uint32_t(groups_.size());
        }
        g.centre /= g.area;
        const float length = glm::length(g.axis);
        g.axis = length > 1e-6f * g.area ? g.axis / length : Vec3(0);
        float cosine = 1;
        for (uint32_t i = begin; i < end; ++i) {
            const uint32_t t = order_[i];
            g.radius = std::max(g.radius, glm::length(surface.centres[t] - g.centre) + surface.radii[t]);
            cosine = std::min(cosine, glm::dot(surface.normals[t], g.axis));
        }
        g.coneSine = cosine > 0 ? std::sqrt(std::max(0.0f, 1 - cosine * cosine)) : 1.0f;
        if (cosine <= 0) g.axis = Vec3(0);
        groups_.push_back(g);
    }
}

bool EmitterSampler::prepare(const Vec3& point, const Vec3& normal, Proposal& p) const {
    p.weight.resize(groups_.size());
    p.cumulative.resize(groups_.size());
    float sum = 0;
    for (size_t i = 0; i < groups_.size(); ++i) {
        const Group& g = groups_[i];
        const Vec3 to = g.centre - point;
        const float d2 = glm::dot(to, to), near = g.radius * g.radius, d = std::sqrt(d2);
        const float blur = std::min(1.0f, g.radius / std::max(d, 1e-20f));  // sine of the angle it covers
        const float facing = g.axis == Vec3(0) || surface_.twoSided
                                 ? 1.0f
                                 : std::min(1.0f, -glm::dot(to, g.axis) / std::max(d, 1e-20f) + g.coneSine + blur);
        const float height = std::min(1.0f, glm::dot(to, normal) / std::max(d, 1e-20f) + blur + 0.02f);
        p.weight[i] = facing > 0 && height > 0 ? g.area * facing * height / (d2 + near) : 0.0f;
        sum += p.weight[i];
        p.cumulative[i] = sum;
    }
    p.total = sum;
    return sum > 0;
}

Vec3 EmitterSampler::sample(const Proposal& p, const Vec2& u, float& density, size_t& triangle) const {
    const float pick = u.x * p.total;
    const size_t at =
        std::min(size_t(std::upper_bound(p.cumulative.begin(), p.cumulative.end(), pick) - p.cumulative.begin()),
                 groups_.size() - 1);
    const Group& g = groups_[at];
    const float below = at ? p.cumulative[at - 1] : 0.0f, width = p.cumulative[at] - below;
    float inside = width > 0 ? std::clamp((pick - below) / width, 0.0f, 0.999999f) : 0.5f;
    const float area = inside * g.area;
    const auto begin = cumulativeArea_.begin() + g.begin, end = cumulativeArea_.begin() + g.end;
    const auto place = std::min(std::upper_bound(begin, end, area), end - 1);
    const float areaBelow = place == begin ? 0.0f : *(place - 1);
    inside = *place > areaBelow ? std::clamp((area - areaBelow) / (*place - areaBelow), 0.0f, 0.999999f) : 0.5f;
    triangle = order_[size_t(place - cumulativeArea_.begin())];
    density = p.weight[at] / p.total / g.area;
    const float root = std::sqrt(inside);
    const auto& c = surface_.corners[triangle];
    return (1 - root) * c[0] + root * (1 - u.y) * c[1] + root * u.y * c[2];
}

float EmitterSampler::areaDensity(const Proposal& p, size_t triangle) const {
    const uint32_t g = groupOf_[triangle];
    return p.total > 0 ? p.weight[g] / p.total / groups_[g].area : 0.0f;
}

}  // namespace relamp
