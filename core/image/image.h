// An image in memory: linear radiance, row 0 at the top.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "base/math.h"

namespace relamp {

/// width x height colours, row-major from the top left. Pixel (x, y) has its centre at (x + 0.5, y + 0.5).
struct Image {
    int width = 0, height = 0;
    std::vector<Rgb> pixels;
    std::vector<uint8_t> usable;  ///< 1 where the pixel may be trusted (finite, not negative, not masked); empty = all

    Image() = default;
    Image(int w, int h, Rgb fill = Rgb(0)) : width(w), height(h), pixels(size_t(w) * h, fill) {}
    Rgb& at(int x, int y) { return pixels[size_t(y) * width + x]; }
    const Rgb& at(int x, int y) const { return pixels[size_t(y) * width + x]; }
    bool usableAt(int x, int y) const { return usable.empty() || usable[size_t(y) * width + x]; }
};

/// An image as its file stores it, before any transfer curve: codes on a scale of 0 to 65535 (8-bit ones times 257).
struct CodeImage {
    int width = 0, height = 0;
    bool linear = false;  ///< codes are proportional to exposure: camera raw, or the header says so
    std::vector<uint16_t>
        codes;  ///< width x height x 3, row-major from the top left; grey is spread over three channels

    const uint16_t* at(int x, int y) const { return &codes[(size_t(y) * width + x) * 3]; }
};

/// How a photograph was exposed, as its header says; 0: not given.
struct ExposureTags {
    double seconds = 0, aperture = 0, iso = 0;
};

/// One named channel of a frame.
struct Channel {
    std::string name;           ///< as written, for example "Combined_world.R"
    bool half = true;           ///< half float on disk (colour), else float (geometry)
    std::vector<float> values;  ///< width x height, row-major from the top
};

}  // namespace relamp
