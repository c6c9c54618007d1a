// The exported scene as Wavefront OBJ.
#include "shot/export_scene.h"

namespace relamp {
namespace {

/// One word, as OBJ wants names.
std::string wordOf(const std::string& name) {
    std::string word;
    for (const char c : name) word += static_cast<unsigned char>(c) <= 32 ? '_' : c;
    return word.empty() ? "_" : word;
}

Rgb meanAlbedo(const ExportedComponent& component) {
    Rgb sum(0);
    for (const Rgb& a : component.albedo) sum += a;
    return component.albedo.empty() ? Rgb(0) : sum / float(component.albedo.size());
}

}  // namespace

Obj objOf(const ExportedScene& scene, const std::string& materialFile, const std::string& textureFile) {
    Obj obj;
    obj.geometry = fmt::format("# metres, Z up\nmtllib {}\n", materialFile);
    size_t vertices = 0, texcoords = 0;
    for (size_t i = 0; i < scene.components.size(); ++i) {
        const ExportedComponent& c = scene.components[i];
        if (c.triangles.empty()) continue;
        const std::string material = fmt::format("material_{}", i + 1);
        obj.materials += fmt::format("newmtl {}\n", material);
        if (c.emits) {
            obj.materials += fmt::format("Kd 0 0 0\nKe {} {} {}\n\n", c.radiance.x, c.radiance.y, c.radiance.z);
        } else if (c.textured) {
            obj.materials += fmt::format("Kd 1 1 1\nmap_Kd {}\n\n", textureFile);
        } else {
            const Rgb mean = meanAlbedo(c);
            obj.materials += fmt::format("Kd {} {} {}\n\n", mean.x, mean.y, mean.z);
        }
        obj.geometry += fmt::format("o {}\n", wordOf(c.name));
        for (size_t v = 0; v < c.positions.size(); ++v) {
            const DVec3 p = scene.origin + DVec3(c.origin) + DVec3(c.positions[v]);
            // Colours of vertices, as many programs read them, where there is no texture.
            if (c.emits || c.textured) obj.geometry += fmt::format("v {:.9g} {:.9g} {:.9g}\n", p.x, p.y, p.z);
            else
                obj.geometry += fmt::format("v {:.9g} {:.9g} {:.9g} {:.5g} {:.5g} {:.5g}\n", p.x, p.y, p.z,
                                            c.albedo[v].x, c.albedo[v].y, c.albedo[v].z);
        }
        for (const Vec2& at : c.texcoords) obj.geometry += fmt::format("vt {:.7g} {:.7g}\n", at.x, at.y);
        for (const Vec3& n : c.normals) obj.geometry += fmt::format("vn {:.5g} {:.5g} {:.5g}\n", n.x, n.y, n.z);
        obj.geometry += fmt::format("usemtl {}\n", material);
        for (const Triangle& t : c.triangles) {
            obj.geometry += "f";
            for (const uint32_t v : t) {
                const size_t at = vertices + v + 1;
                if (c.texcoords.empty()) obj.geometry += fmt::format(" {}//{}", at, at);
                else obj.geometry += fmt::format(" {}/{}/{}", at, texcoords + v + 1, at);
            }
            obj.geometry += "\n";
        }
        vertices += c.positions.size();
        texcoords += c.texcoords.size();
    }
    return obj;
}

}  // namespace relamp
