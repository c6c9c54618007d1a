// An estimate with a look applied: moved geometry, emitters with their radiance, the environment to use. What frames
// and the viewport shade.
#pragma once
#include <memory>

#include "base/progress.h"
#include "relight/bounced_light.h"
#include "relight/distant_light.h"
#include "relight/emission_profile.h"
#include "relight/look.h"
#include "scene/scene.h"
#include "solve/estimate.h"
#include "transport/near_field.h"

namespace relamp {

struct ClosedMesh;

struct RelitEmitter {
    std::string id;
    EmitterSurface surface;
    EmissionProfile emission;
    std::string name{};    ///< what it is called in files (emitterNames)
    bool shadows = true;   ///< false: its light passes through everything
    float sunDegrees = 0;  ///< of a sun, whose surface stands far away and is no part of the mesh: the angle it covers
    LightLink link{};
    std::shared_ptr<const LightReach> reach{};  ///< null: it falls on everything
    /// Whether its light falls on a component of the capture's mesh; EditedPart::none: what is none of it.
    bool reaches(uint32_t component) const { return !reach || component >= reach->size() || (*reach)[component]; }
};

/// Triangles that move as one. Part 0 of a geometry is what stays; its matrix is the identity.
struct EditedPart {
    static constexpr uint32_t none = ~0u;
    int emitter = -1;  ///< index into the emitters; -1: no emitter
    uint32_t component =
        none;        ///< connected component of the capture's mesh; none: of an emitter's own or an added shape
    Mat4 matrix{1};  ///< applied to the capture's positions, to a shape's own about the origin
};

/// The mesh of a look, without the costly ray tracer.
struct EditedGeometry {
    Mesh mesh;                           ///< the capture's vertices in order, then copies, then added shapes
    std::vector<uint32_t> vertexOrigin;  ///< per vertex the capture's it stands for; EditedBody::none on added shapes
    std::vector<EditedPart> parts;
    std::vector<uint32_t> partOfTriangle;  ///< index into parts
    std::vector<int> emitterOfTriangle;    ///< index into emitters, -1: none
    std::vector<RelitEmitter> emitters;    ///< recovered ones in order, then added ones
    std::vector<uint8_t> mirrored;         ///< per part 1 where its triangles are turned round (corners 1 and 2 change)
    /// Per emitter and vertex what its form factor lacks (NearFieldCorrection), while both are where they were
    /// captured; empty: nothing.
    std::vector<std::vector<float>> addedFactor;
    std::vector<uint32_t> untextured;  ///< the capture's triangles whose texels no longer hold (ClosedMesh)
    bool moved = false;                ///< false: the capture's own mesh
};

/// Which parts are kept apart although they stand where they were captured. A vertex that a part shares with its
/// environment is doubled, so the numbering of vertices depends on the list of parts alone and not on where they are.
struct PartsApart {
    bool emitters = false;             ///< every recovered emitter
    std::vector<uint32_t> components;  ///< these components of the mesh
};

/// Applies the geometry and the emitters of a look. Cost: one pass over the mesh. Throws Error as applyLook does.
/// `closed`: of an earlier call for the same scene and estimate; used where the same emitters leave, replaced
/// elsewhere.
EditedGeometry editGeometry(const Scene& scene, const Estimate& estimate, const Look& look,
                            const PartsApart& apart = {}, std::shared_ptr<const ClosedMesh>* closed = nullptr);

/// The environment of a lighting state, in the cells of the estimate's; empty: it has none.
std::vector<Rgb> environmentOf(const Estimate& estimate, const LightingState& state);

/// The environment of a look. Throws Error naming an unreadable file, or a lighting state that does not exist.
std::shared_ptr<const DistantLight> distantOfLook(const Estimate& estimate, const EnvironmentLook& look);

struct RelitScene {
    Scene scene;                                  ///< with moved and added geometry
    std::vector<int> emitterOfTriangle;           ///< index into emitters, -1: none
    std::vector<RelitEmitter> emitters;           ///< recovered ones in order, then added ones
    std::vector<std::vector<float>> addedFactor;  ///< as in EditedGeometry
    std::vector<uint32_t>
        component;         ///< of the capture's mesh, per vertex; empty where every light falls on everything
    StoredWeights weight;  ///< per lobe, per vertex of `scene`; readers ask weightsAt
    BrdfBasis basis;
    std::vector<float> confidence;                 ///< Reflectance::confidence per vertex of `scene`; empty: 1
    std::shared_ptr<const AlbedoTexture> texture;  ///< albedo finer than weight[0], by triangle of the capture's mesh
    std::vector<uint8_t> mirrored;                 ///< triangles whose corners 1 and 2 have changed places; empty: none
    std::vector<uint8_t> untextured;               ///< the same for triangles without texture; empty: none
    bool neutralMaterials = false;
    std::shared_ptr<const DistantLight> distant;
    BouncedLight bounced;  ///< empty where the estimate has none

    /// Diffuse albedo at a hit: per texel where there is a texture, else between the vertices. `direction` is that of a
    /// ray that stands for a cone of `spread` radians (its whole angle): what it covers is averaged. 0: a point.
    Rgb albedoAt(const Hit& hit, const Vec3& direction = Vec3(0), float spread = 0) const;
    /// How far the albedo at a hit rests on photographs, in [0, 1]: AlbedoTexture::confidence, else that of the
    /// vertices.
    float confidenceAt(const Hit& hit) const;

    LobesAtVertex weightsAt(size_t vertex) const { return {weight, vertex}; }
    uint32_t componentAt(size_t vertex) const { return component.empty() ? EditedPart::none : component[vertex]; }
    LobesAtHit weightsAt(const Hit& hit) const { return {weight, scene.mesh.triangles[hit.triangle], hit.barycentric}; }

private:
    bool hasTexels(uint32_t triangle) const {
        return texture && texture->has(triangle) && (untextured.empty() || !untextured[triangle]);
    }
    Vec2 placeInTexture(const Hit& hit) const {
        const Vec2 b = hit.barycentric;
        return texture->place(hit.triangle, isMirrored(hit.triangle) ? Vec2(b.y, b.x) : b);
    }
    bool isMirrored(uint32_t triangle) const { return !mirrored.empty() && mirrored[triangle]; }
};

/// `scene` is the capture's. Cost: a rebuild of the ray tracer when something moved (tens of ms). Throws Error naming
/// an unknown emitter id, a part's vertex out of range, a component of mesh that shines already, or an unreadable
/// environment file. `distant`: what distantOfLook gives for this look, where it is known already. `bounceRays`: from a
/// vertex, for light that surfaces send each other; 0: as BounceOptions says.
RelitScene applyLook(const Scene& scene, const Estimate& estimate, const Look& look, Progress& progress,
                     std::shared_ptr<const DistantLight> distant = {}, uint32_t bounceRays = 0);

}  // namespace relamp
