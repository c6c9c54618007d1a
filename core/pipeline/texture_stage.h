// What is finer than vertices and cells in the course of a solve, after the light is known: albedo per texel, and the
// background.
#pragma once
#include <optional>

#include "radiance/samples.h"
#include "solve/solve_plan.h"
#include "texture/fit_texture.h"

namespace relamp {

/// What an artist may ask for: the side of the texture in texels, 64 to 8192. Throws Error for another one.
constexpr int leastTextureSide = 64, mostTextureSide = 8192;

/// Leaves the texture out of the plan where the mesh is as fine as the photographs, or predicts what it costs. `side`:
/// as PipelineOptions::texture.
void planTexture(const Capture& capture, const Scene& scene, const RadianceSamples& samples, std::optional<int> side,
                 bool everything, SolvePlan& plan);

/// Fits the texture of an estimate that has just been solved, if its plan does not leave it out and time is left. What
/// it finds not worth it is named in estimate.leftOut. Takes estimate.surfaceLight. Throws Cancelled.
void addTexture(const Capture& capture, const Scene& scene, std::optional<int> side, Estimate& estimate,
                Progress& progress);

/// What the photographs show behind the scene, of each environment that was found (Estimate::background). Left out
/// without time. Throws Cancelled.
void addBackgrounds(const Capture& capture, const RadianceSamples& samples, Estimate& estimate, Progress& progress);

}  // namespace relamp
