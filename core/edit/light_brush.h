// Painting with light: brush strokes on surfaces become powers and colours of lights (relight/light_goal), as one
// change of the look.
#pragma once
#include <span>
#include <string>
#include <vector>

#include "relight/light_goal.h"
#include "relight/live/live_scene.h"
#include "relight/look.h"
#include "solve/estimate.h"

namespace relamp {

struct LightBrush {
    enum class Kind { brighter, darker, colour } kind = Kind::brighter;
    float stops = 1;      ///< by which it makes brighter or darker
    Rgb colour{1};        ///< that light there is to have; its brightness stays
    float stillness = 1;  ///< how much what was not painted stays: all of it together, in parts of what was painted
};

/// A vertex of the live mesh under the brush.
struct PaintedVertex {
    uint32_t vertex = 0;
    float amount = 1;  ///< 0 to 1: how much of the stroke's change is wanted
};

/// Which lights may change: indices into LiveFrame::emitterIds; the environment.
struct PaintedLights {
    std::vector<size_t> emitters;
    bool environment = false;
};

/// The goal of a stroke. Painted vertices are to have their present radiance changed, up to 4096 of the others
/// (evenly chosen) to keep it. Light by way of other surfaces and in glossy lobes stays as it is in `rest`. Cost: one
/// pass over the vertices. Throws Error when a vertex or emitter does not exist.
LightGoal brushedGoal(const LiveFrame& frame, const Estimate& estimate, const Look& look,
                      std::span<const PaintedVertex> painted, const LightBrush& brush, const PaintedLights& lights);

/// Scales radiance, and exposure and tint of the environment (the last of `scale`, where it may change), by an answer.
/// A light of scale 0 is switched off.
void scaleLights(Look& look, const Estimate& estimate, const std::vector<std::string>& ids, bool environment,
                 const std::vector<Rgb>& scale);

/// "Light 1 +0.4 stops, environment off; 12 % stays too dark": what an answer does, for the artist.
std::string wordsOf(const LightGoalAnswer& answer, const std::vector<std::string>& names, bool environment);

}  // namespace relamp
