// The scene for other programs: lights as JSON, USD and glTF, the environment, the materials and the cameras.
#pragma once
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "relight/relit_scene.h"
#include "shot/frame_layers.h"
#include "shot/shot_file.h"

namespace relamp {

/// A lobe beside the matte part.
struct ExportedLobe {
    Lobe lobe;
    Rgb weight;
};

/// A component of the scene's surface, in metres about `origin`, which counts from the scene's; Z is up.
struct ExportedComponent {
    std::string id;               ///< of the emitter; "surfaces" for the rest
    std::string name;             ///< what the artist calls it, else its id
    Vec3 origin{0};               ///< the centroid of an emitter: what other programs turn it about
    std::vector<Vec3> positions;  ///< relative to origin
    std::vector<Vec3> normals;
    std::vector<Rgb> albedo;          ///< diffuse
    std::vector<ExportedLobe> lobes;  ///< the same on all of it; empty: matte
    std::vector<Vec2> texcoords;      ///< u to the right, v up; of the texture, or as the capture's file has them
    bool textured = false;            ///< its colour is the texture's; else `albedo`
    std::vector<Triangle> triangles;  ///< counter-clockwise from outside
    Rgb radiance{0};                  ///< emitted, linear Rec.709; where it is shaped: the shaping's unit
    std::vector<float> level{};       ///< per vertex, emitted radiance in parts of `radiance`; empty: even
    LightShaping shaping{};           ///< of an added light
    Vec3 axis{0, 0, -1};              ///< that the shaping counts from, unit
    Rgb shapedFraction{1};            ///< of the power that it would have without shaping
    std::shared_ptr<const ShapedEmission> shaped{};  ///< null: it has no shaping
    bool emits = false, twoSided = false;
    bool shadows = true;
    std::vector<uint32_t> unlit{};  ///< of a light: the components that it does not fall on (indices into the scene's)
    float sunDegrees = 0;           ///< of a sun: the angle that it covers; it has no triangles
    float area = 0;                 ///< square metres
};

struct ExportedView {
    std::string name;  ///< of the photograph
    Camera camera;
};

struct ExportedScene {
    /// The emitters in order, then surfaces with texture, then the rest, each by the lobes that they have and the
    /// lights that do not fall on them.
    std::vector<ExportedComponent> components;
    std::vector<ExportedView> views;  ///< their cameras count from origin
    DVec3 origin{0};                  ///< Capture::origin: double where single precision would not hold the places
};

/// The components of a scene under a look. Cost: one pass over the mesh.
ExportedScene exportedScene(const RelitScene& relit, const Capture& capture);

/// USD as text: a Mesh with MeshLightAPI and an emissive UsdPreviewSurface per emitter, a DomeLight over
/// `environmentFile`, a Camera per view, ShapingAPI where a light has a cone, focus or photometric file, a lightLink
/// where it does not fall on every surface, the rest of the mesh with its albedo as displayColor, or as a UsdUVTexture
/// of `textureFile` (linear). A light that shines unevenly takes its emission from its material, whose colour is the
/// primvar emission. Z up, metres. Prims are called after their emitters, channel-safe; ids stand in relamp:id.
std::string usdaOf(const ExportedScene& scene, const std::string& environmentFile,
                   const std::string& textureFile = "albedo.exr");

/// glTF 2.0 with its binary buffer, to be stored as `bufferFile` beside it: emitters are meshes whose material has
/// emissiveFactor and KHR_materials_emissive_strength (radiance = factor x strength), one that shines unevenly an
/// emissiveTexture as well, the rest has its albedo as COLOR_0, or as baseColorTexture from `textureFile` (sRGB),
/// cameras are nodes. The root turns Z up to glTF's Y up.
struct Gltf {
    std::string json, buffer;
    std::map<std::string, Image> images{};  ///< by file name, linear, to be stored as sRGB beside it
};
Gltf gltfOf(const ExportedScene& scene, const std::string& bufferFile, const std::string& textureFile = "albedo.png");

/// Wavefront OBJ with its material library, to be stored as `materialFile` beside it: every component is an object,
/// surfaces with texture name `textureFile` (sRGB), emitters have Ke. Z up, metres.
struct Obj {
    std::string geometry, materials;
};
Obj objOf(const ExportedScene& scene, const std::string& materialFile, const std::string& textureFile = "albedo.png");

/// MaterialX 1.38: an open_pbr_surface for each surface, whose colour is `textureFile` (linear) or the primvar
/// displayColor, a surface_unlit for each emitter, and the assignments to the prims of the USD.
std::string materialXOf(const ExportedScene& scene, const std::string& textureFile = "albedo.exr");

/// A Nuke script that adds the light groups of a frame up again, each through a Grade of its own: `frameFile` is what
/// its Read node asks for, `groups` the emitters' names of its layers.
std::string nukeOf(const std::vector<std::string>& groups, LayerNaming naming = LayerNaming::blender,
                   const std::string& frameFile = "frame.####.exr");

/// What Blender runs to rebuild the scene from the files beside it (assets/export/scene.py).
std::string blenderScript();

/// The prims of the components in usdaOf, in order; "" where there is none. No two alike.
std::vector<std::string> primNamesOf(const ExportedScene& scene);

/// The views as a transforms.json (axes of the scene, Z up); images are named relative to `folder`, the mesh is
/// `meshFile`.
std::string transformsOf(const Capture& capture, const std::filesystem::path& folder, const std::string& meshFile);

/// Writes lights.json, lights.usda, lights.gltf with lights.bin, surfaces.obj with surfaces.mtl, materials.mtlx,
/// scene.py for Blender, relight.nk for Nuke, environment.exr (float, 1024 x 512), materials.ply (all vertices: albedo,
/// weights of every lobe, emitter) and transforms.json into `folder`, each whole or not at all. Where the look has a
/// backdrop also environment_background.exr (half float, as wide as its widest layer). Where there is a texture also
/// albedo.exr (linear) and albedo.png (sRGB, 8 bits); for each light that shines unevenly emission-N.png; copies of
/// photometric files and images of lights. What formats cannot hold of a light's shape is returned in words. Throws
/// Error when the folder holds something already and `overwrite` is false; OutOfResources when the disk is full.
std::vector<std::string> exportScene(const Shot& shot, const RelitScene& relit, const std::filesystem::path& folder,
                                     bool overwrite, const InputFiles& inputs = {});

}  // namespace relamp
