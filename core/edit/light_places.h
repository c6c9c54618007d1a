// Painting with light through the live model: powers and colours, places of lights, and the environment's sides are
// solved for together, as one change of the look (docs/method.md 7).
#pragma once
#include <string>
#include <vector>

#include "base/progress.h"
#include "edit/light_brush.h"
#include "relight/light_goal.h"
#include "relight/live/live_scene.h"

namespace relamp {

/// A vertex of the capture's mesh with the radiance it is to have towards the eye.
struct GoalVertex {
    uint32_t vertex = 0;
    float weight = 1;
    Rgb target{0};
};

struct LiveGoal {
    std::vector<GoalVertex> points;
    std::vector<std::string> ids;  ///< lights that may change; they shine
    bool environment = false;      ///< its exposure and tint may change
    bool sides = false;            ///< in place of these, its light from six sides (EnvironmentSides)
    bool places = false;           ///< the lights may move, without turning
};

struct LiveGoalAnswer {
    Look look;
    LightGoalAnswer goal;                ///< scales in order of the ids, then the environment or its six sides
    std::vector<Vec3> moves;             ///< per light, metres
    std::vector<LightGoalAnswer> steps;  ///< of places: what each Gauss-Newton step came to, the start first
};

/// The points of a stroke with a brush, as brushedGoal() takes them, of the capture's own vertices.
std::vector<GoalVertex> brushedPoints(const LiveFrame& frame, std::span<const PaintedVertex> painted,
                                      const LightBrush& brush, size_t vertices);

/// The look that comes nearest to the goal. Scales are a non-negative program for every place of the lights; places
/// follow by Gauss-Newton on what that leaves (variable projection), with derivatives by moving each light a fiftieth
/// of its distance, at most `steps` times. Shadows and attached objects take part, as the live scene moves them. Leaves
/// `live` at the answer. Cost: an image of a drag for each of 3 lights + 2 trials a step, six changes of the
/// environment for its sides. Throws Error for a light or vertex that does not exist; Cancelled.
LiveGoalAnswer reachLiveGoal(LiveScene& live, const Estimate& estimate, const Look& look, const LiveGoal& goal,
                             const LightGoalOptions& options, Progress& progress, int steps = 6);

}  // namespace relamp
