#include "capture/brackets.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>

#include "base/error.h"
#include "base/parallel.h"
#include "base/random.h"
#include "base/statistics.h"
#include "image/image_io.h"

namespace relamp {
namespace {

constexpr int codes = 256;
/// Codes outside are clipped, or nearly: encoders ring, and noise is cut off.
constexpr double lowestCode = 3, highestCode = 250;
constexpr double lowestNoise = 0.29;  ///< of rounding to whole codes

double at(const std::array<double, codes>& table, double code) {
    const double z = std::clamp(code, 0.0, 255.0);
    const int i = std::min(int(z), codes - 2);
    const double f = z - i;
    return table[size_t(i)] * (1 - f) + table[size_t(i) + 1] * f;
}

/// Slope of ln exposure by code, over a few codes because the table is a fit.
double slopeAt(const std::array<double, codes>& table, double code) {
    const double low = std::clamp(code - 1.5, 0.0, 252.0), high = low + 3;
    return std::max((at(table, high) - at(table, low)) / 3, 1e-5);
}

/// Solves A x = b for a symmetric positive definite A (row-major, overwritten) by Cholesky.
void solveCholesky(std::vector<double>& a, std::vector<double>& b) {
    const size_t n = b.size();
    for (size_t j = 0; j < n; ++j) {
        double diagonal = a[j * n + j];
        for (size_t k = 0; k < j; ++k) diagonal -= a[j * n + k] * a[j * n + k];
        if (!(diagonal > 0)) throw Error("the response curve is not determined by these exposures");
        const double root = std::sqrt(diagonal);
        a[j * n + j] = root;
        for (size_t i = j + 1; i < n; ++i) {
            double sum = a[i * n + j];
            for (size_t k = 0; k < j; ++k) sum -= a[i * n + k] * a[j * n + k];
            a[i * n + j] = sum / root;
        }
    }
    for (size_t i = 0; i < n; ++i) {
        for (size_t k = 0; k < i; ++k) b[i] -= a[i * n + k] * b[k];
        b[i] /= a[i * n + i];
    }
    for (size_t i = n; i-- > 0;) {
        for (size_t k = i + 1; k < n; ++k) b[i] -= a[k * n + i] * b[k];
        b[i] /= a[i * n + i];
    }
}

/// The nearest never-falling sequence (pool adjacent violators).
void makeMonotone(std::array<double, codes>& g) {
    std::vector<std::pair<double, int>> pools;  // mean, length
    for (const double value : g) {
        pools.emplace_back(value, 1);
        while (pools.size() > 1 && pools[pools.size() - 2].first > pools.back().first) {
            const auto [mean, length] = pools.back();
            pools.pop_back();
            auto& before = pools.back();
            before.first = (before.first * before.second + mean * length) / (before.second + length);
            before.second += length;
        }
    }
    size_t i = 0;
    for (const auto& [mean, length] : pools)
        for (int k = 0; k < length; ++k) g[i++] = mean;
}

/// Median spread of the codes in bins of the code, joined by lines: the camera's noise as the smooth parts show it.
std::array<double, codes> noiseOf(const std::vector<ResponseSample>& samples) {
    constexpr int bins = 16;
    std::array<std::vector<float>, bins> spreads;
    for (const ResponseSample& s : samples)
        for (const auto& look : s.looks)
            for (size_t c = 0; c < 3; ++c)
                if (look.code[c] > lowestCode && look.code[c] < highestCode)
                    spreads[size_t(std::min(bins - 1, int(look.code[c] / 16)))].push_back(look.spread[c]);
    std::vector<std::pair<double, double>> knots;
    for (size_t b = 0; b < bins; ++b) {
        if (spreads[b].size() < 20) continue;
        knots.emplace_back(16.0 * double(b) + 8, std::max(double(medianOf(std::move(spreads[b]))), lowestNoise));
    }
    std::array<double, codes> noise;
    noise.fill(1);
    if (knots.empty()) return noise;
    for (int z = 0; z < codes; ++z) {
        size_t k = 0;
        while (k + 1 < knots.size() && knots[k + 1].first < z) ++k;
        const auto& a = knots[k];
        const auto& b = knots[std::min(k + 1, knots.size() - 1)];
        const double f = b.first > a.first ? std::clamp((z - a.first) / (b.first - a.first), 0.0, 1.0) : 0;
        noise[size_t(z)] = a.second * (1 - f) + b.second * f;
    }
    return noise;
}

struct ChannelFit {
    std::array<double, codes> g{};
    double chi = 0;
    size_t looks = 0;
};

/// One look of one pixel in one channel as the equations see it.
struct Term {
    int knot;
    double fraction, logExposure, weight;
};

/// Which looks of a sample count in a channel, with their weights for the present curve.
void termsOf(const ResponseSample& sample, size_t channel, const std::array<double, codes>& g,
             const std::array<double, codes>& noise, bool first, std::vector<Term>& terms) {
    terms.clear();
    for (const auto& look : sample.looks) {
        const double z = double(look.code[channel]);
        if (z < lowestCode || z > highestCode) continue;
        Term t{std::min(int(z), codes - 2), 0, look.logExposure, 0};
        t.fraction = z - t.knot;
        if (first) {
            t.weight = std::min(z, 255 - z) / 64;  // the hat of [DM97]
        } else {
            // A mean over nine pixels still holds a third of the noise, and texture.
            const double sigma = slopeAt(g, z) * (0.4 * at(noise, z) + 0.15);
            t.weight = 1 / (sigma * sigma);
        }
        terms.push_back(t);
    }
}

ChannelFit fitChannel(const std::vector<ResponseSample>& samples, size_t channel,
                      const std::array<double, codes>& noise, double smoothness) {
    constexpr size_t n = codes;
    ChannelFit fit;
    std::vector<Term> terms;
    constexpr int rounds = 6;
    for (int round = 0; round < rounds; ++round) {
        const bool first = round == 0;
        std::vector<double> a(n * n, 0.0), b(n, 0.0);
        fit.chi = 0;
        fit.looks = 0;
        for (const ResponseSample& sample : samples) {
            termsOf(sample, channel, fit.g, noise, first, terms);
            if (terms.size() < 2) continue;
            const auto value = [&](const Term& t) {
                return fit.g[size_t(t.knot)] * (1 - t.fraction) + fit.g[size_t(t.knot) + 1] * t.fraction;
            };
            if (!first)  // Cauchy, twice: the mean itself must not lean to what moved
                for (int pass = 0; pass < 2; ++pass) {
                    double sum = 0, mean = 0;
                    for (const Term& t : terms) sum += t.weight, mean += t.weight * (value(t) - t.logExposure);
                    mean /= sum;
                    for (Term& t : terms) {
                        const double z = t.knot + t.fraction, sigma = slopeAt(fit.g, z) * (0.4 * at(noise, z) + 0.15);
                        const double r = (value(t) - t.logExposure - mean) / (3 * sigma);
                        t.weight = 1 / (sigma * sigma) / (1 + r * r);
                    }
                }
            double sum = 0, meanTime = 0, meanValue = 0;
            for (const Term& t : terms)
                sum += t.weight, meanTime += t.weight * t.logExposure, meanValue += t.weight * value(t);
            if (!(sum > 0)) continue;
            meanTime /= sum, meanValue /= sum;
            // The pixel's ln radiance is eliminated: sum w (g - t)^2 - (sum w (g - t))^2 / sum w.
            for (const Term& t : terms) {
                const size_t i = size_t(t.knot);
                const double w[2] = {1 - t.fraction, t.fraction};
                for (size_t p = 0; p < 2; ++p) {
                    b[i + p] += t.weight * w[p] * (t.logExposure - meanTime);
                    for (size_t q = 0; q < 2; ++q) a[(i + p) * n + i + q] += t.weight * w[p] * w[q];
                }
                for (const Term& u : terms) {
                    const size_t j = size_t(u.knot);
                    const double v[2] = {1 - u.fraction, u.fraction}, both = t.weight * u.weight / sum;
                    for (size_t p = 0; p < 2; ++p)
                        for (size_t q = 0; q < 2; ++q) a[(i + p) * n + j + q] -= both * w[p] * v[q];
                }
                const double r = value(t) - meanValue - (t.logExposure - meanTime);
                fit.chi += t.weight * r * r;
                ++fit.looks;
            }
        }
        if (fit.looks < 20)
            throw Error("only {} looks are well exposed in two exposures or more, so there is no response curve",
                        fit.looks);
        // Curvature over u = ln(code + 1/2), in which a power law is straight. The weight stands to the data's as one
        // look does.
        const auto u = [](size_t z) { return std::log(double(z) + 0.5); };
        const double lambda = 2700 * smoothness;
        for (size_t z = 1; z + 1 < n; ++z) {
            const double before = u(z) - u(z - 1), after = u(z + 1) - u(z), span = 0.5 * (before + after);
            // Shoulders bend the upper end, where there is light enough to see how: there the prior lets go.
            const double upper = 1 - double(z) / 256, stiffness = lambda * upper * upper;
            const double row[3] = {1 / (before * span), -(1 / before + 1 / after) / span, 1 / (after * span)};
            for (size_t p = 0; p < 3; ++p)
                for (size_t q = 0; q < 3; ++q) a[(z - 1 + p) * n + z - 1 + q] += stiffness * span * row[p] * row[q];
        }
        double largest = 0;
        for (size_t i = 0; i < n; ++i) largest = std::max(largest, a[i * n + i]);
        for (size_t i = 0; i < n; ++i) a[i * n + i] += 1e-12 * largest;
        a[n * n - 1] += largest;  // code 255 is exposure 1
        solveCholesky(a, b);
        const double full = b[n - 1];
        for (size_t z = 0; z < n; ++z) fit.g[z] = b[z] - full;
        makeMonotone(fit.g);
        for (const double value : fit.g)
            if (!std::isfinite(value)) throw Error("the response curve came out without numbers");
    }
    return fit;
}

float codeOf(uint16_t stored) { return float(stored) / 257.0f; }

}  // namespace

double ResponseCurve::exposure(int channel, double code) const {
    return linear ? std::max(code, 0.0) / 255 : std::exp(at(logExposure[size_t(channel)], code));
}

double ResponseCurve::code(int channel, double value) const {
    if (linear) return std::clamp(value * 255, 0.0, 255.0);
    if (!(value > 0)) return 0;
    const auto& g = logExposure[size_t(channel)];
    const double wanted = std::log(value);
    const size_t above = size_t(std::upper_bound(g.begin(), g.end(), wanted) - g.begin());
    if (above == 0) return 0;
    if (above >= g.size()) return 255;
    const double low = g[above - 1], high = g[above];
    return double(above - 1) + (high > low ? (wanted - low) / (high - low) : 0);
}

ResponseCurve linearResponse() {
    ResponseCurve curve;
    curve.linear = true;
    for (size_t z = 0; z < codes; ++z) {
        for (auto& g : curve.logExposure) g[z] = std::log(std::max(double(z), 0.25) / 255);
        curve.noise[z] = 0.3;
    }
    return curve;
}

ResponseCurve fitResponse(const std::vector<ResponseSample>& samples, double smoothness) {
    double shortest = std::numeric_limits<double>::infinity(), longest = -shortest;
    for (const ResponseSample& s : samples)
        for (const auto& look : s.looks) {
            shortest = std::min(shortest, look.logExposure);
            longest = std::max(longest, look.logExposure);
        }
    if (!(longest - shortest > 0.1))
        throw Error("the exposures do not differ, expected brackets of different exposure times");
    ResponseCurve curve;
    curve.noise = noiseOf(samples);
    curve.samples = samples.size();
    // Even exposure steps leave ripples of the step's period undetermined, so the curve is as smooth as the data allow:
    // the smoothest that explains them within a twentieth of the roughest.
    constexpr double ladder[] = {1, 0.3, 0.1};
    constexpr double tolerance = 1.05;
    std::array<std::array<ChannelFit, 3>, 3> fits;
    std::array<double, 3> residual{};
    parallelFor(9, 1, [&](size_t i) {
        fits[i / 3][i % 3] = fitChannel(samples, i % 3, curve.noise, smoothness * ladder[i / 3]);
    });
    for (size_t step = 0; step < 3; ++step) {
        double chi = 0, looks = 0;
        for (const ChannelFit& fit : fits[step]) chi += fit.chi, looks += double(fit.looks);
        residual[step] = std::sqrt(chi / std::max(looks, 1.0));
    }
    size_t chosen = 0;
    while (chosen < 2 && residual[chosen] > tolerance * residual[2]) ++chosen;
    for (size_t c = 0; c < 3; ++c) curve.logExposure[c] = fits[chosen][c].g;
    curve.residual = residual[chosen];
    return curve;
}

std::vector<ResponseSample> sampleBracket(const std::vector<CodeImage>& images, const std::vector<double>& exposures,
                                          size_t count) {
    std::vector<ResponseSample> samples;
    if (images.empty() || count == 0) return samples;
    const int width = images[0].width, height = images[0].height;
    if (width < 8 || height < 8) return samples;
    const int across = std::max(1, int(std::sqrt(double(count) * width / height))),
              down = std::max(1, int(double(count) / across));
    struct Place {
        int x = -1, y = -1;
        float score = 1e9f;
    };
    std::vector<Place> places(size_t(across) * down);
    const auto summary = [&](const CodeImage& p, int x, int y, size_t c, float& mean, float& spread, float& range) {
        float sum = 0, squares = 0, low = 255, high = 0;
        for (int dy = -1; dy <= 1; ++dy)
            for (int dx = -1; dx <= 1; ++dx) {
                const float z = codeOf(p.at(x + dx, y + dy)[c]);
                sum += z, squares += z * z, low = std::min(low, z), high = std::max(high, z);
            }
        mean = sum / 9;
        spread = std::sqrt(std::max(0.0f, (squares - sum * sum / 9) / 8));
        range = high - low;
    };
    parallelFor(places.size(), 16, [&](size_t b) {
        const int column = int(b) % across, row = int(b) / across;
        const int x0 = 1 + column * (width - 2) / across, x1 = 1 + (column + 1) * (width - 2) / across;
        const int y0 = 1 + row * (height - 2) / down, y1 = 1 + (row + 1) * (height - 2) / down;
        if (x1 <= x0 || y1 <= y0) return;
        const Vec2 shift = randomShift(1, b, 0);
        for (int trial = 0; trial < 24; ++trial) {
            const Vec2 u = r2Point(uint32_t(trial), shift);
            const int x = x0 + int(u.x * float(x1 - x0)), y = y0 + int(u.y * float(y1 - y0));
            if (x >= x1 || y >= y1) continue;
            float worst = 0;
            int good = 0;
            for (const CodeImage& p : images) {
                bool well = false;
                for (size_t c = 0; c < 3; ++c) {
                    float mean, spread, range;
                    summary(p, x, y, c, mean, spread, range);
                    if (mean < 8 || mean > 245) continue;
                    well = true;
                    worst = std::max(worst, range);
                }
                good += well;
            }
            if (good >= 2 && worst < places[b].score) places[b] = {x, y, worst};
        }
    });
    for (const Place& place : places) {
        if (place.x < 0 || place.score > 40) continue;
        ResponseSample sample;
        for (size_t i = 0; i < images.size(); ++i) {
            ResponseSample::Look look;
            look.logExposure = std::log(exposures[i]);
            for (size_t c = 0; c < 3; ++c) {
                float range;
                summary(images[i], place.x, place.y, c, look.code[c], look.spread[c], range);
                // A clipped pixel among the nine pulls the mean: outside the range that counts.
                if (look.code[c] + 0.5f * range > float(highestCode) + 3) look.code[c] = 255;
                if (look.code[c] - 0.5f * range < 0.5f) look.code[c] = 0;
            }
            sample.looks.push_back(look);
        }
        samples.push_back(std::move(sample));
    }
    return samples;
}

namespace {

struct ReadSet {
    std::vector<CodeImage> images;
    std::vector<double> exposures;
    std::vector<PixelShift> shifts;  // empty: none was moved
};

/// The exposure most pixels of which are neither bright nor dark.
size_t bestExposed(const std::vector<CodeImage>& images, const std::vector<size_t>& order) {
    const size_t pixels = images[0].codes.size() / 3;
    size_t best = order[0], most = 0;
    for (const size_t i : order) {
        size_t well = 0;
        for (size_t p = 0; p < pixels; p += std::max<size_t>(1, pixels / 50000)) {
            const uint16_t* z = &images[i].codes[p * 3];
            well += std::max({z[0], z[1], z[2]}) < 230 * 257 && std::min({z[0], z[1], z[2]}) > 25 * 257;
        }
        if (well > most) {
            most = well;
            best = i;
        }
    }
    return best;
}

std::vector<size_t> fromShortest(const std::vector<double>& exposures) {
    std::vector<size_t> order(exposures.size());
    std::iota(order.begin(), order.end(), size_t(0));
    std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) { return exposures[a] < exposures[b]; });
    return order;
}

