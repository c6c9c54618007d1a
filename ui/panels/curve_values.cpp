#include "panels/curve_values.h"

#include <algorithm>
#include <cmath>

#include "panels/emitter_controls.h"
#include "widgets.h"

namespace relamp::ui {
namespace {

constexpr ImU32 componentColours[] = {IM_COL32(226, 110, 110, 255), IM_COL32(126, 196, 110, 255),
                                      IM_COL32(110, 150, 230, 255)};
constexpr ImU32 singleColours[] = {IM_COL32(230, 200, 120, 255), IM_COL32(110, 200, 200, 255),
                                   IM_COL32(210, 140, 220, 255), IM_COL32(200, 200, 200, 255)};

/// What the stops of a light are more than the logarithm of its keyed value.
double stopsOffset(const Editor& editor, const KeyedOf& what) {
    const EmitterState* light = editor.emitter(what.of);
    if (!light) return 0;
    EmitterState unit = *light;
    unit.radiance = Rgb(1);
    if (what.value == KeyedValue::radiance) return double(stopsOf(editor, unit));
    return 0;  // of a recovered one they count from what was recovered
}

double niceStep(double atLeast) {
    const double power = std::pow(10.0, std::floor(std::log10(atLeast)));
    for (const double factor : {1.0, 2.0, 5.0})
        if (factor * power >= atLeast * (1 - 1e-9)) return factor * power;
    return 10 * power;
}

}  // namespace

int curvesOf(const KeyedValueInfo& info) { return info.kind == KeyedValueInfo::Kind::light ? 1 : info.components; }

float shownValue(const KeyedValueInfo& info, const Vec3& value, int component) {
    if (info.kind != KeyedValueInfo::Kind::light) return value[component];
    const float light = luminance(value);
    return light > 0 ? std::max(std::log2(light), -20.0f) : -20.0f;
}

ImU32 curveColour(const KeyedValueInfo& info, size_t place, int component) {
    return curvesOf(info) > 1 ? componentColours[component] : singleColours[place % std::size(singleColours)];
}

CurveSpan spanOf(const ValueCurve& curve) {
    const KeyedValueInfo& info = infoOf(curve.what.value);
    CurveSpan span{INFINITY, -INFINITY};
    for (const ValueKey& key : curve.keys)
        for (int c = 0; c < curvesOf(info); ++c) {
            const float value = shownValue(info, key.value, c);
            span = {std::min(span.low, value), std::max(span.high, value)};
        }
    const float room = std::max(0.5f, 0.15f * (span.high - span.low));
    return {span.low - room, span.high + room};
}

CurveAxis axisOf(const Editor& editor, const KeyedOf& what, int component) {
    const LengthUnitInfo& length = infoOf(editor.state.lengthUnit);
    switch (what.value) {
        case KeyedValue::position: {
            CurveAxis axis{0, length.inMetres, length.symbol};
            const EmitterState* light = editor.emitter(what.of);
            const auto now = valueOf(editor.look(), what, editor.pivots());
            if (!light || !now) return axis;
            axis.offset = double(light->pivot[component]) - double((*now)[component]);
            if (editor.state.document.capture) axis.offset += editor.state.document.capture->origin[component];
            return axis;
        }
        case KeyedValue::size: return {0, length.inMetres, length.symbol};
        case KeyedValue::rotation:
        case KeyedValue::yaw:
        case KeyedValue::coneDegrees: return {0, 1, "\u00b0"};
        case KeyedValue::exposure: return {0, 1, "stops"};
        default: break;
    }
    if (infoOf(what.value).kind == KeyedValueInfo::Kind::light) return {stopsOffset(editor, what), 1, "stops"};
    return {};
}

std::vector<AxisTick> axisTicks(const Editor& editor, const KeyedOf& what, int component, const CurveSpan& span,
                                int most) {
    if (infoOf(what.value).kind == KeyedValueInfo::Kind::flag) return {{0, "off"}, {1, "on"}};
    const CurveAxis axis = axisOf(editor, what, component);
    const double low = (double(span.low) + axis.offset) / axis.unit,
                 high = (double(span.high) + axis.offset) / axis.unit;
    if (!(high > low) || most < 1) return {};
    const double step = niceStep((high - low) / most);
    const int digits = std::clamp(int(std::ceil(-std::log10(step) - 1e-9)), 0, 9);
    std::vector<AxisTick> ticks;
    for (double n = std::ceil(low / step); n * step <= high && int(ticks.size()) < most; ++n) {
        const double value = n == 0 ? 0 : n * step;
        ticks.push_back({float(value * axis.unit - axis.offset), fmt::format("{:.{}f}", value, digits)});
    }
    // The unit once, with the topmost number.
    if (!ticks.empty() && *axis.symbol)
        ticks.back().words += (std::string(axis.symbol) == "\u00b0" ? "" : " ") + std::string(axis.symbol);
    return ticks;
}

int frameStep(int frames, float width) {
    const double wanted = std::max(1, frames) * double(em(3.5f)) / double(std::max(1.0f, width));
    for (int step = 1; step < 100'000'000; step *= 10)
        for (int factor : {1, 2, 5})
            if (step * factor >= wanted) return step * factor;
    return 100'000'000;
}

std::string valueWords(const Editor& editor, const ValueCurve& curve, const Vec3& value) {
    const KeyedValueInfo& info = infoOf(curve.what.value);
    if (info.kind == KeyedValueInfo::Kind::flag) return value.x > 0.5f ? "on" : "off";
    if (curve.what.value == KeyedValue::powerScale)
        if (const EmitterState* light = editor.emitter(curve.what.of)) {
            EmitterState then = *light;
            then.radiance = value * light->recoveredRadiance;
            return fmt::format("{:+.2f} stops", stopsOf(editor, then));
        }
    const CurveAxis axis = axisOf(editor, curve.what, 0);
    const auto shown = [&](int c) {
        const CurveAxis own = axisOf(editor, curve.what, c);
        return (double(shownValue(info, value, c)) + own.offset) / own.unit;
    };
    if (info.kind == KeyedValueInfo::Kind::light || curve.what.value == KeyedValue::exposure)
        return fmt::format("{:+.2f} stops", shown(0));
    std::string words;
    const bool length = curve.what.value == KeyedValue::position || curve.what.value == KeyedValue::size;
    const int decimals = infoOf(editor.state.lengthUnit).decimals;
    for (int c = 0; c < curvesOf(info); ++c)
        words +=
            (c ? "  " : "") + (length ? fmt::format("{:.{}f}", shown(c), decimals) : fmt::format("{:.3g}", shown(c)));
    return words + (length ? " " : "") + axis.symbol;
}

}  // namespace relamp::ui
