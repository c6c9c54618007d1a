// Lights of which the mesh has a part: such as every photograph's frame cuts (a panel overhead), where reconstruction
// ends, and candidates, of which emitter_mend asks the brightest alone.
#pragma once
#include "clusters/emitter_body.h"

namespace relamp {

/// An end of a body at which no photograph shows that it ends.
struct OpenEnd {
    int axis = 0;      ///< of the body
    double side = 1;   ///< -1 or 1 along it
    double reach = 0;  ///< metres by which it may go on; farther photographs would show it
};

struct PartialLight {
    EmitterCluster mesh;                   ///< what the mesh has of it
    bool certain = false;                  ///< an emitter, no candidate
    std::vector<EmitterOutline> outlines;  ///< of that
    EmitterBody body;                      ///< that explains them
    float covered = 0;                     ///< overlap of the outlines and the mesh
    std::vector<OpenEnd> ends;
    bool showsMore() const { return body.overlap > covered + 0.02f; }
};

/// The body with each end moved out by so many metres.
EmitterBody withEnds(EmitterBody body, const std::vector<OpenEnd>& ends, const std::vector<double>& lengths);

/// What photographs say against a body of this light.
class BodyWitness {
public:
    /// Keeps references.
    BodyWitness(const Scene& scene, const Capture& capture, const RadianceSamples& samples,
                const EmitterCluster& light);
    /// False where a view would see more than a thirtieth of its surface that it does not show. O(views).
    bool allow(const EmitterBody& body) const;

private:
    const Scene& scene_;
    const Capture& capture_;
    const RadianceSamples& samples_;
    const EmitterCluster& light_;
    std::vector<std::vector<uint8_t>> shows_;  ///< per view, per pixel
};

/// Emitters that at most two photographs show whole, and candidates, if three photographs show them at all and a tube
/// or box explains what they show. It covers 2 % more of that than the mesh, or could go on beyond the frames. O(pixels
/// of such lights x 2000).
std::vector<PartialLight> partialLights(const Scene& scene, const Capture& capture, const RadianceSamples& samples,
                                        const EmitterClusters& clusters);

}  // namespace relamp
