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
    std::map<std::string, Image> images;

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
    /// The number of a texture that is not repeated.
    int texture(const std::string& file, const std::string& name) {
        root["samplers"] = {{{"magFilter", 9729}, {"minFilter", 9729}, {"wrapS", 33071}, {"wrapT", 33071}}};
        root["images"].push_back({{"uri", file}, {"name", name}});
        root["textures"].push_back({{"source", root["images"].size() - 1}, {"sampler", 0}});
        return int(root["textures"].size()) - 1;
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

/// A texture of levels over the largest, 2 x 2 texels a triangle: its corners lie in the middle of three, the fourth
/// lies in their plane, and so filtering is linear on the triangle. `places` becomes where the corners lie, v
/// downwards.
Image levelsOf(const ExportedComponent& component, float most, std::vector<Vec2>& places) {
    const auto count = uint32_t(component.triangles.size());
    const auto columns = uint32_t(std::ceil(std::sqrt(double(count)))), rows = (count + columns - 1) / columns;
    Image image(int(2 * columns), int(2 * rows));
    for (uint32_t t = 0; t < count; ++t) {
        const Triangle& at = component.triangles[t];
        const int x = int(2 * (t % columns)), y = int(2 * (t / columns));
        const float a = component.level[at[0]] / most, b = component.level[at[1]] / most,
                    c = component.level[at[2]] / most;
        image.at(x, y) = Rgb(a);
        image.at(x + 1, y) = Rgb(b);
        image.at(x, y + 1) = Rgb(c);
        image.at(x + 1, y + 1) = Rgb(std::clamp(b + c - a, 0.0f, 1.0f));
        for (const Vec2 corner : {Vec2(0.5f), Vec2(1.5f, 0.5f), Vec2(0.5f, 1.5f)})
            places.push_back((Vec2(x, y) + corner) / Vec2(image.width, image.height));
    }
    return image;
}

/// With vertices that belong to one triangle each.
ExportedComponent cornersApart(const ExportedComponent& component) {
    ExportedComponent apart = component;
    apart.positions.clear();
    apart.normals.clear();
    apart.texcoords.clear();
    for (Triangle& t : apart.triangles)
        for (uint32_t& v : t) {
            apart.positions.push_back(component.positions[v]);
            apart.normals.push_back(component.normals[v]);
            if (!component.texcoords.empty()) apart.texcoords.push_back(component.texcoords[v]);
            v = uint32_t(apart.positions.size()) - 1;
        }
    return apart;
}

Json materialOf(const ExportedComponent& component) {
    Json material{{"name", component.name}, {"doubleSided", component.twoSided || !component.emits}};
    if (!component.emits) {
        const SurfaceMaterial surface = surfaceMaterialOf(component);
        material["pbrMetallicRoughness"] = {{"metallicFactor", surface.metallic},
                                            {"roughnessFactor", surface.roughness}};
        // Index 1.5 and full strength are what glTF assumes; a matte surface has to say that it has no coating.
        // Blender's importer (3.4) reads the colour and not the factor.
        const Rgb tint = surface.specular > 0 ? surface.specularColour : Rgb(0);
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

void addComponent(Document& d, const ExportedComponent& given, const DVec3& origin) {
    if (given.triangles.empty()) return;
    const bool uneven = !given.level.empty();
    const ExportedComponent component = uneven ? cornersApart(given) : given;
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
    Json material = materialOf(component);
    if (uneven) {
        const float most = std::max(*std::max_element(given.level.begin(), given.level.end()), 1e-6f);
        const std::string file = fmt::format("emission-{}.png", d.images.size() + 1);
        const int set = component.texcoords.empty() ? 0 : 1;
        std::vector<Vec2> places;
        d.images[file] = levelsOf(given, most, places);
        attributes[fmt::format("TEXCOORD_{}", set)] = d.places(places);
        material["emissiveTexture"] = {{"index", d.texture(file, component.name)}, {"texCoord", set}};
        Json& strength = material["extensions"]["KHR_materials_emissive_strength"]["emissiveStrength"];
        strength = strength.get<float>() * most;
    }
    d.root["materials"].push_back(std::move(material));
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
                    [](const ExportedComponent& c) { return c.textured; }))
        d.texture(textureFile, "albedo");
    const double half = std::sqrt(0.5);
    d.root["nodes"].push_back({{"name", "relamp"}, {"rotation", {-half, 0, 0, half}}, {"children", Json::array()}});
    d.root["scenes"] = {{{"nodes", {0}}}};
    for (const ExportedComponent& component : scene.components) addComponent(d, component, scene.origin);
    for (const ExportedView& view : scene.views) addView(d, view, scene.origin);
    d.root["buffers"] = {{{"uri", bufferFile}, {"byteLength", d.buffer.size()}}};
    return {dumpJson(d.root, 1) + "\n", d.buffer, std::move(d.images)};
}

}  // namespace relamp
