// A shot's texture: albedo.exr and albedo_confidence.exr, and texture coordinates on the faces of reflectance.ply.
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

/// Its confidence as half floats in [0, 1], channel Y. Whole or not at all; errors as writeChannels.
void writeTextureConfidence(const AlbedoTexture& texture, const std::filesystem::path& file);

/// The texture of a shot for these triangles, with its coarser copies; faces are known by their vertices, whatever
/// their order. Null where no face has texture coordinates. `confidence`: the other file; where there is none it is not
/// known. Throws Error naming the file.
std::shared_ptr<const AlbedoTexture> readTexture(const std::filesystem::path& image,
                                                 const std::vector<TexturedFace>& faces,
                                                 const std::vector<Triangle>& triangles,
                                                 const std::filesystem::path& confidence = {});

}  // namespace relamp
