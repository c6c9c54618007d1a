#include "pipeline/sharpen_creases.h"

#include "base/log.h"
#include "scene/flat_surface.h"
#include "scene/sharp_creases.h"
#include "solve/registration/contour_fit.h"
#include "solve/registration/crease_fit.h"

namespace relamp {
namespace {

constexpr size_t fewCreases = 50;      ///< vertices: outlines take seconds
constexpr double flatEnough = 0.0001;  ///< of the diagonal: waves of what is flat

/// Vertices whose place is known: of lights, and on flat surfaces.
std::vector<uint8_t> stillVertices(const Scene& scene, const SharpenOptions& options) {
    std::vector<uint8_t> still = options.lights;
    const Flattening flat = flattening(scene, flatSurfaces(scene, options.lights), options.vertices, options.lights);
    for (size_t v = 0; v < flat.surface.size(); ++v)
        if (flat.surface[v] >= 0 && flat.waves[size_t(flat.surface[v])] < flatEnough * double(scene.diagonal))
            still[v] = 1;
    return still;
}

}  // namespace

SharpenedMesh sharpenedCreases(const Capture& capture, const Scene& scene, const std::vector<Vec3>& places,
                               const SharpenOptions& options, Progress& progress) {
    Mesh mesh = scene.mesh;
    for (size_t v = 0; v < places.size(); ++v)
        if (!options.leftOut[v]) mesh.positions[v] = places[v];
    std::vector<Vec3> sides(mesh.vertexCount(), Vec3(0));
    const auto sharpen = [&] {
        const std::vector<CreaseVertex> found = sharpCreases(scene, mesh.positions, sides, options.leftOut);
        for (const CreaseVertex& c : found) {
            mesh.positions[c.vertex] = c.position;
            mesh.normals[c.vertex] = sides[c.vertex] = c.normal;
        }
        return found;
    };
    if (sharpen().size() < fewCreases) return {};
    const std::vector<CreaseVertex> again = sharpen();  // sharper sides reach further
    Mesh common = mesh;                                 // both sides of a crease go the same way
    for (const CreaseVertex& c : again) common.normals[c.vertex] = c.middle;
    const Scene sharp = buildScene(std::move(common), progress, scene.axes);
    const ContourEstimate contours =
        alignContours(capture, sharp, {}, options.vertices, options.lights, options.floor, progress);
    logInfo("with sharp creases {}{}", toText(contours), contours.needed() ? "; moved" : "; left as they are");
    if (contours.needed()) {
        Mesh moved = sharp.mesh;
        applyRegistration(contours.fix, moved);
        mesh.positions = std::move(moved.positions);
    }
    const Scene sided = buildScene(mesh, progress, scene.axes);
    const CreaseEstimate creases =
        alignCreases(capture, sided, again, stillVertices(scene, options), options.vertices, options.floor, progress);
    logInfo("{} places of creases: {}{}", creases.points, toText(creases), creases.needed() ? "; moved" : "; left");
    if (creases.needed()) mesh.positions = creases.positions;
    return {std::move(mesh.positions), std::move(sides)};
}

}  // namespace relamp
