#include "display/scope.h"

#include "base/error.h"

namespace relamp {

Scope scopeOf(std::span<const uint8_t> rgba, int width, int height) {
    if (width < 0 || height < 0 || rgba.size() < size_t(width) * size_t(height) * 4)
        throw Error("an image of {} x {} pixels has {} bytes", width, height, rgba.size());
    constexpr size_t most = 300000;
    const size_t w = size_t(width), h = size_t(height), step = std::max<size_t>(1, w * h / most);
    Scope scope;
    for (auto& channel : scope.waveform) channel.assign(Scope::columns, {});
    uint32_t dark = 0, bright = 0;
    for (size_t y = step / 2; y < h; y += step)
        for (size_t x = 0; x < w; ++x) {
            const uint8_t* pixel = &rgba[4 * (y * w + x)];
            if (pixel[3] < 128) continue;
            const size_t column = x * Scope::columns / w;
            for (size_t c = 0; c < 3; ++c) {
                const size_t level = size_t(pixel[c]) * Scope::levels / 256;
                ++scope.waveform[c][column][level];
                ++scope.histogram[c][level];
            }
            dark += pixel[0] == 0 || pixel[1] == 0 || pixel[2] == 0;
            bright += pixel[0] == 255 || pixel[1] == 255 || pixel[2] == 255;
            ++scope.pixels;
        }
    if (scope.pixels) {
        scope.clippedDark = float(dark) / float(scope.pixels);
        scope.clippedBright = float(bright) / float(scope.pixels);
    }
    return scope;
}

}  // namespace relamp
