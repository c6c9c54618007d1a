// The stages on the way from a capture to an estimate: what the plan predicts and the meter measures.
#pragma once
#include <string>

namespace relamp {

enum class Stage {
    // Before the solve.
    photographs,
    unobservedLight,
    scene,
    observations,
    emitters,
    registration,
    exposures,
    normals,
    planning,
    // The solve.
    resuming,
    ratios,
    visibility,
    rows,
    coarseLight,
    firstSurfaces,
    light,
    bouncedLight,
    priorStrength,
    finerLight,
    surfaces,
    glossLight,
    glossSurfaces,
    turns,
    closing,
    // After it.
    texture,
    reproduction,
    other  ///< of a file that another version wrote
};

/// For people: "coarse light".
const char* nameOf(Stage stage);
/// As shot.json and `info --json` name it.
const char* fileNameOf(Stage stage);
/// The inverse of fileNameOf; Stage::other for a name that is not known.
Stage stageNamed(const std::string& fileName);

}  // namespace relamp
