// The materials of an exported scene as MaterialX text: OpenPBR for surfaces, unlit emission for lights.
#include "shot/export_scene.h"
#include "shot/scene_materials.h"

namespace relamp {
namespace {

std::string input(const char* name, const char* type, const std::string& value) {
    return fmt::format("    <input name=\"{}\" type=\"{}\" value=\"{}\" />\n", name, type, value);
}
std::string input(const char* name, float value) { return input(name, "float", fmt::format("{}", value)); }
std::string colour(const char* name, const Rgb& c) {
    return input(name, "color3", fmt::format("{}, {}, {}", c.x, c.y, c.z));
}

std::string emitterShader(const ExportedComponent& p, const std::string& name) {
    if (!p.level.empty())
        return fmt::format("  <geompropvalue name=\"{}_emission\" type=\"color3\">\n", name) +
               input("geomprop", "string", "emission") + "  </geompropvalue>\n" +
               fmt::format("  <surface_unlit name=\"{}_shader\" type=\"surfaceshader\">\n", name) +
               input("emission", 1.0f) +
               fmt::format("    <input name=\"emission_color\" type=\"color3\" nodename=\"{}_emission\" />\n", name) +
               "  </surface_unlit>\n";
    const float brightest = maxChannel(p.radiance) > 0 ? maxChannel(p.radiance) : 0.0f;
    return fmt::format("  <surface_unlit name=\"{}_shader\" type=\"surfaceshader\">\n", name) +
           input("emission", brightest) + colour("emission_color", brightest > 0 ? p.radiance / brightest : Rgb(0)) +
           "  </surface_unlit>\n";
}

std::string surfaceShader(const ExportedComponent& p, const std::string& name, const std::string& textureFile) {
    const SurfaceMaterial surface = surfaceMaterialOf(p);
    std::string s;
    if (!p.textured)
        s = fmt::format("  <geompropvalue name=\"{}_albedo\" type=\"color3\">\n", name) +
            input("geomprop", "string", "displayColor") + "  </geompropvalue>\n";
    else
        s = fmt::format("  <image name=\"{}_albedo\" type=\"color3\">\n", name) +
            fmt::format("    <input name=\"file\" type=\"filename\" value=\"{}\" colorspace=\"lin_rec709\" />\n",
                        textureFile) +
            input("uaddressmode", "string", "clamp") + input("vaddressmode", "string", "clamp") + "  </image>\n";
    return s +
           fmt::format(
               "  <open_pbr_surface name=\"{0}_shader\" type=\"surfaceshader\">\n"
               "    <input name=\"base_color\" type=\"color3\" nodename=\"{0}_albedo\" />\n",
               name) +
           input("base_metalness", surface.metallic) +
           input("specular_weight", surface.plain() ? 0 : surface.specular) +
           colour("specular_color", surface.specularColour) + input("specular_roughness", surface.roughness) +
           input("specular_ior", 1.5f) + "  </open_pbr_surface>\n";
}

}  // namespace

std::string materialXOf(const ExportedScene& scene, const std::string& textureFile) {
    const std::vector<std::string> names = primNamesOf(scene);
    std::string s = "<?xml version=\"1.0\"?>\n<materialx version=\"1.38\" colorspace=\"lin_rec709\">\n", assigned;
    for (size_t i = 0; i < scene.components.size(); ++i) {
        const ExportedComponent& p = scene.components[i];
        if (p.triangles.empty()) continue;
        s += p.emits ? emitterShader(p, names[i]) : surfaceShader(p, names[i], textureFile);
        s += fmt::format(
            "  <surfacematerial name=\"{0}\" type=\"material\">\n"
            "    <input name=\"surfaceshader\" type=\"surfaceshader\" nodename=\"{0}_shader\" />\n  "
            "</surfacematerial>\n\n",
            names[i]);
        assigned +=
            fmt::format("    <materialassign name=\"assign_{0}\" material=\"{0}\" geom=\"/relamp/{0}\" />\n", names[i]);
    }
    return s + "  <look name=\"relamp\">\n" + assigned + "  </look>\n</materialx>\n";
}

}  // namespace relamp
