// Meshes of known shape, closed-form form factors and brute-force rays for tests.
#pragma once
#include <cmath>
#include <limits>
#include <vector>

#include "base/progress.h"
#include "clusters/emitter_clusters.h"
#include "scene/scene.h"

namespace relamp::test {

/// Adds vertices and faces of `part` to `mesh`; returns the indices of its triangles there.
std::vector<uint32_t> append(Mesh& mesh, const Mesh& part);

/// A parallelogram cut into nu x nv quads: corner + u edgeU + v edgeV, facing cross(edgeU, edgeV).
Mesh sheet(const Vec3& corner, const Vec3& edgeU, const Vec3& edgeV, int nu = 1, int nv = 1);

/// A square facing down at height `z`, centred over (x, y).
Mesh squareAbove(float side, float x, float y, float z, int cuts = 1);

/// A regular polygon about (0, 0, z), facing down.
Mesh discAbove(float radius, float z, int sides);

/// A ball with smooth normals, poles shared.
Mesh ball(const Vec3& centre, float radius, int rings, int around);

/// A box of six sheets (no shared vertices, so its normals are those of its faces).
Mesh box(const Vec3& low, const Vec3& high, int cuts = 1);

Scene sceneOf(const Mesh& mesh);

/// Emitters that are the given triangles, indexed as room 4 leaves them (strongest first).
EmitterClusters emittersOf(const Scene& scene, const std::vector<std::vector<uint32_t>>& triangles,
                           const std::vector<Rgb>& radiance);

/// Distance along a ray to a triangle (Moeller and Trumbore 1997, in double), infinity when it misses.
double rayTriangle(const DVec3& origin, const DVec3& direction, const DVec3& a, const DVec3& b, const DVec3& c);

/// Whether a ray hits any triangle, by asking each of them.
bool blockedByBruteForce(const Mesh& mesh, const Vec3& origin, const Vec3& direction,
                         double far = std::numeric_limits<double>::infinity());

/// Form factor to a parallel rectangle a x b at distance c with one corner over the point (Howell's catalogue, B-3).
double cornerFormFactor(double a, double b, double c);
/// ... to a parallel square centred over the point.
double centredSquareFormFactor(double side, double height);
/// ... to a parallel rectangle [x0, x1] x [y0, y1] at height c over a point at the origin.
double rectangleFormFactor(double x0, double x1, double y0, double y1, double c);
/// ... to an upright rectangle of height a and width b that stands on the plane of the point at distance c, one of its
/// upright edges opposite the point (Howell's catalogue, B-5).
double uprightFormFactor(double a, double b, double c);

}  // namespace relamp::test
