// An emitter that the capture's mesh does not hold: a small sphere put in its place, so that it is lit, moved and
// exported as any emitter.
#pragma once
#include <vector>

#include "capture/emission_lobe.h"
#include "scene/mesh.h"

namespace relamp {

struct ProxyLight {
    DVec3 centre{
        0};  ///< metres, Z up; among a Capture's proxies counted from its origin, in a CaptureFix from the files'
    float radius = 0;     ///< metres, more than 0
    Vec3 sigma{0};        ///< standard deviation of the centre along X, Y, Z, metres; 0: it was told, not found
    bool found = false;   ///< from shading and shadows (solve/unobserved/unobserved_light.h)
    Rgb radiance{0};      ///< as photographs show it; 0: none shows it, and the solve finds it
    EmissionLobe lobe{};  ///< where it shines to one side
    bool observed() const { return maxChannel(radiance) > 0; }
    bool operator==(const ProxyLight&) const = default;
};

/// Vertices and triangles that a proxy adds to the mesh: an octahedron cut up twice, with the area of the sphere.
constexpr size_t proxyVertices = 66, proxyTriangles = 128;

/// Appends the proxies' spheres to the mesh, one after the other, behind everything else. Throws Error for one that has
/// no place or no size, or is more than a thousand times the mesh's diagonal away or large.
void addProxies(const std::vector<ProxyLight>& proxies, Mesh& mesh);

}  // namespace relamp
