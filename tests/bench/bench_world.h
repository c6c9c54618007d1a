// Scenes for measurements, made by rule: a bumpy ground with balls and boxes on it under one emitter of a tenth of its
// size. The same numbers always give the same scene.
#pragma once
#include <memory>

#include "base/random.h"
#include "support/estimates.h"

namespace relamp::bench {

struct World {
    std::shared_ptr<const Scene> scene;
    std::shared_ptr<const Estimate> estimate;
    Vec3 middle{0};
    size_t vertices = 0;
};

/// Smooth random height of about +-1 at a point of the plane.
inline float bumps(float x, float y) {
    float sum = 0, scale = 0.5f;
    for (int octave = 0; octave < 4; ++octave, scale *= 0.5f, x = 1.9f * x + 3.1f, y = 1.9f * y - 1.7f)
        sum += scale * std::sin(2.3f * x + 0.7f * std::sin(1.3f * y)) * std::cos(1.9f * y);
    return sum;
}

/// A gradient sky over dark ground, three soft windows and a sun of a few cells: about five thousand to one.
inline std::vector<Rgb> benchSky(int side) {
    const DirectionGrid grid{side};
    std::vector<Rgb> cells(size_t(grid.cells()));
    const Vec3 windows[] = {glm::normalize(Vec3(1, 0.2f, 0.5f)), glm::normalize(Vec3(-0.3f, 1, 0.3f)),
                            glm::normalize(Vec3(-0.8f, -0.6f, 0.9f))};
    const Vec3 sun = glm::normalize(Vec3(0.4f, -0.7f, 0.8f));
    for (int c = 0; c < grid.cells(); ++c) {
        const Vec3 d = grid.direction(c);
        Rgb light =
            d.z < 0 ? Rgb(0.06f, 0.05f, 0.04f) : glm::mix(Rgb(0.9f, 0.9f, 0.8f), Rgb(0.3f, 0.5f, 0.9f), std::sqrt(d.z));
        for (int k = 0; k < 3; ++k)
            light += Rgb(3, 2.5f, 2) * (1 / (1 + std::exp(-150 * (glm::dot(d, windows[k]) - 0.97f))));
        if (glm::dot(d, sun) > 0.9995f) light += Rgb(300, 280, 240);
        cells[size_t(c)] = light;
    }
    return cells;
}

/// About `vertices` vertices. `glossy`: every one of them has a glossy lobe, wide on the ground, narrow on some balls;
/// else none has.
inline World makeWorld(size_t vertices, bool glossy) {
    const double n = double(vertices);
    Mesh mesh;
    std::vector<size_t> firstOf;
    const auto add = [&](const Mesh& part) {
        firstOf.push_back(mesh.vertexCount());
        test::append(mesh, part);
    };
    const int cuts = int(std::sqrt(0.5 * n));
    Mesh ground = test::sheet({-5, -5, 0}, {10, 0, 0}, {0, 10, 0}, cuts, cuts);
    for (Vec3& p : ground.positions) p.z = 0.25f * bumps(p.x, p.y);
    ground.normals = vertexNormalsFromFaces(ground);
    add(ground);
    const int rings = std::max(4, int(std::sqrt(0.06 * n / 2)));
    for (int b = 0; b < 6; ++b) {
        const float angle = 2 * pi * float(b) / 6, radius = 0.5f + 0.12f * float(b % 3);
        Mesh ball =
            test::ball({2.6f * std::cos(angle), 2.6f * std::sin(angle), radius + 0.35f}, radius, rings, 2 * rings);
        if (b % 2) {
            for (size_t v = 0; v < ball.vertexCount(); ++v) {
                const Vec3 d = ball.normals[v];
                ball.positions[v] += d * (0.06f * bumps(6 * d.x + float(b), 6 * d.y + 3 * d.z));
            }
            ball.normals = vertexNormalsFromFaces(ball);
        }
        add(ball);
    }
    const int boxCuts = std::max(1, int(std::sqrt(0.06 * n / 6)));
    for (int b = 0; b < 2; ++b)
        add(test::box({-0.7f + 0.9f * float(b), -0.5f, 0.3f}, {-0.1f + 0.9f * float(b), 0.5f, 1.2f + 0.4f * float(b)},
                      boxCuts));
    // The emitter: a ball as wide as a tenth of the ground, in a fixed number of triangles.
    const std::vector<uint32_t> emitter = test::append(mesh, test::ball({0.4f, 0.2f, 3.4f}, 0.5f, 12, 24));
    World world;
    world.vertices = mesh.vertexCount();
    auto scene = std::make_shared<Scene>(test::sceneOf(mesh));
    auto estimate = std::make_shared<Estimate>(
        test::matteEstimate(*scene, Rgb(0.5f), Rgb(1), test::emittersOf(*scene, {emitter}, {Rgb(40, 36, 30)})));
    estimate->environmentSide = 256;
    estimate->environment = benchSky(256);
    Reflectance& r = estimate->reflectance;
    firstOf.push_back(mesh.vertexCount());
    for (size_t part = 0; part + 1 < firstOf.size(); ++part)
        for (size_t v = firstOf[part]; v < firstOf[part + 1]; ++v)
            if (estimate->emitters.emitterOfVertex[v] < 0)
                r.weight[0][v] = Rgb(unitFloat(mixBits(3 * part)), unitFloat(mixBits(3 * part + 1)),
                                     unitFloat(mixBits(3 * part + 2))) *
                                     0.6f +
                                 Rgb(0.1f);
    if (glossy) {
        // Plastic of roughness 0.32 on the ground, 0.22 on boxes and bumpy balls, metal of 0.22 and 0.32 on the smooth
        // ones.
        r.basis = builtInBasis();
        r.weight.resize(r.basis.lobes.size(), std::vector<Rgb>(mesh.vertexCount(), Rgb(0)));
        const auto lobe = [&](Lobe::Kind kind, float roughness) {
            size_t best = 1;
            for (size_t k = 1; k < r.basis.lobes.size(); ++k)
                if (r.basis.lobes[k].kind == kind && (r.basis.lobes[best].kind != kind ||
                                                      std::abs(std::sqrt(r.basis.lobes[k].alpha) - roughness) <
                                                          std::abs(std::sqrt(r.basis.lobes[best].alpha) - roughness)))
                    best = k;
            return best;
        };
        for (size_t part = 0; part + 1 < firstOf.size(); ++part) {
            const bool metal = part >= 1 && part <= 6 && part % 2;
            const size_t k = metal ? lobe(Lobe::Kind::ggx, part == 3 ? 0.32f : 0.22f)
                                   : lobe(Lobe::Kind::ggxDielectric, part == 0 ? 0.32f : 0.22f);
            for (size_t v = firstOf[part]; v < firstOf[part + 1]; ++v) {
                if (estimate->emitters.emitterOfVertex[v] >= 0) continue;
                r.weight[k][v] = metal ? Rgb(0.8f, 0.7f, 0.5f) : Rgb(1);
                if (metal) r.weight[0][v] *= 0.1f;
            }
        }
    }
    for (const Vec3& p : mesh.positions) world.middle += p / float(mesh.vertexCount());
    world.scene = scene;
    world.estimate = estimate;
    return world;
}

}  // namespace relamp::bench
