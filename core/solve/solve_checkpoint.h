// Where a solve stands between two of its stages: all that cannot be computed again from the capture in a moment.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "solve/albedo/albedo_step.h"
#include "solve/estimate.h"
#include "solve/gloss/gloss.h"

namespace relamp {

struct SolveCheckpoint {
    uint32_t step = 0;         ///< the next one in the list of steps
    bool between = true;       ///< false: taken inside that step, which then starts again from a better light
    double seconds = 0;        ///< run time so far
    EmitterClusters clusters;  ///< emitters and rejected patches; the indices are made again
    std::vector<uint8_t> suspect;
    std::vector<Leaf> leaves;
    std::vector<Rgb> leafRadiance, emitterRadiance;
    bool environmentBlack = false, refined = false, bounceKept = false;
    bool noMetals = false, backgroundRefuted = false;
    uint32_t visibilityStep = 0;  ///< how far visibility was traced (Visibility::step); 0: not at all
    double refinedMisfit = 0;
    float bouncedFraction = 0;
    std::string noBounceBecause;
    std::vector<Rgb> vertexBounce, outgoing;     ///< empty: none
    std::vector<Rgb> matteRadiance, matteSigma;  ///< of the observations, without what coatings reflect; empty: as seen
    PriorStrength lightSmoothness, albedoSmoothness;
    std::vector<ComponentGloss> gloss, firstGloss;
    bool metalsHeard = false, metalsJoined = false, glossSettled = false, lightUnfinished = false;
    std::vector<double>
        information;  ///< what fixed the light (LightInformation): columns of `all` from the diagonal down
    std::vector<double> informationOfObservations[3], informationSeen[3];
    std::vector<Rgb> albedo;  ///< per vertex; empty: not solved yet
    std::vector<float> confidence;
    std::vector<PaletteColour> palette;
    std::vector<TimelineEntry> timeline;
    double kktResidual = 0;
    SolvePlan plan;
    std::vector<uint8_t> patchUsed;  ///< per patch of known albedo, whether it takes part; empty: not asked yet
};

/// A sequence of bytes for this machine's byte order.
std::string checkpointBytes(const SolveCheckpoint& checkpoint);
/// Of the sizes of all fields, in order: bytes of another layout were written by another program. Never 0.
uint32_t checkpointLayout();
/// Throws Error when the bytes end early or hold what cannot be.
SolveCheckpoint checkpointFromBytes(const std::string& bytes);

}  // namespace relamp
