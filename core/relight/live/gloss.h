// Light that glossy lobes send towards the eye: the environment by taps behind the baked visibility, emitters component
// by component, each component no wider than the lobe there. Only vertices that face the eye inside the image, those
// that cover most of it first.
#pragma once
#include "relight/live/carried.h"
#include "relight/live/gloss_taps.h"
#include "relight/live/live_scene.h"

namespace relamp {

/// What a glossy pass needs of the rest.
struct GlossInputs {
    const LiveVertices& vertices;
    const LiveMatte& matte;
    const LiveCarried& carried;
    const std::vector<NearEmitter>& near;
    const LiveOccluders& occluders;
    const EnvironmentPyramid& environment;
    Eye eye;
};

class LiveGloss {
public:
    LiveGloss(const LiveGrid& grid, const Estimate& estimate) : grid_(grid), estimate_(estimate) {}
    /// Vertices with glossy weight, after a change of geometry or materials; everything is stale.
    void setVertices(const LiveVertices& vertices, size_t emitters, bool neutral);
    /// The same vertices, some parts and emitters stand elsewhere: only what moved is stale.
    void moveVertices(const LiveVertices& vertices, std::span<const uint8_t> partMoved,
                      std::span<const uint8_t> emitterMoved);
    bool empty() const { return vertex_.empty(); }
    void markDistant() { std::fill(distantLevel_.begin(), distantLevel_.end(), uint8_t(0)); }
    void markDistant(std::span<const uint32_t> vertices);
    /// The same when all that changed lies inside the spheres: a vertex whose lobes look past them keeps its light
    /// until it is refined.
    void markDistant(std::span<const uint32_t> vertices, std::span<const LivePart> spheres, const GlossInputs& in);
    void markNear(size_t emitter) { std::fill(nearLevel_[emitter].begin(), nearLevel_[emitter].end(), uint8_t(0)); }
    /// Where a shadow went into the light of the emitter, and the vertex is stale there, it is taken again.
    void markShadowed(size_t emitter, const NearEmitter& near);
    void markAll();
    void markImage() {
        queueStale_ = true;
    }  ///< the eye turned where it stands: what comes into the image is shaded, the rest stays
    /// What is stale, from as many taps as the number of visible vertices allows. Of more than about 150 000 only those
    /// that cover most of the image; the next call takes the next ones. Returns vertices shaded.
    size_t coarse(const GlossInputs& in, Progress& progress);
    /// One batch; false when nothing is left. Vertices outside the image wait until they come into it.
    bool refine(const GlossInputs& in, Progress& progress);

    size_t outside() const { return outside_; }  ///< glossy vertices that face the eye outside the image

    /// Per vertex of the mesh, empty when no vertex is glossy: light of the environment before exposure and tint.
    const std::vector<Rgb>& distant() const { return distant_; }
    /// Per vertex: light of an emitter of radiance 1.
    const std::vector<Rgb>& near(size_t emitter) const { return near_[emitter]; }
    /// Whether near() holds the shadows already; else it is to be scaled by the fraction of the emitter that is seen.
    bool shadowed(size_t emitter, size_t vertex) const;

private:
    struct Surface;  // a vertex being shaded
    const LiveGrid& grid_;
    const Estimate& estimate_;
    std::vector<uint32_t> vertex_, placeOf_;
    std::vector<uint32_t> start_;  // per glossy vertex: its lobes
    std::vector<LobeWeight> lobes_;
    std::vector<Rgb> distant_;
    std::vector<std::vector<Rgb>> near_;
    std::vector<uint8_t> distantLevel_;  // per glossy vertex: 0 stale, 1 coarse, 2 fine
    std::vector<uint32_t> queue_;        // glossy vertices in the image, those that cover most of it first
    size_t outside_ = 0;
    bool queueStale_ = true;
    std::vector<std::vector<uint8_t>>
        nearLevel_;  // per emitter and glossy vertex: 0 stale, 1 coarse, 2 fine, 3 fine with shadows inside

    bool surfaceOf(const GlossInputs& in, size_t i, Surface& s) const;
    void fillQueue(const GlossInputs& in);
    Rgb distantLight(const GlossInputs& in, const Surface& s, const TapPattern& taps) const;
    Rgb nearLight(const GlossInputs& in, const Surface& s, const NearEmitter& emitter, bool fine, bool shadows) const;
};

}  // namespace relamp
