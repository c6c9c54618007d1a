// A capture whose mesh is too large to solve on: the solve runs on a decimated one, and what it finds is carried back.
#pragma once
#include <optional>

#include "base/progress.h"
#include "capture/capture.h"
#include "scene/decimate.h"
#include "solve/estimate.h"

namespace relamp {

/// Meshes of more triangles are decimated unless the user says otherwise, to half as many.
constexpr size_t largestWorkingMesh = 300'000;

/// The mesh to solve on: nothing where the capture's own will do. `triangles`: about how many it may have, 0: any
/// number, none: by largestWorkingMesh. Proxies stay whole, at its end. Cost: as decimate.
std::optional<DecimatedMesh> workingMesh(const Capture& capture, std::optional<size_t> triangles, Progress& progress);

/// What was found on the working mesh, on the capture's: a vertex takes the values between the corners of the triangle
/// it lies on, and belongs to an emitter where that does. Areas and vertex lists of emitters are the capture's; light
/// is as it was found.
Estimate carriedBack(const Estimate& found, const DecimatedMesh& working, const Mesh& mesh);

/// What a reconstruction is off by, metres: half the median length of its edges.
float halfAnEdge(const Scene& scene);

/// The mesh without the spheres of its proxies, which stand at its end.
Mesh withoutProxies(Mesh mesh, size_t proxies);

}  // namespace relamp
