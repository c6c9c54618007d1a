#include "display/display_image.h"

#include <algorithm>

#include "base/statistics.h"
#include "image/image_io.h"

namespace relamp {

Camera smallerCamera(const Camera& camera, int longestSide) {
    Camera small = camera;
    const double scale = std::min(1.0, double(longestSide) / std::max(camera.width, camera.height));
    small.width = std::max(1, int(std::lround(camera.width * scale)));
    small.height = std::max(1, int(std::lround(camera.height * scale)));
    const double sx = double(small.width) / camera.width, sy = double(small.height) / camera.height;
    small.focalX *= sx, small.centreX *= sx;
    small.focalY *= sy, small.centreY *= sy;
    return small;
}

Image shrunk(const Image& image, int width, int height) {
    Image small(width, height);
    small.usable.assign(small.pixels.size(), 0);
    const double sx = double(image.width) / width, sy = double(image.height) / height;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const double left = x * sx, right = (x + 1) * sx, top = y * sy, bottom = (y + 1) * sy;
            DVec3 sum(0);
            double weight = 0;
            for (int v = int(top); v < std::min(image.height, int(std::ceil(bottom))); ++v)
                for (int u = int(left); u < std::min(image.width, int(std::ceil(right))); ++u) {
                    if (!image.usableAt(u, v)) continue;
                    const double fraction = (std::min(right, u + 1.0) - std::max(left, double(u))) *
                                            (std::min(bottom, v + 1.0) - std::max(top, double(v)));
                    if (fraction <= 0) continue;
                    sum += fraction * DVec3(image.at(u, v));
                    weight += fraction;
                }
            if (weight <= 0) continue;
            small.at(x, y) = Rgb(sum / weight);
            small.usable[size_t(y) * width + x] = 1;
        }
    return small;
}

float exposureFor(const Image& image, float percentile) {
    std::vector<float> values;
    values.reserve(image.pixels.size());
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x)
            if (image.usableAt(x, y)) values.push_back(luminance(image.at(x, y)));
    if (values.empty()) return 1;
    const float white =
        selectRank(values, std::min(values.size() - 1, size_t(percentile / 100 * float(values.size()))));
    return white > 0 && std::isfinite(white) ? 1 / white : 1;
}

Image scaledBy(Image image, float exposure) {
    for (Rgb& c : image.pixels) c *= exposure;
    return image;
}

Image differenceOf(const Image& image, const Image& reference, float exposure) {
    Image out(image.width, image.height);
    for (size_t i = 0; i < out.pixels.size(); ++i)
        for (int c = 0; c < 3; ++c) {
            const bool usable = reference.usable.empty() || reference.usable[i];
            const float step =
                usable ? srgbEncode(image.pixels[i][c] * exposure) - srgbEncode(reference.pixels[i][c] * exposure)
                       : 0.0f;
            out.pixels[i][c] = srgbDecode(0.5f + 2 * step);
        }
    return out;
}

Rgb tintOf(const Rgb& albedo) {
    const float y = luminance(albedo);
    return (y > 0.002f ? albedo / y : Rgb(1)) * 0.3f;
}

std::vector<Rgb> tintsOf(const std::vector<Rgb>& albedo, const std::vector<float>& alpha) {
    std::vector<Rgb> tints(albedo.size());
    for (size_t i = 0; i < tints.size(); ++i) tints[i] = tintOf(albedo[i]) * alpha[i];
    return tints;
}

Image over(const std::vector<Rgb>& pixels, const std::vector<float>& alpha, int width, int height, const Rgb& ground) {
    Image out(width, height);
    for (size_t i = 0; i < out.pixels.size(); ++i) out.pixels[i] = pixels[i] + (1 - alpha[i]) * ground;
    return out;
}

double DisplayError::psnr() const {
    return pixels ? std::min(100.0, -10 * std::log10(std::max(squares / double(pixels), 1e-10))) : 0.0;
}

double squaredDisplayStep(const Rgb& image, const Rgb& reference, float exposure) {
    double sum = 0;
    for (int c = 0; c < 3; ++c) {
        const double step = srgbEncode(image[c] * exposure) - srgbEncode(reference[c] * exposure);
        sum += step * step;
    }
    return std::isfinite(sum) ? sum / 3 : 1;  // a pixel that is no number is as wrong as can be
}

DisplayError displayError(const Image& image, const Image& reference, const std::vector<uint8_t>& mask,
                          float exposure) {
    DisplayError error;
    for (size_t i = 0; i < image.pixels.size(); ++i) {
        if (!mask[i]) continue;
        error.squares += squaredDisplayStep(image.pixels[i], reference.pixels[i], exposure);
        ++error.pixels;
    }
    return error;
}

double meanTintDegrees(const std::vector<Rgb>& albedo, const std::vector<uint8_t>& mask) {
    double sum = 0;
    size_t count = 0;
    for (size_t i = 0; i < albedo.size(); ++i) {
        if (!mask[i] || luminance(albedo[i]) < 0.02f) continue;
        const DVec3 c(albedo[i]);
        sum += std::acos(std::clamp((c.x + c.y + c.z) / (glm::length(c) * std::sqrt(3.0)), -1.0, 1.0));
        ++count;
    }
    return count ? sum / double(count) * 180 / piD : 0.0;
}

}  // namespace relamp