ReadSet readSet(const Bracket& set, const BracketOptions& options, const Progress& progress) {
    ReadSet read;
    read.images.resize(set.size());
    parallelFor(set.size(), 1, [&](size_t i) {
        read.images[i] = readCodes(set[i].file, options.maxPixels, [&] { progress.check(); });
    });
    for (size_t i = 0; i < set.size(); ++i) {
        const CodeImage &p = read.images[i], &first = read.images[0];
        if (p.width != first.width || p.height != first.height)
            throw Error("{}: is {} x {} pixels, {} is {} x {}", set[i].file.string(), p.width, p.height,
                        set[0].file.string(), first.width, first.height);
        read.exposures.push_back(set[i].exposure);
    }
    if (!options.align || set.size() < 2) return read;
    size_t reference = bestExposed(read.images, fromShortest(read.exposures));
    for (size_t i = 0; i < set.size(); ++i)
        if (set[i].reference) reference = i;
    read.shifts = bracketShifts(read.images, read.exposures, reference);
    if (std::all_of(read.shifts.begin(), read.shifts.end(), [](const PixelShift& s) { return s == PixelShift{}; }))
        read.shifts.clear();
    for (size_t i = 0; i < read.shifts.size(); ++i) read.images[i] = shifted(read.images[i], read.shifts[i]);
    return read;
}

}  // namespace

