#include "shot/export_scene.h"

#include <map>
#include <nlohmann/json.hpp>
#include <tuple>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/json_fields.h"
#include "brdf/layered_albedo.h"
#include "capture/transforms_json.h"
#include "image/environment_map.h"
#include "image/image_io.h"
#include "relight/backdrop.h"
#include "scene/mesh_io.h"
#include "scene/texcoords.h"
#include "shot/background_file.h"
#include "shot/shot_texture.h"

namespace relamp {
namespace fs = std::filesystem;
namespace {

Json listOf(const Vec3& v) { return {v.x, v.y, v.z}; }
Json listOf(const DVec3& v) { return {v.x, v.y, v.z}; }

/// More kinds of surface than this are exported as one, matte.
constexpr size_t mostMaterials = 64;

constexpr const char* backgroundFile = "environment_background.exr";

/// The kinds of surface by the lobes beside the matte part, which are kept per connected component.
struct Materials {
    std::vector<uint32_t> ofVertex;  ///< empty: all are one
    std::vector<std::vector<ExportedLobe>> lobes{1};
};

/// The kinds of surface by which lights fall on them, also the same all over a connected component.
struct LitKinds {
    std::vector<uint32_t> ofVertex;              ///< empty: all are one
    std::vector<std::vector<uint32_t>> kept{1};  ///< of each kind: emitters that do not fall on it
};

LitKinds litKindsOf(const RelitScene& relit) {
    LitKinds kinds;
    if (relit.component.empty()) return kinds;
    std::map<std::vector<uint32_t>, uint32_t> known{{{}, 0}};
    for (const uint32_t component : relit.component) {
        std::vector<uint32_t> kept;
        for (uint32_t e = 0; e < relit.emitters.size(); ++e)
            if (!relit.emitters[e].reaches(component)) kept.push_back(e);
        const auto [at, isNew] = known.emplace(kept, uint32_t(known.size()));
        if (isNew) kinds.kept.push_back(std::move(kept));
        kinds.ofVertex.push_back(at->second);
    }
    return kinds;
}

Materials materialsOf(const RelitScene& relit) {
    Materials materials;
    if (relit.weight.size() < 2) return materials;
    std::map<std::vector<float>, uint32_t> known;
    const size_t vertices = relit.weight[0].size();
    materials.ofVertex.resize(vertices);
    materials.lobes.clear();
    for (size_t v = 0; v < vertices; ++v) {
        std::vector<float> key;
        for (size_t k = 1; k < relit.weight.size(); ++k)
            for (int c = 0; c < 3; ++c) key.push_back(relit.weight[k][v][c]);
        const auto [at, isNew] = known.emplace(std::move(key), uint32_t(known.size()));
        materials.ofVertex[v] = at->second;
        if (!isNew) continue;
        if (known.size() > mostMaterials) return {};
        std::vector<ExportedLobe> lobes;
        for (size_t k = 1; k < relit.weight.size(); ++k)
            if (maxChannel(relit.weight[k][v]) > 0) lobes.push_back({relit.basis.lobes[k], relit.weight[k][v]});
        materials.lobes.push_back(std::move(lobes));
    }
    return materials;
}

/// Of which triangles a component is made.
struct Selected {
    int emitter = -1;  ///< -1: of none
    bool textured = false;
    uint32_t material = 0;
    const Materials* materials = nullptr;
    uint32_t litKind = 0;
    const LitKinds* litKinds = nullptr;
    bool holds(const RelitScene& relit, uint32_t t) const {
        if (relit.emitterOfTriangle[t] != emitter) return false;
        if (bool(relit.texture && relit.texture->has(t)) != textured) return false;
        const uint32_t corner = relit.scene.mesh.triangles[t][0];
        if (litKinds && !litKinds->ofVertex.empty() && litKinds->ofVertex[corner] != litKind) return false;
        return !materials || materials->ofVertex.empty() || materials->ofVertex[corner] == material;
    }
};

/// The selected triangles with their vertices numbered anew. A vertex on the seam between two charts is there twice.
/// `own`: texture coordinates that the capture's file has, per triangle; empty where it has none.
ExportedComponent componentOf(const RelitScene& relit, const std::vector<FaceTexcoords>& own, const Selected& selected,
                              const std::string& id, const std::string& name, const Vec3& origin) {
    const Mesh& mesh = relit.scene.mesh;
    const AlbedoTexture* texture = relit.texture.get();
    ExportedComponent component;
    component.id = id;
    component.name = name;
    component.origin = origin;
    component.textured = selected.textured;
    std::map<std::tuple<uint32_t, float, float>, uint32_t> place;
    for (uint32_t t = 0; t < mesh.triangles.size(); ++t) {
        if (!selected.holds(relit, t)) continue;
        Triangle triangle = mesh.triangles[t];
        FaceTexcoords texcoords{};
        if (selected.textured) {
            texcoords = texcoordsOf(*texture, t);
            if (!relit.mirrored.empty() && relit.mirrored[t]) std::swap(texcoords[1], texcoords[2]);
        } else if (!own.empty()) {
            texcoords = own[t];
        }
        for (size_t k = 0; k < 3; ++k) {
            const uint32_t v = triangle[k];
            const auto [at, isNew] =
                place.emplace(std::tuple(v, texcoords[k].x, texcoords[k].y), uint32_t(component.positions.size()));
            if (isNew) {
                component.positions.push_back(mesh.positions[v] - origin);
                component.normals.push_back(mesh.normals[v]);
                component.albedo.push_back(relit.weightsAt(v).albedo());
                component.texcoords.push_back(texcoords[k]);
            }
            triangle[k] = at->second;
        }
        component.triangles.push_back(triangle);
        component.area += mesh.triangleArea(t);
    }
    if (std::all_of(component.texcoords.begin(), component.texcoords.end(), [](const Vec2& p) { return p == Vec2(0); }))
        component.texcoords.clear();
    return component;
}

/// With the names of the copies beside the scene.
Json exportedShaping(LightShaping shaping) {
    for (const ShapingFile file : shapingFiles) shaping.*file = (shaping.*file).filename();
    return shapingToJson(shaping);
}

/// Where the parts of a shape lie, for programs that know no light like it.
void placeShaping(const ExportedScene& scene, const ExportedComponent& light, Json& out) {
    out["axis"] = listOf(light.axis);
    if (!light.shaped) return;
    out["x_axis"] = listOf(light.shaped->axes()[0]);
    out["y_axis"] = listOf(light.shaped->axes()[1]);
    if (!light.shaping.iesFile.empty()) out["ies_candela"] = iesOf(light.shaping.iesFile)->most;
    if (light.shaping.surfaceFile.empty() && !light.shaping.doors()) return;
    out["middle"] = listOf(scene.origin + DVec3(light.shaped->middle()));
    out["half_size"] = {light.shaped->half().x, light.shaped->half().y};
    const auto slopes = light.shaped->imageSlopes();
    out["image_u"] = listOf(slopes[0]);
    out["image_v"] = listOf(slopes[1]);
}

/// The surfaces that a light does not fall on, by name.
void nameUnlit(const ExportedScene& scene, const ExportedComponent& light, Json& out) {
    for (const uint32_t surface : light.unlit) out["not_on"].push_back(scene.components[surface].name);
}

Json lightsJson(const Shot& shot, const RelitScene& relit, const ExportedScene& scene) {
    Json lights = Json::array();
    for (const ExportedComponent& p : scene.components) {
        if (!p.emits) continue;
        if (p.sunDegrees > 0) {
            lights.push_back({{"id", p.id},
                              {"name", p.name},
                              {"type", "sun"},
                              {"direction", listOf(p.axis)},
                              {"angle_degrees", p.sunDegrees},
                              {"radiance", listOf(p.radiance)},
                              {"shadows", p.shadows},
                              {"irradiance", listOf(p.radiance * (pi / sunRadiance(p.sunDegrees)))}});
            nameUnlit(scene, p, lights.back());
            continue;
        }
        Vec3 normal(0);
        for (const Triangle& t : p.triangles)
            normal += glm::cross(p.positions[t[1]] - p.positions[t[0]], p.positions[t[2]] - p.positions[t[0]]) / 2.0f;
        Json positions = Json::array(), triangles = Json::array();
        for (const Vec3& v : p.positions) positions.push_back(listOf(scene.origin + DVec3(v + p.origin)));
        for (const Triangle& t : p.triangles) triangles.push_back({t[0], t[1], t[2]});
        lights.push_back({{"id", p.id},
                          {"name", p.name},
                          {"type", "mesh"},
                          {"radiance", listOf(p.radiance)},
                          {"two_sided", p.twoSided},
                          {"area_m2", p.area},
                          {"flux", listOf(p.radiance * p.shapedFraction * (pi * p.area * (p.twoSided ? 2.0f : 1.0f)))},
                          {"centroid", listOf(scene.origin + DVec3(p.origin))},
                          {"mean_normal", listOf(p.area > 0 ? normal / p.area : Vec3(0))},
                          {"positions", positions},
                          {"triangles", triangles}});
        if (!p.shadows) lights.back()["shadows"] = false;
        nameUnlit(scene, p, lights.back());
        if (!p.level.empty()) lights.back()["levels"] = p.level;
        if (!p.shaping.plain()) {
            lights.back()["shaping"] = exportedShaping(p.shaping);
            placeShaping(scene, p, lights.back()["shaping"]);
        }
    }
    const GaugeReport& gauge = shot.estimate.gauge;
    Json environment = {{"file", "environment.exr"},
                        {"projection", "latitude-longitude"},
                        {"centre", "+X"},
                        {"right_of_centre", "-Y"},
                        {"top", "+Z"}};
    if (relit.distant->backdrop()) environment["background"] = backgroundFile;
    return {{"version", 1},
            {"units",
             {{"length", "metre"},
              {"up", "+Z"},
              {"radiance", "linear Rec.709 in units of the photographs"},
              {"flux", "pi x radiance x area"}}},
            {"gauge", {{"kind", gauge.kind}, {"evidence", gauge.evidence}}},
            {"origin", listOf(scene.origin)},
            {"interreflection", !relit.bounced.world.empty()},
            {"environment", environment},
            {"lights", lights}};
}

void writeEnvironment(const fs::path& file, const DistantLight& light) {
    const Image map = latLongFromCells(light.cells(), light.grid(), 1024);
    std::vector<Channel> channels;
    for (int c = 0; c < 3; ++c) {
        Channel channel{std::string(1, "RGB"[c]), false, {}};  // a sun exceeds what half floats hold
        for (const Rgb& p : map.pixels) channel.values.push_back(p[c]);
        channels.push_back(std::move(channel));
    }
    writeChannels(file, map.width, map.height, channels);
}

/// As wide as its widest layer.
void writeBackdrop(const fs::path& file, const Backdrop& backdrop) {
    int width = 0;
    for (const Backdrop::Layer& layer : backdrop.layers) width = std::max(width, layer.panorama->width());
    writeBackgroundFile(file, width, [&](int x, int y) {
        return backdrop.radiance(directionFromLatLong((Vec2(x, y) + 0.5f) / Vec2(width, width / 2)));
    });
}

void writeMaterials(const fs::path& file, const RelitScene& relit, const DVec3& origin) {
    std::vector<VertexProperty> properties;
    const auto add = [&](const std::string& name, const std::vector<Rgb>& values) {
        for (int c = 0; c < 3; ++c) {
            VertexProperty p{fmt::format("{}_{}", name, "rgb"[c]), {}, false};
            for (const Rgb& v : values) p.values.push_back(v[c]);
            properties.push_back(std::move(p));
        }
    };
    if (!relit.weight.empty()) add("albedo", albedoUnderCoating(relit.basis, relit.weight));
    for (size_t k = 0; k < relit.weight.size(); ++k) add(fmt::format("weight_{}", k), relit.weight[k]);
    VertexProperty emitter{"emitter", std::vector<float>(relit.scene.mesh.vertexCount(), -1), true};
    for (size_t t = 0; t < relit.emitterOfTriangle.size(); ++t)
        if (relit.emitterOfTriangle[t] >= 0)
            for (uint32_t v : relit.scene.mesh.triangles[t]) emitter.values[v] = float(relit.emitterOfTriangle[t]);
    properties.push_back(std::move(emitter));
    writeVertexPly(file, relit.scene.mesh, properties, origin);
}

/// What light shapes are made of is copied beside the scene, which names the copies. Two files of one name get two.
void copyShapingFiles(ExportedScene& scene, const fs::path& folder, const InputFiles& inputs) {
    std::map<std::string, fs::path> copies;  // by name
    for (ExportedComponent& component : scene.components)
        for (const ShapingFile which : shapingFiles) {
            fs::path* file = &(component.shaping.*which);
            if (file->empty()) continue;
            const std::string stem = file->stem().string(), extension = file->extension().string();
            std::string name = stem + extension;
            for (int i = 2; !copies.emplace(name, *file).second && copies[name] != *file; ++i)
                name = fmt::format("{}-{}{}", stem, i, extension);
            inputs.refuse(folder / name);
            writeBytesAtomically(folder / name, readBytes(*file));
            *file = folder / name;
        }
}

/// One line a light.
std::vector<std::string> leftOut(const ExportedScene& scene) {
    std::vector<std::string> lines;
    for (const ExportedComponent& c : scene.components) {
        if (c.shaping.plain()) continue;
        std::string line =
            fmt::format("{}: lights.gltf, surfaces.obj and materials.mtlx have its radiance without its shape", c.name);
        const bool images = !c.shaping.goboFile.empty() || !c.shaping.surfaceFile.empty(), doors = c.shaping.doors();
        if (images || doors)
            line += fmt::format("; lights.usda leaves its {} out", images && doors ? "images and barn doors"
                                                                   : images        ? "images"
                                                                                   : "barn doors");
        lines.push_back(line);
    }
    for (const ExportedComponent& c : scene.components)
        if (!c.unlit.empty())
            lines.push_back(
                fmt::format("{}: lights.gltf and surfaces.obj let it fall on all surfaces; scene.py needs "
                            "Blender 4.0 to keep it from some",
                            c.name));
    for (const ExportedComponent& c : scene.components)
        if (!c.level.empty())
            lines.push_back(fmt::format("{}: surfaces.obj has the mean of its uneven radiance", c.name));
    return lines;
}

}  // namespace

ExportedScene exportedScene(const RelitScene& relit, const Capture& capture) {
    ExportedScene scene;
    scene.origin = capture.origin;
    const std::vector<FaceTexcoords> own =
        capture.texcoords ? texcoordsOf(*capture.texcoords, relit.scene.mesh.triangles) : std::vector<FaceTexcoords>();
    for (size_t e = 0; e < relit.emitters.size(); ++e) {
        const RelitEmitter& emitter = relit.emitters[e];
        scene.components.push_back(
            componentOf(relit, own, {int(e)}, emitter.id, emitter.name, emitter.surface.centroid));
        scene.components.back().radiance = emitter.emission.level;
        scene.components.back().sunDegrees = emitter.sunDegrees;
        scene.components.back().shadows = emitter.shadows;
        if (emitter.sunDegrees > 0 && !emitter.surface.normals.empty())
            scene.components.back().axis = emitter.surface.normals[0];
        if (const ShapedEmission* shaped = emitter.emission.shaped.get()) {
            ExportedComponent& light = scene.components.back();
            light.shaping = shaped->shaping();
            light.shaped = emitter.emission.shaped;
            light.axis = shaped->axis();
            light.shapedFraction = shaped->mean();
            for (size_t v = 0; !shaped->even() && v < light.positions.size(); ++v)
                light.level.push_back(shaped->patternAt(light.positions[v] + light.origin));
        }
        scene.components.back().emits = true;
        scene.components.back().twoSided = emitter.surface.twoSided;
    }
    const Materials materials = materialsOf(relit);
    const LitKinds litKinds = litKindsOf(relit);
    for (const bool textured : {true, false}) {
        if (textured && !relit.texture) continue;
        const std::string kind = relit.texture && !textured ? "plain surfaces" : "surfaces";
        size_t count = 0;
        for (uint32_t m = 0; m < materials.lobes.size() * litKinds.kept.size(); ++m) {
            const std::string name = count == 0 ? kind : fmt::format("{} {}", kind, count + 1);
            const uint32_t material = m / uint32_t(litKinds.kept.size()), lit = m % uint32_t(litKinds.kept.size());
            ExportedComponent component =
                componentOf(relit, own, {-1, textured, material, &materials, lit, &litKinds}, name, name, Vec3(0));
            if (component.triangles.empty()) continue;
            component.lobes = materials.lobes[material];
            for (const uint32_t e : litKinds.kept[lit])
                scene.components[e].unlit.push_back(uint32_t(scene.components.size()));
            scene.components.push_back(std::move(component));
            ++count;
        }
    }
    for (const View& view : capture.views) scene.views.push_back({view.name, view.camera});
    return scene;
}

std::string transformsOf(const Capture& capture, const fs::path& folder, const std::string& meshFile) {
    Json frames = Json::array();
    for (const View& view : capture.views) {
        Camera c = view.camera;
        c.worldFromCamera[3] += glm::dvec4(capture.origin, 0);
        const std::string image = view.file.empty()
                                      ? view.name
                                      : fs::proximate(fs::absolute(view.file), fs::absolute(folder)).generic_string();
        frames.push_back(transformsFrame(c, image));
    }
    return dumpJson({{"mesh_path", meshFile}, {"up", "z"}, {"frames", frames}}, 1) + "\n";
}

std::vector<std::string> exportScene(const Shot& shot, const RelitScene& relit, const fs::path& folder, bool overwrite,
                                     const InputFiles& inputs) {
    std::error_code failed;
    if (fs::exists(folder, failed) &&
        (!fs::is_directory(folder, failed) || (!overwrite && !fs::is_empty(folder, failed))))
        throw Error("{}: exists already, add --overwrite to write into it", folder.string());
    for (const char* name : {"environment.exr", backgroundFile, "materials.ply", "transforms.json", "lights.usda",
                             "lights.bin", "lights.gltf", "lights.json", "surfaces.obj", "surfaces.mtl", "albedo.exr",
                             "albedo.png", "materials.mtlx", "scene.py", "relight.nk"})
        inputs.refuse(folder / name);
    fs::create_directories(folder, failed);
    if (failed) throw Error("{}: cannot be made ({})", folder.string(), failed.message());
    ExportedScene scene = exportedScene(relit, shot.capture);
    copyShapingFiles(scene, folder, inputs);
    writeEnvironment(folder / "environment.exr", *relit.distant);
    const std::shared_ptr<const Backdrop>& backdrop = relit.distant->backdrop();
    if (backdrop) writeBackdrop(folder / backgroundFile, *backdrop);
    writeMaterials(folder / "materials.ply", relit, shot.capture.origin);
    writeBytesAtomically(folder / "transforms.json", transformsOf(shot.capture, folder, "materials.ply"));
    writeBytesAtomically(folder / "lights.usda", usdaOf(scene, "environment.exr"));
    const Gltf gltf = gltfOf(scene, "lights.bin");
    writeBytesAtomically(folder / "lights.bin", gltf.buffer);
    for (const auto& [name, image] : gltf.images) {
        inputs.refuse(folder / name);
        writeImage(folder / name, image);
    }
    writeBytesAtomically(folder / "lights.gltf", gltf.json);
    const Obj obj = objOf(scene, "surfaces.mtl");
    writeBytesAtomically(folder / "surfaces.mtl", obj.materials);
    writeBytesAtomically(folder / "surfaces.obj", obj.geometry);
    writeBytesAtomically(folder / "materials.mtlx", materialXOf(scene));
    writeBytesAtomically(folder / "scene.py", blenderScript());
    std::vector<std::string> groups;
    for (const RelitEmitter& emitter : relit.emitters) groups.push_back(emitter.name);
    writeBytesAtomically(folder / "relight.nk", nukeOf(groups));
    if (relit.texture) {
        writeTexture(*relit.texture, folder / "albedo.exr");
        Image shown(relit.texture->width, relit.texture->height);
        shown.pixels = relit.texture->texels;
        writeImage(folder / "albedo.png", shown);
    }
    writeBytesAtomically(folder / "lights.json", dumpJson(lightsJson(shot, relit, scene), 1) + "\n");
    return leftOut(scene);
}

}  // namespace relamp
