#include "image/pull_push.h"

#include "base/parallel.h"

namespace relamp {
namespace {

struct Level {
    Image image;
    std::vector<float> weight;
};

/// Weighted means of 2 x 2 pixels; their weights add up to at most 1.
Level coarser(const Image& image, const std::vector<float>& weight) {
    Level out{Image(image.width / 2, image.height / 2), {}};
    out.weight.resize(out.image.pixels.size());
    parallelFor(size_t(out.image.height), 16, [&](size_t y) {
        for (int x = 0; x < out.image.width; ++x) {
            Rgb sum(0);
            float total = 0;
            for (int k = 0; k < 4; ++k) {
                const size_t from = (2 * y + size_t(k / 2)) * size_t(image.width) + size_t(2 * x + k % 2);
                sum += weight[from] * image.pixels[from];
                total += weight[from];
            }
            const size_t to = y * size_t(out.image.width) + size_t(x);
            out.image.pixels[to] = total > 0 ? sum / total : Rgb(0);
            out.weight[to] = std::min(1.0f, total);
        }
    });
    return out;
}

/// Bilinear between pixels of the coarser level.
Rgb between(const Image& coarse, int x, int y) {
    const float px = 0.5f * (float(x) + 0.5f) - 0.5f, py = 0.5f * (float(y) + 0.5f) - 0.5f;
    const int left = int(std::floor(px)), top = int(std::floor(py));
    const float fx = px - float(left), fy = py - float(top);
    const auto at = [&](int u, int v) {
        return coarse.at((u + coarse.width) % coarse.width, std::clamp(v, 0, coarse.height - 1));
    };
    return (1 - fy) * ((1 - fx) * at(left, top) + fx * at(left + 1, top)) +
           fy * ((1 - fx) * at(left, top + 1) + fx * at(left + 1, top + 1));
}

void push(const Image& coarse, const std::vector<float>& weight, Image& image) {
    parallelFor(size_t(image.height), 16, [&](size_t row) {
        const int y = int(row);
        for (int x = 0; x < image.width; ++x) {
            const float known = weight[row * size_t(image.width) + size_t(x)];
            if (known < 1) image.at(x, y) = known * image.at(x, y) + (1 - known) * between(coarse, x, y);
        }
    });
}

}  // namespace

void pullPush(Image& image, std::vector<float> weight) {
    std::vector<Level> levels;
    levels.reserve(32);  // pointers into it stay
    const Image* finest = &image;
    const std::vector<float>* known = &weight;
    while (finest->width > 1 && finest->height > 1) {
        levels.push_back(coarser(*finest, *known));
        finest = &levels.back().image;
        known = &levels.back().weight;
    }
    for (size_t l = levels.size(); l-- > 0;) {
        if (l > 0) push(levels[l].image, levels[l - 1].weight, levels[l - 1].image);
        else push(levels[0].image, weight, image);
    }
}

}  // namespace relamp
