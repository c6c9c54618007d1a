#include "pipeline/state_checks.h"

#include <map>

#include "base/log.h"
#include "base/statistics.h"
#include "capture/lighting_states.h"
#include "radiance/background_cells.h"

namespace relamp {
namespace {

constexpr size_t leastCells = 30;
constexpr uint32_t leastPixels = 4;  // of a cell
constexpr float mostGain = 0.15f, otherCell = 0.25f, mostOther = 0.33f;
constexpr int side = 32;

/// Background of one state, in cells of 6 degrees.
BackgroundCells cellsOf(const Capture& capture, const RadianceSamples& samples, uint32_t state) {
    const DirectionGrid grid{side};
    BackgroundCells sum{std::vector<Rgb>(size_t(grid.cells()), Rgb(0)), std::vector<uint32_t>(size_t(grid.cells()), 0)};
    for (size_t i = 0; i < capture.views.size(); ++i) {
        if (capture.views[i].state != state) continue;
        const BackgroundCells one = backgroundCells(capture.views[i], samples.geometry[i], grid);
        for (size_t cell = 0; cell < sum.sum.size(); ++cell) {
            sum.sum[cell] += one.sum[cell];
            sum.pixels[cell] += one.pixels[cell];
        }
    }
    return sum;
}

}  // namespace

std::vector<std::string> warnOfOtherEnvironments(const Capture& capture, const RadianceSamples& samples) {
    std::vector<std::string> warnings;
    std::map<int, std::pair<uint32_t, BackgroundCells>> seen;  // by environment: its first state
    for (uint32_t s = 0; samples.states > 1 && s < samples.states; ++s) {
        const int environment = samples.environmentOf(s);
        if (environment < 0) continue;
        const auto [at, isFirst] = seen.try_emplace(environment, s, cellsOf(capture, samples, s));
        if (isFirst) continue;
        const auto& [firstState, first] = at->second;
        const BackgroundCells other = cellsOf(capture, samples, s);
        std::vector<float> change;
        for (size_t cell = 0; cell < first.sum.size(); ++cell) {
            if (first.pixels[cell] < leastPixels || other.pixels[cell] < leastPixels) continue;
            const float a = luminance(first.mean(cell)), b = luminance(other.mean(cell));
            if (std::max(a, b) > 20 * samples.noiseFloor)
                change.push_back(std::log(std::max(b, samples.noiseFloor) / std::max(a, samples.noiseFloor)));
        }
        if (change.size() < leastCells) continue;
        const float gain = medianOf(change);
        const float differs =
            float(std::count_if(change.begin(), change.end(), [](float c) { return std::abs(c) > otherCell; })) /
            float(change.size());
        const std::string &before = capture.states[firstState], &now = capture.states[s];
        logInfo("background of states {} and {}: {:+.1f} %, {:.0f} % of it differs", before, now,
                100 * (std::exp(gain) - 1), 100 * differs);
        if (std::abs(gain) <= mostGain && differs <= mostOther) continue;
        warnings.push_back(fmt::format(
            "the background that states {} and {} show differs by {:.0f} %, {:.0f} % of it by more than 25 %: the "
            "exposure or the environment has changed. {}",
            before, now, 100 * (std::exp(std::abs(gain)) - 1), 100 * differs, howToSayOwnEnvironment(now)));
        logWarning("{}", warnings.back());
    }
    return warnings;
}

}  // namespace relamp
