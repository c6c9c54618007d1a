// What lies under the mouse: rays against the mesh that is drawn, on the CPU, so that it works without a window and
// inside wipes.
#pragma once
#include <optional>
#include <span>

#include "editor_state.h"

namespace relamp::ui {

/// First triangle along the ray. `visible` (per triangle; empty: all) leaves hidden components out. Cost: about 5 ns a
/// triangle and core.
std::optional<PickedPoint> pickSurface(const Mesh& mesh, const Ray& ray, std::span<const uint8_t> visible = {});

/// Radiance that the frame shows at a point of its mesh, linear between its vertices.
Rgb radianceAt(const LiveFrame& frame, const PickedPoint& point);
/// The same along the ray; none past the surface.
std::optional<Rgb> radianceAlong(const LiveFrame& frame, const Ray& ray, std::span<const uint8_t> visible = {});

/// Which triangles are drawn: those whose component is not hidden. Empty: all. `origin` maps vertices to the capture's
/// (null: they are).
std::vector<uint8_t> visibleTriangles(const Mesh& mesh, const std::vector<uint32_t>* origin, const Scene& scene,
                                      const std::set<uint32_t>& hiddenComponents);

}  // namespace relamp::ui
