// A shot's texture: albedo.exr, and texture coordinates on the faces of reflectance.ply.
#pragma once
#include <filesystem>
#include <memory>

#include "brdf/albedo_texture.h"
#include "scene/mesh_io.h"

namespace relamp {

/// Of one triangle, as files have them; all 0 where it has no texels.
FaceTexcoords texcoordsOf(const AlbedoTexture& texture, uint32_t triangle);

/// Diffuse albedo as half floats, row 0 at the top. Whole or not at all; errors as writeChannels.
void writeTexture(const AlbedoTexture& texture, const std::filesystem::path& file);

/// The texture of a shot for these triangles; faces are known by their vertices, whatever their order. Null where no
/// face has texture coordinates. Throws Error naming the file.
std::shared_ptr<const AlbedoTexture> readTexture(const std::filesystem::path& image,
                                                 const std::vector<TexturedFace>& faces,
                                                 const std::vector<Triangle>& triangles);

}  // namespace relamp
