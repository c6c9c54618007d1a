// A capture with known truth made of four measured materials, and how well a solve found them. The materials are in the
// user's own folder (see brdf_fit.cpp); the images are rendered here, straight from the networks and from closed
// forms of the shapes: nothing of relamp's light transport.
//   measured_scene tables FOLDER OUT MATERIAL...           MERL .binary files, filled from the networks
//   measured_scene render FOLDER ENV OTHER-ENV OUT A B C D  the capture, with truth as evaluate-like scripts read it
//   measured_scene score FOLDER SHOT A B C D                what each ball was taken for, colour and error of its
//   reflectance
// Four balls on a textured matte floor, a small emitter that is seen above them, a photographed environment. Direct
// light only.
#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <numeric>

#include "base/atomic_file.h"
#include "base/parallel.h"
#include "base/random.h"
#include "bench/measured_materials.h"
#include "brdf/models.h"
#include "image/environment_map.h"
#include "image/image_io.h"
#include "scene/mesh_io.h"
#include "shot/shot_file.h"

namespace {
using namespace relamp;
using namespace relamp::bench;
namespace fs = std::filesystem;
using Json = nlohmann::json;

struct Ball {
    Vec3 centre;
    float radius;
};
constexpr float floorHalf = 0.8f;
const std::array<Ball, 4> balls{Ball{{-0.24f, -0.22f, 0.17f}, 0.17f}, Ball{{0.24f, -0.22f, 0.17f}, 0.17f},
                                Ball{{-0.24f, 0.22f, 0.17f}, 0.17f}, Ball{{0.24f, 0.22f, 0.17f}, 0.17f}};
const Rgb emitterRadiance(60, 44, 24);
constexpr int rings = 56, sectors = 96, floorCells = 96;

struct Light {
    Ball ball{{0.05f, -0.02f, 0.62f}, 0.05f};
    Rgb radiance = emitterRadiance;
};

Rgb floorAlbedo(float x, float y) {
    // Smooth: colours are kept per vertex, and what that costs is not what is measured here.
    const float tile = 0.5f + 0.5f * std::sin(11 * x + 2 * std::sin(5 * y)) * std::sin(9 * y + 1);
    return glm::mix(Rgb(0.24f, 0.27f, 0.33f), Rgb(0.58f, 0.52f, 0.42f), tile);
}

/// Distance along the ray to a ball, or something huge.
float reach(const Ball& ball, const Vec3& from, const Vec3& d) {
    const Vec3 to = ball.centre - from;
    const float along = glm::dot(to, d), inside = ball.radius * ball.radius - glm::dot(to, to) + along * along;
    if (inside < 0) return 1e30f;
    const float root = std::sqrt(inside);
    return along - root > 1e-4f ? along - root : along + root > 1e-4f ? along + root : 1e30f;
}

struct Met {
    float distance = 1e30f;
    int what = -1;  // 0 to 3 a ball, 4 the floor, 5 the emitter
};

Met trace(const Vec3& from, const Vec3& d, const Light& emitter) {
    Met met;
    for (int b = 0; b < 4; ++b)
        if (const float t = reach(balls[size_t(b)], from, d); t < met.distance) met = {t, b};
    if (d.z < 0 && from.z > 0) {
        const float t = -from.z / d.z;
        const Vec3 at = from + t * d;
        if (t > 1e-4f && t < met.distance && std::abs(at.x) < floorHalf && std::abs(at.y) < floorHalf) met = {t, 4};
    }
    if (const float t = reach(emitter.ball, from, d); t < met.distance) met = {t, 5};
    return met;
}

/// An environment with a table to draw directions from.
struct Sky {
    Image map;
    std::vector<double> upTo;

