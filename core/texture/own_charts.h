// A mesh laid out by the texture coordinates of its file, where these are fit for it.
#pragma once
#include "texture/atlas.h"

namespace relamp {

struct OwnCharts {
    std::vector<FaceTexcoords> places;  ///< per triangle, all 0 where it has none; empty where they are not used
    std::string why;                    ///< they are not used; empty where they are
};

/// Not used where a twentieth of the surface has no coordinates, or such outside the image (tiles, several images in
/// one row), or where triangles lie on one another (mirrored halves, several images). Cost: O(n log n + 2048^2).
OwnCharts ownCharts(const Mesh& mesh, const std::vector<TexturedFace>& faces);

/// As layOut, by `own`; triangles without coordinates have no texels. The image is square, and as fine as three
/// quarters of the texels that are asked for. Nothing (width 0), and own.why says so, where charts lie closer together
/// than texels, or where that leaves less than half of the resolution that charts of our making have.
Atlas layOutOwn(const Mesh& mesh, OwnCharts& own, const std::vector<float>& texelsPerMetre,
                const AtlasOptions& options);

}  // namespace relamp
