// The exported scene as glTF 2.0.
#include <cstring>
#include <nlohmann/json.hpp>

#include "base/box.h"

#include "base/json_fields.h"
#include "shot/export_scene.h"
#include "shot/scene_materials.h"

namespace relamp {
namespace {

constexpr int floats = 5126, indices = 5125, vertexBuffer = 34962,
              indexBuffer = 34963;  // the specification's constants

struct Document {
    Json root{{"asset", {{"version", "2.0"}, {"generator", "relamp " RELAMP_VERSION}}},
              {"scene", 0},
              {"extensionsUsed", {"KHR_materials_emissive_strength", "KHR_materials_specular"}}};
    std::string buffer;

    /// Appends `bytes` as a view and an accessor over it; returns the accessor's number.
    int add(const void* bytes, size_t size, size_t count, int component, const char* type, int target) {
        root["bufferViews"].push_back(
            {{"buffer", 0}, {"byteOffset", buffer.size()}, {"byteLength", size}, {"target", target}});
        root["accessors"].push_back({{"bufferView", root["bufferViews"].size() - 1},
                                     {"componentType", component},
                                     {"count", count},
                                     {"type", type}});
        buffer.append(static_cast<const char*>(bytes), size);
        return int(root["accessors"].size()) - 1;
    }
    int places(const std::vector<Vec2>& values) {
        return add(values.data(), values.size() * sizeof(Vec2), values.size(), floats, "VEC2", vertexBuffer);
    }
    int vectors(const std::vector<Vec3>& values) {
        return add(values.data(), values.size() * sizeof(Vec3), values.size(), floats, "VEC3", vertexBuffer);
    }
    void child(Json node) {
        root["nodes"].push_back(std::move(node));
        root["nodes"][0]["children"].push_back(root["nodes"].size() - 1);
    }
};

int positions(Document& d, const ExportedComponent& component) {
    const Box box = boxOf(component.positions);
    const int at = d.vectors(component.positions);
    d.root["accessors"][size_t(at)]["min"] = {box.min.x, box.min.y, box.min.z};
    d.root["accessors"][size_t(at)]["max"] = {box.max.x, box.max.y, box.max.z};
    return at;
}

Json materialOf(const ExportedComponent& component) {
    Json material{{"name", component.name}, {"doubleSided", component.twoSided || !component.emits}};
    if (!component.emits) {
        const SurfaceMaterial surface = surfaceMaterialOf(component);
        material["pbrMetallicRoughness"] = {{"metallicFactor", surface.metallic},
                                            {"roughnessFactor", surface.roughness}};
        // Index 1.5 and full strength are what glTF assumes; a matte surface has to say that it has no coating.
        const Rgb& tint = surface.specularColour;
        material["extensions"]["KHR_materials_specular"] = {{"specularFactor", surface.specular},
                                                            {"specularColorFactor", {tint.x, tint.y, tint.z}}};
        for (const ExportedLobe& l : component.lobes)
            material["extras"]["relamp_lobes"].push_back({{"kind", kindName(l.lobe.kind)},
                                                          {"alpha", l.lobe.alpha},
                                                          {"weight", {l.weight.x, l.weight.y, l.weight.z}}});
        if (component.textured) material["pbrMetallicRoughness"]["baseColorTexture"] = {{"index", 0}, {"texCoord", 0}};
        return material;
    }
    const float strength = maxChannel(component.radiance) > 0 ? maxChannel(component.radiance) : 1.0f;
    const Rgb factor = component.radiance / strength;
    material["pbrMetallicRoughness"] = {
        {"baseColorFactor", {0, 0, 0, 1}}, {"metallicFactor", 0}, {"roughnessFactor", 1}};
    material["emissiveFactor"] = {factor.x, factor.y, factor.z};
    material["extensions"] = {{"KHR_materials_emissive_strength", {{"emissiveStrength", strength}}}};
    return material;
}

void addComponent(Document& d, const ExportedComponent& component, const DVec3& origin) {
    if (component.triangles.empty()) return;
    static_assert(sizeof(Vec3) == 12 && sizeof(Triangle) == 12);
    Json attributes{{"POSITION", positions(d, component)}, {"NORMAL", d.vectors(component.normals)}};
    if (!component.texcoords.empty()) {
        // glTF counts v downwards.
        std::vector<Vec2> down = component.texcoords;
        for (Vec2& at : down) at.y = 1 - at.y;
        attributes["TEXCOORD_0"] = d.places(down);
    }
    if (!component.emits && !component.textured) attributes["COLOR_0"] = d.vectors(component.albedo);
    const int faces = d.add(component.triangles.data(), component.triangles.size() * sizeof(Triangle),
                            component.triangles.size() * 3, indices, "SCALAR", indexBuffer);
    d.root["materials"].push_back(materialOf(component));
    d.root["meshes"].push_back(
        {{"name", component.name},
         {"primitives",
          {{{"attributes", attributes}, {"indices", faces}, {"material", d.root["materials"].size() - 1}}}}});
    const DVec3 place = origin + DVec3(component.origin);
    d.child({{"name", component.name},
             {"mesh", d.root["meshes"].size() - 1},
             {"translation", {place.x, place.y, place.z}}});
}

void addView(Document& d, const ExportedView& view, const DVec3& origin) {
    Camera c = view.camera;
    c.worldFromCamera[3] += glm::dvec4(origin, 0);
    d.root["cameras"].push_back({{"name", view.name},
                                 {"type", "perspective"},
                                 {"perspective",
                                  {{"yfov", 2 * std::atan(0.5 * c.height / c.focalY)},
                                   {"aspectRatio", double(c.width) / c.height * c.focalY / c.focalX},
                                   {"znear", 0.01},
                                   {"zfar", 1000}}}});
    Json matrix = Json::array();
    for (int column = 0; column < 4; ++column)
        for (int row = 0; row < 4; ++row) matrix.push_back(c.worldFromCamera[column][row]);
    d.child({{"name", view.name}, {"camera", d.root["cameras"].size() - 1}, {"matrix", matrix}});
}

}  // namespace

Gltf gltfOf(const ExportedScene& scene, const std::string& bufferFile, const std::string& textureFile) {
    Document d;
    if (std::any_of(scene.components.begin(), scene.components.end(),
                    [](const ExportedComponent& c) { return c.textured; })) {
        d.root["images"] = {{{"uri", textureFile}, {"name", "albedo"}}};
        d.root["samplers"] = {{{"magFilter", 9729}, {"minFilter", 9729}, {"wrapS", 33071}, {"wrapT", 33071}}};
        d.root["textures"] = {{{"source", 0}, {"sampler", 0}}};
    }
    const double half = std::sqrt(0.5);
    d.root["nodes"].push_back({{"name", "relamp"}, {"rotation", {-half, 0, 0, half}}, {"children", Json::array()}});
    d.root["scenes"] = {{{"nodes", {0}}}};
    for (const ExportedComponent& component : scene.components) addComponent(d, component, scene.origin);
    for (const ExportedView& view : scene.views) addView(d, view, scene.origin);
    d.root["buffers"] = {{{"uri", bufferFile}, {"byteLength", d.buffer.size()}}};
    return {dumpJson(d.root, 1) + "\n", d.buffer};
}

}  // namespace relamp
