// The exported scene as USD text.
#include <cctype>
#include <set>

#include "shot/export_scene.h"
#include "shot/scene_materials.h"

namespace relamp {
namespace {

/// Letters, digits, underscores; no two alike.
std::string primName(const std::string& id, std::set<std::string>& taken) {
    std::string safe;
    for (char c : id) safe += std::isalnum(static_cast<unsigned char>(c)) ? c : '_';
    if (safe.empty() || std::isdigit(static_cast<unsigned char>(safe[0]))) safe = "_" + safe;
    std::string name = safe;
    for (int i = 2; !taken.insert(name).second; ++i) name = fmt::format("{}_{}", safe, i);
    return name;
}

std::string quoted(const std::string& text) {
    std::string out = "\"";
    for (char c : text) {
        if (c == '"' || c == '\\') out += '\\';
        if (static_cast<unsigned char>(c) >= 32) out += c;
    }
    return out + "\"";
}

std::string tuple(const Vec3& v) { return fmt::format("({}, {}, {})", v.x, v.y, v.z); }
std::string wideTuple(const DVec3& v) { return fmt::format("({}, {}, {})", v.x, v.y, v.z); }

template <class T, class Text>
std::string list(const std::vector<T>& values, Text&& text) {
    std::string out = "[";
    for (size_t i = 0; i < values.size(); ++i) out += (i ? ", " : "") + text(values[i]);
    return out + "]";
}

std::string matrix(const DMat4& m) {
    std::string out = "(";
    for (int c = 0; c < 4; ++c)
        out += fmt::format("{}({}, {}, {}, {})", c ? ", " : " ", m[c][0], m[c][1], m[c][2], m[c][3]);
    return out + " )";
}

/// UsdLux ShapingAPI: cone, focus and photometric file; images have no place in it.
std::string shapingOf(const LightShaping& shaping) {
    std::string s = fmt::format(
        "        float inputs:shaping:cone:angle = {}\n        float inputs:shaping:cone:softness = {}\n"
        "        float inputs:shaping:focus = {}\n",
        shaping.coneDegrees, shaping.coneSoftness, shaping.focus);
    if (shaping.iesFile.empty()) return s;
    std::string file = "./" + shaping.iesFile.filename().generic_string();
    std::erase_if(file, [](char c) { return c == '@' || static_cast<unsigned char>(c) < 32; });
    return s + "        asset inputs:shaping:ies:file = @" + file +
           "@\n        bool inputs:shaping:ies:normalize = 0\n";
}

/// With its positions in axes of its own: a shaped light's axis has to be -Z there.
ExportedComponent turned(ExportedComponent component, const Mat3& axes) {
    for (Vec3& v : component.positions) v = v * axes;
    return component;
}

/// The collection that every light of UsdLux has: all prims but those that it does not fall on.
std::string linkOf(const ExportedComponent& light, const std::vector<std::string>& prims) {
    if (light.unlit.empty()) return "";
    return "        uniform bool collection:lightLink:includeRoot = 1\n        rel collection:lightLink:excludes = " +
           list(light.unlit, [&](uint32_t surface) { return "</relamp/" + prims[surface] + ">"; }) + "\n";
}

std::string meshOf(const ExportedComponent& given, const DVec3& origin, const std::string& name,
                   const std::string& link) {
    const bool shaped = !given.shaping.plain();
    const Mat3 turn = shaped ? frameAround(-given.axis) : Mat3(1);
    const ExportedComponent p = shaped ? turned(given, turn) : given;
    std::string s = fmt::format(
        "    def Mesh \"{}\" (\n        prepend apiSchemas = [{}{}{}\"MaterialBindingAPI\"]\n    )\n    {{\n", name,
        p.emits ? "\"MeshLightAPI\", " : "", shaped ? "\"ShapingAPI\", " : "", p.shadows ? "" : "\"ShadowAPI\", ");
    if (!p.shadows) s += "        bool inputs:shadow:enable = 0\n";
    s += link;
    s += fmt::format(
        "        string relamp:id = {}\n        uniform token subdivisionScheme = \"none\"\n        uniform bool "
        "doubleSided = {}\n",
        quoted(p.id), p.twoSided || !p.emits ? 1 : 0);
    s += "        point3f[] points = " + list(p.positions, tuple) + "\n";
    s += "        int[] faceVertexCounts = " + list(p.triangles, [](const Triangle&) { return std::string("3"); }) +
         "\n";
    s += "        int[] faceVertexIndices = " +
         list(p.triangles, [](const Triangle& t) { return fmt::format("{}, {}, {}", t[0], t[1], t[2]); }) + "\n";
    if (shaped) {
        DMat4 place{glm::dmat3(turn)};
        place[3] = glm::dvec4(origin + DVec3(p.origin), 1);
        s += "        matrix4d xformOp:transform = " + matrix(place) +
             "\n        uniform token[] xformOpOrder = [\"xformOp:transform\"]\n" + shapingOf(p.shaping);
    } else {
        s += fmt::format(
            "        double3 xformOp:translate = {}\n        uniform token[] xformOpOrder = [\"xformOp:translate\"]\n",
            origin == DVec3(0) ? tuple(p.origin) : wideTuple(origin + DVec3(p.origin)));
    }
    if (!p.texcoords.empty())
        s += "        texCoord2f[] primvars:st = " +
             list(p.texcoords, [](const Vec2& v) { return fmt::format("({}, {})", v.x, v.y); }) +
             " (\n            interpolation = \"vertex\"\n        )\n";
    if (p.emits) {
        const float brightest = !p.level.empty() ? 1.0f : std::max(maxChannel(p.radiance), 0.0f);
        // What is not normalised counts in candela, where ours is in parts of the largest.
        const float intensity = p.shaping.iesFile.empty() ? brightest : brightest / iesOf(p.shaping.iesFile)->most;
        // A mesh light's emission is its material's, tinted, unless it says otherwise.
        s += fmt::format(
            "        color3f inputs:color = {}\n        float inputs:intensity = {}\n        bool inputs:normalize = "
            "0\n        uniform token light:materialSyncMode = \"{}\"\n",
            tuple(brightest > 0 && p.level.empty() ? p.radiance / brightest : Rgb(1)), intensity,
            p.level.empty() ? "independent" : "materialGlowTintsLight");
        if (!p.level.empty()) {
            std::vector<Rgb> emission;
            for (const float level : p.level) emission.push_back(level * p.radiance);
            s += "        color3f[] primvars:emission = " + list(emission, tuple) +
                 " (\n            interpolation = \"vertex\"\n        )\n";
        }
        s += fmt::format("        rel material:binding = </relamp/Materials/{}>\n", name);
    } else if (p.textured) {
        s += fmt::format("        rel material:binding = </relamp/Materials/{}>\n", name);
    } else {
        s += "        color3f[] primvars:displayColor = " + list(p.albedo, tuple) +
             " (\n            interpolation = \"vertex\"\n        )\n";
        s += fmt::format("        rel material:binding = </relamp/Materials/{}>\n", name);
    }
    return s + "    }\n\n";
}

/// Its intensity is the irradiance: normalised, a sun's power does not change with its angle.
std::string sunOf(const ExportedComponent& p, const std::string& name, const std::string& link) {
    const Rgb irradiance = p.radiance * (pi / sunRadiance(p.sunDegrees));
    const float intensity = std::max(maxChannel(irradiance), 0.0f);
    return fmt::format(
        "    def DistantLight \"{}\"{}\n    {{\n{}{}        string relamp:id = {}\n        float inputs:angle = {}\n"
        "        color3f inputs:color = {}\n        float inputs:intensity = {}\n        bool inputs:normalize = 1\n"
        "        matrix4d xformOp:transform = {}\n        uniform token[] xformOpOrder = [\"xformOp:transform\"]\n    "
        "}}\n\n",
        name, p.shadows ? "" : " (\n        prepend apiSchemas = [\"ShadowAPI\"]\n    )",
        p.shadows ? "" : "        bool inputs:shadow:enable = 0\n", link, quoted(p.id), p.sunDegrees,
        tuple(intensity > 0 ? irradiance / intensity : Rgb(1)), intensity,
        matrix(DMat4(glm::dmat3(frameAround(-p.axis)))));
}

std::string materialOf(const ExportedComponent& p, const std::string& name) {
    const std::string reader =
        p.level.empty()
            ? ""
            : "\n            def Shader \"glow\"\n            {\n                uniform token info:id = "
              "\"UsdPrimvarReader_float3\"\n                string inputs:varname = \"emission\"\n                "
              "float3 outputs:result\n            }\n";
    const std::string emission = p.level.empty()
                                     ? " = " + tuple(p.radiance)
                                     : fmt::format(".connect = </relamp/Materials/{}/glow.outputs:result>", name);
    return fmt::format(
        "        def Material \"{0}\"\n        {{\n            token outputs:surface.connect = "
        "</relamp/Materials/{0}/surface.outputs:surface>\n\n"
        "            def Shader \"surface\"\n            {{\n                uniform token info:id = "
        "\"UsdPreviewSurface\"\n                color3f inputs:diffuseColor = (0, 0, 0)\n"
        "                color3f inputs:emissiveColor{1}\n                float inputs:roughness = 1\n              "
        "  token outputs:surface\n            }}\n{2}        }}\n\n",
        name, emission, reader);
}

/// Roughness and coating; UsdPreviewSurface has no weight of the coating, so its index follows from the reflectance at
/// right angles.
std::string glossInputs(const ExportedComponent& p) {
    const SurfaceMaterial surface = surfaceMaterialOf(p);
    const float root = std::sqrt(0.04f * surface.specular);
    return fmt::format(
        "                float inputs:roughness = {}\n                float inputs:metallic = {}\n                "
        "float "
        "inputs:ior = {}\n",
        surface.roughness, surface.metallic, (1 + root) / (1 - root));
}

/// Its colour is a texture of `file`, or the primvar displayColor.
std::string surfaceMaterial(const ExportedComponent& p, const std::string& name, const std::string& file) {
    if (!p.textured)
        return fmt::format(
            "        def Material \"{0}\"\n        {{\n            token outputs:surface.connect = "
            "</relamp/Materials/{0}/surface.outputs:surface>\n\n"
            "            def Shader \"surface\"\n            {{\n                uniform token info:id = "
            "\"UsdPreviewSurface\"\n                color3f inputs:diffuseColor.connect = "
            "</relamp/Materials/{0}/albedo.outputs:result>\n{1}                token outputs:surface\n            "
            "}}\n\n"
            "            def Shader \"albedo\"\n            {{\n                uniform token info:id = "
            "\"UsdPrimvarReader_float3\"\n                string inputs:varname = \"displayColor\"\n                "
            "float3 outputs:result\n            }}\n        }}\n\n",
            name, glossInputs(p));
    return fmt::format(
        "        def Material \"{0}\"\n        {{\n            token outputs:surface.connect = "
        "</relamp/Materials/{0}/surface.outputs:surface>\n\n"
        "            def Shader \"surface\"\n            {{\n                uniform token info:id = "
        "\"UsdPreviewSurface\"\n                color3f inputs:diffuseColor.connect = "
        "</relamp/Materials/{0}/albedo.outputs:rgb>\n{2}                token outputs:surface\n            }}\n\n"
        "            def Shader \"albedo\"\n            {{\n                uniform token info:id = "
        "\"UsdUVTexture\"\n                asset inputs:file = @./{1}@\n                token "
        "inputs:sourceColorSpace = \"raw\"\n                float2 inputs:st.connect = "
        "</relamp/Materials/{0}/st.outputs:result>\n                float3 outputs:rgb\n            }}\n\n"
        "            def Shader \"st\"\n            {{\n                uniform token info:id = "
        "\"UsdPrimvarReader_float2\"\n                string inputs:varname = \"st\"\n                float2 "
        "outputs:result\n            }}\n        }}\n\n",
        name, file, glossInputs(p));
}

/// The film is 36 units wide; USD counts focal lengths and apertures in tenths of the scene's unit, which is the same
/// for both.
std::string cameraOf(const ExportedView& view, const DVec3& origin, const std::string& name) {
    Camera c = view.camera;
    c.worldFromCamera[3] += glm::dvec4(origin, 0);
    constexpr double width = 36;
    const double pixel = width / c.width, height = width * c.focalX / c.focalY * c.height / c.width;
    return fmt::format(
        "    def Camera \"{}\"\n    {{\n        string relamp:photograph = {}\n        token projection = "
        "\"perspective\"\n        float focalLength = {}\n        float horizontalAperture = {}\n"
        "        float verticalAperture = {}\n        float horizontalApertureOffset = {}\n        float "
        "verticalApertureOffset = {}\n        float2 clippingRange = (0.01, 1000)\n"
        "        matrix4d xformOp:transform = {}\n        uniform token[] xformOpOrder = [\"xformOp:transform\"]\n    "
        "}}\n\n",
        name, quoted(view.name), c.focalX * pixel, width, height, (0.5 * c.width - c.centreX) * pixel,
        (c.centreY - 0.5 * c.height) * height / c.height, matrix(c.worldFromCamera));
}

std::set<std::string> takenNames() { return {"Materials", "environment"}; }

}  // namespace

std::vector<std::string> primNamesOf(const ExportedScene& scene) {
    std::set<std::string> taken = takenNames();
    std::vector<std::string> names;
    for (const ExportedComponent& c : scene.components)
        names.push_back(c.triangles.empty() && !(c.sunDegrees > 0) ? "" : primName(c.name, taken));
    return names;
}

std::string usdaOf(const ExportedScene& scene, const std::string& environmentFile, const std::string& textureFile) {
    const std::vector<std::string> names = primNamesOf(scene);
    std::set<std::string> taken = takenNames();
    taken.insert(names.begin(), names.end());
    std::string s = "#usda 1.0\n(\n    defaultPrim = \"relamp\"\n    metersPerUnit = 1\n    upAxis = \"Z\"\n)\n\ndef "
                    "Xform \"relamp\"\n{\n",
                materials;
    for (size_t i = 0; i < scene.components.size(); ++i) {
        const ExportedComponent& component = scene.components[i];
        const std::string& name = names[i];
        if (name.empty()) continue;
        if (component.sunDegrees > 0) {
            s += sunOf(component, name, linkOf(component, names));
            continue;
        }
        s += meshOf(component, scene.origin, name, linkOf(component, names));
        if (component.emits) materials += materialOf(component, name);
        else materials += surfaceMaterial(component, name, textureFile);
    }
    // A dome's image has its centre towards +Z, its left towards +X, its top towards +Y; ours has +X, +Y and +Z
    // there.
    s += fmt::format(
        "    def DomeLight \"environment\"\n    {{\n        asset inputs:texture:file = @./{}@\n        token "
        "inputs:texture:format = \"latlong\"\n        float inputs:intensity = 1\n"
        "        matrix4d xformOp:transform = ( (0, 1, 0, 0), (0, 0, 1, 0), (1, 0, 0, 0), (0, 0, 0, 1) )\n        "
        "uniform token[] xformOpOrder = [\"xformOp:transform\"]\n    }}\n\n",
        environmentFile);
    for (const ExportedView& view : scene.views)
        s += cameraOf(view, scene.origin, primName("view_" + view.name, taken));
    return s + "    def Scope \"Materials\"\n    {\n" + materials + "    }\n}\n";
}

}  // namespace relamp