    explicit Sky(Image m) : map(std::move(m)) {
        double sum = 0;
        for (int y = 0; y < map.height; ++y)
            for (int x = 0; x < map.width; ++x)
                upTo.push_back(sum +=
                               (double(luminance(map.at(x, y))) + 1e-3) * std::sin((y + 0.5) / map.height * piD));
    }
    Vec3 draw(const Vec2& u, float inside) const {
        const size_t at =
            std::min(size_t(std::upper_bound(upTo.begin(), upTo.end(), double(u.x) * upTo.back()) - upTo.begin()),
                     upTo.size() - 1);
        return directionFromLatLong({(float(at % size_t(map.width)) + inside) / float(map.width),
                                     (float(at / size_t(map.width)) + u.y) / float(map.height)});
    }
    float density(const Vec3& d) const {
        const Vec2 uv = latLongFromDirection(d);
        const size_t x = std::min(size_t(uv.x * float(map.width)), size_t(map.width) - 1),
                     y = std::min(size_t(uv.y * float(map.height)), size_t(map.height) - 1),
                     at = y * size_t(map.width) + x;
        const double fraction = (upTo[at] - (at ? upTo[at - 1] : 0)) / upTo.back(),
                     sine = std::max(1e-6, std::sqrt(1 - double(d.z) * double(d.z)));
        return float(fraction * double(map.width) * double(map.height) / (2 * piD * piD * sine));
    }
};

using Materials = std::array<BrdfFunction, 4>;

Rgb shade(const Materials& materials, const Sky* sky, const Light& emitter, const Vec3& from, const Vec3& ray,
          int samples, uint64_t seed) {
    const Met met = trace(from, ray, emitter);
    if (met.what < 0) return sky ? environmentRadiance(sky->map, ray) : Rgb(0);
    if (met.what == 5) return emitter.radiance;
    const Vec3 at = from + met.distance * ray;
    const Vec3 normal =
        met.what == 4 ? Vec3(0, 0, 1) : (at - balls[size_t(met.what)].centre) / balls[size_t(met.what)].radius;
    const Mat3 frame = frameAround(normal), toLocal = glm::transpose(frame);
    const Vec3 eye = toLocal * -ray, start = at + 1e-4f * normal;
    const bool matte = met.what == 4;
    const Rgb albedo = matte ? floorAlbedo(at.x, at.y) : Rgb(0);
    const auto reflected = [&](const Vec3& light) {
        return (matte ? albedo / pi : materials[size_t(met.what)](light, eye)) * light.z;
    };
    constexpr std::array<float, 3> widths{0.02f, 0.08f, 0.3f};
    // Lobes of three widths, the cosine, the sky: one direction each; balance heuristic.
    const auto skyDensity = [&](const Vec3& light, const Vec3& world) {
        float sum = light.z / pi + sky->density(world);
        if (!matte)
            for (const float a : widths) sum += ggxSampleDensity(light, eye, a);
        return sum;
    };
    Rgb sum(0);
    for (int i = 0; i < samples; ++i) {
        const uint32_t n = uint32_t(i);
        if (sky) {
            const auto add = [&](const Vec3& light) {
                if (light.z <= 1e-4f) return;
                const Vec3 world = frame * light;
                if (trace(start, world, emitter).what >= 0) return;
                sum += reflected(light) * environmentRadiance(sky->map, world) / skyDensity(light, world);
            };
            add(cosineHemisphere(r2Point(n, randomShift(seed, 1, 0))));
            add(toLocal * sky->draw(r2Point(n, randomShift(seed, 2, 0)), r2Point(n, randomShift(seed, 3, 0)).x));
            if (!matte)
                for (const float a : widths)
                    add(sampleGgx(eye, a, r2Point(n, randomShift(seed, 4, uint64_t(a * 1000)))));
        }
        if (maxChannel(emitter.radiance) > 0) {
            // Evenly over the cone that the emitter covers.
            const Vec3 to = emitter.ball.centre - at;
            const float distance2 = glm::dot(to, to),
                        cosine = std::sqrt(std::max(0.0f, 1 - emitter.ball.radius * emitter.ball.radius / distance2)),
                        solid = 2 * pi * (1 - cosine);
            const Vec2 u = r2Point(n, randomShift(seed, 5, 0));
            const float z = 1 - u.x * (1 - cosine), r = std::sqrt(std::max(0.0f, 1 - z * z));
            const Vec3 world = frameAround(to / std::sqrt(distance2)) *
                               Vec3(r * std::cos(2 * pi * u.y), r * std::sin(2 * pi * u.y), z),
                       light = toLocal * world;
            if (light.z > 0 && trace(start, world, emitter).what == 5)
                sum += reflected(light) * emitter.radiance * solid;
        }
    }
    return sum / float(samples);
}

struct Eye {
    Vec3 position;
    Mat3 world;  // columns: right, up, back
    int width = 480, height = 360;
    float focal = 520;

