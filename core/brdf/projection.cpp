#include "brdf/projection.h"

#include <array>
#include <limits>
#include <numeric>

#include "base/parallel.h"

namespace relamp {
namespace {

/// Solves the rows and columns `set` of A x = b; small ridge, because neighbouring lobes are nearly the same.
bool solveOn(const std::vector<double>& a, const std::vector<double>& b, const std::vector<size_t>& set,
             std::vector<double>& x) {
    const size_t n = b.size(), m = set.size();
    std::vector<double> l(m * m);
    x.assign(m, 0);
    for (size_t j = 0; j < m; ++j)
        for (size_t i = j; i < m; ++i) {
            double sum = a[set[i] * n + set[j]];
            if (i == j) sum *= 1 + 1e-11;
            for (size_t k = 0; k < j; ++k) sum -= l[i * m + k] * l[j * m + k];
            if (i == j) {
                if (!(sum > 0)) return false;
                l[i * m + j] = std::sqrt(sum);
            } else {
                l[i * m + j] = sum / l[j * m + j];
            }
        }
    for (size_t i = 0; i < m; ++i) {
        x[i] = b[set[i]];
        for (size_t k = 0; k < i; ++k) x[i] -= l[i * m + k] * x[k];
        x[i] /= l[i * m + i];
    }
    for (size_t i = m; i-- > 0;) {
        for (size_t k = i + 1; k < m; ++k) x[i] -= l[k * m + i] * x[k];
        x[i] /= l[i * m + i];
    }
    return true;
}

/// Roughnesses in a geometric ladder.
std::vector<float> ladder(float sharpest, float widest, int steps) {
    std::vector<float> result;
    result.reserve(size_t(steps));
    for (int i = 0; i < steps; ++i)
        result.push_back(sharpest * std::pow(widest / sharpest, float(i) / float(steps - 1)));
    return result;
}

/// BRDF x cosine below which the cube root's weight no longer grows: black materials would be fitted to their noise.
constexpr double darkest = 1e-4;

}  // namespace

std::vector<NamedLobe> lobesOf(const BrdfBasis& basis) {
    std::vector<NamedLobe> lobes;
    for (const Lobe& lobe : basis.lobes)
        lobes.push_back({lobe.name, [lobe](const Vec3& l, const Vec3& e) { return evaluateLobe(lobe, l, e); }});
    return lobes;
}

std::vector<NamedLobe> lobeDictionary() {
    std::vector<NamedLobe> lobes;
    lobes.push_back({"lambert", [](const Vec3& l, const Vec3& e) { return lambert(l, e); }});
    for (const float r : ladder(0.03f, 0.9f, 14)) {
        const float alpha = r * r;
        lobes.push_back(
            {fmt::format("ggx {:.3f}", r), [alpha](const Vec3& l, const Vec3& e) { return ggx(l, e, alpha); }});
        lobes.push_back({fmt::format("ggx dielectric {:.3f}", r),
                         [alpha](const Vec3& l, const Vec3& e) { return ggxDielectric(l, e, alpha); }});
        lobes.push_back({fmt::format("ggx grazing {:.3f}", r),
                         [alpha](const Vec3& l, const Vec3& e) { return ggxGrazing(l, e, alpha); }});
        lobes.push_back({fmt::format("cook-torrance {:.3f}", r),
                         [alpha](const Vec3& l, const Vec3& e) { return cookTorrance(l, e, alpha); }});
    }
    for (const float r : ladder(0.05f, 0.8f, 6)) {
        const float alpha = r * r;
        lobes.push_back(
            {fmt::format("ward {:.3f}", r), [alpha](const Vec3& l, const Vec3& e) { return ward(l, e, alpha); }});
    }
    // Backscatter of cloth and paint, and forward scatter towards grazing.
    for (const float exponent : {1.0f, 2.0f, 4.0f, 8.0f, 16.0f, 64.0f})
        lobes.push_back({fmt::format("lafortune back {:.0f}", exponent),
                         [exponent](const Vec3& l, const Vec3& e) { return lafortune(l, e, -1, 1, exponent); }});
    for (const float exponent : {1.0f, 2.0f, 4.0f, 8.0f})
        lobes.push_back({fmt::format("lafortune forward {:.0f}", exponent),
                         [exponent](const Vec3& l, const Vec3& e) { return lafortune(l, e, 1, 0, exponent); }});
    return lobes;
}

std::vector<double> nonNegativeLeastSquares(const std::vector<double>& gram, const std::vector<double>& moment,
                                            const std::vector<size_t>& allowed) {
    const size_t n = moment.size();
    std::vector<uint8_t> may(n, allowed.empty()), active(n, 0), tired(n, 0);
    for (const size_t k : allowed) may[k] = 1;
    std::vector<double> x(n, 0), inner;
    std::vector<size_t> set;
    double tolerance = 0;
    for (size_t k = 0; k < n; ++k)
        if (gram[k * n + k] > 0)
            tolerance = std::max(tolerance, 1e-10 * std::abs(moment[k]) / std::sqrt(gram[k * n + k]));
    for (size_t round = 0; round < 4 * n + 10; ++round) {
        // The free column that pulls most, in units of its own length.
        size_t enter = n;
        double most = tolerance;
        for (size_t k = 0; k < n; ++k) {
            if (!may[k] || active[k] || tired[k] || !(gram[k * n + k] > 0)) continue;
            double gradient = moment[k];
            for (size_t j = 0; j < n; ++j) gradient -= gram[k * n + j] * x[j];
            if (const double pull = gradient / std::sqrt(gram[k * n + k]); pull > most) {
                most = pull;
                enter = k;
            }
        }
        if (enter == n) break;
        active[enter] = 1;
        for (;;) {
            set.clear();
            for (size_t k = 0; k < n; ++k)
                if (active[k]) set.push_back(k);
            if (!solveOn(gram, moment, set, inner)) {
                active[enter] = 0;
                tired[enter] = 1;
                break;
            }
            double step = 1;
            for (size_t i = 0; i < set.size(); ++i)
                if (inner[i] <= 0) step = std::min(step, x[set[i]] / (x[set[i]] - inner[i] + 1e-300));
            bool dropped = false;
            for (size_t i = 0; i < set.size(); ++i) {
                const size_t k = set[i];
                x[k] += step * (inner[i] - x[k]);
                if (step < 1 && inner[i] <= 0 && x[k] <= 1e-14 * std::abs(inner[i]) + 1e-300) {
                    x[k] = 0;
                    active[k] = 0;
                    tired[k] = k == enter;  // rounding let it in
                    dropped = true;
                }
            }
            if (step >= 1) {
                std::fill(tired.begin(), tired.end(), uint8_t(0));
                break;
            }
            if (!dropped) break;
        }
    }
    return x;
}

std::vector<BrdfSample> brdfSamples(int detail) {
    std::vector<BrdfSample> samples;
    constexpr int azimuths = 16;
    for (int e = 0; e <= 5; ++e) {
        const double eyeAngle = e * piD / 12;
        const DVec3 eye(std::sin(eyeAngle), 0, std::cos(eyeAngle));
        for (int i = 0; i < detail; ++i) {
            const auto angle = [&](double place) { return place * place / (double(detail) * detail) * 0.5 * piD; };
            const double low = angle(i), high = angle(i + 1), theta = angle(i + 0.5);
            for (int k = 0; k < azimuths; ++k) {
                const double phi = (k + 0.5) / azimuths * piD;  // the other half is its mirror image
                const DVec3 h(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta));
                const double cosine = glm::dot(eye, h);
                if (!(cosine > 0)) continue;
                const DVec3 light = 2 * cosine * h - eye;
                // Grazing light is where nothing was measured well.
                if (!(light.z > 0.08)) continue;
                const double solid = (std::cos(low) - std::cos(high)) * 2 * piD / azimuths * 4 * cosine;
                samples.push_back({Vec3(light), Vec3(eye), float(solid)});
            }
        }
    }
    return samples;
}

