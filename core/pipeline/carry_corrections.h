// What was put right on a working mesh, put right on the capture's mesh that it stands for.
#pragma once
#include "pipeline/pipeline.h"
#include "scene/decimate.h"

namespace relamp {

/// `found` with displacements and mends for `mesh`, whose vertices take what moves the place of the working mesh that
/// they lie on; `corrected`: positions of the working mesh's vertices in the end. Triangles go of which two corners
/// lie on triangles that go; what is left of those beside comes to the nearest corner that stays. Normals and marks
/// are those of the nearest corner. What is added is the same. O(triangles).
Corrections carriedBack(const Corrections& found, const DecimatedMesh& working, const std::vector<Vec3>& corrected,
                        const Mesh& mesh);

/// Those of `vertices` of a capture's mesh, ascending, that a working mesh holds, by its own numbers, ascending.
std::vector<uint32_t> inWorkingMesh(const std::vector<uint32_t>& vertices, const DecimatedMesh& working);

}  // namespace relamp
