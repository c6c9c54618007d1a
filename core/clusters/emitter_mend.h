// Emitters that the mesh shows too small, in part or not at all are given the shape that the photographs' pixels show.
#pragma once
#include <string>

#include "capture/mesh_mend.h"
#include "capture/proxy_light.h"
#include "clusters/emitter_body.h"
#include "clusters/emitter_clusters.h"

namespace relamp {

/// An emitter whose surface moves.
struct EmitterMove {
    std::vector<MeshMend::MovedVertex> vertices;
    std::vector<uint32_t> shining = {};  ///< of them, those that shine though few pixels show it
    Vec3 centroid{0};                    ///< before
    float radius = 0;                    ///< of the sphere about it that holds the emitter
    float overlap = 0;                   ///< of its pixels and the mesh, before
    std::vector<size_t> hiddenIn = {};   ///< views in which something hides a part of it: not asked
    std::string words;
};

/// A straight body that takes the place of what the mesh has of an emitter.
struct EmitterReplacement {
    /// What goes of the mesh, and what it hid of the surface that the emitter stands on.
    struct Place {
        std::vector<uint32_t> removed;          ///< triangles, ascending
        std::vector<Vec3> ground;               ///< metres
        std::vector<Triangle> groundTriangles;  ///< of `ground`
    };
    EmitterBody body;
    Place place;
    Place whole;                                 ///< with `bag`
    std::vector<uint32_t> bag;                   ///< vertices behind the body that may be there or not, ascending
    std::vector<MeshMend::MovedVertex> setBack;  ///< vertices of a ridge, or of a fillet about the body, on the
                                                 ///< surface behind it
    Vec3 level{0};                               ///< that surface's normal where it is flat, else 0
    uint32_t first = 0;                          ///< vertex of the scene, where the body is in it
    EmitterMove was;                             ///< without vertices: what it is judged by
    EmitterCluster light;                        ///< what photographs show of it
    bool open = false;                           ///< a shade without ends, which shines to both sides
    double margin = 0;                           ///< metres about the body that it takes the place of
    std::vector<uint8_t> dark = {};              ///< per side of the body 1 where they show that it does not shine
};

struct EmitterMend {
    std::vector<uint32_t> removed;   ///< triangles, ascending
    std::vector<ProxyLight> balls;   ///< of known radiance; counted from the capture's origin
    std::vector<std::string> words;  ///< a sentence for each ball
    std::vector<EmitterReplacement> bodies;
    std::vector<EmitterMove> moves;
    bool needed() const { return !words.empty() || !moves.empty() || !bodies.empty(); }
};

/// Reconstruction shrinks and rounds what is small, and closes what is narrow. The emitter's area is then too small,
/// its power with it, and every surface too bright. Where the pixels of its radiance and the mesh's emitting triangles
/// disagree by more than 3 %:
/// - a ball that explains the pixels clearly better takes the place of the triangles, and of those before it through
///   which photographs see it;
/// - otherwise a straight tube, cone or box that does so; parts of one radiance that photographs show in one piece are
/// one
///   emitter then. A ridge of the surface behind goes back to it;
/// - otherwise the surface moves along its normals, by as much as pixels and mesh differ in area.
/// Candidates are asked too where they are even and too bright to reflect anything. Exact meshes stay as they are.
/// O(pixels x emitters).
EmitterMend mendEmitters(const Scene& scene, const Capture& capture, const RadianceSamples& samples,
                         const EmitterClusters& clusters);

/// The body in the place of the light: what of the mesh it replaces, what it hid. `covered`: the overlap of the
/// outlines and the mesh, `words`: why. O(pixels + triangles).
EmitterReplacement replacedBy(const EmitterBody& body, const Scene& scene, const Capture& capture,
                              const RadianceSamples& samples, const EmitterClusters& clusters,
                              const EmitterCluster& light, const std::vector<EmitterOutline>& outlines, float covered,
                              std::string words);

/// Per side of the body, which is in the scene, 1 where most pixels that show it do not show its light, as on the back
/// of a light with a housing. Pixels at a side's edge are not asked. O(pixels).
std::vector<uint8_t> darkSides(const EmitterReplacement& replacement, const Scene& scene, const Capture& capture,
                               const RadianceSamples& samples);

/// How well the mesh covers the emitter that was moved, where it is now: overlap of its pixels and the mesh; 0 where
/// there is none any more.
float overlapAfter(const EmitterMove& move, const Scene& scene, const Capture& capture, const RadianceSamples& samples,
                   const EmitterClusters& clusters);

}  // namespace relamp
