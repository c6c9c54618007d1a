#include "relight/live/grid.h"

namespace relamp {
namespace {
float angleBetween(const Vec3& a, const Vec3& b) { return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b)); }
}  // namespace

LiveGrid::LiveGrid(int side) : grid_{side} {
    const size_t n = size_t(grid_.cells());
    cap_.resize(n);
    for (size_t q = 0; q < 4; ++q) {
        x_[q].resize(n);
        y_[q].resize(n);
        z_[q].resize(n);
    }
    for (size_t c = 0; c < n; ++c) {
        cap_[c].axis = grid_.direction(int(c));
        float radius = 0;
        for (int q = 0; q < 4; ++q) {
            const Vec3 d = grid_.direction(int(c), Vec2(q % 2 ? 0.75f : 0.25f, q / 2 ? 0.75f : 0.25f));
            x_[size_t(q)][c] = d.x;
            y_[size_t(q)][c] = d.y;
            z_[size_t(q)][c] = d.z;
            radius =
                std::max(radius, angleBetween(cap_[c].axis, grid_.direction(int(c), Vec2(float(q % 2), float(q / 2)))));
        }
        cap_[c].setRadius(1.01f * radius);
    }
    for (int y = 0; y < side; y += 2)
        for (int x = 0; x < side; x += 4)
            for (int k = 0; k < 8; ++k)
                if (y + k / 4 < side && x + k % 4 < side) order_.push_back(uint16_t((y + k / 4) * side + x + k % 4));
    for (size_t y = 0; y < size_t(side); y += 4)
        for (size_t x = 0; x < size_t(side); x += 4) {
            const size_t first = y * size_t(side) + x;
            Cap parent;
            parent.axis = squareToSphere((Vec2(float(x), float(y)) + Vec2(2)) / float(side));
            float radius = 0;
            childCaps_.emplace_back();
            for (size_t i = 0; i < capLanes; ++i) {
                const Cap& child = cap_[first + i / 4 * size_t(side) + i % 4];
                childCaps_.back().set(i, child);
                radius = std::max(radius, angleBetween(parent.axis, child.axis) + child.radius);
            }
            parent.setRadius(radius);
            if (parents_.size() % capLanes == 0) parentCaps_.emplace_back();
            parentCaps_.back().set(parents_.size() % capLanes, parent);
            parents_.push_back(first);
        }
}

size_t LiveGrid::quarterAt(const Vec2& square) const {
    const int fine = 2 * grid_.side;
    const int x = std::min(int(square.x * float(fine)), fine - 1), y = std::min(int(square.y * float(fine)), fine - 1);
    return size_t((y / 2) * grid_.side + x / 2) * 4 + size_t((y % 2) * 2 + x % 2);
}

float LiveGrid::weightScale(const Vec3& n) const {
    float sum = 0;
    for (size_t q = 0; q < 4; ++q) {
        const float *x = x_[q].data(), *y = y_[q].data(), *z = z_[q].data();
        float lane[16] = {};
        // Sixteen running sums, so that the compiler may use vectors without changing the order of additions.
        const size_t count = cap_.size() / 16 * 16;
        for (size_t c = 0; c < count; c += 16)
            for (size_t k = 0; k < 16; ++k) lane[k] += std::max(0.0f, x[c + k] * n.x + y[c + k] * n.y + z[c + k] * n.z);
        for (size_t c = count; c < cap_.size(); ++c) lane[0] += std::max(0.0f, x[c] * n.x + y[c] * n.y + z[c] * n.z);
        for (float v : lane) sum += v;
    }
    return sum > 0 ? 1 / sum : 0.0f;
}

float LiveGrid::weightOf(const Vec3& normal, size_t cell, unsigned mask, float scale) const {
    float sum = 0;
    for (int q = 0; q < 4; ++q)
        if (mask >> q & 1) sum += std::max(0.0f, glm::dot(quarter(cell, q), normal));
    return sum * scale;
}

void LiveGrid::weights(const Vec3& n, std::span<const uint8_t> masks, std::span<float> weight) const {
    const float scale = weightScale(n);
    const size_t count = cap_.size();
    for (size_t c = 0; c < count; ++c) weight[c] = 0;
    for (size_t q = 0; q < 4; ++q) {
        const float *x = x_[q].data(), *y = y_[q].data(), *z = z_[q].data();
        for (size_t pair = 0; pair < count / 2; ++pair) {
            const unsigned byte = masks[pair];
            const size_t c = 2 * pair;
            const float a = std::max(0.0f, x[c] * n.x + y[c] * n.y + z[c] * n.z),
                        b = std::max(0.0f, x[c + 1] * n.x + y[c + 1] * n.y + z[c + 1] * n.z);
            weight[c] += byte >> q & 1 ? a : 0.0f;
            weight[c + 1] += byte >> (4 + q) & 1 ? b : 0.0f;
        }
    }
    for (size_t c = 0; c < count; ++c) weight[c] *= scale;
}

}  // namespace relamp
