// Distant light as a latitude-longitude image, and its integration over the cells of a direction grid.
// Convention (Blender's): centre of the image is +X, going right is towards -Y, top is +Z.
#pragma once
#include <filesystem>

#include "image/direction_grid.h"
#include "image/image.h"

namespace relamp {

/// Latitude-longitude position in [0,1]^2 (u from the left, v from the top) of a unit direction, and back.
Vec2 latLongFromDirection(const Vec3& direction);
Vec3 directionFromLatLong(const Vec2& uv);

/// Reads a 2:1 latitude-longitude file; never clamps; negative and not finite texels count as 0. Throws Error naming
/// the file when it is not about 2:1.
Image readEnvironment(const std::filesystem::path& file);

/// Radiance of a direction, bilinear, wrapping in longitude.
Rgb environmentRadiance(const Image& latLong, const Vec3& direction);

/// Mean radiance of each cell: every texel's energy (radiance x solid angle, split 4 x 4 or finer) is added to the cell
/// it falls in, so a sun keeps its energy to 1e-3. Returns grid.cells() values.
std::vector<Rgb> integrateOverCells(const Image& latLong, const DirectionGrid& grid);

/// A latitude-longitude image of a piecewise constant environment, texels box-filtered 2 x 2, at bright edges 16 x
/// 16: a sun keeps its energy to 1e-3.
Image latLongFromCells(const std::vector<Rgb>& cells, const DirectionGrid& grid, int width);

/// The map turned by `degrees` about +Z (counter-clockwise from above).
Image yawed(const Image& latLong, float degrees);

}  // namespace relamp
