// The mesh in the place of a body of light: what goes, and what stays behind it. Inner part of the clusters, not a
// door.
#pragma once
#include <optional>
#include <set>

#include "capture/mesh_mend.h"
#include "clusters/emitter_body.h"

namespace relamp {

/// A ball or a straight body.
class LightBody {
public:
    explicit LightBody(const EmitterSphere& ball) : ball_(&ball) {}
    LightBody(const EmitterBody& body, double margin) : body_(&body), margin_(margin) {}

    /// Metres along the ray to the middle of what lies in the body's inner nine tenths; below 0: nothing does.
    double middle(const DVec3& eye, const DVec3& direction) const;
    /// Whether the point lies in it, a little about it included.
    bool holds(const DVec3& point) const;
    bool straight() const { return body_ != nullptr; }

private:
    const EmitterSphere* ball_ = nullptr;
    const EmitterBody* body_ = nullptr;
    double margin_ = 0;
};

/// Adds to `removed` the triangles that the body takes the place of: its emitter's `own`, those within it, and those
/// before it where photographs see it all the same. Those of other emitters stay: what they show is their own light.
/// Before a straight body, which is large, those stay as well that are a surface where it is not behind them.
/// O(pixels of the body x layers).
void collectObstacles(const Scene& scene, const Capture& capture, const RadianceSamples& samples,
                      const std::vector<EmitterOutline>& outlines, const LightBody& body,
                      const std::vector<uint32_t>& own, const std::vector<int>& emitterOfTriangle,
                      std::set<uint32_t>& removed);

/// Where an emitter's surface is a ridge of the surface about it, as a reconstruction makes of a strip on a wall: its
/// vertices on that surface, behind the light. Empty where it is a finger or a bag. O(vertices about it).
std::vector<MeshMend::MovedVertex> ridgeSetBack(const Scene& scene, const EmitterCluster& emitter);

/// What a reconstruction closes behind a light, ascending.
struct Scraps {
    std::vector<uint32_t> sure;      ///< hang on what goes most of all
    std::vector<uint32_t> doubtful;  ///< hang on it, and more on what stays: a bag on the ground, or a thing
};

/// Triangles of the scene about the body that hang together with the others by `removed` ones, and that no photograph
/// shows but in pixels beside the light's, or through which photographs show what lies behind: the bag that a
/// reconstruction closes below a panel. Large flat surfaces are none. O(pixels + triangles).
Scraps scrapsBehind(const Scene& scene, const Capture& capture, const RadianceSamples& samples,
                    const std::vector<EmitterOutline>& outlines, const EmitterBody& body,
                    const std::set<uint32_t>& removed);

/// The flat surface that a body stands on or hangs at, where meshes round the corner between the two. The fillet hides
/// the body's lowest part, and with it 3 to 5 % of its light.
struct FlatGround {
    DVec3 normal{0};    ///< unit, away from the ground
    double offset = 0;  ///< metres: of the plane along the normal
    double reach = 0;   ///< metres from the body to where fillets end
    /// The point on the plane, if it is of the fillet: no farther from the plane than half of what the reach leaves.
    std::optional<DVec3> levelled(const DVec3& point, const EmitterBody& body) const;
};

/// None where the triangles about the body, without `removed`, have no flat surface by the body's side: a quarter of
/// their vertices in one plane. Reconstructions that were not flattened have none. O(vertices about it).
std::optional<FlatGround> flatGround(const Scene& scene, const EmitterBody& body, const std::set<uint32_t>& removed);

/// Fans of triangles over the borders that are left where `removed` triangles met others within `reach` metres of the
/// body: the ground that a standing light hid. Triangles of `positions`; corners are copies of the mesh's.
/// O(triangles).
void groundUnder(const Scene& scene, const EmitterBody& body, double reach, const std::set<uint32_t>& removed,
                 std::vector<Vec3>& positions, std::vector<Triangle>& triangles);

}  // namespace relamp
