// Values with keys as the view of curves shows them: as numbers on an axis, in words, in colours.
#pragma once
#include <imgui.h>

#include <string>
#include <vector>

#include "editor.h"

namespace relamp::ui {

/// Numbers of a value that have curves: brightness stands for red, green and blue.
int curvesOf(const KeyedValueInfo& info);
/// One of them, as it is drawn: light in stops, everything else as its keys have it.
float shownValue(const KeyedValueInfo& info, const Vec3& value, int component);
/// Of the curve at this place of the list, and of one of its numbers.
ImU32 curveColour(const KeyedValueInfo& info, size_t place, int component);

struct CurveSpan {
    float low = 0, high = 1;
};
/// Holds all keys, with air above and below.
CurveSpan spanOf(const ValueCurve& curve);

/// From what is drawn to what the inspector shows: places in the world in the window's unit of length, stops against
/// what was recovered. shown = (drawn + offset) / unit.
struct CurveAxis {
    double offset = 0, unit = 1;
    const char* symbol = "";
};
CurveAxis axisOf(const Editor& editor, const KeyedOf& what, int component);

struct AxisTick {
    float drawn = 0;  ///< where it stands, as shownValue() has it
    std::string words;
};
/// 1, 2 or 5 times powers of ten of what is shown, `most` of them at most; "off" and "on" of what is one of the two.
std::vector<AxisTick> axisTicks(const Editor& editor, const KeyedOf& what, int component, const CurveSpan& span,
                                int most);

/// Frames from one number to the next: 1, 2 or 5 times a power of ten, wide enough for the numbers in `width` pixels.
int frameStep(int frames, float width);

/// "0.250  0.100  1.200 m", "+1.50 stops", "on".
std::string valueWords(const Editor& editor, const ValueCurve& curve, const Vec3& value);

}  // namespace relamp::ui