    Json matrix() const {
        Json rows = Json::array();
        for (int r = 0; r < 3; ++r) rows.push_back({world[0][r], world[1][r], world[2][r], position[r]});
        rows.push_back({0, 0, 0, 1});
        return rows;
    }
};

Eye lookingFrom(float azimuth, float height, float distance) {
    Eye eye;
    const Vec3 target(0, 0, 0.22f);
    eye.position = {distance * std::cos(azimuth), distance * std::sin(azimuth), height};
    const Vec3 back = glm::normalize(eye.position - target), right = glm::normalize(glm::cross(Vec3(0, 0, 1), back));
    eye.world = Mat3(right, glm::cross(back, right), back);
    return eye;
}

Image render(const Eye& eye, const Materials& materials, const Sky* sky, const Light& emitter, int across, int samples,
             uint64_t seed) {
    Image image(eye.width, eye.height);
    parallelFor(size_t(eye.height), 1, [&](size_t y) {
        for (int x = 0; x < eye.width; ++x) {
            Rgb sum(0);
            for (int s = 0; s < across * across; ++s) {
                const float px = float(x) + (float(s % across) + 0.5f) / float(across),
                            py = float(y) + (float(s / across) + 0.5f) / float(across);
                const Vec3 ray = glm::normalize(eye.world * Vec3((px - float(eye.width) / 2) / eye.focal,
                                                                 -(py - float(eye.height) / 2) / eye.focal, -1));
                sum += shade(materials, sky, emitter, eye.position, ray, samples,
                             mixBits(seed) + (y * size_t(eye.width) + size_t(x)) * 16 + size_t(s));
            }
            image.at(x, int(y)) = sum / float(across * across);
        }
    });
    return image;
}

Image objectMask(const Eye& eye, const Light& emitter) {
    Image mask(eye.width, eye.height);
    for (int y = 0; y < eye.height; ++y)
        for (int x = 0; x < eye.width; ++x) {
            bool all = true;
            for (int s = 0; s < 9; ++s) {
                const float px = float(x + s % 3) - 0.5f, py = float(y + s / 3) - 0.5f;
                const int what = trace(eye.position,
                                       glm::normalize(eye.world * Vec3((px - float(eye.width) / 2) / eye.focal,
                                                                       -(py - float(eye.height) / 2) / eye.focal, -1)),
                                       emitter)
                                     .what;
                all &= what >= 0 && what < 5;
            }
            mask.at(x, y) = Rgb(all ? 1 : 0);
        }
    return mask;
}

/// Halved until it is at most 512 wide: neighbouring texels averaged.
Image readSky(const fs::path& file, float mean) {
    Image map = readEnvironment(file);
    while (map.width > 512) {
        Image half(map.width / 2, map.height / 2);
        for (int y = 0; y < half.height; ++y)
            for (int x = 0; x < half.width; ++x)
                half.at(x, y) = 0.25f * (map.at(2 * x, 2 * y) + map.at(2 * x + 1, 2 * y) + map.at(2 * x, 2 * y + 1) +
                                         map.at(2 * x + 1, 2 * y + 1));
        map = std::move(half);
    }
    double sum = 0, area = 0;
    for (int y = 0; y < map.height; ++y)
        for (int x = 0; x < map.width; ++x) {
            const double w = std::sin((y + 0.5) / map.height * piD);
            sum += w * double(luminance(map.at(x, y)));
            area += w;
        }
    for (Rgb& p : map.pixels) p *= float(double(mean) * area / sum);
    return map;
}

struct Truth {
    Mesh mesh;
    std::vector<int> object;  // 0 to 3 a ball, 4 the floor, 5 the emitter
};

Truth makeMesh() {
    Truth truth;
    const auto addBall = [&](const Ball& ball, int object) {
        const uint32_t first = uint32_t(truth.mesh.positions.size());
        const auto add = [&](float theta, float phi) {
            const Vec3 n(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta));
            truth.mesh.positions.push_back(ball.centre + ball.radius * n);
            truth.mesh.normals.push_back(n);
            truth.object.push_back(object);
        };
        const int r = object == 5 ? 16 : rings, s = object == 5 ? 24 : sectors;
        add(0, 0);
        for (int i = 1; i < r; ++i)
            for (int k = 0; k < s; ++k) add(float(i) / float(r) * pi, float(k) / float(s) * 2 * pi);
        add(pi, 0);
        const auto index = [&](int i, int k) {
            return i == 0   ? first
                   : i == r ? first + 1 + uint32_t((r - 1) * s)
                            : first + 1 + uint32_t((i - 1) * s + k % s);
        };
        for (int i = 0; i < r; ++i)
            for (int k = 0; k < s; ++k) {
                if (i + 1 < r) truth.mesh.triangles.push_back({index(i, k), index(i + 1, k), index(i + 1, k + 1)});
                if (i > 0) truth.mesh.triangles.push_back({index(i, k), index(i + 1, k + 1), index(i, k + 1)});
            }
    };
    for (int b = 0; b < 4; ++b) addBall(balls[size_t(b)], b);
    const uint32_t first = uint32_t(truth.mesh.positions.size());
    for (int y = 0; y <= floorCells; ++y)
        for (int x = 0; x <= floorCells; ++x) {
            truth.mesh.positions.push_back(
                {floorHalf * (2 * float(x) / floorCells - 1), floorHalf * (2 * float(y) / floorCells - 1), 0});
            truth.mesh.normals.push_back({0, 0, 1});
            truth.object.push_back(4);
        }
    for (uint32_t y = 0; y < floorCells; ++y)
        for (uint32_t x = 0; x < floorCells; ++x) {
            const uint32_t a = first + y * (floorCells + 1) + x, b = a + floorCells + 1;
            truth.mesh.triangles.push_back({a, a + 1, b + 1});
            truth.mesh.triangles.push_back({a, b + 1, b});
        }
    addBall(Light().ball, 5);
    return truth;
}

