// Light from emitters that stand in the scene, by area sampling with form factors ([Put15] 3.1; docs/method.md 1:
// radiance does not fall off along a ray, 1/r^2 and the emitter's cosine are the solid angle it covers).
#pragma once
#include "base/progress.h"
#include "clusters/emitter_clusters.h"
#include "scene/scene.h"
#include "transport/visibility.h"

namespace relamp {

/// The surface of one emitter, ready for sampling.
struct EmitterSurface {
    std::vector<std::array<Vec3, 3>> corners;  ///< triangles, counter-clockwise from outside
    std::vector<Vec3> centres, normals;
    std::vector<float> areas, radii;    ///< radius: of the circle about the centre through the farthest corner
    std::vector<float> cumulativeArea;  ///< running sum of areas
    bool twoSided = false;
    Vec3 centroid{0};
    float radius = 0;                                     ///< of the sphere about the centroid that holds it
    std::shared_ptr<const EmissionPattern> pattern = {};  ///< null: it shines evenly
    Mat4 toCaptured{1};                                   ///< from the world to where the pattern was captured
    EmissionLobe lobe = {};                               ///< in the world
    /// Radiance from a point of the surface into the unit direction `away`, in parts of the emitter's.
    float levelAt(const Vec3& point, const Vec3& away) const {
        return lobe.at(away) * (pattern ? pattern->at(Vec3(toCaptured * Vec4(point, 1))) : 1.0f);
    }
    float area() const { return cumulativeArea.empty() ? 0 : cumulativeArea.back(); }
};

/// In the order of the cluster's triangles, which samplers count on; those without area are left out. `toWorld` moves
/// the surface.
EmitterSurface emitterSurface(const Mesh& mesh, const EmitterCluster& cluster, const Mat4& toWorld = Mat4(1));

/// The same along a curve through the emitter (alongLamp): patterns on it do not know the file's order. For who does
/// not go from the mesh's triangles to the surface's.
EmitterSurface orderedEmitterSurface(const Scene& scene, const EmitterCluster& cluster);

/// Form factor from a surface point to a triangle, unshadowed, clipped at the point's horizon: the fraction of the
/// cosine- weighted hemisphere it covers, in [0, 1]. Exact (Lambert 1760); finite when touching or coplanar. Only the
/// front counts.
float triangleFormFactor(const Vec3& point, const Vec3& normal, const std::array<Vec3, 3>& corners, bool twoSided);

/// One direction towards an emitter.
struct EmitterSample {
    Vec3 direction{0};     ///< unit, world
    float formFactor = 0;  ///< its part of the form factor: sums to the unshadowed one
    float visible = 0;     ///< 1 or 0
    float level = 1;       ///< EmitterSurface::levelAt where it arrives
};

/// `count` samples spread over what the emitter covers in proportion to the form factor; 0: by its solid angle, and
/// four times as many where a sheet that shines to both sides shows both, 256 where only a part of its back is seen.
/// Returns the unshadowed form factor. `seed` fixes the pattern.
float sampleEmitter(const Scene& scene, const EmitterSurface& emitter, const Vec3& point, const Vec3& normal, int count,
                    uint64_t seed, std::vector<EmitterSample>& samples);

/// Samples by the solid angle covered: 4x4 below 0.06 sr, 8x8 to 1 sr, 16x16 nearer.
int samplesForSolidAngle(float steradians);

struct NearFieldOptions {
    uint64_t seed = 1;
    const std::vector<uint8_t>* only =
        nullptr;  ///< per vertex: 0 leaves it out, it then gets no light; null: every vertex
};

/// Per vertex and emitter the form factor with shadows, each part times its level: a Lambert surface of albedo 1 shows
/// formFactor x radiance.
struct NearField {
    size_t emitters = 0;
    std::vector<float> formFactor;  ///< vertex-major, emitters values a vertex
    std::vector<float> unshadowed;  ///< the same without shadows
    float at(uint32_t v, size_t e) const { return formFactor[v * emitters + e]; }
};

NearField computeNearField(const Scene& scene, const EmitterClusters& clusters, const NearFieldOptions& options,
                           Progress& progress);
/// Fills in the vertices that `only` marks.
void addNearField(const Scene& scene, const EmitterClusters& clusters, const NearFieldOptions& options,
                  NearField& field, Progress& progress);

/// The near-field irradiance map of [Put15]: fraction of each direction cell that the emitter covers, as Haar
/// coefficients (times its radiance it is incident radiance).
SparseCoefs nearFieldCoefs(const Scene& scene, const EmitterSurface& emitter, uint32_t vertex,
                           const DirectionGrid& grid, int count, float energyFraction);

}  // namespace relamp
