// The exposures of one view become radiance.
#include <functional>

#include "base/parallel.h"
#include "base/statistics.h"
#include "capture/bracket_codes.h"
#include "capture/brackets.h"

namespace relamp {
namespace {

constexpr double topCode = highestCode;

/// What is left of the exposures' shifts, and the variance that adds to ln radiance where the image has a gradient.
class EdgeNoise {
public:
    /// `slope(channel, code)`: of ln exposure over the code.
    template <class Slope>
    EdgeNoise(const std::vector<CodeImage>& images, const std::vector<double>& exposures, const ResponseCurve& response,
              const Slope& slope)
        : images_(images), slope_(slope) {
        const int width = images[0].width, height = images[0].height;
        if (images.size() < 2 || width < 8 || height < 8) return;
        std::vector<double> found;
        const int step = std::max(1, int(std::sqrt(double(width) * height / 60000)));
        for (int y = 1; y + 1 < height; y += step)
            for (int x = 1; x + 1 < width; x += step)
                for (size_t c = 0; c < 3; ++c) {
                    const size_t a = middleOf(x, y, c);
                    const double za = codeAt(a, x, y, c), steep2 = gradient2(a, x, y, c);
                    if (za < 40 || za > 220 || steep2 < 0.05 * 0.05) continue;
                    for (size_t i = 0; i < images.size(); ++i) {
                        const double z = codeAt(i, x, y, c);
                        if (i == a || z < 30 || z > 225) continue;
                        const double r = std::log(response.exposure(int(c), z) * exposures[a] /
                                                  (response.exposure(int(c), za) * exposures[i]));
                        const double ni = slope(c, z) * atCode(response.noise, z),
                                     na = slope(c, za) * atCode(response.noise, za);
                        // The median of a normal variable's square is 0.455 of its variance; both exposures are off.
                        found.push_back((r * r / 0.455 - ni * ni - na * na) / (2 * steep2));
                    }
                }
        if (found.size() < 100) return;
        variance = std::clamp(medianOf(std::move(found)), 0.0, 1.0);
    }

    /// Of ln radiance, each exposure.
    double at(int x, int y, size_t c) const {
        if (variance < 1e-6) return 0;
        x = std::clamp(x, 1, images_[0].width - 2);
        y = std::clamp(y, 1, images_[0].height - 2);
        return variance * gradient2(middleOf(x, y, c), x, y, c);
    }

    double variance = 0;  ///< square pixels, an axis

private:
    double codeAt(size_t i, int x, int y, size_t c) const { return double(images_[i].at(x, y)[c]) / 257; }
    /// The exposure that shows the pixel nearest to mid scale.
    size_t middleOf(int x, int y, size_t c) const {
        size_t best = 0;
        for (size_t i = 1; i < images_.size(); ++i)
            if (std::abs(codeAt(i, x, y, c) - 128) < std::abs(codeAt(best, x, y, c) - 128)) best = i;
        return best;
    }
    double gradient2(size_t i, int x, int y, size_t c) const {
        const double gx = 0.5 * (codeAt(i, x + 1, y, c) - codeAt(i, x - 1, y, c)),
                     gy = 0.5 * (codeAt(i, x, y + 1, c) - codeAt(i, x, y - 1, c));
        const double s = slope_(c, std::clamp(codeAt(i, x, y, c), 4.0, 250.0));
        return s * s * (gx * gx + gy * gy);
    }
    const std::vector<CodeImage>& images_;
    std::function<double(size_t, double)> slope_;
};

/// What every pixel of a set has in common.
class BracketMerger {
public:
    BracketMerger(const std::vector<CodeImage>& images, const std::vector<double>& exposures,
                  const ResponseCurve& response, bool rejectGhosts, const std::vector<PixelShift>& shifts)
        : images_(images),
          exposures_(exposures),
          response_(response),
          rejectGhosts_(rejectGhosts && images.size() > 1),
          shifts_(shifts),
          width_(images[0].width),
          height_(images[0].height),
          order_(fromShortest(exposures)),
          edges_(images, exposures, response, [&](size_t c, double z) {
              return response.linear ? 1 / std::max(z, 1.0) : slopeAt(response.logExposure[c], z);
          }) {
        // Variance of ln radiance by code; the inverse counts, 0 where clipped; a ramp, so that no step shows where an
        // exposure drops out.
        constexpr double ramp = 12;
        for (size_t c = 0; c < 3; ++c)
            for (int z = 0; z < bracketCodes; ++z) {
                double sigma = slopeAt(response.logExposure[c], z) * response.noise[size_t(z)];
                if (response.linear) sigma = response.noise[size_t(z)] / std::max(z, 1);
                fade_[size_t(z)] = std::clamp(std::min((topCode - z) / ramp, (z - lowestCode + 1) / 4.0), 0.0, 1.0);
                variance_[c][size_t(z)] = sigma * sigma;
            }
        double full = std::numeric_limits<double>::infinity();
        for (int c = 0; c < 3; ++c) full = std::min(full, response.exposure(c, topCode));
        saturation = float(full / exposures[order_[0]]);
        misfit = float(std::sqrt(edges_.variance));
        // What moved is shown as it was in the best exposure.
        best_ = size_t(std::find(order_.begin(), order_.end(), bestExposed(images, order_)) - order_.begin());
    }

