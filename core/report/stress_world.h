// Small worlds with known light for the stress cases: a floor, a box and a ball under emitters and a sky, painted by
// the frame renderer.
#pragma once
#include <functional>

#include "clusters/emitter_clusters.h"
#include "report/stress_variants.h"

namespace relamp {

/// An emitter: a square that faces down.
struct StressEmitter {
    Vec3 centre{0.35f, 0.25f, 1.15f};
    float side = 0.3f;
    Rgb radiance{40, 34, 26};  ///< mean over it
    float uneven =
        1;  ///< how many times as bright one side is as the other, in eight strips; painted as an emitter each
};

struct StressScene {
    std::vector<StressEmitter> emitters{StressEmitter{}};
    std::function<Rgb(const Vec3&)> sky;  ///< radiance by direction; empty: bluish above with a warm glow
    Rgb albedo{0.55f, 0.5f, 0.42f};       ///< of floor, and with red and blue exchanged of what stands on it
    float specularAlpha = 0;              ///< > 0: the ball is bare metal of this GGX width
    bool shade = false;                   ///< an open box hangs about the first emitter
    bool closed = false;                  ///< ... and is closed below as well
    bool needles = false;                 ///< the floor is cut into strips of 1 : 2000
    int views = 6;
};

/// What the painter knows: the capture and where its emitters are.
struct PaintedWorld {
    Capture capture;
    EmitterClusters emitters;  ///< of the capture's mesh, indexed
};

/// Six views of 72 x 54, 900 vertices. Cost about 0.2 s. Throws Cancelled.
PaintedWorld paintStressScene(const StressScene& world, Progress& progress);

/// A single triangle of three vertices, seen by one view.
Capture oneTriangle();

}  // namespace relamp
