#include "support/known_world.h"

#include <map>
#include <nlohmann/json.hpp>
#include <tuple>

#include "base/parallel.h"
#include "base/random.h"

namespace relamp::test {

Rgb skyIrradiance(const std::function<Rgb(const Vec3&)>& radiance, const Vec3& normal) {
    const DirectionGrid grid{128};
    DVec3 sum(0);
    for (int c = 0; c < grid.cells(); ++c) {
        const Vec3 d = grid.direction(c);
        if (const float cosine = glm::dot(d, normal); cosine > 0) sum += DVec3(radiance(d) * cosine);
    }
    return Rgb(sum * double(grid.cellSolidAngle()));
}

namespace {

/// Light that leaves a matte point: 8 x 8 points on the emitter, 16 x 16 directions of the sky, each with one ray.
Rgb paintPoint(const KnownWorld& world, const RayTracer& tracer, const Vec3& position, const Vec3& normal,
               uint64_t seed, float emitter, KnownWorld::Sky sky = KnownWorld::Sky::day) {
    const Vec3 origin = position + normal * 1e-4f;
    const Vec2 shift = randomShift(seed, 1, 2), emitterShift = randomShift(seed, 3, 4);
    const Mat3 frame = frameAround(normal);
    DVec3 irradiance(0);
    constexpr int side = 16, emitterSide = 8;
    for (int i = 0; i < side * side; ++i) {
        const Vec2 u = (Vec2(float(i % side), float(i / side)) + shift) / float(side);
        const Vec3 d = frame * cosineHemisphere(u);
        if (!tracer.occluded({origin, d, 0, 1e30f}))
            irradiance += DVec3(KnownWorld::skyAt(sky, d)) * (piD / (side * side));
    }
    for (int i = 0; emitter > 0 && i < emitterSide * emitterSide; ++i) {
        const Vec2 u =
            (Vec2(float(i % emitterSide), float(i / emitterSide)) + emitterShift) / float(emitterSide) - 0.5f;
        const Vec3 to = world.emitterCentre + world.emitterSide * Vec3(u.x, u.y, 0) - origin;
        const float d2 = glm::dot(to, to);
        const Vec3 d = to / std::sqrt(d2);
        const float cosine = glm::dot(d, normal), facing = d.z;
        if (cosine <= 0 || facing <= 0 || tracer.occluded({origin, d, 0, std::sqrt(d2) * 0.999f})) continue;
        irradiance += DVec3(emitter * world.emitterRadiance) * double(cosine * facing / d2 * world.emitterSide *
                                                                      world.emitterSide / (emitterSide * emitterSide));
    }
    return KnownWorld::albedoAt(position) * Rgb(irradiance) / pi;
}

/// Light that surfaces send each other, at the vertices: 256 rays each, three bounces. Radiance a white matte surface
/// shows.
std::vector<Rgb> paintBounces(const KnownWorld& world, const Scene& scene, const std::vector<uint8_t>& shines,
                              bool emitter) {
    const Mesh& mesh = scene.mesh;
    std::vector<Rgb> direct(mesh.vertexCount()), bounced(mesh.vertexCount(), Rgb(0));
    for (size_t v = 0; v < direct.size(); ++v)
        direct[v] = paintPoint(world, *scene.tracer, mesh.positions[v], mesh.normals[v], 900000 + v, emitter ? 1 : 0);
    for (int bounce = 0; bounce < 3; ++bounce) {
        std::vector<Rgb> next(mesh.vertexCount(), Rgb(0));
        parallelFor(next.size(), 16, [&](size_t v) {
            const Mat3 frame = frameAround(mesh.normals[v]);
            for (int i = 0; i < 256; ++i) {
                const Vec2 u = (Vec2(float(i % 16), float(i / 16)) + randomShift(v, 5, size_t(i))) / 16.0f;
                const Hit hit = scene.tracer->closest(
                    {mesh.positions[v] + mesh.normals[v] * 1e-4f, frame * cosineHemisphere(u), 0, 1e30f});
                if (!hit || shines[hit.triangle] ||
                    glm::dot(mesh.faceNormal(hit.triangle), frame * cosineHemisphere(u)) > 0)
                    continue;
                const Triangle& t = mesh.triangles[hit.triangle];
                const float weight[3] = {1 - hit.barycentric.x - hit.barycentric.y, hit.barycentric.x,
                                         hit.barycentric.y};
                for (size_t k = 0; k < 3; ++k)
                    next[v] += weight[k] / 256 * (direct[t[k]] + world.albedo[t[k]] * bounced[t[k]]);
            }
        });
        bounced = next;
    }
    return bounced;
}

KnownWorld paintAnew(const std::filesystem::path& folder, bool emitter, int views, int floorCuts, bool room,
                     bool metalBall, const std::vector<float>& levels, const std::vector<KnownWorld::Sky>& skies,
                     int width) {
    const int height = width * 3 / 4;
    const double focal = width * 95.0 / 96;
    KnownWorld world;
    world.views = views;
    world.mesh = sheet({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, floorCuts, floorCuts);
    world.floorVertices = world.mesh.vertexCount();
    append(world.mesh, box({-0.55f, -0.35f, 0.002f}, {-0.2f, 0.05f, 0.4f}, 5));
    world.ballBegin = world.mesh.vertexCount();
    append(world.mesh, ball({0.3f, -0.25f, 0.252f}, 0.25f, 14, 20));
    world.ballEnd = world.mesh.vertexCount();
    if (room) {
        append(world.mesh, sheet({-1, 1, 0.002f}, {2, 0, 0}, {0, 0, 1.3f}, 16, 10));
        append(world.mesh, sheet({-1, -1, 0.002f}, {0, 2, 0}, {0, 0, 1.3f}, 16, 10));
    }
    if (emitter)
        world.emitterTriangles = append(world.mesh, squareAbove(world.emitterSide, world.emitterCentre.x,
                                                                world.emitterCentre.y, world.emitterCentre.z, 4));
    for (const Vec3& p : world.mesh.positions) world.albedo.push_back(KnownWorld::albedoAt(p));
    std::vector<uint8_t> shines(world.mesh.triangles.size(), 0);
    for (uint32_t t : world.emitterTriangles) shines[t] = 1;

    const Scene scene = sceneOf(world.mesh);
    const std::vector<Rgb> bounced =
        room ? paintBounces(world, scene, shines, emitter) : std::vector<Rgb>(world.mesh.vertexCount(), Rgb(0));
    std::filesystem::create_directories(folder / "images");
    writeVertexPly(folder / "mesh.ply", world.mesh, {});
    nlohmann::json file{
        {"w", width}, {"h", height}, {"fl_x", focal}, {"mesh_path", "mesh.ply"}, {"frames", nlohmann::json::array()}};
    for (int k = 0; k < views * int(levels.size()); ++k) {
        const int i = k % views;
        const size_t state = size_t(k / views);
        const float level = emitter ? levels[state] : 0;
        const KnownWorld::Sky sky = skies.empty() ? KnownWorld::Sky::day : skies[state];
        // High ones look down, low ones see the underside of the emitter and the sky.
        const double a = room ? -1.5 + 1.5 * i / (views - 1) : 2 * piD * i / views + 0.3;  // before the open sides
        const bool low = i % 2;
        const Camera camera = cameraAt({2.3 * std::cos(a), 2.3 * std::sin(a), low ? 0.45 : 1.9},
                                       {0.05, 0, low ? 0.6 : 0.15}, width, height, focal);
        Image image(width, height);
        parallelFor(image.pixels.size(), size_t(width), [&](size_t p) {
            const Vec3 d = camera.rayDirection(Vec2(p % size_t(width) + 0.5f, p / size_t(width) + 0.5f));
            const Hit hit = scene.tracer->closest({Vec3(camera.position()), d, 0, 1e30f});
            if (!hit) {
                image.pixels[p] = KnownWorld::skyAt(sky, d);
                return;
            }
            if (shines[hit.triangle]) {
                image.pixels[p] = d.z > 0 ? level * world.emitterRadiance : Rgb(0);
                return;
            }
            const Vec3 normal = scene.normalOf(hit);
            if (glm::dot(normal, d) >= 0) {
                image.pixels[p] = Rgb(0);
                return;
            }
            const Triangle& t = scene.mesh.triangles[hit.triangle];
            if (metalBall && t[0] >= world.ballBegin && t[0] < world.ballEnd) {
                const Vec3 mirrored = glm::reflect(d, normal);
                image.pixels[p] = scene.tracer->occluded({scene.pointOf(hit) + normal * 1e-4f, mirrored, 0, 1e30f})
                                      ? Rgb(0)
                                      : world.ballTint * KnownWorld::skyAt(sky, mirrored);
                return;
            }
            const Vec2 b = hit.barycentric;
            const Rgb indirect = (1 - b.x - b.y) * bounced[t[0]] + b.x * bounced[t[1]] + b.y * bounced[t[2]];
            const Vec3 point = scene.pointOf(hit);
            image.pixels[p] = paintPoint(world, *scene.tracer, point, normal, size_t(k) * 10000 + p, level, sky) +
                              KnownWorld::albedoAt(point) * indirect;
        });
        const std::string name = fmt::format("images/{:02}.exr", k);
        writeImage(folder / name, image);
        nlohmann::json rows = nlohmann::json::array();
        for (int r = 0; r < 4; ++r)
            rows.push_back({camera.worldFromCamera[0][r], camera.worldFromCamera[1][r], camera.worldFromCamera[2][r],
                            camera.worldFromCamera[3][r]});
        file["frames"].push_back({{"file_path", name}, {"transform_matrix", rows}});
        if (levels.size() < 2) continue;
        const std::string named =
            skies.empty() ? fmt::format("lamp {}", level) : fmt::format("lamp {}, sky {}", level, state);
        file["frames"].back()["state"] = named;
        if (!skies.empty()) file["states"][named]["environment"] = sky == KnownWorld::Sky::none ? "none" : "own";
    }
    std::ofstream(folder / "transforms.json") << file.dump(1);
    return world;
}

/// Each world is painted once in a run of the program: tests get copies of its files, which they may change.
KnownWorld paint(const std::filesystem::path& folder, bool emitter, int views, int floorCuts, bool room, bool metalBall,
                 const std::vector<float>& levels, const std::vector<KnownWorld::Sky>& skies, int width) {
    struct Painted {
        TemporaryFolder folder;
        KnownWorld world;
    };
    static std::map<std::tuple<bool, int, int, bool, bool, std::vector<float>, std::vector<KnownWorld::Sky>, int>,
                    Painted>
        all;
    const auto [at, fresh] = all.try_emplace({emitter, views, floorCuts, room, metalBall, levels, skies, width});
    Painted& painted = at->second;
    if (fresh)
        painted.world =
            paintAnew(painted.folder.path(), emitter, views, floorCuts, room, metalBall, levels, skies, width);
    std::filesystem::create_directories(folder);
    std::filesystem::copy(painted.folder.path(), folder,
                          std::filesystem::copy_options::recursive | std::filesystem::copy_options::overwrite_existing);
    return painted.world;
}

}  // namespace

KnownWorld paintKnownWorld(const std::filesystem::path& folder, bool emitter, int views, int floorCuts, bool room,
                           bool metalBall, const std::vector<float>& levels,
                           const std::vector<KnownWorld::Sky>& skies) {
    return paint(folder, emitter, views, floorCuts, room, metalBall, levels, skies, 96);
}

KnownWorld paintSmallWorld(const std::filesystem::path& folder, int views, int floorCuts, bool emitter) {
    return paint(folder, emitter, views, floorCuts, false, false, {1}, {}, 64);
}

}  // namespace relamp::test
