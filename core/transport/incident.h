// The one forward model, B = [D | N] (equation 6): what a vertex or a look at it takes from each leaf of the
// environment and from each emitter, per lobe. The solver assembles its rows from these; frames evaluate the same
// lobes.
#pragma once
#include "brdf/basis.h"
#include "transport/lighting.h"
#include "transport/near_field.h"
#include "transport/visibility.h"

namespace relamp {

/// Row-major matrix of floats.
struct InfluenceMatrix {
    size_t rows = 0, columns = 0;
    std::vector<float> values;
    float* row(size_t r) { return &values[r * columns]; }
    const float* row(size_t r) const { return &values[r * columns]; }
};

/// Of outgoing radiance per vertex, what the point of a hit sends. `from`: place in it of vertex 0.
Rgb outgoingAt(const Scene& scene, const Hit& hit, const std::vector<Rgb>& outgoing, size_t from = 0);

/// Of each lighting state of the photographs, the level of each emitter: its radiance there in parts of that in its
/// brightest state. Empty: there is one state.
using EmitterLevels = std::vector<std::vector<float>>;

/// What a row (leaves, then emitters) says of the given light.
Rgb lightOfRow(const float* row, const Lighting& lighting);

/// Lambert rows (albedo 1) for the given vertices: columns are the leaves, then the emitters. Element (i, leaf) =
/// integral over the leaf of V max(0, n.w) / pi. Leaves finer than the visibility grid are traced with `raysPerSide`^2
/// rays each.
InfluenceMatrix lambertInfluence(const Scene& scene, const Visibility& visibility, const NearField& nearField,
                                 const LightLeaves& leaves, const std::vector<uint32_t>& vertices, Progress& progress);

/// Fills only the columns of `leafIndices` (after a split) of an influence matrix with room for them.
void lambertInfluenceOfLeaves(const Scene& scene, const Visibility& visibility, const LightLeaves& leaves,
                              const std::vector<uint32_t>& vertices, const std::vector<uint32_t>& leafIndices,
                              InfluenceMatrix& matrix, Progress& progress);

struct LobeRowOptions {
    int lobeSamples = 128;   ///< directions drawn from the lobe
    int cosineSamples = 64;  ///< directions drawn from the cosine: far from its peak a lobe is weak, but a sky is large
                             ///< and may be bright
    int emitterSamples = 32;  ///< directions drawn from each emitter
    uint64_t seed = 1;
    /// Optional: relative brightness inside a leaf where the background shows it (mean 1 over each leaf), per cell of
    /// `shapeGrid`, one environment after the other.
    const std::vector<float>* shape = nullptr;
    DirectionGrid shapeGrid;
    /// Optional: radiance that the surfaces send, per vertex; what a lobe shows of it is an offset beside its row.
    const std::vector<Rgb>* outgoing = nullptr;
    /// Optional: levels of the emitters. `outgoing` then holds the lighting states one after the other.
    const EmitterLevels* levels = nullptr;
    uint32_t state = 0;  ///< lighting state of the look

    float shapeAt(const Vec3& direction, int environment) const {
        return shape ? (*shape)[size_t(environment * shapeGrid.cells() + shapeGrid.cellOf(direction))] : 1.0f;
    }
    float levelOf(size_t emitter) const { return levels ? (*levels)[state][emitter] : 1.0f; }
    /// Radiance of the emitters in that state.
    std::vector<Rgb> shining(const Lighting& lighting) const {
        std::vector<Rgb> radiance = lighting.emitterRadiance;
        for (size_t e = 0; levels && e < radiance.size(); ++e) radiance[e] *= levelOf(e);
        return radiance;
    }
    Rgb outgoingAt(const Scene& scene, const Hit& hit) const {
        return relamp::outgoingAt(scene, hit, *outgoing, state * scene.mesh.vertexCount());
    }
};

/// One row for a look at `vertex` from the unit direction `towardEye` through a GGX lobe: `row` holds leaves then
/// emitters, these times their levels. Leaves of other environments than that of the state hold nothing. Lobe, cosine
/// and emitter samples are combined by multiple importance sampling (balance heuristic, Veach 1997). `mirrored`, if not
/// null: what the lobe shows of other surfaces, by `options.outgoing`; their backs send nothing.
void glossyInfluence(const Scene& scene, const std::vector<EmitterSurface>& emitters,
                     const std::vector<int>& emitterOfTriangle, const LightLeaves& leaves, const Lobe& lobe,
                     uint32_t vertex, const Vec3& towardEye, const LobeRowOptions& options, float* row,
                     Rgb* mirrored = nullptr);

}  // namespace relamp
