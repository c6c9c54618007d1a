#pragma once
#include <functional>

#include "solve/gloss/matte_under_gloss.h"
#include "support/shapes.h"

namespace relamp::test {

/// A dark red, glazed ball under a bright sky with a glow, seen by four cameras without noise.
struct CoatedBall {
    Scene scene;
    Capture capture;
    RadianceSamples samples;
    Lighting lighting;
    ComponentGloss gloss;
    std::vector<Rgb> matte;  ///< what the matte part alone shows, per vertex

    /// `hasCoating`: whether a place is red and has the coating; else it is grey. `rays`: of an observation.
    explicit CoatedBall(int rings = 12, const std::function<bool(const Vec3&)>& hasCoating = {}, int rays = 1024)
        : scene(sceneOf(ball({0, 0, 0}, 0.5f, rings, rings * 3 / 2))) {
        const Rgb red(0.4f, 0.08f, 0.05f), grey(0.3f);
        lighting.leaves = LightLeaves::uniform(3);
        for (size_t i = 0; i < lighting.leaves.size(); ++i)
            lighting.leafRadiance.push_back(Rgb(0.5f + 4 * std::max(0.0f, lighting.leaves.direction(i, Vec2(0.5f)).x)));
        gloss.lobe = Lobe{Lobe::Kind::ggxDielectric, 0.05f, "glaze"};
        gloss.weight = Rgb(1);
        for (const DVec3& eye : {DVec3(3, 0, 1), DVec3(0, 3, 1), DVec3(-3, 0, 1), DVec3(0, -3, 1)}) {
            View view;
            view.camera.worldFromCamera[3] = glm::dvec4(eye, 1);
            capture.views.push_back(view);
        }
        samples.relativeNoise = 0.005f;
        LobeRowOptions fine;
        fine.lobeSamples = rays;
        fine.cosineSamples = rays / 2;
        std::vector<float> row(lighting.leaves.size());
        constexpr int fineness = 64;
        const DirectionGrid grid{fineness};
        std::vector<std::pair<Vec3, Rgb>> sky;  // direction; light through the cell, over pi
        for (int c = 0; c < grid.cells(); ++c)
            sky.emplace_back(grid.direction(c), lighting.leafRadiance[lighting.leaves.leafOf(grid.direction(c))] *
                                                    (grid.cellSolidAngle() / pi));
        for (uint32_t v = 0; v < scene.mesh.vertexCount(); ++v) {
            samples.start.push_back(uint32_t(samples.samples.size()));
            Rgb lit(0);
            for (const auto& [direction, light] : sky)
                lit += light * std::max(0.0f, glm::dot(scene.mesh.normals[v], direction));
            const bool coated = !hasCoating || hasCoating(scene.mesh.positions[v]);
            matte.push_back((coated ? red : grey) * lit);
            for (uint32_t view = 0; view < capture.views.size(); ++view) {
                const Vec3 toward =
                    glm::normalize(Vec3(capture.views[view].camera.position()) - scene.mesh.positions[v]);
                if (glm::dot(toward, scene.mesh.normals[v]) < 0.25f) continue;
                Rgb coating(0);
                if (coated) {
                    glossyInfluence(scene, {}, {}, lighting.leaves, *gloss.lobe, v, toward, fine, row.data());
                    coating = gloss.weight * lightOfRow(row.data(), lighting);
                }
                samples.samples.push_back({view, matte[v] + coating, 1, false});
            }
        }
        samples.start.push_back(uint32_t(samples.samples.size()));
    }
};

}  // namespace relamp::test
