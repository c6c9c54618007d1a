// The shapes of added emitters: one table, one row a shape. Files, edits, meshes and the window's menus loop over it.
#pragma once
#include <span>
#include <string>

#include "scene/mesh.h"

namespace relamp {

/// part: the connected component of mesh that holds a seed vertex shines and moves. copy: the geometry of a recovered
/// emitter again, shining on the same faces as that one does. sun: parallel light along its -Z; it has no geometry.
enum class EmitterShape { rectangle, disk, sphere, spot, sun, part, copy };

struct EmitterShapeInfo {
    EmitterShape shape;
    const char* name;         ///< in files (docs/interface.md 3), and what ids begin with
    const char* label;        ///< in menus; empty: nothing adds it there
    const char* explanation;  ///< the menu's tooltip
    const char* edit;         ///< the history's entry when it is added
    const char* icon;         ///< name of an icon of the window
    /// Whose geometry it has: its own about the origin, a component of the mesh, or a recovered emitter's.
    enum class Geometry { own, component, emitter } geometry;
    int sizes = 0;          ///< numbers that say its size: 2 width and height, 1 diameter, 0 none
    bool flat = false;      ///< lies in its own XY plane, facing -Z
    Vec2 freshSize{1};      ///< size of a new one, in eighths of the scene's radius
    float freshCone = 180;  ///< LightShaping::coneDegrees of a new one
    /// Own geometry before the matrix. Null for other shapes.
    Mesh (*mesh)(const Vec2& size) = nullptr;
    /// Square metres before the matrix, for own geometry.
    float (*area)(const Vec2& size) = nullptr;
    /// Shines from far away: its size is the angle that it covers, degrees, its radiance what a white matte surface
    /// shows that faces it, and its position means nothing.
    bool distant = false;
    bool own() const { return geometry == Geometry::own; }
    bool shapeable() const { return own() && !distant; }  ///< may have a LightShaping
};

/// In the order of EmitterShape. Files and exported scenes need nothing more: a shape is exported as the triangles
/// that it lights the scene with (glTF emissive material, USD mesh light).
std::span<const EmitterShapeInfo> emitterShapes();
const EmitterShapeInfo& infoOf(EmitterShape shape);
/// The shape of that name in files; null: none.
const EmitterShapeInfo* emitterShapeNamed(const std::string& name);

/// Of a sun of this angle, degrees: its radiance over the light that it sends on a white matte surface facing it, which
/// is 1 / sin^2 of half the angle.
float sunRadiance(float degrees);

}  // namespace relamp
