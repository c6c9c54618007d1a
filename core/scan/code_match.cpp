#include "scan/code_match.h"

#include <cmath>

#include "base/error.h"
#include "scan/affine_fit.h"

namespace relamp {
CodeIndex::CodeIndex(const DecodedView& view, const std::array<int, 2>& projectorSize)
    : view_(view), size_(projectorSize) {
    const size_t cells = size_t(size_[0]) * size_t(size_[1]);
    if (cells > size_t(1) << 26)
        throw Error("a projector of {} x {} pixels is beyond the 64 million that can be read", size_[0], size_[1]);
    start_.assign(cells + 1, 0);
    const auto cellOf = [&](const Vec2& place) {
        return size_t(std::clamp(int(place.y), 0, size_[1] - 1)) * size_t(size_[0]) +
               size_t(std::clamp(int(place.x), 0, size_[0] - 1));
    };
    for (size_t i = 0; i < view.places.size(); ++i)
        if (view.at(i)) ++start_[cellOf(view.places[i]) + 1];
    for (size_t c = 0; c < cells; ++c) start_[c + 1] += start_[c];
    pixels_.resize(start_[cells]);
    std::vector<uint32_t> next(start_.begin(), start_.end() - 1);
    for (size_t i = 0; i < view.places.size(); ++i)
        if (view.at(i)) pixels_[next[cellOf(view.places[i])]++] = uint32_t(i);
    reach_ = 3 + (view.slope > 0 ? 2 / view.slope : 1.0f);
}

std::optional<glm::dvec2> CodeIndex::pixelOf(const Vec2& place) const {
    const int cu = int(std::floor(place.x)), cv = int(std::floor(place.y));
    const auto width = uint32_t(view_.width);
    const auto pixelAt = [&](uint32_t i) { return glm::dvec2(double(i % width) + 0.5, double(i / width) + 0.5); };
    const auto forEach = [&](auto&& each) {
        for (int v = std::max(0, cv - 1); v <= std::min(size_[1] - 1, cv + 1); ++v)
            for (int u = std::max(0, cu - 1); u <= std::min(size_[0] - 1, cu + 1); ++u) {
                const size_t cell = size_t(v) * size_t(size_[0]) + size_t(u);
                for (uint32_t k = start_[cell]; k < start_[cell + 1]; ++k) each(pixels_[k]);
            }
    };
    float nearest = 1e30f;
    uint32_t anchor = 0;
    forEach([&](uint32_t i) {
        const Vec2 off = view_.places[i] - place;
        if (const float distance = glm::dot(off, off); distance < nearest) {
            nearest = distance;
            anchor = i;
        }
    });
    if (!(nearest <= 1)) return std::nullopt;
    const glm::dvec2 about = pixelAt(anchor);
    AffineFit<glm::dvec2> sums;
    forEach([&](uint32_t i) {
        const glm::dvec2 pixel = pixelAt(i);
        if (std::max(std::abs(pixel.x - about.x), std::abs(pixel.y - about.y)) > double(reach_)) return;
        const Vec2 off = view_.places[i] - place;
        const double weight =
            (1.75 - std::min(1.7, double(std::abs(off.x)))) * (1.75 - std::min(1.7, double(std::abs(off.y))));
        sums.add(double(off.x), double(off.y), pixel, weight);
    });
    if (const auto fitted = sums.solved(1e-2))
        if (glm::length(fitted->at - about) <= double(reach_)) return fitted->at;
    if (nearest <= 0.25f) return about;
    return std::nullopt;
}

}  // namespace relamp
