// The stands of lights, measured in photographs or completed. Inner part of the mesh's mends, not a door.
#pragma once
#include <string>

#include "capture/capture.h"
#include "capture/mesh_mend.h"
#include "clusters/emitter_mend.h"
#include "clusters/light_stands.h"
#include "scene/scene.h"

namespace relamp {

std::vector<HeldLight> heldBalls(const EmitterMend& mend);
std::vector<HeldLight> heldBodies(const EmitterMend& mend);

struct MendedStands {
    std::vector<SurfacePatch> surfaces;  ///< each with what it replaces of the mesh
    std::vector<uint32_t> replaced;      ///< of all: triangles of the file
    std::vector<std::string> words;      ///< a sentence for each
};

/// The stands of lights in the file's mesh after the mend `before`. Those that photographs show as tubes (fitTube) take
/// the place of the mesh's, down to a surface that the mesh's end a few radii before; so do those of tubes and cones of
/// which the mesh has nothing, on their axes. `sleeves` complete the others. `scene`: what hides them from cameras;
/// `floor`: radiance that counts as dark. O(lights x triangles + places x views); one to four seconds a stand. Throws
/// Cancelled.
MendedStands mendStands(const Mesh& file, const MeshMend& before, const std::vector<HeldLight>& lights, bool sleeves,
                        const Capture& capture, const Scene& scene, float floor, const Progress& progress);

}  // namespace relamp
