// How large the scene is: what "frame all" fills the viewport with, and between which depths everything lies. Stray far
// points of a photogrammetry mesh count for the depths, not for the framing.
#pragma once
#include "scene/mesh.h"

namespace relamp::ui {

struct SceneExtent {
    Vec3 low{-0.5f}, high{0.5f};  ///< of the box that holds 98 percent of the vertices along each axis
    Vec3 centre{0};               ///< of that box
    float radius = 1;             ///< metres
    Vec3 wholeCentre{0};          ///< of everything
    float wholeRadius = 1;
    float ground = 0;  ///< height of the floor grid: 0 when the scene stands there, else its lowest point
};

SceneExtent extentOf(const Mesh& mesh);

/// 1, 2 or 5 times a power of ten, at least `value`.
float roundStep(float value);

}  // namespace relamp::ui
