// Sides of slabs and other narrow surfaces that begin where a larger one ends: of one material with it, as a rule.
#pragma once
#include <vector>

#include "scene/scene.h"

namespace relamp {

/// Per material the one whose albedo it is likely to have: its own, or that of a surface ten times as large at whose
/// rim a quarter of its own rim lies, along a fifth of that surface's extent at least. Mends add the sides of tables as
/// components of their own; light that reaches nothing but these could be of any strength if nothing tied their albedo
/// to the table's. O(vertices).
std::vector<uint32_t> joinedMaterials(const Scene& scene);

}  // namespace relamp