ResponseCurve responseOf(const std::vector<Bracket>& sets, const BracketOptions& options, Progress& progress) {
    progress.begin("Response curve", sets.size());
    std::vector<ResponseSample> samples;
    const size_t each = std::max<size_t>(200, options.samples / std::max<size_t>(1, sets.size()));
    // Beyond this many sets, every so many are enough.
    const size_t stride = std::max<size_t>(1, sets.size() * each / (2 * options.samples));
    size_t linear = 0, looked = 0;
    for (size_t i = 0; i < sets.size(); ++i) {
        progress.advance();
        if (i % stride != 0 || sets[i].empty()) continue;
        const ReadSet read = readSet(sets[i], options, progress);
        for (const CodeImage& p : read.images) linear += p.linear, ++looked;
        for (ResponseSample& s : sampleBracket(read.images, read.exposures, each)) samples.push_back(std::move(s));
    }
    if (linear && linear != looked)
        throw Error("{}: some exposures are linear (camera raw) and others are not", sets[0][0].file.string());
    if (linear) return linearResponse();
    return withContext(sets.empty() || sets[0].empty() ? std::string("brackets") : sets[0][0].file.string(),
                       [&] { return fitResponse(samples, options.smoothness); });
}

namespace {

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
                        const double ni = slope(c, z) * relamp::at(response.noise, z),
                                     na = slope(c, za) * relamp::at(response.noise, za);
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

}  // namespace

