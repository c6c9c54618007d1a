#include "solve/registration/step_edge.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "capture/view_pixels.h"

namespace relamp {
namespace {

constexpr float stepReach = 4;        ///< pixels
constexpr float stepSpacing = 0.25f;  ///< between places that are tried
constexpr float stepBlur = 0.6f;      ///< pixels: standard deviation of the step's edge
constexpr size_t stepPlaces = 33;
constexpr double clearlyBetter = 0.3;  ///< of the squared residual of a bend that a step may leave
constexpr double clearestBy = 0.6;     ///< of the squared residual of the next best step
constexpr float stepElsewhere = 1.5f;  ///< pixels
constexpr float leastStep = 6;         ///< standard deviations of a value

constexpr float stepAt(size_t k) { return stepSpacing * float(k) - stepReach; }
constexpr float profileAt(size_t j) { return profileStep * (float(j) - float(profileSize / 2)); }

using Column = std::array<double, profileSize>;

double product(const Column& a, const Column& b) {
    double sum = 0;
    for (size_t j = 0; j < profileSize; ++j) sum += a[j] * b[j];
    return sum;
}

/// Orthonormal columns that span the given ones.
std::vector<Column> orthonormal(std::vector<Column> columns) {
    for (size_t i = 0; i < columns.size(); ++i) {
        for (size_t k = 0; k < i; ++k) {
            const double along = product(columns[i], columns[k]);
            for (size_t j = 0; j < profileSize; ++j) columns[i][j] -= along * columns[k][j];
        }
        const double length = std::sqrt(product(columns[i], columns[i]));
        for (double& x : columns[i]) x /= length;
    }
    return columns;
}

/// Profiles with a step at each place, and with a bend there.
struct Models {
    std::array<std::vector<Column>, stepPlaces> step, bend;

    Models() {
        for (size_t k = 0; k < stepPlaces; ++k) {
            std::vector<Column> steps(4), bends(3);
            for (size_t j = 0; j < profileSize; ++j) {
                const double off = double(profileAt(j) - stepAt(k));
                const double beyond = 0.5 * std::erfc(-off / (double(stepBlur) * std::sqrt(2.0)));
                steps[0][j] = 1 - beyond;
                steps[1][j] = beyond;
                steps[2][j] = (1 - beyond) * off;
                steps[3][j] = beyond * off;
                bends[0][j] = 1;
                bends[1][j] = off;
                bends[2][j] = std::max(0.0, off);
            }
            step[k] = orthonormal(std::move(steps));
            bend[k] = orthonormal(std::move(bends));
        }
    }
};

}  // namespace

std::optional<Profile> profileAcross(const View& view, const Vec2& middle, const Vec2& outward, float floor) {
    const Vec2 beside(-outward.y, outward.x);
    Profile profile;
    Rgb mean(floor);
    for (size_t j = 0; j < profileSize; ++j) {
        Rgb sum(0);
        for (int k = -1; k <= 1; ++k) {
            const std::optional<Rgb> value =
                radianceAt(view, middle + profileAt(j) * outward + float(k) * beside, false);
            if (!value) return {};
            sum += *value;
        }
        profile[j] = sum / 3.0f;
        mean += profile[j] / float(profileSize);
    }
    for (Rgb& value : profile) value /= mean;
    return profile;
}

std::optional<float> findStep(const Profile& profile, float noise) {
    static const Models models;
    std::array<Column, 3> values{};
    double energy = 0;
    for (size_t c = 0; c < 3; ++c) {
        double mean = 0;
        for (size_t j = 0; j < profileSize; ++j) mean += double(profile[j][int(c)]) / double(profileSize);
        for (size_t j = 0; j < profileSize; ++j) values[c][j] = double(profile[j][int(c)]) - mean;
        energy += product(values[c], values[c]);
    }
    const auto left = [&](const std::vector<Column>& model) {
        double explained = 0;
        for (const Column& value : values)
            for (const Column& column : model) {
                const double along = product(value, column);
                explained += along * along;
            }
        return std::max(0.0, energy - explained);
    };
    std::array<double, stepPlaces> residual{};
    for (size_t k = 0; k < stepPlaces; ++k) residual[k] = left(models.step[k]);
    const size_t best = size_t(std::min_element(residual.begin(), residual.end()) - residual.begin());
    if (best == 0 || best + 1 == stepPlaces) return {};
    const double without = left(models.bend[best]), floor = 1e-12 + 0.25 * double(noise * noise);
    if (!(residual[best] < clearlyBetter * without)) return {};
    if (without - residual[best] < double(leastStep * leastStep * noise * noise)) return {};
    for (size_t k = 0; k < stepPlaces; ++k)
        if (std::abs(stepAt(k) - stepAt(best)) > stepElsewhere &&
            residual[best] + floor > clearestBy * (residual[k] + floor))
            return {};
    // The lowest point of the parabola through three places.
    const double a = residual[best - 1], b = residual[best], c = residual[best + 1], bend = a - 2 * b + c;
    const double shift = bend > 0 ? std::clamp(0.5 * (a - c) / bend, -0.5, 0.5) : 0.0;
    return stepAt(best) + stepSpacing * float(shift);
}

}  // namespace relamp
