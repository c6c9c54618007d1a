// Light of emitters on matte surfaces: form factors with shadows per vertex, from 4 samples while something is dragged,
// from up to 256 where a shadow's edge runs at rest.
#pragma once
#include <functional>

#include "relight/emission_profile.h"
#include "relight/live/emitter_tree.h"
#include "relight/live/gaze.h"
#include "relight/live/levels.h"
#include "relight/live/parts.h"

namespace relamp {

/// The vertices to be lit, as the edited mesh has them.
struct LiveVertices {
    enum Kind : uint8_t { none, ground, carried, emitting };  ///< carried: on a part that is no emitter
    std::shared_ptr<const Mesh> mesh;
    std::vector<Kind> kind;
    std::vector<uint32_t> part;    ///< per vertex
    std::vector<uint32_t> origin;  ///< per vertex: the capture's it stands for, EditedBody::none on added shapes
    bool lit(size_t v) const { return kind[v] == ground || kind[v] == carried; }
    size_t count() const { return kind.size(); }
};

/// Samples of a level of NearEmitter; up to level 2 twice as many near the emitter.
inline int nearSamples(int level) { return level ? 1 << 2 * level : 0; }

struct NearEmitter {
    std::string id;
    LiveEmitterTree tree;
    uint32_t part = 0;
    Vec3 centre{0};
    float radius = 0;
    std::vector<float> factor;                     ///< with shadows
    std::vector<float> open;                       ///< without
    std::vector<float> added;                      ///< to the factor (EditedGeometry::addedFactor); empty: nothing
    std::shared_ptr<const ShapedEmission> shaped;  ///< null: Lambertian and even
    bool shadows = true;                           ///< false: factor is open
    std::vector<uint8_t> unreached;  ///< per vertex 1 where it does not fall by its link; empty: it falls everywhere
    std::vector<Rgb> shape;          ///< what of its unshadowed light its shaping lets through; empty: all
    std::vector<uint8_t> level;      ///< 0: stale; 1 to 4: from 4, 16, 64, 256 samples
    int pass = 0;                    ///< of the refinement; passes: done
    size_t next = 0;                 ///< vertex at which the pass goes on

    static constexpr int passes = 4;  ///< 16 samples everywhere; 64 at edges, twice, as edges show better; 256 at edges
    /// The refinement starts anew.
    void restart() {
        pass = 0;
        next = 0;
    }
    void markStale(size_t vertex) {
        level[vertex] = 0;
        restart();
    }
    bool reaches(size_t v) const { return unreached.empty() || !unreached[v]; }
    float at(size_t v) const { return added.empty() || !reaches(v) ? factor[v] : std::max(0.0f, factor[v] + added[v]); }
    /// Light on a white matte surface, of an emitter of level 1.
    Rgb light(size_t v) const { return shape.empty() ? Rgb(at(v)) : at(v) * shape[v]; }
    float seen(size_t v) const { return open[v] > 0 ? factor[v] / open[v] : 1.0f; }
};

/// Form factor and its open value from `count` samples, the same pattern for the same seed. `groundClear`: the ground
/// is known to hide nothing of it; then rays are only cast at parts, and none where no part can stand between. `shape`,
/// of a shaped emitter: what of the open light its shaping lets through; where that is nothing no ray is cast. `flux`:
/// the vector whose product with a normal is the open value, for normals that have all of the emitter above their
/// horizon.
float nearFactor(const NearEmitter& emitter, const LiveOccluders& occluders, const Vec3& point, const Vec3& normal,
                 const CutTolerance& tolerance, int count, uint64_t seed, float& open, bool groundClear = false,
                 Rgb* shape = nullptr, Vec3* flux = nullptr);

/// Vertices between which the light of an emitter in a hand lies, and memory for it.
struct NearLevels {
    /// What a vertex gives those that lie beside it, in one place of memory.
    struct Known {
        enum State : uint32_t { nothing, open, whole };  ///< whole: all of the emitter is above its horizon
        Vec3 flux{0};
        float factor = 0, seen = 1;  ///< without shadows, what of it they leave
        State state = nothing;
    };
    LiveLevels levels;
    std::vector<Known> known;      ///< per vertex, of one emitter
    std::vector<uint8_t> between;  ///< per vertex 1: its value lies between those of its parents; 2: whatever they are
    Gaze gaze;                     ///< what it misses lies between its parents, however they differ
};

/// All stale vertices from 4 samples, or none where `groundClear` says so of a vertex (LiveMatte::groundClear). Cost:
/// about a microsecond a vertex and emitter, a third of it without rays. With `detail`, of an emitter that is stale
/// everywhere: a vertex takes its light from its parents where that changes little between them and their shadows
/// agree, unless a neighbour's differs; a shadow that no vertex of a coarser level meets is missed. Cost: about a
/// third. `graph`: the capture's neighbours.
void nearCoarse(NearEmitter& emitter, const LiveVertices& vertices, const LiveOccluders& occluders,
                const std::function<bool(size_t)>& groundClear, uint64_t seed, Progress& progress,
                NearLevels* detail = nullptr, const VertexGraph* graph = nullptr);
/// Takes samples of a level at the chosen vertices elsewhere; false: it did not.
using SampleElsewhere = std::function<bool(NearEmitter&, std::span<const uint32_t> chosen, int level)>;
/// One batch of refinement, eight times as large where `elsewhere` is given; false when nothing is left. `graph`: the
/// capture's neighbours.
bool nearRefine(NearEmitter& emitter, const LiveVertices& vertices, const VertexGraph& graph,
                const LiveOccluders& occluders, uint64_t seed, Progress& progress,
                const SampleElsewhere& elsewhere = {});

/// Marks the vertices at which the part, where it stands, can stand between them and the emitter.
void markShadowed(NearEmitter& emitter, const LiveVertices& vertices, const LivePart& part);

}  // namespace relamp
