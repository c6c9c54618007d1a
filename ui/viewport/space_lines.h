// The floor grid and the photographs' cameras as lines in space.
#pragma once
#include <array>

#include "viewport/renderer.h"
#include "viewport/scene_extent.h"

namespace relamp::ui {

void addGrid(std::vector<LineVertex>& lines, const SceneExtent& extent);
void addFrustum(std::vector<LineVertex>& lines, const Camera& camera, float depth, bool selected);

/// The corners of a photograph's image `depth` metres in front of its camera: top left, top right, bottom right,
/// bottom left.
std::array<Vec3, 4> frustumCorners(const Camera& camera, float depth);
/// From inside or close behind, a camera's drawing would stand in the middle of the image and be no camera.
bool frustumShown(const Camera& camera, const Vec3& eye, float depth);
/// How deep frusta are drawn, metres.
inline float frustumDepth(float sceneRadius) { return 0.13f * sceneRadius; }

}  // namespace relamp::ui