std::pair<double, double> brdfErrors(const std::vector<BrdfSample>& samples, const std::vector<Rgb>& truth,
                                     const std::vector<Rgb>& model) {
    double difference = 0, size = 0, cube = 0, weights = 0;
    for (size_t i = 0; i < samples.size(); ++i) {
        const double cosine = double(samples[i].towardLight.z), w = double(samples[i].solidAngle);
        for (int c = 0; c < 3; ++c) {
            const double t = double(truth[i][c]) * cosine, m = double(model[i][c]) * cosine;
            difference += w * (t - m) * (t - m);
            size += w * t * t;
            const double r = std::cbrt(t) - std::cbrt(m);
            cube += w * r * r;
            weights += w;
        }
    }
    return {size > 0 ? std::sqrt(difference / size) : 0, weights > 0 ? std::sqrt(cube / weights) : 0};
}

BrdfFit projectBrdf(const BrdfFunction& truth, const std::vector<NamedLobe>& basis,
                    const std::vector<BrdfSample>& samples, FitMetric metric, size_t mostLobes, Progress& progress) {
    const size_t n = basis.size(), count = samples.size();
    std::vector<Rgb> values(count);
    std::vector<float> lobes(count * n);
    progress.begin("Fitting reflectance", count);
    parallelFor(
        count, 64,
        [&](size_t i) {
            values[i] = truth(samples[i].towardLight, samples[i].towardEye);
            for (size_t k = 0; k < n; ++k)
                lobes[i * n + k] = basis[k].value(samples[i].towardLight, samples[i].towardEye);
        },
        &progress);

    BrdfFit fit;
    fit.weights.assign(n, Rgb(0));
    struct Channel {
        std::vector<double> gram, moment;
        double size = 0;
    };
    std::array<Channel, 3> channels;
    for (size_t c = 0; c < 3; ++c) {
        Channel& channel = channels[c];
        channel.gram.assign(n * n, 0);
        channel.moment.assign(n, 0);
        for (size_t i = 0; i < count; ++i) {
            const double cosine = double(samples[i].towardLight.z), t = double(values[i][int(c)]) * cosine;
            double w = double(samples[i].solidAngle);
            // d cbrt(t) = dt / (3 t^(2/3)).
            if (metric == FitMetric::cubeRoot) w *= std::pow(std::max(t, darkest), -4.0 / 3);
            for (size_t k = 0; k < n; ++k) {
                const double a = double(lobes[i * n + k]) * cosine;
                channel.moment[k] += w * a * t;
                for (size_t j = 0; j <= k; ++j) channel.gram[k * n + j] += w * a * double(lobes[i * n + j]) * cosine;
            }
            channel.size += w * t * t;
        }
        for (size_t k = 0; k < n; ++k)
            for (size_t j = 0; j < k; ++j) channel.gram[j * n + k] = channel.gram[k * n + j];
    }
    const auto objective = [&](const Channel& channel, const std::vector<double>& x) {
        double sum = channel.size;
        for (size_t k = 0; k < n; ++k) {
            double row = 0;
            for (size_t j = 0; j < n; ++j) row += channel.gram[k * n + j] * x[j];
            sum += x[k] * (row - 2 * channel.moment[k]);
        }
        return std::max(sum, 0.0) / std::max(channel.size, 1e-300);
    };
    std::vector<size_t> allowed;
    if (mostLobes && mostLobes < n) {
        // Greedy: one set of lobes for all channels.
        while (allowed.size() < mostLobes) {
            progress.check();
            std::vector<double> error(n, std::numeric_limits<double>::infinity());
            parallelFor(n, 1, [&](size_t k) {
                if (std::find(allowed.begin(), allowed.end(), k) != allowed.end()) return;
                std::vector<size_t> tried = allowed;
                tried.push_back(k);
                error[k] = 0;
                for (const Channel& channel : channels)
                    error[k] += objective(channel, nonNegativeLeastSquares(channel.gram, channel.moment, tried));
            });
            allowed.push_back(size_t(std::min_element(error.begin(), error.end()) - error.begin()));
        }
    }
    for (size_t c = 0; c < 3; ++c) {
        const std::vector<double> x = nonNegativeLeastSquares(channels[c].gram, channels[c].moment, allowed);
        for (size_t k = 0; k < n; ++k) fit.weights[k][int(c)] = float(x[k]);
    }
    std::vector<Rgb> model(count, Rgb(0));
    for (size_t i = 0; i < count; ++i)
        for (size_t k = 0; k < n; ++k) model[i] += fit.weights[k] * lobes[i * n + k];
    std::tie(fit.radianceError, fit.cubeRootError) = brdfErrors(samples, values, model);
    for (const Rgb& w : fit.weights) fit.lobes += maxChannel(w) > 0;
    return fit;
}

}  // namespace relamp
