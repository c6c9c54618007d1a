#include "capture/response_curve.h"

#include <cmath>
#include <limits>

#include "base/error.h"
#include "base/parallel.h"
#include "base/random.h"
#include "base/statistics.h"
#include "capture/bracket_codes.h"

namespace relamp {
namespace {

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
void makeMonotone(CodeTable& g) {
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
CodeTable noiseOf(const std::vector<ResponseSample>& samples) {
    constexpr int bins = 16;
    std::array<std::vector<float>, bins> spreads;
    for (const ResponseSample& s : samples)
        for (const auto& observation : s.observations)
            for (size_t c = 0; c < 3; ++c)
                if (observation.code[c] > lowestCode && observation.code[c] < highestCode)
                    spreads[size_t(std::min(bins - 1, int(observation.code[c] / 16)))].push_back(observation.spread[c]);
    std::vector<std::pair<double, double>> knots;
    for (size_t b = 0; b < bins; ++b) {
        if (spreads[b].size() < 20) continue;
        knots.emplace_back(16.0 * double(b) + 8, std::max(double(medianOf(std::move(spreads[b]))), lowestNoise));
    }
    CodeTable noise;
    noise.fill(1);
    if (knots.empty()) return noise;
    for (int z = 0; z < bracketCodes; ++z) {
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
    CodeTable g{};
    double chi = 0;
    size_t observations = 0;
};

/// One observation of one pixel in one channel as the equations see it.
struct Term {
    int knot;
    double fraction, logExposure, weight;
};

/// Which observations of a sample count in a channel, with their weights for the present curve.
void termsOf(const ResponseSample& sample, size_t channel, const CodeTable& g, const CodeTable& noise, bool first,
             std::vector<Term>& terms) {
    terms.clear();
    for (const auto& observation : sample.observations) {
        const double z = double(observation.code[channel]);
        if (z < lowestCode || z > highestCode) continue;
        Term t{std::min(int(z), bracketCodes - 2), 0, observation.logExposure, 0};
        t.fraction = z - t.knot;
        if (first) {
            t.weight = std::min(z, 255 - z) / 64;  // the hat of [DM97]
        } else {
            // A mean over nine pixels still holds a third of the noise, and texture.
            const double sigma = slopeAt(g, z) * (0.4 * atCode(noise, z) + 0.15);
            t.weight = 1 / (sigma * sigma);
        }
        terms.push_back(t);
    }
}

ChannelFit fitChannel(const std::vector<ResponseSample>& samples, size_t channel, const CodeTable& noise,
                      double smoothness) {
    constexpr size_t n = bracketCodes;
    ChannelFit fit;
    std::vector<Term> terms;
    constexpr int rounds = 6;
    for (int round = 0; round < rounds; ++round) {
        const bool first = round == 0;
        std::vector<double> a(n * n, 0.0), b(n, 0.0);
        fit.chi = 0;
        fit.observations = 0;
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
                        const double z = t.knot + t.fraction,
                                     sigma = slopeAt(fit.g, z) * (0.4 * atCode(noise, z) + 0.15);
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
                ++fit.observations;
            }
        }
        if (fit.observations < 20)
            throw Error("only {} observations are well exposed in two exposures or more, so there is no response curve",
                        fit.observations);
        // Curvature over u = ln(code + 1/2), in which a power law is straight. The weight stands to the data's as one
        // observation does.
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
    return linear ? std::max(code, 0.0) / 255 : std::exp(atCode(logExposure[size_t(channel)], code));
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
    for (size_t z = 0; z < bracketCodes; ++z) {
        for (auto& g : curve.logExposure) g[z] = std::log(std::max(double(z), 0.25) / 255);
        curve.noise[z] = 0.3;
    }
    return curve;
}

ResponseCurve fitResponse(const std::vector<ResponseSample>& samples, double smoothness) {
    double shortest = std::numeric_limits<double>::infinity(), longest = -shortest;
    for (const ResponseSample& s : samples)
        for (const auto& observation : s.observations) {
            shortest = std::min(shortest, observation.logExposure);
            longest = std::max(longest, observation.logExposure);
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
        double chi = 0, observations = 0;
        for (const ChannelFit& fit : fits[step]) chi += fit.chi, observations += double(fit.observations);
        residual[step] = std::sqrt(chi / std::max(observations, 1.0));
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
            ResponseSample::Observation observation;
            observation.logExposure = std::log(exposures[i]);
            for (size_t c = 0; c < 3; ++c) {
                float range;
                summary(images[i], place.x, place.y, c, observation.code[c], observation.spread[c], range);
                // A clipped pixel among the nine pulls the mean: outside the range that counts.
                if (observation.code[c] + 0.5f * range > float(highestCode) + 3) observation.code[c] = 255;
                if (observation.code[c] - 0.5f * range < 0.5f) observation.code[c] = 0;
            }
            sample.observations.push_back(observation);
        }
        samples.push_back(std::move(sample));
    }
    return samples;
}

}  // namespace relamp
