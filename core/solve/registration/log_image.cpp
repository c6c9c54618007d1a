#include "solve/registration/log_image.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/parallel.h"

namespace relamp {
namespace {

constexpr float none = std::numeric_limits<float>::quiet_NaN();

std::vector<float> gaussian(float sigma) {
    const int reach = std::max(1, int(std::ceil(2.5f * sigma)));
    std::vector<float> kernel;
    float sum = 0;
    for (int k = -reach; k <= reach; ++k) {
        kernel.push_back(std::exp(-0.5f * float(k * k) / (sigma * sigma)));
        sum += kernel.back();
    }
    for (float& k : kernel) k /= sum;
    return kernel;
}

}  // namespace

LogImage::LogImage(const Image& image, int factor, float sigma, float floor)
    : factor_(factor), width_(image.width / factor), height_(image.height / factor) {
    const size_t count = size_t(width_) * size_t(height_);
    std::vector<float> plain(count), usable(count), across(count), acrossUsable(count);
    parallelFor(size_t(height_), 16, [&](size_t row) {
        for (int x = 0; x < width_; ++x)
            for (int k = 0; k < factor * factor; ++k) {
                const int px = x * factor + k % factor, py = int(row) * factor + k / factor;
                if (!image.usableAt(px, py)) continue;
                plain[index(x, int(row))] += float(luminance(image.at(px, py)));
                usable[index(x, int(row))] += 1;
            }
    });
    const std::vector<float> kernel = gaussian(sigma);
    const int reach = int(kernel.size() / 2);
    parallelFor(size_t(height_), 16, [&](size_t row) {
        const int y = int(row);
        for (int x = 0; x < width_; ++x) {
            float sum = 0, weight = 0;
            for (int k = -reach; k <= reach; ++k) {
                const size_t at = index(std::clamp(x + k, 0, width_ - 1), y);
                sum += kernel[size_t(k + reach)] * plain[at];
                weight += kernel[size_t(k + reach)] * usable[at];
            }
            across[index(x, y)] = sum;
            acrossUsable[index(x, y)] = weight;
        }
    });
    value_.resize(count);
    parallelFor(size_t(height_), 16, [&](size_t row) {
        const int y = int(row);
        for (int x = 0; x < width_; ++x) {
            float sum = 0, weight = 0;
            for (int k = -reach; k <= reach; ++k) {
                const size_t at = index(x, std::clamp(y + k, 0, height_ - 1));
                sum += kernel[size_t(k + reach)] * across[at];
                weight += kernel[size_t(k + reach)] * acrossUsable[at];
            }
            value_[index(x, y)] =
                weight > 0.9f * float(factor * factor) ? std::log(std::max(sum / weight, 0.0f) + floor) : none;
        }
    });
}

LogImage::At LogImage::at(const Vec2& position) const {
    const Vec2 pixel = position / float(factor_);
    if (!(pixel.x > 2 && pixel.y > 2 && pixel.x < float(width_ - 3) && pixel.y < float(height_ - 3))) return {};
    const int x = int(pixel.x - 0.5f), y = int(pixel.y - 0.5f);
    const float fx = pixel.x - 0.5f - float(x), fy = pixel.y - 0.5f - float(y);
    const float* top = &value_[index(x, y)];
    const float* bottom = top + width_;
    // Slopes are central differences, bilinear as the value is.
    const auto row = [&](const float* p) {
        return Vec2((1 - fx) * p[0] + fx * p[1], 0.5f * ((1 - fx) * (p[1] - p[-1]) + fx * (p[2] - p[0])));
    };
    const Vec2 above = row(top - width_), upper = row(top), lower = row(bottom), below = row(bottom + width_);
    At at;
    at.value = (1 - fy) * upper.x + fy * lower.x;
    at.slope = {(1 - fy) * upper.y + fy * lower.y, 0.5f * ((1 - fy) * (lower.x - above.x) + fy * (below.x - upper.x))};
    at.slope /= float(factor_);
    at.valid = std::isfinite(at.value) && std::isfinite(at.slope.x) && std::isfinite(at.slope.y);
    return at;
}

}  // namespace relamp