std::vector<double> const& rowOf(const Rows& networks, const std::string& material) {
    const auto row = networks.find(material);
    if (row == networks.end()) throw Error("{}: is in no table", material);
    return row->second;
}

void writeTables(const Rows& networks, const fs::path& out, const std::vector<std::string>& names) {
    fs::create_directories(out);
    constexpr size_t cells = size_t(90) * 90 * 180;
    constexpr double scale[3] = {1.0 / 1500, 1.15 / 1500, 1.66 / 1500};
    for (const std::string& name : names) {
        const BrdfFunction truth = network(rowOf(networks, name));
        std::string bytes(12 + cells * 3 * sizeof(double), '\0');
        const int32_t counts[3] = {90, 90, 180};
        std::memcpy(bytes.data(), counts, sizeof counts);
        parallelFor(90, 1, [&](size_t h) {
            for (int d = 0; d < 90; ++d)
                for (int p = 0; p < 180; ++p) {
                    const double th = double(h * h) / 8100 * piD / 2, td = d / 90.0 * piD / 2, pd = p / 180.0 * piD;
                    const DVec3 local(std::sin(td) * std::cos(pd), std::sin(td) * std::sin(pd), std::cos(td));
                    const auto turned = [&](const DVec3& v) {
                        return Vec3(DVec3(std::cos(th) * v.x + std::sin(th) * v.z, v.y,
                                          -std::sin(th) * v.x + std::cos(th) * v.z));
                    };
                    const Vec3 light = turned(local), eye = turned({-local.x, -local.y, local.z});
                    const Rgb value = light.z > 0 && eye.z > 0 ? truth(light, eye) : Rgb(-1);
                    for (size_t c = 0; c < 3; ++c) {
                        const double stored = value.x < 0 ? -1 : double(value[int(c)]) / scale[c];
                        std::memcpy(bytes.data() + 12 + (c * cells + MeasuredBrdf::index(int(h), d, p)) * sizeof stored,
                                    &stored, sizeof stored);
                    }
                }
        });
        writeBytesAtomically(out / (name + ".binary"), bytes);
    }
}