MergedBracket mergeCodes(const std::vector<CodeImage>& images, const std::vector<double>& exposures,
                         const ResponseCurve& response, const BracketOptions& options, Progress& progress,
                         const std::vector<PixelShift>& shifts) {
    MergedBracket merged;
    if (images.empty()) return merged;
    const int width = images[0].width, height = images[0].height;
    const size_t count = images.size(), pixels = size_t(width) * height;
    merged.image = Image(width, height);
    merged.ghost.assign(pixels, 0);
    merged.clipped.assign(pixels, 0);
    const std::vector<size_t> order = fromShortest(exposures);
    merged.shifts = shifts;

    // Variance of ln radiance by code; the inverse counts, 0 where clipped; a ramp, so that no step shows where an
    // exposure drops out.
    constexpr double top = highestCode, ramp = 12;
    std::array<std::array<double, codes>, 3> variance{};
    std::array<double, codes> fade{};
    for (size_t c = 0; c < 3; ++c)
        for (int z = 0; z < codes; ++z) {
            double sigma = slopeAt(response.logExposure[c], z) * response.noise[size_t(z)];
            if (response.linear) sigma = response.noise[size_t(z)] / std::max(z, 1);
            fade[size_t(z)] = std::clamp(std::min((top - z) / ramp, (z - lowestCode + 1) / 4.0), 0.0, 1.0);
            variance[c][size_t(z)] = sigma * sigma;
        }
    const auto slope = [&](size_t c, double z) {
        return response.linear ? 1 / std::max(z, 1.0) : slopeAt(response.logExposure[c], z);
    };
    const EdgeNoise edges(images, exposures, response, slope);
    merged.misfit = float(std::sqrt(edges.variance));
    double full = std::numeric_limits<double>::infinity();
    for (int c = 0; c < 3; ++c) full = std::min(full, response.exposure(c, top));
    merged.saturation = float(full / exposures[order[0]]);

    // What moved is shown as it was in the best exposure.
    const size_t best =
        size_t(std::find(order.begin(), order.end(), bestExposed(images, order)) - order.begin());  // place in `order`

    progress.begin("Merging exposures", size_t(height));
    parallelFor(
        size_t(height), 8,
        [&](size_t row) {
            const int y = int(row);
            std::vector<std::array<double, 3>> code(count), radiance(count);
            std::vector<uint8_t> kept(count);
            for (int x = 0; x < width; ++x) {
                const size_t pixel = size_t(y) * width + x;
                for (size_t i = 0; i < count; ++i) {
                    const uint16_t* z = images[i].at(x, y);
                    for (size_t c = 0; c < 3; ++c) {
                        code[i][c] = double(z[c]) / 257;
                        radiance[i][c] = response.exposure(int(c), code[i][c]) / exposures[i];
                    }
                    const auto inside = [&](const PixelShift& s) {
                        return x + s.x >= 0 && x + s.x < width && y + s.y >= 0 && y + s.y < height;
                    };
                    kept[i] = shifts.empty() || inside(shifts[i]);
                }
                if (options.rejectGhosts && count > 1) {
                    // The anchor: the best exposure, or the nearest to it that is neither clipped nor black here.
                    const auto usable = [&](size_t i) {
                        const double most = std::max({code[i][0], code[i][1], code[i][2]});
                        return kept[i] && most < 240 && most > 20;
                    };
                    size_t anchor = count;
                    for (size_t step = 0; step < count && anchor == count; ++step)
                        for (const size_t k : {best + step, best - step})
                            if (k < count && usable(order[k])) {
                                anchor = order[k];
                                break;
                            }
                    for (size_t i = 0; anchor < count && i < count; ++i) {
                        if (i == anchor || !kept[i]) continue;
                        for (size_t c = 0; c < 3; ++c) {
                            const double a = code[anchor][c];
                            if (a < 12 || a > 245) continue;
                            const double predicted = response.code(int(c), radiance[anchor][c] * exposures[i]);
                            if (predicted < 4 && code[i][c] < 16) continue;
                            if (predicted > 243 && code[i][c] > 235) continue;
                            // Noise of both, the anchor's carried over in ln exposure, and room for what no curve
                            // explains.
                            const double carried = response.linear ? at(response.noise, a) * predicted / a
                                                                   : slopeAt(response.logExposure[c], a) /
                                                                         slopeAt(response.logExposure[c], predicted) *
                                                                         at(response.noise, a);
                            const double allowed = 6 + 5 * std::min(carried, 12.0) + 5 * at(response.noise, predicted);
                            if (std::abs(code[i][c] - predicted) <= allowed) continue;
                            // At edges a shift of half a pixel explains much.
                            double low = 255, high = 0;
                            for (int dy = -1; dy <= 1; ++dy)
                                for (int dx = -1; dx <= 1; ++dx) {
                                    const int nx = std::clamp(x + dx, 0, width - 1),
                                              ny = std::clamp(y + dy, 0, height - 1);
                                    const double z = double(images[i].at(nx, ny)[c]) / 257;
                                    low = std::min(low, z), high = std::max(high, z);
                                }
                            if (std::abs(code[i][c] - predicted) <= allowed + (high - low)) continue;
                            kept[i] = 0;
                            merged.ghost[pixel] = 1;
                        }
                    }
                }
                bool clipped = false;
                for (size_t c = 0; c < 3; ++c) {
                    double sum = 0, weights = 0;
                    const double edge = edges.at(x, y, c);
                    const auto weightAt = [&](double z) { return at(fade, z) / (at(variance[c], z) + edge); };
                    for (size_t i = 0; i < count; ++i) {
                        if (!kept[i]) continue;
                        const double w = weightAt(code[i][c]);
                        sum += w * radiance[i][c], weights += w;
                    }
                    if (weights > 0) {
                        const double estimate = sum / weights;
                        sum = weights = 0;
                        for (size_t i = 0; i < count; ++i) {
                            if (!kept[i] || code[i][c] > 253.5) continue;
                            const double w = weightAt(response.code(int(c), estimate * exposures[i]));
                            sum += w * radiance[i][c], weights += w;
                        }
                        merged.image.pixels[pixel][int(c)] = float(weights > 0 ? sum / weights : estimate);
                        continue;
                    }
                    // Clipped in all that is left, or dark in all: the shortest, or the longest, says the most.
                    size_t shortest = count, longest = count;
                    for (const size_t i : order)
                        if (kept[i]) {
                            if (shortest == count) shortest = i;
                            longest = i;
                        }
                    const bool bright = code[shortest][c] > 128;
                    clipped |= bright;
                    merged.image.pixels[pixel][int(c)] =
                        bright
                            ? std::max(float(response.exposure(int(c), top) / exposures[shortest]), merged.saturation)
                            : float(radiance[longest][c]);
                    if (!bright && code[longest][c] < 0.5)
                        merged.image.pixels[pixel][int(c)] =
                            0.5f * float(response.exposure(int(c), 0.5) / exposures[longest]);
                }
                merged.clipped[pixel] = clipped;
            }
        },
        &progress);

    // A lone pixel is noise; what moves comes in patches.
    if (options.rejectGhosts) {
        std::vector<uint8_t> patches(pixels, 0);
        parallelFor(size_t(height), 32, [&](size_t y) {
            for (int x = 0; x < width; ++x) {
                if (!merged.ghost[y * width + x]) continue;
                int around = 0;
                for (int dy = -1; dy <= 1; ++dy)
                    for (int dx = -1; dx <= 1; ++dx) {
                        const int nx = x + dx, ny = int(y) + dy;
                        if (nx >= 0 && ny >= 0 && nx < width && ny < height)
                            around += merged.ghost[size_t(ny) * width + nx];
                    }
                patches[y * width + x] = around >= 4;
            }
        });
        merged.ghost.swap(patches);
    }
    const size_t longest = order.back();
    for (size_t p = 0; p < pixels; ++p) {
        merged.ghosts += merged.ghost[p];
        merged.clippedPixels += merged.clipped[p];
        const uint16_t* z = &images[longest].codes[p * 3];
        merged.dark += std::max({z[0], z[1], z[2]}) < uint16_t(lowestCode * 257);
    }
    if (merged.ghosts) {
        merged.image.usable.assign(pixels, 1);
        for (size_t p = 0; p < pixels; ++p) merged.image.usable[p] = !merged.ghost[p];
    }
    return merged;
}

MergedBracket mergeBracket(const Bracket& set, const ResponseCurve& response, const BracketOptions& options,
                           Progress& progress) {
    const ReadSet read = readSet(set, options, progress);
    return mergeCodes(read.images, read.exposures, response, options, progress, read.shifts);
}

BracketPhoto bracketPhoto(const std::filesystem::path& file, ExposureTags tags, ExposureReference& reference) {
    if (!(tags.seconds > 0)) throw Error("{}: its exposure time is not given, and its EXIF has none", file.string());
    if (!reference.known) reference = {tags.aperture, tags.iso, true};
    double gain = 1;
    // Light through the lens goes with 1 / aperture^2, the signal with the sensitivity. Where one photograph says
    // nothing it is taken to be as the first.
    if (tags.aperture > 0 && reference.aperture > 0)
        gain *= (reference.aperture / tags.aperture) * (reference.aperture / tags.aperture);
    if (tags.iso > 0 && reference.iso > 0) gain *= tags.iso / reference.iso;
    return {file, tags.seconds * gain};
}

}  // namespace relamp
