// The view modes: one table, one row a mode. Toolbar, menu, keys, strips, dividers and legends all read it.
#pragma once
#include <span>
#include <vector>

namespace relamp::ui {

struct ViewportState;

/// In the order of the toolbar, and as the window's test map counts them.
enum class ViewMode {
    photograph = 1,
    relit,
    difference,
    clusters,
    correction,
    albedo,
    confidence,
    irradiance,
    wipe,
    compare
};

/// What can be painted (viewport/paint.cpp has a row for each).
enum class Paint {
    photographs,
    model,
    distantModel,
    difference,
    clusters,
    correction,
    distantCorrection,
    albedo,
    confidence,
    irradiance,
    before
};

/// What must be there before a strip can be painted.
enum class Needs { nothing, photographs, estimate, distantEstimate, emitter };

/// Explains the colours (viewport/legend.cpp has a row for each).
enum class Legend { none, confidence, difference, emitters, oneLight };

/// One vertical strip of a mode's image.
struct StripInfo {
    Paint paint;
    Needs needs = Needs::estimate;
    const char* caption = "";  ///< shown where a mode has several strips
};

struct ViewModeInfo {
    ViewMode mode;
    const char* id;           ///< of its command: "view.mode1"
    const char* name;         ///< for buttons and menus
    const char* explanation;  ///< one sentence for the tooltip
    int key;                  ///< from keys.h; 0: none
    std::vector<StripInfo> strips;
    std::vector<float ViewportState::*> dividers{};  ///< between two strips: fraction of the width
    Legend legend = Legend::none;
    bool display = false;    ///< the colours are for the screen: exposure bands say nothing about them
    bool restImage = false;  ///< a resting camera gets an image traced by rays
    bool shows(Paint paint) const;
};

std::span<const ViewModeInfo> viewModes();
const ViewModeInfo& infoOf(ViewMode mode);

}  // namespace relamp::ui
