// Floors and walls that photographs' frames cut: a mesh ends there, the surface does not.
#pragma once
#include "radiance/round_sheets.h"
#include "scene/flat_surface.h"

namespace relamp {

/// One side of a flat surface at which no photograph shows that it ends, in lines `cell` metres apart.
struct CutSurface {
    struct Line {
        double end = 0;    ///< metres along `out`: as far as photographs show it
        double reach = 0;  ///< metres to which none shows that it is not there; 0: it ends
        Vec3 from{0};      ///< a vertex of the mesh shortly before that: what continues it begins there
    };
    FlatSurface surface;
    DVec3 along{1, 0, 0}, out{0, 1, 0};  ///< unit, in the plane: along the side, away from the surface
    double cell = 0, first = 0;          ///< metres: between lines; of the first of them along `along`
    std::vector<Line> lines;
    double end = 0;                  ///< metres along `out`: lengths count from here
    double shown = 0;                ///< metres along `out`: of it that photographs show
    double likely = 0;               ///< metres from `end` by which it goes on
    bool level = false;              ///< that is where another surface of the scene ends
    double setBack = 0;              ///< metres behind the plane: what continues it lies behind its rim
    std::vector<uint32_t> replaced;  ///< triangles beyond its rim that no photograph shows, ascending

    /// What continues it by `likely`, with `replaced`.
    SurfacePatch continued() const;
    /// "a flat surface at 0.00 0.60 0.45, towards 0.0 0.0 1.0", counted from `origin`.
    std::string words(const DVec3& origin = DVec3(0)) const;
};

/// Sides of the mesh's large flat surfaces (flatSurfaces) along which most of the rim lies at the frames of photographs
/// and not where they show an end. Likely they go on to where photographs show that another one ends in the same
/// direction: walls of one height, a wall as long as its floor; else by 40 % of what is shown of them. Surfaces that
/// meet no other at an angle are left out: their light does not depend on how far they go. `isLight`: per vertex,
/// non-zero for those of emitters. O(trials x vertices + cells x views rays).
std::vector<CutSurface> cutSurfaces(const Scene& scene, const Capture& capture, const RadianceSamples& samples,
                                    const std::vector<uint8_t>& isLight);

}  // namespace relamp
