// Where single views show an edge. Inner part of what completes surfaces, not a door.
#pragma once
#include "capture/capture.h"
#include "scene/scene.h"

namespace relamp {

/// Where one view shows an edge.
struct EdgeCrossing {
    double at = 0;      ///< part of the way along the edge
    double off = 0;     ///< metres across it, from where it was taken to be
    double pixel = 0;   ///< metres across it
    double weight = 0;  ///< log ratio between its sides
};

class EdgeViews {
public:
    /// Below the radiance `floor` all is alike.
    EdgeViews(const Scene& scene, const Capture& capture, float floor)
        : scene_(scene), capture_(capture), floor_(floor) {}

    /// Whether the mesh hides a point, from farther than `slack` metres before it.
    bool hidden(const DVec3& eye, const DVec3& p, double slack) const;
    /// What a view shows there, bilinear; none outside it and where a pixel is not usable.
    std::optional<Rgb> shownAt(const View& view, const DVec3& p) const;
    /// Log ratio between what a view shows at two points, 1 at most; none where they are too close in it.
    std::optional<float> contrast(const View& view, const DVec3& p, const DVec3& q) const;
    /// What all views that see a surface facing `facing` show of the edge between two points, along `across`.
    /// `spacing`: metres, of the mesh. O(length / spacing x views rays).
    std::vector<EdgeCrossing> crossings(const DVec3& from, const DVec3& to, double spacing, const DVec3& across,
                                        const DVec3& facing) const;

    const std::vector<View>& views() const { return capture_.views; }

private:
    std::optional<EdgeCrossing> crossing(const View& view, double spacing, const DVec3& p, const DVec3& across,
                                         const DVec3& facing) const;

    const Scene& scene_;
    const Capture& capture_;
    float floor_;
};

/// Metres off at the start of an edge, and how much more at its end: the line through the crossings, without strays
/// (Cauchy, half a pixel). The same all along where it is not `sloped`; 0 where nothing tells. O(crossings).
glm::dvec2 lineThrough(const std::vector<EdgeCrossing>& crossings, bool sloped);

}  // namespace relamp
