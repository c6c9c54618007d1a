// The error-against-run-time plot: two logarithmic axes, values under the pointer, and the same curves as CSV and SVG.
#pragma once
#include <imgui.h>

#include <array>
#include <string>
#include <vector>

#include "display/log_plot.h"
#include "editor_state.h"

namespace relamp::ui {

struct PlotRange {
    double low = 1, high = 10;  ///< both positive
};
/// Encloses all positive values with a little air; {1, 10} when there is none. At least a factor of 1.2.
PlotRange plotRange(const std::vector<PlotCurve>& curves, bool alongX);
/// 1, 2, 5 times powers of ten inside the range, at most `most` of them (then powers of ten, then some of those).
std::vector<double> plotTicks(const PlotRange& range, int most);

/// Near-field and distant-only as curves; empty ones are left out.
std::vector<PlotCurve> timelineCurves(const std::array<RunCurve, 2>& curves);
/// mode,seconds,stage,iteration,objective,rmse
std::string timelineCsv(const std::array<RunCurve, 2>& curves);
/// Empty when there is nothing to draw.
std::string timelineSvg(const std::array<RunCurve, 2>& curves);

/// Fills `size`; `empty` is shown when no point can be drawn.
void drawLogPlot(const char* id, const std::vector<PlotCurve>& curves, const char* xLabel, const char* yLabel,
                 const ImVec2& size, const std::string& empty);

}  // namespace relamp::ui