    float saturation = 0, misfit = 0;  ///< as in MergedBracket

    size_t longest() const { return order_.back(); }

    /// One row of the image, of the ghosts and of the clipped pixels.
    void mergeRow(int y, MergedBracket& merged) const {
        Pixel p(images_.size());
        p.y = y;
        for (p.x = 0; p.x < width_; ++p.x) {
            const size_t pixel = size_t(y) * size_t(width_) + size_t(p.x);
            read(p);
            if (rejectGhosts_ && dropGhosts(p)) merged.ghost[pixel] = 1;
            bool clipped = false;
            for (size_t c = 0; c < 3; ++c) merged.image.pixels[pixel][int(c)] = radianceOf(p, c, clipped);
            merged.clipped[pixel] = clipped;
        }
    }

private:
    /// One pixel in all exposures.
    struct Pixel {
        explicit Pixel(size_t exposures) : code(exposures), radiance(exposures), kept(exposures) {}
        int x = 0, y = 0;
        std::vector<std::array<double, 3>> code, radiance;
        std::vector<uint8_t> kept;
    };

    void read(Pixel& p) const {
        for (size_t i = 0; i < images_.size(); ++i) {
            const uint16_t* z = images_[i].at(p.x, p.y);
            for (size_t c = 0; c < 3; ++c) {
                p.code[i][c] = double(z[c]) / 257;
                p.radiance[i][c] = response_.exposure(int(c), p.code[i][c]) / exposures_[i];
            }
            const auto inside = [&](const PixelShift& s) {
                return p.x + s.x >= 0 && p.x + s.x < width_ && p.y + s.y >= 0 && p.y + s.y < height_;
            };
            p.kept[i] = shifts_.empty() || inside(shifts_[i]);
        }
    }

    /// The best exposure, or the nearest to it that is neither clipped nor black here; their number where none is.
    size_t anchorOf(const Pixel& p) const {
        const size_t count = images_.size();
        for (size_t step = 0; step < count; ++step)
            for (const size_t k : {best_ + step, best_ - step}) {
                if (k >= count) continue;
                const std::array<double, 3>& code = p.code[order_[k]];
                const double most = std::max({code[0], code[1], code[2]});
                if (p.kept[order_[k]] && most < 240 && most > 20) return order_[k];
            }
        return count;
    }

    /// Whether exposure i shows something else than the anchor in this channel.
    bool disagrees(const Pixel& p, size_t anchor, size_t i, size_t c) const {
        const double a = p.code[anchor][c];
        if (a < 12 || a > 245) return false;
        const double predicted = response_.code(int(c), p.radiance[anchor][c] * exposures_[i]);
        if (predicted < 4 && p.code[i][c] < 16) return false;
        if (predicted > 243 && p.code[i][c] > 235) return false;
        // Noise of both, the anchor's carried over in ln exposure, and room for what no curve explains.
        const double carried = response_.linear
                                   ? atCode(response_.noise, a) * predicted / a
                                   : slopeAt(response_.logExposure[c], a) /
                                         slopeAt(response_.logExposure[c], predicted) * atCode(response_.noise, a);
        const double allowed = 6 + 5 * std::min(carried, 12.0) + 5 * atCode(response_.noise, predicted);
        if (std::abs(p.code[i][c] - predicted) <= allowed) return false;
        // At edges a shift of half a pixel explains much.
        double low = 255, high = 0;
        for (int dy = -1; dy <= 1; ++dy)
            for (int dx = -1; dx <= 1; ++dx) {
                const int nx = std::clamp(p.x + dx, 0, width_ - 1), ny = std::clamp(p.y + dy, 0, height_ - 1);
                const double z = double(images_[i].at(nx, ny)[c]) / 257;
                low = std::min(low, z), high = std::max(high, z);
            }
        return !(std::abs(p.code[i][c] - predicted) <= allowed + (high - low));
    }

    /// Leaves out the exposures that disagree with the anchor; whether there were any.
    bool dropGhosts(Pixel& p) const {
        const size_t anchor = anchorOf(p);
        bool any = false;
        for (size_t i = 0; anchor < images_.size() && i < images_.size(); ++i) {
            if (i == anchor || !p.kept[i]) continue;
            for (size_t c = 0; c < 3; ++c)
                if (disagrees(p, anchor, i, c)) {
                    p.kept[i] = 0;
                    any = true;
                }
        }
        return any;
    }

