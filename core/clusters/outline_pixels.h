// The pixels about an emitter's outlines, and how well a body of light explains them. Inner part of the clusters, not a
// door.
#pragma once
#include "base/parallel.h"
#include "clusters/emitter_sphere.h"

namespace relamp {

/// A pixel on or about an outline.
struct OutlinePixel {
    Vec3 direction{0};  ///< unit, from the camera through the pixel's middle
    float depth = 0;    ///< of the mesh, metres; infinite where there is none or it is the emitter's own
    bool shows = false;
};

/// What one view shows about an outline.
struct OutlineView {
    DVec3 eye{0};
    std::vector<OutlinePixel> pixels;
};

/// Pixels of each outline and those up to `reach` pixels from it, every `stride`-th. Depths are infinite on triangles
/// of `own` (ascending): what the mesh has of the emitter hides no part of it. O(pixels).
std::vector<OutlineView> pixelsAbout(const Capture& capture, const RadianceSamples& samples,
                                     const std::vector<EmitterOutline>& outlines, const std::vector<uint32_t>& own,
                                     const std::vector<float>& reach, size_t stride = 1);

/// How the pixels about outlines agree with a body.
struct OutlineOverlap {
    size_t both = 0, either = 0;  ///< pixels that show the emitter and the body, that show one of them
    size_t hidden = 0;            ///< of the body behind the mesh, where no light shows
    float mostSeen = 0;           ///< of the body's discs, the fraction that shows it, in the best view
    float nextSeen = 0;           ///< in the second best view
    float overlap() const { return either ? float(both) / float(either) : 0; }
};

/// `hitOf(eye, direction)`: metres to the body along a ray, below 0: none. Where the mesh lies before it by more than
/// `slack` and no light shows, it is hidden. O(pixels); the same on any number of threads.
template <class HitOf>
OutlineOverlap outlineOverlap(const std::vector<OutlineView>& views, double slack, const HitOf& hitOf) {
    struct Counts {
        size_t disc = 0, both = 0, either = 0, hidden = 0;
    };
    std::vector<Counts> counts(views.size());
    parallelFor(views.size(), 1, [&](size_t i) {
        Counts& c = counts[i];
        for (const OutlinePixel& p : views[i].pixels) {
            const double hit = hitOf(views[i].eye, DVec3(p.direction));
            const bool body = hit > 0;
            if (!body && !p.shows) continue;
            c.disc += body;
            const bool hidden = !p.shows && double(p.depth) + slack < hit;
            c.hidden += hidden;
            c.either += !hidden;
            c.both += body && p.shows;
        }
    });
    OutlineOverlap all;
    for (const Counts& c : counts) {
        all.both += c.both;
        all.either += c.either;
        all.hidden += c.hidden;
        const float seen = c.disc ? float(c.both) / float(c.disc) : 0;
        all.nextSeen = std::max(all.nextSeen, std::min(seen, all.mostSeen));
        all.mostSeen = std::max(all.mostSeen, seen);
    }
    return all;
}

}  // namespace relamp
