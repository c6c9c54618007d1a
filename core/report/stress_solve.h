// One solve of a stress case and how two answers are held against each other. Not a door.
#pragma once
#include <optional>

#include "report/stress.h"
#include "solve/solve.h"

namespace relamp {

/// How a variant's world lies in the world it came from: p -> turn * p * scale + offset, radiance times `radiance`.
struct VariantOf {
    glm::dmat3 turn{1.0};
    double scale = 1;
    DVec3 offset{0};
    Rgb radiance{1};
    std::vector<uint32_t> newIndex;  ///< where each vertex went; empty: where it was
};

/// The rooms from mesh to estimate at draft quality. `emitters`, when not null, stand in place of room 4's finding.
/// `emittersReversed`: the candidates come in the opposite order. Throws what the rooms throw.
Estimate solveForStress(const Capture& capture, const EmitterClusters* emitters, bool emittersReversed,
                        const SolveOptions& options, Progress& progress);

/// Every number of it.
bool allFinite(const Estimate& estimate);

/// Relative differences of what `variant` found from what `base` did: emitters' radiance, irradiance of the distant
/// light on six orientations, albedo (root mean square over the vertices that rest on their own observations). 1 when
/// the emitters are not the same ones.
struct AnswerDifference {
    double emitters = 0, irradiance = 0, albedo = 0;
    double worst() const { return std::max(emitters, std::max(irradiance, albedo)); }
};
AnswerDifference differenceOf(const Estimate& base, const Estimate& variant, const VariantOf& how);

}  // namespace relamp
