#include "pipeline/stand_mend.h"

#include <fmt/format.h>

#include "solve/registration/tube_fit.h"

namespace relamp {
namespace {

/// Where photographs show a tube of the mesh; the truer its axis, the farther the mesh is seen to follow it.
std::optional<StraightTube> measuredStand(const Mesh& mesh, const StraightTube& tube, const Capture& capture,
                                          const Scene& scene, float floor, const Progress& progress) {
    std::optional<StraightTube> measured = fitTube(capture, scene, tube, floor, progress);
    for (int round = 0; round < 3 && measured; ++round) {
        StraightTube farther = *measured;
        farther.to = tubeEnd(mesh, farther);
        if (!(farther.to > measured->to + measured->radius)) break;
        const std::optional<StraightTube> again = fitTube(capture, scene, farther, floor, progress);
        if (!again) break;
        measured = again;
    }
    return measured;
}

}  // namespace

MendedStands mendStands(const Mesh& mesh, const std::vector<ProxyLight>& balls, const Capture& capture,
                        const Scene& scene, float floor, const Progress& progress) {
    MendedStands mended;
    for (const BallStand& stand : ballStands(mesh, balls)) {
        const auto measured = measuredStand(mesh, stand.tube, capture, scene, floor, progress);
        mended.surfaces.push_back(measured ? wholeStandOf(mesh, stand, *measured) : sleeveOf(mesh, stand));
        const std::vector<uint32_t>& replaced = mended.surfaces.back().replaced;
        mended.replaced.insert(mended.replaced.end(), replaced.begin(), replaced.end());
        mended.words.push_back(
            measured ? fmt::format("what holds a ball of light is a tube of {:.1f} mm radius in the photographs and "
                                   "{:.1f} mm in the mesh: measured",
                                   1000 * measured->radius, 1000 * stand.tube.radius)
                     : "what holds a ball of light ended before it, or wrapped it: it reaches into the ball");
    }
    return mended;
}

}  // namespace relamp
