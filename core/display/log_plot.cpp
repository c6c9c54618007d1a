#include "display/log_plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "display/html.h"

namespace relamp {
namespace {

constexpr double width = 860, fieldHeight = 292, left = 78, right = 24, bottom = 52;

double legendWidth(const PlotCurve& curve) { return 80 + 7.2 * double(curve.name.size()); }

bool drawable(const PlotPoint& p) { return p.x > 0 && p.y > 0 && std::isfinite(p.x) && std::isfinite(p.y); }

/// One logarithmic axis: a little air at both ends, ticks at 1, 2, 5 times powers of ten.
struct Axis {
    double low = 1e300, high = 0;  // values
    double from = 0, to = 1;       // pixels

    void include(double value) {
        low = std::min(low, value);
        high = std::max(high, value);
    }
    void addAir() {
        const double air = std::max(1.08, std::pow(high / low, 0.04));
        low /= air, high *= air;
    }
    double at(double value) const { return from + (to - from) * std::log(value / low) / std::log(high / low); }
    std::vector<double> ticks() const {
        const double decades = std::log10(high / low);
        std::vector<double> steps{1, 2, 5};
        if (decades > 4) steps = {1};
        if (decades < 0.7) steps = {1, 1.5, 2, 3, 4, 5, 6, 7, 8, 9};
        std::vector<double> values;
        for (int power = int(std::floor(std::log10(low))); power <= int(std::ceil(std::log10(high))); ++power)
            for (double step : steps) {
                const double value = step * std::pow(10.0, power);
                if (value >= low && value <= high) values.push_back(value);
            }
        return values;
    }
};

}  // namespace

std::string logPlotSvg(const std::vector<PlotCurve>& curves, const std::string& xLabel, const std::string& yLabel) {
    // Names stand in rows above the field, where no curve can run through them.
    double top = 36;
    for (double at = left; const PlotCurve& curve : curves) {
        if (!curve.name.empty() && at > left && at + legendWidth(curve) > width) at = left, top += 20;
        if (!curve.name.empty()) at += legendWidth(curve);
    }
    const double height = top + fieldHeight + bottom;
    Axis x, y;
    x.from = left, x.to = width - right;
    y.from = height - bottom, y.to = top;
    for (const PlotCurve& curve : curves)
        for (const PlotPoint& p : curve.points)
            if (drawable(p)) x.include(p.x), y.include(p.y);
    if (x.high <= 0) return "";
    x.addAir();
    y.addAir();
    std::string svg = fmt::format(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" font-family=\"system-ui, DejaVu Sans, sans-serif\" "
        "style=\"background:#1e1e1e\" viewBox=\"0 0 {0} {1}\" width=\"{0}\" height=\"{1}\" role=\"img\" "
        "font-size=\"12.5\" fill=\"#b4b4b4\">\n",
        width, height);
    svg += fmt::format("<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" fill=\"#252525\"/>\n", left, top,
                       width - left - right, height - top - bottom);
    for (double value : x.ticks())
        svg += fmt::format(
            "<path d=\"M{0:.1f} {1}V{2}\" stroke=\"#3a3a3a\"/><text x=\"{0:.1f}\" y=\"{3}\" "
            "text-anchor=\"middle\">{4:.3g}</text>\n",
            x.at(value), top, height - bottom, height - bottom + 18, value);
    for (double value : y.ticks())
        svg += fmt::format(
            "<path d=\"M{1} {0:.1f}H{2}\" stroke=\"#3a3a3a\"/><text x=\"{3}\" y=\"{4:.1f}\" "
            "text-anchor=\"end\">{5:.3g}</text>\n",
            y.at(value), left, width - right, left - 8, y.at(value) + 4, value);
    svg += fmt::format("<text x=\"{}\" y=\"{}\" text-anchor=\"middle\">{}</text>\n", (left + width - right) / 2,
                       height - 12, htmlText(xLabel));
    svg += fmt::format("<text transform=\"translate(18 {}) rotate(-90)\" text-anchor=\"middle\">{}</text>\n",
                       (top + height - bottom) / 2, htmlText(yLabel));
    double legend = left, line = 18;
    for (const PlotCurve& curve : curves) {
        std::string path, dots;
        for (const PlotPoint& p : curve.points) {
            if (!drawable(p)) continue;
            path += fmt::format("{}{:.1f} {:.1f}", path.empty() ? "M" : "L", x.at(p.x), y.at(p.y));
            if (p.note.empty()) continue;
            dots +=
                fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3.2\" fill=\"{}\"><title>{}</title></circle>\n",
                            x.at(p.x), y.at(p.y), curve.colour, htmlText(p.note));
        }
        if (path.empty()) continue;
        const char* dash = curve.dashed ? " stroke-dasharray=\"7 5\"" : "";
        svg += fmt::format("<path d=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"1.8\"{}/>\n{}", path,
                           curve.colour, dash, dots);
        if (curve.name.empty()) continue;
        if (legend > left && legend + legendWidth(curve) > width) legend = left, line += 20;
        svg += fmt::format(
            "<path d=\"M{} {}h34\" stroke=\"{}\" stroke-width=\"1.8\"{}/><text x=\"{}\" y=\"{}\" "
            "fill=\"#dcdcdc\">{}</text>\n",
            legend, line, curve.colour, dash, legend + 42, line + 4, htmlText(curve.name));
        legend += legendWidth(curve);
    }
    return svg + "</svg>\n";
}

}  // namespace relamp
