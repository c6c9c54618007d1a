// Light references that photographs show, as they are marked by hand: mirror balls, grey cards, charts.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "base/math.h"

namespace relamp {

struct PipelineOptions;

struct MarkedReference {
    enum class Kind { mirrorBall, grey, chart } kind = Kind::grey;
    size_t view = 0;
    /// Pixels. Of a mirror ball and of a grey the centre; of a chart the middles of dark skin, bluish green, black and
    /// white, round it. None: a mirror ball that is looked for.
    std::vector<Vec2> points = {};
    float radius = 0;                       ///< pixels; of a grey 0: that pixel alone
    Rgb albedo{0.18f};                      ///< of a grey, linear
    std::filesystem::path photograph = {};  ///< of a mirror ball, by the view's camera; empty: the view's own
    bool operator==(const MarkedReference&) const = default;
};

/// As the command line takes it: "2:640,410,12=0.5", "ball.exr@3:640,410,90".
std::string toText(const MarkedReference& mark);

/// As an estimate calls it: name of a PatchFit or of a ProbeFit; of a chart what the names of its patches begin with.
std::string nameOf(const MarkedReference& mark);

/// Adds it to what the pipeline is asked for. Throws Error for a chart whose points are no convex shape, and for a
/// photograph that cannot be read.
void takeReference(const MarkedReference& mark, PipelineOptions& options);

}  // namespace relamp
