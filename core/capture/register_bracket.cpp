#include "capture/register_bracket.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "base/parallel.h"

namespace relamp {
namespace {

/// An image as brighter (1) or darker (0) than its threshold, and where that is too close to call (2).
struct Bitmap {
    int width = 0, height = 0;
    std::vector<uint8_t> value;
};

struct Grey {
    int width = 0, height = 0;
    std::vector<uint8_t> value;
};

Grey greyOf(const CodeImage& p) {
    Grey grey{p.width, p.height, std::vector<uint8_t>(size_t(p.width) * size_t(p.height))};
    // Ward's weights in 256ths.
    for (size_t i = 0; i < grey.value.size(); ++i)
        grey.value[i] =
            uint8_t((54u * p.codes[i * 3] + 183u * p.codes[i * 3 + 1] + 19u * p.codes[i * 3 + 2]) / (256u * 257u));
    return grey;
}

Grey halved(const Grey& g) {
    Grey half{g.width / 2, g.height / 2, std::vector<uint8_t>(size_t(g.width / 2) * size_t(g.height / 2))};
    for (int y = 0; y < half.height; ++y)
        for (int x = 0; x < half.width; ++x) {
            const auto at = [&](int dx, int dy) {
                return unsigned(g.value[size_t(2 * y + dy) * size_t(g.width) + size_t(2 * x + dx)]);
            };
            half.value[size_t(y) * size_t(half.width) + size_t(x)] =
                uint8_t((at(0, 0) + at(1, 0) + at(0, 1) + at(1, 1) + 2) / 4);
        }
    return half;
}

/// The code with the given fraction of the pixels below it.
int quantileOf(const Grey& g, double fraction) {
    std::array<size_t, 256> counts{};
    for (const uint8_t v : g.value) ++counts[v];
    size_t sum = 0;
    for (int z = 0; z < 256; ++z)
        if ((sum += counts[size_t(z)]) > size_t(fraction * double(g.value.size()))) return z;
    return 255;
}

Bitmap thresholded(const Grey& g, int threshold) {
    constexpr int tooClose = 4;
    Bitmap b{g.width, g.height, std::vector<uint8_t>(g.value.size())};
    for (size_t i = 0; i < b.value.size(); ++i)
        b.value[i] = std::abs(int(g.value[i]) - threshold) <= tooClose ? 2 : g.value[i] > threshold;
    return b;
}

/// Fraction of the pixels that disagree, of those that both can tell.
double disagreement(const Bitmap& a, const Bitmap& b, int dx, int dy) {
    size_t differ = 0, told = 0;
    for (int y = std::max(0, -dy); y < std::min(a.height, b.height - dy); ++y)
        for (int x = std::max(0, -dx); x < std::min(a.width, b.width - dx); ++x) {
            const uint8_t p = a.value[size_t(y) * size_t(a.width) + size_t(x)],
                          q = b.value[size_t(y + dy) * size_t(b.width) + size_t(x + dx)];
            const bool both = p < 2 && q < 2;
            told += both;
            differ += both && p != q;
        }
    return told ? double(differ) / double(told) : 1;
}

PixelShift shiftBetween(const CodeImage& from, const CodeImage& to) {
    std::vector<Grey> a{greyOf(from)}, b{greyOf(to)};
    const int reach = std::max(1, from.width / 25);
    while ((1 << a.size()) <= 2 * reach && std::min(a.back().width, a.back().height) >= 32) {
        a.push_back(halved(a.back()));
        b.push_back(halved(b.back()));
    }
    // The same fraction of the image on either side in both; another share than a half where the median is clipped in
    // one of them.
    double fraction = 0.5;
    for (const double other : {0.5, 0.7, 0.3, 0.85, 0.15}) {
        const int p = quantileOf(a[0], other), q = quantileOf(b[0], other);
        if (std::min(p, q) > 12 && std::max(p, q) < 243) {
            fraction = other;
            break;
        }
    }
    PixelShift shift;
    double still = 1, best = 1;
    for (size_t level = a.size(); level-- > 0;) {
        const Bitmap p = thresholded(a[level], quantileOf(a[level], fraction)),
                     q = thresholded(b[level], quantileOf(b[level], fraction));
        const PixelShift middle{2 * shift.x, 2 * shift.y};
        std::array<double, 9> error{};
        parallelFor(9, 1, [&](size_t i) {
            error[i] = disagreement(p, q, middle.x + int(i % 3) - 1, middle.y + int(i / 3) - 1);
        });
        size_t least = 4;  // no change where nothing is better
        for (size_t i = 0; i < 9; ++i)
            if (error[i] < error[least]) least = i;
        shift = {middle.x + int(least % 3) - 1, middle.y + int(least / 3) - 1};
        best = error[least];
        if (level == 0) still = disagreement(p, q, 0, 0);
    }
    return best < 0.9 * still ? shift : PixelShift{};
}

}  // namespace

std::vector<PixelShift> bracketShifts(const std::vector<CodeImage>& images, const std::vector<double>& exposures,
                                      size_t reference) {
    std::vector<PixelShift> shifts(images.size());
    std::vector<size_t> order(images.size());
    std::iota(order.begin(), order.end(), size_t(0));
    std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) { return exposures[a] < exposures[b]; });
    const size_t start = size_t(std::find(order.begin(), order.end(), reference) - order.begin());
    const auto link = [&](size_t from, size_t to) {
        const PixelShift step = shiftBetween(images[from], images[to]);
        shifts[to] = {shifts[from].x + step.x, shifts[from].y + step.y};
    };
    for (size_t k = start; k + 1 < order.size(); ++k) link(order[k], order[k + 1]);
    for (size_t k = start; k > 0 && k < order.size(); --k) link(order[k], order[k - 1]);
    return shifts;
}

CodeImage shifted(const CodeImage& image, const PixelShift& shift) {
    if (shift == PixelShift{}) return image;
    CodeImage result{image.width, image.height, image.linear, std::vector<uint16_t>(image.codes.size(), 0)};
    const int first = std::max(0, -shift.x), last = std::min(image.width, image.width - shift.x);
    for (int y = std::max(0, -shift.y); y < std::min(image.height, image.height - shift.y) && first < last; ++y)
        std::copy(image.at(first + shift.x, y + shift.y), image.at(last - 1 + shift.x, y + shift.y) + 3,
                  &result.codes[(size_t(y) * size_t(image.width) + size_t(first)) * 3]);
    return result;
}

}  // namespace relamp
