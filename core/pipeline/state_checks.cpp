#include "pipeline/state_checks.h"

#include "base/error.h"
#include "base/log.h"
#include "base/statistics.h"
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

void refuseOtherEnvironments(const Capture& capture, const RadianceSamples& samples) {
    if (samples.states == 1) return;
    const BackgroundCells first = cellsOf(capture, samples, 0);
    for (uint32_t s = 1; s < samples.states; ++s) {
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
        logInfo("background of states {} and {}: {:+.1f} %, {:.0f} % of it differs", capture.states[0],
                capture.states[s], 100 * (std::exp(gain) - 1), 100 * differs);
        if (std::abs(gain) > mostGain || differs > mostOther)
            throw Error(
                "the background that states {} and {} show differs by {:.0f} %, {:.0f} % of it by more than 25 %: the "
                "exposure or the environment has changed. Between lighting states only lights may change: use one "
                "exposure, and make a capture of each environment",
                capture.states[0], capture.states[s], 100 * (std::exp(std::abs(gain)) - 1), 100 * differs);
    }
}

}  // namespace relamp
