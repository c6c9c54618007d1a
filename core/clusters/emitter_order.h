// The order in which random patterns go through the triangles of an emitter.
#pragma once
#include "scene/mesh.h"

namespace relamp {

/// The triangles along a curve through the emitter at rest, laid along `axes` (Scene::axes): the same in any order of
/// the file, and samples that are spread over them are spread over space. Cost: n log n.
std::vector<uint32_t> alongEmitter(const Mesh& mesh, const std::vector<uint32_t>& triangles,
                                   const Mat3& axes = Mat3(1));

}  // namespace relamp