    float radianceOf(const Pixel& p, size_t c, bool& clipped) const {
        const size_t count = images_.size();
        double sum = 0, weights = 0;
        const double edge = edges_.at(p.x, p.y, c);
        const auto weightAt = [&](double z) { return atCode(fade_, z) / (atCode(variance_[c], z) + edge); };
        for (size_t i = 0; i < count; ++i) {
            if (!p.kept[i]) continue;
            const double w = weightAt(p.code[i][c]);
            sum += w * p.radiance[i][c], weights += w;
        }
        if (weights > 0) {
            const double estimate = sum / weights;
            sum = weights = 0;
            for (size_t i = 0; i < count; ++i) {
                if (!p.kept[i] || p.code[i][c] > 253.5) continue;
                const double w = weightAt(response_.code(int(c), estimate * exposures_[i]));
                sum += w * p.radiance[i][c], weights += w;
            }
            return float(weights > 0 ? sum / weights : estimate);
        }
        // Clipped in all that is left, or dark in all: the shortest, or the longest, says the most.
        size_t shortest = count, longest = count;
        for (const size_t i : order_)
            if (p.kept[i]) {
                if (shortest == count) shortest = i;
                longest = i;
            }
        const bool bright = p.code[shortest][c] > 128;
        clipped |= bright;
        if (bright) return std::max(float(response_.exposure(int(c), topCode) / exposures_[shortest]), saturation);
        if (p.code[longest][c] < 0.5) return 0.5f * float(response_.exposure(int(c), 0.5) / exposures_[longest]);
        return float(p.radiance[longest][c]);
    }

    const std::vector<CodeImage>& images_;
    const std::vector<double>& exposures_;
    const ResponseCurve& response_;
    const bool rejectGhosts_;
    const std::vector<PixelShift>& shifts_;
    const int width_, height_;
    const std::vector<size_t> order_;
    const EdgeNoise edges_;
    std::array<CodeTable, 3> variance_{};
    CodeTable fade_{};
    size_t best_ = 0;  ///< place in order_
};

/// A lone pixel is noise; what moves comes in patches.
void dropLonePixels(MergedBracket& merged) {
    const int width = merged.image.width, height = merged.image.height;
    std::vector<uint8_t> patches(merged.ghost.size(), 0);
    parallelFor(size_t(height), 32, [&](size_t y) {
        for (int x = 0; x < width; ++x) {
            const size_t pixel = y * size_t(width) + size_t(x);
            if (!merged.ghost[pixel]) continue;
            int around = 0;
            for (int dy = -1; dy <= 1; ++dy)
                for (int dx = -1; dx <= 1; ++dx) {
                    const int nx = x + dx, ny = int(y) + dy;
                    if (nx >= 0 && ny >= 0 && nx < width && ny < height)
                        around += merged.ghost[size_t(ny) * size_t(width) + size_t(nx)];
                }
            patches[pixel] = around >= 4;
        }
    });
    merged.ghost.swap(patches);
}

}  // namespace

MergedBracket mergeCodes(const std::vector<CodeImage>& images, const std::vector<double>& exposures,
                         const ResponseCurve& response, const BracketOptions& options, Progress& progress,
                         const std::vector<PixelShift>& shifts) {
    MergedBracket merged;
    if (images.empty()) return merged;
    const int width = images[0].width, height = images[0].height;
    const size_t pixels = size_t(width) * size_t(height);
    merged.image = Image(width, height);
    merged.ghost.assign(pixels, 0);
    merged.clipped.assign(pixels, 0);
    merged.shifts = shifts;
    const BracketMerger merger(images, exposures, response, options.rejectGhosts, shifts);
    merged.misfit = merger.misfit;
    merged.saturation = merger.saturation;
    progress.begin("Merging exposures", size_t(height));
    parallelFor(
        size_t(height), 8, [&](size_t row) { merger.mergeRow(int(row), merged); }, &progress);
    if (options.rejectGhosts) dropLonePixels(merged);
    for (size_t p = 0; p < pixels; ++p) {
        merged.ghosts += merged.ghost[p];
        merged.clippedPixels += merged.clipped[p];
        const uint16_t* z = &images[merger.longest()].codes[p * 3];
        merged.dark += std::max({z[0], z[1], z[2]}) < uint16_t(lowestCode * 257);
    }
    if (merged.ghosts) {
        merged.image.usable.assign(pixels, 1);
        for (size_t p = 0; p < pixels; ++p) merged.image.usable[p] = !merged.ghost[p];
    }
    return merged;
}

}  // namespace relamp
