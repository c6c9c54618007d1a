#include "report/stress_world.h"

#include "relight/frame.h"

namespace relamp {
namespace {

/// Adds a parallelogram of nu x nv quads that faces cross(u, v); returns its triangles.
std::vector<uint32_t> addSheet(Mesh& mesh, const Vec3& corner, const Vec3& u, const Vec3& v, int nu, int nv) {
    const uint32_t first = uint32_t(mesh.vertexCount()), wide = uint32_t(nu) + 1;
    for (int j = 0; j <= nv; ++j)
        for (int i = 0; i <= nu; ++i) {
            mesh.positions.push_back(corner + u * (float(i) / float(nu)) + v * (float(j) / float(nv)));
            mesh.normals.push_back(glm::normalize(glm::cross(u, v)));
        }
    std::vector<uint32_t> added;
    for (int j = 0; j < nv; ++j)
        for (int i = 0; i < nu; ++i) {
            const uint32_t a = first + uint32_t(j) * wide + uint32_t(i);
            for (const Triangle& t : {Triangle{a, a + 1, a + wide + 1}, Triangle{a, a + wide + 1, a + wide}}) {
                added.push_back(uint32_t(mesh.triangles.size()));
                mesh.triangles.push_back(t);
            }
        }
    return added;
}

void addBox(Mesh& mesh, const Vec3& low, const Vec3& high, int cuts) {
    const Vec3 d = high - low, x(d.x, 0, 0), y(0, d.y, 0), z(0, 0, d.z);
    addSheet(mesh, low, y, x, cuts, cuts);
    addSheet(mesh, low + z, x, y, cuts, cuts);
    addSheet(mesh, low, x, z, cuts, cuts);
    addSheet(mesh, low + y, z, x, cuts, cuts);
    addSheet(mesh, low, z, y, cuts, cuts);
    addSheet(mesh, low + x, y, z, cuts, cuts);
}

void addBall(Mesh& mesh, const Vec3& centre, float radius, int rings, int around) {
    const uint32_t first = uint32_t(mesh.vertexCount());
    const auto add = [&](const Vec3& n) {
        mesh.positions.push_back(centre + radius * n);
        mesh.normals.push_back(n);
    };
    for (int r = 0; r <= rings; ++r)
        for (int i = 0; i < around; ++i) {
            const float t = pi * (float(r) + 0.001f) / (float(rings) + 0.002f), p = 2 * pi * float(i) / float(around);
            add({std::sin(t) * std::cos(p), std::sin(t) * std::sin(p), std::cos(t)});
        }
    const auto at = [&](int r, int i) { return first + uint32_t(r * around + i % around); };
    for (int r = 0; r < rings; ++r)
        for (int i = 0; i < around; ++i) {
            mesh.triangles.push_back({at(r, i), at(r + 1, i), at(r + 1, i + 1)});
            mesh.triangles.push_back({at(r, i), at(r + 1, i + 1), at(r, i + 1)});
        }
}

/// The open box about an emitter: four walls and a lid seen from both sides, wider than the emitter.
void addShade(Mesh& mesh, const StressEmitter& emitter, bool closed) {
    const float w = 0.75f * emitter.side, down = 0.35f, up = 0.08f;
    const Vec3 low = emitter.centre - Vec3(w, w, down), d(2 * w, 2 * w, down + up), x(d.x, 0, 0), y(0, d.y, 0),
               z(0, 0, d.z);
    const float wall = 0.01f;
    for (const float grow : {0.0f, wall}) {
        const bool outside = grow > 0;
        const Vec3 l = low - Vec3(grow, grow, 0), gx = x + Vec3(2 * grow, 0, 0), gy = y + Vec3(0, 2 * grow, 0),
                   gz = z + Vec3(0, 0, grow);
        const auto sheet = [&](const Vec3& corner, const Vec3& u, const Vec3& v) {
            outside ? addSheet(mesh, corner, u, v, 5, 5) : addSheet(mesh, corner, v, u, 5, 5);
        };
        sheet(l + gz, gx, gy);
        sheet(l, gx, gz);
        sheet(l + gy, gz, gx);
        sheet(l, gz, gy);
        sheet(l + gx, gy, gz);
        if (closed) sheet(l - Vec3(0, 0, grow), gy, gx);
    }
}

Rgb plainSky(const Vec3& d) {
    const float glow = std::exp(6 * (glm::dot(d, glm::normalize(Vec3(1, -0.6f, 0.5f))) - 1));
    return Rgb(0.15f, 0.18f, 0.22f) + Rgb(0.25f, 0.32f, 0.45f) * std::max(0.0f, d.z) + Rgb(1.6f, 1.1f, 0.6f) * glow;
}

Camera cameraAt(const DVec3& eye, const DVec3& target) {
    Camera camera;
    camera.width = 72;
    camera.height = 54;
    camera.focalX = camera.focalY = 72;
    camera.centreX = 36;
    camera.centreY = 27;
    const DVec3 back = glm::normalize(eye - target), right = glm::normalize(glm::cross(DVec3(0, 0, 1), back)),
                up = glm::cross(back, right);
    camera.worldFromCamera = DMat4(glm::dvec4(right, 0), glm::dvec4(up, 0), glm::dvec4(back, 0), glm::dvec4(eye, 1));
    return camera;
}

EmitterCluster clusterOf(const Mesh& mesh, const std::vector<uint32_t>& triangles, const Rgb& radiance) {
    EmitterCluster cluster;
    cluster.triangles = triangles;
    cluster.radiance = radiance;
    cluster.radianceSigma = 0.01f;
    for (uint32_t t : triangles) {
        const float area = mesh.triangleArea(t);
        cluster.area += area;
        for (uint32_t v : mesh.triangles[t]) {
            cluster.vertices.push_back(v);
            cluster.centroid += mesh.positions[v] * (area / 3);
        }
    }
    cluster.centroid /= cluster.area;
    cluster.normal = Vec3(0, 0, -1);
    std::sort(cluster.vertices.begin(), cluster.vertices.end());
    cluster.vertices.erase(std::unique(cluster.vertices.begin(), cluster.vertices.end()), cluster.vertices.end());
    return cluster;
}

/// What the painter shades: Lambert everywhere but on a metal ball.
Estimate truthOf(const StressScene& world, const Scene& scene, const EmitterClusters& emitters, size_t firstOnFloor,
                 size_t firstOfBall, size_t afterBall) {
    Estimate e;
    e.mode = "near-field";
    e.environmentSide = 64;
    const DirectionGrid grid{e.environmentSide};
    for (int c = 0; c < grid.cells(); ++c)
        e.environment.push_back(world.sky ? world.sky(grid.direction(c)) : plainSky(grid.direction(c)));
    e.lighting.leaves = LightLeaves::uniform(1);
    e.lighting.leafRadiance.assign(4, Rgb(0));
    e.emitters = emitters;
    for (const EmitterCluster& emitter : emitters.emitters) e.lighting.emitterRadiance.push_back(emitter.radiance);
    const size_t n = scene.mesh.vertexCount();
    e.reflectance.basis.lobes = {Lobe{Lobe::Kind::lambert, 1, "lambert"},
                                 Lobe{Lobe::Kind::ggx, std::max(world.specularAlpha, 1e-3f), "ggx"}};
    e.reflectance.weight.assign(2, std::vector<Rgb>(n, Rgb(0)));
    for (size_t v = 0; v < n; ++v) {
        if (emitters.emitterOfVertex[v] >= 0) continue;
        if (world.specularAlpha > 0 && v >= firstOfBall && v < afterBall) e.reflectance.weight[1][v] = Rgb(0.9f);
        else
            e.reflectance.weight[0][v] =
                v < firstOnFloor ? world.albedo : Rgb(world.albedo.z, world.albedo.y, world.albedo.x);
    }
    return e;
}

}  // namespace

PaintedWorld paintStressScene(const StressScene& world, Progress& progress) {
    Mesh mesh;
    addSheet(mesh, {-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, world.needles ? 2000 / 8 : 18, world.needles ? 1 : 18);
    const size_t onFloor = mesh.vertexCount();
    addBox(mesh, {-0.55f, -0.35f, 0.002f}, {-0.2f, 0.05f, 0.4f}, 4);
    const size_t ball = mesh.vertexCount();
    addBall(mesh, {0.3f, -0.25f, 0.252f}, 0.25f, 12, 18);
    const size_t afterBall = mesh.vertexCount();
    if (world.shade && !world.emitters.empty()) addShade(mesh, world.emitters[0], world.closed);
    EmitterClusters emitters;
    for (const StressEmitter& emitter : world.emitters) {
        const float s = emitter.side;
        const int strips = emitter.uneven == 1 ? 1 : 8, cuts = std::max(4, strips);
        const auto triangles = addSheet(mesh, emitter.centre - Vec3(s / 2, s / 2, 0), {0, s, 0}, {s, 0, 0}, cuts, cuts);
        for (int i = 0; i < strips; ++i) {
            const size_t each = triangles.size() / size_t(strips);
            const float along = strips > 1 ? float(i) / float(strips - 1) : 0.5f;
            emitters.emitters.push_back(clusterOf(
                mesh, {triangles.begin() + ptrdiff_t(each) * i, triangles.begin() + ptrdiff_t(each) * (i + 1)},
                emitter.radiance * (2 * glm::mix(1.0f, emitter.uneven, along) / (1 + emitter.uneven))));
        }
    }
    const Scene scene = buildScene(mesh, progress);
    indexEmitters(scene, emitters);
    const Estimate truth = truthOf(world, scene, emitters, onFloor, ball, afterBall);
    const RelitScene relit = applyLook(scene, truth, {}, progress);

    PaintedWorld painted;
    painted.emitters = std::move(emitters);
    painted.capture.mesh = std::move(mesh);
    painted.capture.meshReport.vertices = painted.capture.mesh.vertexCount();
    painted.capture.meshReport.triangles = painted.capture.mesh.triangles.size();
    FrameOptions options;
    options.samplesPerPixel = 4;
    for (int i = 0; i < world.views; ++i) {
        // High ones look down, low ones see the underside of the emitters and the sky.
        const double a = 2 * piD * i / world.views + 0.3;
        View view;
        view.name = fmt::format("{:02}", i);
        view.camera =
            cameraAt({2.3 * std::cos(a), 2.3 * std::sin(a), i % 2 ? 0.45 : 1.9}, {0.05, 0, i % 2 ? 0.6 : 0.15});
        options.seed = uint64_t(i) + 1;
        view.image = Image(view.camera.width, view.camera.height);
        view.image.pixels = renderFrame(relit, view.camera, options, progress).beauty;
        painted.capture.views.push_back(std::move(view));
    }
    return painted;
}

Capture oneTriangle() {
    Capture capture;
    capture.mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    capture.mesh.normals.assign(3, Vec3(0, 0, 1));
    capture.mesh.triangles = {{0, 1, 2}};
    View view;
    view.name = "00";
    view.camera = cameraAt({0.3, -1.2, 1.5}, {0.3, 0.3, 0});
    view.image = Image(view.camera.width, view.camera.height, Rgb(0.4f, 0.5f, 0.6f));
    capture.views.push_back(std::move(view));
    return capture;
}

}  // namespace relamp
