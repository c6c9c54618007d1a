// Images for people: linear radiance at a size and an exposure that a page can show. Linear in, linear out: the sRGB
// curve comes with encodePng.
#pragma once
#include <vector>

#include "capture/camera.h"
#include "image/image.h"

namespace relamp {

/// The same camera with its longer side at most `longestSide` pixels; never larger than it was.
Camera smallerCamera(const Camera& camera, int longestSide);

/// Area-averaged to a smaller size over the usable pixels; a pixel without any is not usable.
Image shrunk(const Image& image, int width, int height);

/// Factor that brings the given percentile (0 to 100) of the usable pixels' luminance to 1; 1 when the image is
/// black.
float exposureFor(const Image& image, float percentile = 99);

Image scaledBy(Image image, float exposure);

/// Signed difference in display values about middle grey: grey is equal, brighter is `image` too bright, twice the
/// contrast.
Image differenceOf(const Image& image, const Image& reference, float exposure);

/// What is left of surface colours when their brightness is divided out: luminance 0.3 where a surface is (times its
/// coverage), grey where there is no tint. Colours darker than 0.002 count as neutral, because their tint is noise.
Rgb tintOf(const Rgb& albedo);
std::vector<Rgb> tintsOf(const std::vector<Rgb>& albedo, const std::vector<float>& alpha);

/// An image over a flat colour by its coverage.
Image over(const std::vector<Rgb>& pixels, const std::vector<float>& alpha, int width, int height, const Rgb& ground);

/// Squared difference of display values (exposed, clipped, sRGB), mean of the channels, in [0, 1]; 1 where either is no
/// number.
double squaredDisplayStep(const Rgb& image, const Rgb& reference, float exposure);

/// Mean squared error of display values (exposed, clipped, sRGB) over the pixels of the mask, and how many there are.
struct DisplayError {
    double squares = 0;
    size_t pixels = 0;
    /// Peak signal-to-noise ratio in dB, at most 100; 0 without pixels.
    double psnr() const;
};
DisplayError displayError(const Image& image, const Image& reference, const std::vector<uint8_t>& mask, float exposure);

/// Mean angle in degrees between colours and grey over the mask, colours darker than 0.02 left out.
double meanTintDegrees(const std::vector<Rgb>& albedo, const std::vector<uint8_t>& mask);

}  // namespace relamp
