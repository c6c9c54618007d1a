#include "support/estimates.h"

namespace relamp::test {

Estimate matteEstimate(const Scene& scene, const Rgb& albedo, const Rgb& environment, const EmitterClusters& clusters) {
    Estimate e;
    const size_t n = scene.mesh.vertexCount();
    e.mode = "near-field";
    e.environmentSide = 64;
    e.environment.assign(64 * 64, environment);
    e.lighting.leaves = LightLeaves::uniform(1);
    e.lighting.leafRadiance.assign(4, environment);
    e.emitters = clusters;
    if (clusters.emitters.empty()) {
        e.emitters.emitterOfVertex.assign(n, -1);
        e.emitters.emitterOfTriangle.assign(scene.mesh.triangles.size(), -1);
    }
    for (const EmitterCluster& c : clusters.emitters) {
        e.lighting.emitterRadiance.push_back(c.radiance);
        e.emitterSigma.push_back(c.radiance * 0.01f);
        e.identifiability.push_back(0.5f);
    }
    e.reflectance.basis.lobes = {Lobe{Lobe::Kind::lambert, 1, "lambert"}};
    e.reflectance.weight.assign(1, std::vector<Rgb>(n, albedo));
    for (size_t v = 0; v < n; ++v)
        if (e.emitters.emitterOfVertex[v] >= 0) e.reflectance.weight[0][v] = Rgb(0);
    e.reflectance.observed.assign(n, 3);
    e.reflectance.confidence.assign(n, 0.75f);
    e.gauge = {"emitter", "set by hand", Rgb(1)};
    return e;
}

RelitScene relitOf(const Scene& scene, const Estimate& estimate, const Look& look) {
    Progress progress;
    return applyLook(scene, estimate, look, progress);
}

Camera cameraAt(const DVec3& eye, const DVec3& target, int width, int height, double focalPixels, const DVec3& upHint) {
    Camera camera;
    camera.width = width;
    camera.height = height;
    camera.focalX = camera.focalY = focalPixels;
    camera.centreX = width / 2.0;
    camera.centreY = height / 2.0;
    const DVec3 back = glm::normalize(eye - target), right = glm::normalize(glm::cross(upHint, back)),
                up = glm::cross(back, right);
    camera.worldFromCamera = DMat4(glm::dvec4(right, 0), glm::dvec4(up, 0), glm::dvec4(back, 0), glm::dvec4(eye, 1));
    return camera;
}

View photographOf(const Scene& scene, const Camera& camera, const std::function<Rgb(const Hit&)>& radiance) {
    constexpr int cut = 4;
    View view;
    view.camera = camera;
    view.image = Image(camera.width, camera.height, Rgb(0));
    for (int y = 0; y < camera.height; ++y)
        for (int x = 0; x < camera.width; ++x) {
            Rgb sum(0);
            for (int s = 0; s < cut * cut; ++s) {
                const Vec2 at(float(x) + (float(s % cut) + 0.5f) / cut, float(y) + (float(s / cut) + 0.5f) / cut);
                sum += radiance(scene.tracer->closest({Vec3(camera.position()), camera.rayDirection(at), 0, 1e30f}));
            }
            view.image.at(x, y) = sum / float(cut * cut);
        }
    return view;
}

Mat4 translation(const Vec3& by) { return Mat4(Vec4(1, 0, 0, 0), Vec4(0, 1, 0, 0), Vec4(0, 0, 1, 0), Vec4(by, 1)); }

}  // namespace relamp::test
