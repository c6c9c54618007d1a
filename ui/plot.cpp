#include "plot.h"

#include <cmath>

#include "widgets.h"

namespace relamp::ui {
namespace {

bool drawable(const PlotPoint& p) { return p.x > 0 && p.y > 0 && std::isfinite(p.x) && std::isfinite(p.y); }

constexpr const char* modeNames[2] = {"lights in the scene", "distant light only"};
constexpr const char* modeKeys[2] = {"near-field", "distant-only"};
constexpr const char* modeColours[2] = {"#e8a24a", "#6fa8dc"};
constexpr const char* xTitle = "seconds since the start";
constexpr const char* yTitle = "error against the photographs (radiance)";

ImU32 colourFromCss(const std::string& css) {
    unsigned value = 0xb4b4b4;
    if (css.size() == 7 && css[0] == '#') value = unsigned(std::stoul(css.substr(1), nullptr, 16));
    return IM_COL32(value >> 16 & 255, value >> 8 & 255, value & 255, 255);
}

std::string quoted(const std::string& field) {
    if (field.find_first_of(",\"\n") == std::string::npos) return field;
    std::string out = "\"";
    for (const char c : field) out += c == '"' ? "\"\"" : std::string(1, c);
    return out + "\"";
}

}  // namespace

PlotRange plotRange(const std::vector<PlotCurve>& curves, bool alongX) {
    double low = 1e300, high = 0;
    for (const PlotCurve& curve : curves)
        for (const PlotPoint& p : curve.points)
            if (drawable(p)) low = std::min(low, alongX ? p.x : p.y), high = std::max(high, alongX ? p.x : p.y);
    if (!(high > 0)) return {};
    const double air = std::max(1.1, std::pow(high / low, 0.05));
    return {low / air, high * air};
}

std::vector<double> plotTicks(const PlotRange& range, int most) {
    const auto collect = [&](const std::vector<double>& steps, int everyPower) {
        std::vector<double> ticks;
        for (int power = int(std::floor(std::log10(range.low))); power <= int(std::ceil(std::log10(range.high)));
             ++power) {
            if (power % everyPower) continue;
            for (const double step : steps)
                if (const double value = step * std::pow(10.0, power); value >= range.low && value <= range.high)
                    ticks.push_back(value);
        }
        return ticks;
    };
    std::vector<double> ticks;
    for (const auto& steps : {std::vector<double>{1, 1.5, 2, 3, 4, 5, 6, 7, 8, 9}, {1, 2, 5}, {1, 3}, {1}})
        if (ticks = collect(steps, 1); int(ticks.size()) <= most) return ticks;
    for (const int every : {2, 3, 5, 10, 20, 50, 100})
        if (ticks = collect({1}, every); int(ticks.size()) <= most) return ticks;
    return ticks;
}

std::vector<PlotCurve> timelineCurves(const std::array<RunCurve, 2>& curves) {
    std::vector<PlotCurve> out;
    for (size_t m = 0; m < 2; ++m) {
        if (curves[m].entries.empty()) continue;
        PlotCurve curve{modeNames[m], modeColours[m], m == 1, {}};
        for (const TimelineEntry& t : curves[m].entries)
            curve.points.push_back(
                {t.seconds, t.rmse,
                 fmt::format("{}, step {}: {:.2f} s, error {:.3g}", t.stage, t.iteration, t.seconds, t.rmse)});
        out.push_back(std::move(curve));
    }
    return out;
}

std::string timelineCsv(const std::array<RunCurve, 2>& curves) {
    std::string csv = "mode,seconds,stage,iteration,objective,rmse\n";
    for (size_t m = 0; m < 2; ++m)
        for (const TimelineEntry& t : curves[m].entries)
            csv += fmt::format("{},{:.4f},{},{},{:.9g},{:.9g}\n", modeKeys[m], t.seconds, quoted(t.stage), t.iteration,
                               t.objective, t.rmse);
    return csv;
}

std::string timelineSvg(const std::array<RunCurve, 2>& curves) {
    std::string svg = logPlotSvg(timelineCurves(curves), xTitle, yTitle);
    // As a file of its own it needs its name space, and a ground to stand on.
    if (const size_t end = svg.find('>'); svg.starts_with("<svg ") && end != std::string::npos) {
        svg.insert(end + 1, "\n<rect width=\"100%\" height=\"100%\" fill=\"#1c1c1c\"/>");
        svg.insert(5, "xmlns=\"http://www.w3.org/2000/svg\" font-family=\"sans-serif\" ");
    }
    return svg;
}

void drawLogPlot(const char* id, const std::vector<PlotCurve>& curves, const char* xLabel, const char* yLabel,
                 const ImVec2& size, const std::string& empty) {
    const ImVec2 at = ImGui::GetCursorScreenPos(), full{std::max(size.x, em(6)), std::max(size.y, em(4))};
    ImGui::InvisibleButton(id, full);
    const bool hovered = ImGui::IsItemHovered();
    ImDrawList* list = ImGui::GetWindowDrawList();
    const float line = ImGui::GetTextLineHeight();
    const ImU32 dim = ImGui::GetColorU32(dimColour), strong = ImGui::GetColorU32(ImGuiCol_Text),
                grid = IM_COL32(62, 62, 62, 255);
    bool any = false;
    for (const PlotCurve& curve : curves)
        for (const PlotPoint& p : curve.points) any |= drawable(p);

    const float left = at.x + em(4.2f), right = at.x + full.x - em(0.6f), top = at.y + line * 1.35f,
                bottom = at.y + full.y - line * (full.y > em(9) ? 2.3f : 1.25f);
    if (bottom - top < em(1) || right - left < em(3)) return;
    list->AddRectFilled({left, top}, {right, bottom}, IM_COL32(30, 30, 30, 255), ImGui::GetStyle().FrameRounding);
    if (!any) {
        const ImVec2 words = ImGui::CalcTextSize(empty.c_str(), nullptr, false, right - left - em(1));
        list->AddText(
            nullptr, 0,
            {left + em(0.5f) + std::max(0.0f, (right - left - em(1) - words.x) / 2), (top + bottom - words.y) / 2}, dim,
            empty.c_str(), nullptr, right - left - em(1));
        return;
    }
    const PlotRange xs = plotRange(curves, true), ys = plotRange(curves, false);
    const auto place = [&](double x, double y) {
        return ImVec2(left + (right - left) * float(std::log(x / xs.low) / std::log(xs.high / xs.low)),
                      bottom - (bottom - top) * float(std::log(y / ys.low) / std::log(ys.high / ys.low)));
    };
    for (const double value : plotTicks(xs, std::max(2, int((right - left) / em(4))))) {
        const float x = std::round(place(value, ys.low).x);
        list->AddLine({x, top}, {x, bottom}, grid);
        const std::string words = fmt::format("{:.4g}", value);
        list->AddText({x - ImGui::CalcTextSize(words.c_str()).x / 2, bottom + em(0.15f)}, dim, words.c_str());
    }
    for (const double value : plotTicks(ys, std::max(2, int((bottom - top) / (1.6f * line))))) {
        const float y = std::round(place(xs.low, value).y);
        list->AddLine({left, y}, {right, y}, grid);
        const std::string words = fmt::format("{:.3g}", value);
        list->AddText({left - ImGui::CalcTextSize(words.c_str()).x - em(0.35f), y - line / 2}, dim, words.c_str());
    }
    if (full.y > em(9))
        list->AddText({(left + right - ImGui::CalcTextSize(xLabel).x) / 2, at.y + full.y - line}, dim, xLabel);

    const PlotPoint* nearest = nullptr;
    const PlotCurve* nearestCurve = nullptr;
    float nearestDistance = em(4);
    const ImVec2 mouse = ImGui::GetIO().MousePos;
    float legend = left;
    list->PushClipRect({left, top}, {right, bottom}, true);
    for (const PlotCurve& curve : curves) {
        const ImU32 colour = colourFromCss(curve.colour);
        const PlotPoint* last = nullptr;
        for (const PlotPoint& p : curve.points) {
            if (!drawable(p)) continue;
            const ImVec2 here = place(p.x, p.y);
            if (last) {
                const ImVec2 before = place(last->x, last->y);
                const float length = std::hypot(here.x - before.x, here.y - before.y), dash = em(0.5f);
                if (!curve.dashed) list->AddLine(before, here, colour, std::max(1.5f, em(0.11f)));
                for (float s = 0; curve.dashed && s < length; s += 1.7f * dash) {
                    const float a = s / length, b = std::min(1.0f, (s + dash) / length);
                    list->AddLine({before.x + a * (here.x - before.x), before.y + a * (here.y - before.y)},
                                  {before.x + b * (here.x - before.x), before.y + b * (here.y - before.y)}, colour,
                                  std::max(1.5f, em(0.11f)));
                }
            }
            list->AddCircleFilled(here, em(0.18f), colour, 10);
            if (const float distance = std::hypot(here.x - mouse.x, here.y - mouse.y);
                hovered && distance < nearestDistance)
                nearestDistance = distance, nearest = &p, nearestCurve = &curve;
            last = &p;
        }
    }
    if (nearest) {
        const ImVec2 here = place(nearest->x, nearest->y);
        list->AddLine({here.x, top}, {here.x, bottom}, IM_COL32(150, 150, 150, 120));
        list->AddLine({left, here.y}, {right, here.y}, IM_COL32(150, 150, 150, 120));
        list->AddCircle(here, em(0.35f), strong, 16, std::max(1.0f, em(0.1f)));
    }
    list->PopClipRect();
    // The legend stands above the field, where no curve can run through it, with the best value of each curve.
    const auto best = [](const PlotCurve& curve) {
        double low = 1e300;
        for (const PlotPoint& p : curve.points)
            if (drawable(p)) low = std::min(low, p.y);
        return low;
    };
    for (const PlotCurve& curve : curves) {
        const ImU32 colour = colourFromCss(curve.colour);
        std::string words = fmt::format("{}: best {:.3g}", curve.name, best(curve));
        if (legend + em(2.2f) + ImGui::CalcTextSize(words.c_str()).x > right)
            words = elided(words, right - legend - em(2.2f), false);
        list->AddLine({legend, at.y + line * 0.55f}, {legend + em(curve.dashed ? 0.7f : 1.7f), at.y + line * 0.55f},
                      colour, std::max(2.0f, em(0.14f)));
        if (curve.dashed)
            list->AddLine({legend + em(1), at.y + line * 0.55f}, {legend + em(1.7f), at.y + line * 0.55f}, colour,
                          std::max(2.0f, em(0.14f)));
        list->AddText({legend + em(2.1f), at.y}, strong, words.c_str());
        legend += em(3.6f) + ImGui::CalcTextSize(words.c_str()).x;
    }
    if (nearest) {
        ImGui::BeginTooltip();
        dimText(nearestCurve->name);
        text(nearest->note);
        ImGui::EndTooltip();
    } else if (hovered) {
        tooltip(
            fmt::format("{} over {}. Both axes are logarithmic: each line is a factor. Lower is better; a flat end "
                        "means that more time brings nothing.",
                        yLabel, xLabel));
    }
}

}  // namespace relamp::ui