void renderCapture(const Materials& materials, const Image& skyMap, const Image& otherMap, const fs::path& out) {
    for (const char* folder : {"images", "truth/relit", "truth/masks"}) fs::create_directories(out / folder);
    const Sky sky(skyMap), other(otherMap), white(Image(64, 32, Rgb(0.5f)));
    const Light emitter;
    const Truth truth = makeMesh();
    writeVertexPly(out / "mesh.ply", truth.mesh, {});
    const size_t n = truth.object.size();
    std::vector<VertexProperty> properties;
    for (int c = 0; c < 3; ++c) {
        VertexProperty albedo{std::string("albedo_") + "rgb"[c], std::vector<float>(n, 0), false},
            emission{std::string("emission_") + "rgb"[c], std::vector<float>(n, 0), false};
        for (size_t v = 0; v < n; ++v) {
            if (truth.object[v] == 4)
                albedo.values[v] = floorAlbedo(truth.mesh.positions[v].x, truth.mesh.positions[v].y)[c];
            if (truth.object[v] == 5) emission.values[v] = emitterRadiance[c];
        }
        properties.push_back(albedo);
        properties.push_back(emission);
    }
    VertexProperty emitterId{"emitter_id", std::vector<float>(n, -1), true};
    for (size_t v = 0; v < n; ++v)
        if (truth.object[v] == 5) emitterId.values[v] = 0;
    properties.push_back(emitterId);
    writeVertexPly(out / "truth" / "vertices.ply", truth.mesh, properties);
    writeImage(out / "truth" / "env.exr", skyMap);
    writeImage(out / "truth" / "env-other.exr", otherMap);
    writeImage(out / "truth" / "env-white.exr", white.map);
    std::vector<Eye> eyes;
    for (int i = 0; i < 10; ++i)
        eyes.push_back(lookingFrom(float(i) * 2 * pi / 10 + 0.2f, i % 2 ? 0.95f : 0.55f, 1.5f));
    Json capture{{"camera_model", "PINHOLE"},  {"w", eyes[0].width},      {"h", eyes[0].height},
                 {"fl_x", eyes[0].focal},      {"fl_y", eyes[0].focal},   {"cx", eyes[0].width / 2.0},
                 {"cy", eyes[0].height / 2.0}, {"mesh_path", "mesh.ply"}, {"frames", Json::array()}};
    for (size_t i = 0; i < eyes.size(); ++i) {
        const std::string name = fmt::format("images/{:04}.exr", i);
        writeImage(out / name, render(eyes[i], materials, &sky, emitter, 2, 16, i + 1));
        capture["frames"].push_back({{"file_path", name}, {"transform_matrix", eyes[i].matrix()}});
        std::fprintf(stderr, "%s\n", name.c_str());
    }
    writeBytesAtomically(out / "transforms.json", capture.dump(1));
    const Eye novel = lookingFrom(1.2f, 0.75f, 1.4f);
    Json novelCamera = capture;
    novelCamera.erase("frames");
    novelCamera.erase("mesh_path");
    novelCamera["transform_matrix"] = novel.matrix();
    const auto matrixOf = [](const Vec3& shift) {
        return Json{{1, 0, 0, shift.x}, {0, 1, 0, shift.y}, {0, 0, 1, shift.z}, {0, 0, 0, 1}};
    };
    Json entries = Json::array();
    const auto add = [&](const std::string& name, const Eye& eye, const Json& camera, const Sky& light,
                         const std::string& env, const Vec3& shift, const Rgb& power, bool edited) {
        Light moved = emitter;
        moved.ball.centre += shift;
        moved.radiance *= power;
        writeImage(out / "truth" / "relit" / (name + ".exr"), render(eye, materials, &light, moved, 2, 32, 99));
        writeImage(out / "truth" / "masks" / (name + ".png"), objectMask(eye, moved));
        Json entry{{"name", name},
                   {"camera", camera},
                   {"image", "relit/" + name + ".exr"},
                   {"env", env},
                   {"edits", Json::array()}};
        if (edited)
            entry["edits"].push_back(
                {{"emitter_id", 0}, {"matrix", matrixOf(shift)}, {"power_scale", {power.x, power.y, power.z}}});
        entries.push_back(entry);
        std::fprintf(stderr, "%s\n", name.c_str());
    };
    add("reconstruction", eyes[0], 0, sky, "unchanged", Vec3(0), Rgb(1), false);
    add("off", eyes[0], 0, sky, "unchanged", Vec3(0), Rgb(0), true);
    add("moved", eyes[3], 3, sky, "unchanged", Vec3(-0.45f, 0.1f, -0.15f), Rgb(1), true);
    add("recoloured", eyes[0], 0, sky, "unchanged", Vec3(0), Rgb(0.1f, 0.5f, 2), true);
    add("other-environment", eyes[6], 6, other, "env-other.exr", Vec3(0), Rgb(1), false);
    add("white", eyes[0], 0, white, "env-white.exr", Vec3(0), Rgb(0), true);
    add("novel-view", novel, novelCamera, sky, "unchanged", Vec3(0), Rgb(1), false);
    // A new camera under the old light counts as an edit: an entry that changes nothing would be taken for the
    // reconstruction.
    entries.back()["edits"].push_back({{"emitter_id", 0}, {"matrix", matrixOf(Vec3(0))}, {"power_scale", {1, 1, 1}}});
    writeBytesAtomically(out / "truth" / "relight.json", entries.dump(1));
}

