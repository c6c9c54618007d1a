// The stands of balls of light, measured in photographs or completed. Inner part of the mesh's mends, not a door.
#pragma once
#include <string>

#include "capture/capture.h"
#include "clusters/ball_stands.h"
#include "scene/scene.h"

namespace relamp {

struct MendedStands {
    std::vector<SurfacePatch> surfaces;  ///< each with what it replaces of the mesh
    std::vector<uint32_t> replaced;      ///< of all
    std::vector<std::string> words;      ///< a sentence for each
};

/// The stands of a mesh from which the triangles that balls replaced are gone. Those that photographs show as tubes
/// (fitTube) take the place of the mesh's; sleeves complete the others. `scene`: what hides them from cameras; `floor`:
/// radiance that counts as dark. O(balls x vertices + places x views); one to four seconds a stand. Throws Cancelled.
MendedStands mendStands(const Mesh& mesh, const std::vector<ProxyLight>& balls, const Capture& capture,
                        const Scene& scene, float floor, const Progress& progress);

}  // namespace relamp
