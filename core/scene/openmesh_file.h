// OpenMesh's own format, .om, as untrusted input: its library takes every number in it on faith.
#pragma once
#include <string>
#include <string_view>

namespace relamp {

/// What OpenMesh may be shown of a file: header, positions and topology, all indices inside their lists and every
/// face's edges closed; normals, colours, states and custom properties left out. For little-endian files up to
/// version 2.2 (OpenMesh 9). Cost: linear in the bytes. Throws Error, without the file's name, for others and for what
/// does not fit together.
std::string openMeshEssentials(std::string_view bytes);

}  // namespace relamp