void score(const Materials& materials, const std::vector<std::string>& names, const fs::path& shotFolder) {
    Progress progress;
    const Shot shot = openShot(shotFolder, false, progress);
    const Reflectance& r = shot.estimate.reflectance;
    const Truth truth = makeMesh();
    const std::vector<BrdfSample> samples = brdfSamples();
    for (int b = 0; b < 4; ++b) {
        std::vector<Rgb> weight(r.basis.lobes.size(), Rgb(0));
        size_t count = 0;
        for (size_t v = 0; v < truth.object.size(); ++v) {
            if (truth.object[v] != b || r.observed[v] < 2) continue;
            for (size_t k = 0; k < weight.size(); ++k) weight[k] += r.weight[k][v];
            ++count;
        }
        for (Rgb& w : weight) w /= float(std::max<size_t>(1, count));
        std::vector<Rgb> values, model;
        Rgb outgoing(0), found(0);
        for (const BrdfSample& s : samples) {
            values.push_back(materials[size_t(b)](s.towardLight, s.towardEye));
            Rgb sum(0);
            for (size_t k = 0; k < weight.size(); ++k)
                sum += weight[k] * evaluateLobe(r.basis.lobes[k], s.towardLight, s.towardEye);
            model.push_back(sum);
            if (s.towardEye.z < 0.7f) continue;  // albedo towards eyes within 45 degrees
            outgoing += values.back() * (s.solidAngle * s.towardLight.z / 4);
            found += sum * (s.solidAngle * s.towardLight.z / 4);
        }
        const auto [l2, cube] = brdfErrors(samples, values, model);
        const float tint =
            std::acos(std::clamp(glm::dot(glm::normalize(outgoing), glm::normalize(found)), -1.0f, 1.0f)) * 180 / pi;
        std::printf(
            "%s: relative L2 %.3f, cube root %.4f; albedo %.3f %.3f %.3f, found %.3f %.3f %.3f, tint %.2f degrees\n",
            names[size_t(b)].c_str(), l2, cube, double(outgoing.x), double(outgoing.y), double(outgoing.z),
            double(found.x), double(found.y), double(found.z), double(tint));
        for (size_t k = 0; k < weight.size(); ++k) {
            if (!(maxChannel(weight[k]) > 0)) continue;
            std::printf("    %-28s weight %.3f %.3f %.3f", r.basis.lobes[k].name.c_str(), double(weight[k].x),
                        double(weight[k].y), double(weight[k].z));
            if (const auto& m = r.basis.lobes[k].measured)
                std::printf("   of the material itself: %.3f %.3f %.3f", double(m->colour.x), double(m->colour.y),
                            double(m->colour.z));
            std::puts("");
        }
    }
}

}  // namespace

int main(int argc, char** argv) {
    const std::vector<std::string> a(argv + 1, argv + argc);
    try {
        if (a.size() < 3)
            throw Error(
                "tables FOLDER OUT MATERIAL..., render FOLDER ENV OTHER-ENV OUT A B C D, or score FOLDER SHOT A B C D");
        const Rows networks = readTable(a[1] + "/nbrdf_merl_67.csv");
        const auto four = [&](size_t from) {
            if (a.size() != from + 4) throw Error("expected four materials at the end");
            Materials materials;
            for (size_t b = 0; b < 4; ++b) materials[b] = network(rowOf(networks, a[from + b]));
            return materials;
        };
        if (a[0] == "tables") writeTables(networks, a[2], {a.begin() + 3, a.end()});
        else if (a[0] == "render") renderCapture(four(5), readSky(a[2], 0.6f), readSky(a[3], 0.6f), a[4]);
        else if (a[0] == "score") score(four(3), {a.begin() + 3, a.end()}, a[2]);
        else throw Error("{}: unknown", a[0]);
        return 0;
    } catch (const std::exception& error) { return std::fprintf(stderr, "measured_scene: %s\n", error.what()), 1; }
}
