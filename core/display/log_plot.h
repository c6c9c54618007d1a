// A plot with two logarithmic axes as inline SVG.
#pragma once
#include <string>
#include <vector>

namespace relamp {

struct PlotPoint {
    double x = 0, y = 0;
    std::string note;  ///< shown when the pointer rests on the point; empty: no dot either
};

struct PlotCurve {
    std::string name;     ///< empty: not in the legend
    std::string colour;   ///< as in CSS
    bool dashed = false;  ///< so that colour alone need not tell curves apart
    std::vector<PlotPoint> points;
};

/// Points that are not positive have no place on a logarithmic axis and are left out. Empty when no point is left.
std::string logPlotSvg(const std::vector<PlotCurve>& curves, const std::string& xLabel, const std::string& yLabel);

}  // namespace relamp
