// Paints a small capture from lighting and reflectance that are known, by brute force: none of the code under test
// shades here. A floor and a box and a ball on it, matte, under a square emitter and an analytic sky; direct light
// only, but for the room with two walls whose surfaces light each other.
#pragma once
#include <filesystem>
#include <functional>

#include "image/image_io.h"
#include "scene/mesh_io.h"
#include "support/estimates.h"
#include "support/temporary_folder.h"

namespace relamp::test {

struct KnownWorld {
    Mesh mesh;
    std::vector<uint32_t> emitterTriangles;
    Rgb emitterRadiance{40, 34, 26};
    Vec3 emitterCentre{0.35f, 0.25f, 1.15f};
    float emitterSide = 0.3f;
    std::vector<Rgb> albedo;  ///< per vertex
    size_t floorVertices = 0;
    size_t ballBegin = 0, ballEnd = 0;  ///< its vertices
    Rgb ballTint{0.9f, 0.7f, 0.45f};
    int views = 0;

    /// Distant radiance: bluish above, a broad warm glow to one side, dim below.
    enum class Sky { none, day, evening };
    static Rgb skyAt(Sky which, const Vec3& d) {
        // The glow has gone round, and all is redder and dimmer.
        if (which == Sky::evening) return Rgb(0.6f, 0.4f, 0.3f) * sky({-d.x, -d.y, d.z});
        return which == Sky::day ? sky(d) : Rgb(0);
    }
    static Rgb sky(const Vec3& d) {
        const float glow = std::exp(6 * (glm::dot(d, glm::normalize(Vec3(1, -0.6f, 0.5f))) - 1));
        return Rgb(0.15f, 0.18f, 0.22f) + Rgb(0.25f, 0.32f, 0.45f) * std::max(0.0f, d.z) + Rgb(1.6f, 1.1f, 0.6f) * glow;
    }
    /// Albedo at a point: a slow pattern on the floor, plain colours on the things on it.
    static Rgb albedoAt(const Vec3& p) {
        if (p.z < 1e-3f)
            return Rgb(0.5f, 0.45f, 0.4f) + Rgb(0.2f, 0.15f, -0.1f) * std::sin(4 * p.x) * std::cos(3 * p.y + 1);
        if (p.x < -0.999f || p.y > 0.999f) return Rgb(0.8f, 0.72f, 0.6f);  // walls
        return p.x < 0 ? Rgb(0.55f, 0.3f, 0.25f) : Rgb(0.3f, 0.45f, 0.6f);
    }
};

/// Irradiance of the bare sky on a surface of the given normal.
Rgb skyIrradiance(const std::function<Rgb(const Vec3&)>& radiance, const Vec3& normal);

/// Writes transforms.json, mesh.ply and the photographs (96 x 72, EXR) into `folder`; `emitter` false leaves the
/// emitter dark and out. `room`: two walls behind the floor, and surfaces light each other. `metalBall`: the ball
/// mirrors the sky, tinted, and has no albedo. `levels`: of the emitter in lighting states, each of which photographs
/// every view; the states are "lamp LEVEL". `skies`: of the states, which then are "lamp LEVEL, sky N" from 0 on, and
/// have an environment of their own, or none; empty: all have the same one.
KnownWorld paintKnownWorld(const std::filesystem::path& folder, bool emitter = true, int views = 10, int floorCuts = 24,
                           bool room = false, bool metalBall = false, const std::vector<float>& levels = {1},
                           const std::vector<KnownWorld::Sky>& skies = {});

/// The same in photographs of under half of the pixels (64 x 48), for tests of what is done with an estimate: most of
/// the time of a small solve goes by the pixel. Smaller ones take no less: at 48 x 36 planning takes 1.0 s, not 0.3.
KnownWorld paintSmallWorld(const std::filesystem::path& folder, int views = 6, int floorCuts = 10, bool emitter = true);

}  // namespace relamp::test
