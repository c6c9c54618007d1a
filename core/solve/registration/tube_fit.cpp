#include "solve/registration/tube_fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "base/coordinate_search.h"
#include "base/log.h"
#include "base/parallel.h"
#include "capture/view_pixels.h"

namespace relamp {
namespace {

constexpr double tubeMargin = 5;     ///< pixels of background beside the tube that are looked at
constexpr double tubeSpacing = 0.5;  ///< pixels between values of a profile
constexpr double firstBlur = 0.5;    ///< pixels: standard deviation of an edge
constexpr double leastBlur = 0.25, mostBlur = 1.5;
constexpr double widestTube = 40;      ///< pixels from its axis to its side: farther, mesh tells more
constexpr double narrowestTube = 0.7;  ///< pixels
constexpr size_t mostPlaces = 48;      ///< along it
constexpr size_t leastProfiles = 60;
constexpr double otherRadius = 1.25;                       ///< that must explain photographs clearly worse
constexpr double roughRadius = 1.6;                        ///< the same where the mesh's is farther off than that
constexpr double clearlyWorse = 0.1, roughlyWorse = 0.05;  ///< mean of the log residual
constexpr double tubeNoise = 0.02;  ///< of a value, relative to the profile's mean: what no model explains
constexpr size_t tubeColumns = 7;

/// What a view shows across the tube at one place along it.
struct TubeProfile {
    uint32_t view = 0;
    double along = 0;  ///< metres
    DVec3 side{0};     ///< unit: from the axis to the side that the camera sees
    Vec2 middle{0}, across{0};
    std::vector<double> values[3];  ///< from -reach on
    double reach = 0;               ///< pixels
    size_t size() const { return values[0].size(); }
};

std::optional<TubeProfile> profileOf(const Capture& capture, const Scene& scene, const StraightTube& tube,
                                     uint32_t view, double along, float floor) {
    const View& photograph = capture.views[view];
    const Camera& camera = photograph.camera;
    const DVec3 eye = camera.position(), place = tube.onAxis(along), to = place - eye;
    const double distance = glm::length(to);
    TubeProfile p{view, along, glm::cross(tube.axes[0], to), {}, {}, {}, 0};
    if (!(glm::length(p.side) > 0.3 * distance)) return {};  // seen along it
    p.side = glm::normalize(p.side);
    // Whatever is of the tube itself does not hide it.
    const Hit hit = scene.cameraTracer->closest({Vec3(eye), Vec3(to / distance)});
    if (hit && double(hit.distance) < distance - 2.5 * tube.radius) return {};
    const auto middle = camera.project(place), rim = camera.project(place + tube.radius * p.side),
               next = camera.project(tube.onAxis(along + tube.radius));
    if (!middle || !rim || !next) return {};
    const Vec2 ahead = *next - *middle;
    const float length = glm::length(ahead);
    const double half = double(glm::length(*rim - *middle));
    if (!(length > 0) || half < narrowestTube || half > widestTube) return {};
    p.middle = *middle;
    p.across = Vec2(ahead.y, -ahead.x) / length;
    if (glm::dot(p.across, *rim - *middle) < 0) p.across = -p.across;
    const auto count = size_t(std::ceil((1.5 * half + tubeMargin) / tubeSpacing));
    p.reach = double(count) * tubeSpacing;
    double mean[3] = {double(floor), double(floor), double(floor)};
    for (size_t j = 0; j <= 2 * count; ++j) {
        Rgb sum(0);
        for (int k = -1; k <= 1; ++k) {
            const Vec2 at = p.middle + float(double(j) * tubeSpacing - p.reach) * p.across + float(k) * ahead / length;
            const std::optional<Rgb> value = radianceAt(photograph, at, false);
            if (!value) return {};
            sum += *value;
        }
        for (int c = 0; c < 3; ++c) {
            p.values[c].push_back(double(sum[c]) / 3);
            mean[c] += double(sum[c]) / 3 / double(2 * count + 1);
        }
    }
    for (int c = 0; c < 3; ++c)
        for (double& v : p.values[c]) v /= mean[c];
    return p;
}

/// Mean square of a profile's values that background, tube and background leave when the tube's sides lie at `low` and
/// `high`, pixels.
double leftOver(const TubeProfile& p, double low, double high, double blur) {
    const size_t n = p.size();
    thread_local std::vector<double> columns, values;
    columns.resize(tubeColumns * n);
    const double soft = blur * std::sqrt(2.0), middle = (low + high) / 2, half = std::max(0.5, (high - low) / 2);
    for (size_t j = 0; j < n; ++j) {
        const double x = double(j) * tubeSpacing - p.reach, left = 0.5 * std::erfc((x - low) / soft),
                     right = 0.5 * std::erfc((high - x) / soft), in = 1 - left - right, t = (x - middle) / half;
        const double of[tubeColumns] = {left, left * (x - low), right, right * (x - high), in, in * t, in * t * t};
        for (size_t k = 0; k < tubeColumns; ++k) columns[k * n + j] = of[k];
    }
    double sum = 0;
    for (size_t c = 0; c < 3; ++c) {
        values.assign(p.values[c].begin(), p.values[c].end());
        for (size_t k = 0; k < tubeColumns; ++k) {
            double* const column = &columns[k * n];
            if (c == 0) {  // orthonormal, once
                double length = 0;
                for (size_t i = 0; i < k; ++i) {
                    double along = 0;
                    for (size_t j = 0; j < n; ++j) along += columns[i * n + j] * column[j];
                    for (size_t j = 0; j < n; ++j) column[j] -= along * columns[i * n + j];
                }
                for (size_t j = 0; j < n; ++j) length += column[j] * column[j];
                const double scale = length > 1e-12 ? 1 / std::sqrt(length) : 0;
                for (size_t j = 0; j < n; ++j) column[j] *= scale;
            }
            double along = 0;
            for (size_t j = 0; j < n; ++j) along += values[j] * column[j];
            for (size_t j = 0; j < n; ++j) values[j] -= along * column[j];
        }
        for (const double v : values) sum += v * v / double(3 * n);
    }
    return sum;
}

/// What photographs show of a tube rests on how sharp they are.
struct BlurredTube {
    StraightTube tube;
    double blur = firstBlur;  ///< pixels
};

/// Shifts of the axis at its two ends along its two other axes, and of the radius, in radii; of the blur, in pixels.
using TubeMotion = std::array<double, 6>;

BlurredTube moved(const BlurredTube& start, const TubeMotion& by) {
    const StraightTube& tube = start.tube;
    const auto end = [&](double along, double a, double b) {
        return tube.onAxis(along) + tube.radius * (a * tube.axes[1] + b * tube.axes[2]);
    };
    StraightTube out = tube;
    const DVec3 first = end(tube.from, by[0], by[1]), last = end(tube.to, by[2], by[3]);
    out.axes[0] = glm::normalize(last - first);
    out.axes[1] = glm::normalize(tube.axes[1] - glm::dot(tube.axes[1], out.axes[0]) * out.axes[0]);
    out.axes[2] = glm::cross(out.axes[0], out.axes[1]);
    out.through = first - tube.from * out.axes[0];
    out.radius = tube.radius * (1 + by[4]);
    return {out, start.blur + by[5]};
}

/// Mean over the profiles of the log of what the tube leaves unexplained.
double lossOf(const Capture& capture, const std::vector<TubeProfile>& profiles, const BlurredTube& model) {
    const StraightTube& tube = model.tube;
    return parallelSum(profiles.size(), 16, 0.0, [&](size_t begin, size_t end) {
        double sum = 0;
        for (size_t i = begin; i < end; ++i) {
            const TubeProfile& p = profiles[i];
            const Camera& camera = capture.views[p.view].camera;
            const DVec3 place = tube.onAxis(p.along);
            const auto low = camera.project(place - tube.radius * p.side),
                       high = camera.project(place + tube.radius * p.side);
            const double left = low && high ? leftOver(p, double(glm::dot(*low - p.middle, p.across)),
                                                       double(glm::dot(*high - p.middle, p.across)), model.blur)
                                            : 1;
            sum += std::log(left + tubeNoise * tubeNoise) / double(profiles.size());
        }
        return sum;
    });
}

/// The best tube within one and a half radii of `tube`. `least`: what it leaves.
BlurredTube searched(const Capture& capture, const std::vector<TubeProfile>& profiles, const BlurredTube& start,
                     double& least, const Progress& progress) {
    TubeMotion best{};
    least = coordinateSearch(best, lossOf(capture, profiles, start), 0.25, 0.005, [&](const TubeMotion& tried) {
        constexpr double never = std::numeric_limits<double>::infinity();
        progress.check();
        for (const double by : tried)
            if (std::abs(by) > 1.5) return never;
        const BlurredTube there = moved(start, tried);
        if (tried[4] < -0.5 || there.blur < leastBlur || there.blur > mostBlur) return never;
        return lossOf(capture, profiles, there);
    });
    return moved(start, best);
}

}  // namespace

std::optional<StraightTube> fitTube(const Capture& capture, const Scene& scene, const StraightTube& start, float floor,
                                    const Progress& progress) {
    const double length = start.to - start.from;
    const auto places = size_t(std::clamp(2 * length / start.radius, 4.0, double(mostPlaces)));
    std::vector<TubeProfile> profiles;
    BlurredTube model{start};
    const StraightTube& found = model.tube;
    double before = 0, least = 0;
    // Twice: a mesh bends a post by as much as its radius, and profiles lie about the present axis.
    for (int round = 0; round < 2; ++round) {
        profiles.clear();
        for (uint32_t view = 0; view < capture.views.size(); ++view)
            for (size_t k = 0; k < places; ++k)
                if (auto p = profileOf(capture, scene, found, view,
                                       found.from + length * (double(k) + 0.5) / double(places), floor))
                    profiles.push_back(std::move(*p));
        if (profiles.size() < leastProfiles) return {};
        before = lossOf(capture, profiles, model);
        model = searched(capture, profiles, model, least, progress);
    }
    const auto otherwise = [&](double factor) {
        double best = 1e30;
        for (const double by : {factor, 1 / factor}) {
            BlurredTube thicker = model;
            thicker.tube.radius *= by;
            best = std::min(best, lossOf(capture, profiles, thicker));
        }
        return best;
    };
    const double other = otherwise(otherRadius), rough = otherwise(roughRadius);
    logInfo(
        "tube of {:.1f} mm radius, {:.0f} mm long: {} profiles, shifted by {:.2f} and {:.2f} mm, radius {:+.2f} mm, "
        "log residual {:.2f} ({:.2f} before, {:.2f} and {:.2f} with radii a quarter and 1.6 times off), edges of "
        "{:.2f} pixels",
        1000 * found.radius, 1000 * length, profiles.size(),
        1000 * glm::length(found.onAxis(found.from) - start.onAxis(start.from)),
        1000 * glm::length(found.onAxis(found.to) - start.onAxis(start.to)), 1000 * (found.radius - start.radius),
        least, before, other, rough, model.blur);
    const bool farOff = std::max(found.radius / start.radius, start.radius / found.radius) > roughRadius;
    const bool clear = least + clearlyWorse < other, known = farOff && least + roughlyWorse < rough;
    if (!clear && !known) return {};
    return found;
}

}  // namespace relamp
