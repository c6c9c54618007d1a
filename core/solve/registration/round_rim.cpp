#include "solve/registration/round_rim.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "base/statistics.h"
#include "solve/registration/step_edge.h"

namespace relamp {
namespace {

constexpr int rimPlaces = 96;      ///< around the rim
constexpr size_t leastSteps = 40;  ///< that photographs must show
constexpr float rimNoise = 0.03f;  ///< of a profile's value, relative to its mean
constexpr float hiddenBy = 0.02f;  ///< of the diagonal: what lies so much before the rim hides it
constexpr double foreshortened =
    0.3;  ///< least length of the surface's line in a photograph, of what it would be unturned
constexpr double rimAgreement = 2;   ///< pixels: median distance from the median
constexpr float rimBand = 0.015f;    ///< of the diagonal: what is brought to the rim
constexpr float onSurface = 0.004f;  ///< of the diagonal

/// What each step says of the rim's height, metres from `height`, and the metres of a pixel there.
std::vector<std::pair<double, double>> stepsAt(const Capture& capture, const Scene& scene,
                                               const RevolutionSurface& surface, double height, float floor) {
    std::vector<std::pair<double, double>> found;
    const double piece = 0.005 * double(scene.diagonal);
    for (const View& view : capture.views)
        for (int k = 0; k < rimPlaces; ++k) {
            const double angle = 2 * double(pi) * k / rimPlaces;
            const DVec3 rim = surface.at(height, angle), further = surface.at(height + piece, angle);
            const DVec3 eye = view.camera.position();
            const std::optional<Vec2> at = view.camera.project(rim), to = view.camera.project(further);
            if (!at || !to) continue;
            const double distance = glm::length(rim - eye), length = glm::length(further - rim);
            const double pixels = double(glm::length(*to - *at)) / piece;
            const double unturned = std::min(view.camera.focalX, view.camera.focalY) / distance * length / piece;
            if (!(pixels > foreshortened * unturned)) continue;
            const Hit hit = scene.cameraTracer->closest({Vec3(eye), Vec3((rim - eye) / distance)});
            if (hit && hit.distance < float(distance) - hiddenBy * scene.diagonal) continue;
            const std::optional<Profile> profile =
                profileAcross(view, *at, (*to - *at) / glm::length(*to - *at), floor);
            if (!profile) continue;
            if (const std::optional<float> step = findStep(*profile, rimNoise))
                found.push_back({double(*step) / pixels, 1 / pixels});
        }
    return found;
}

/// Vertices at which the mesh ends.
std::vector<uint8_t> endsOf(const Mesh& mesh) {
    std::map<std::pair<uint32_t, uint32_t>, int> sides;
    for (const Triangle& t : mesh.triangles)
        for (size_t k = 0; k < 3; ++k) ++sides[std::minmax(t[k], t[(k + 1) % 3])];
    std::vector<uint8_t> ends(mesh.vertexCount(), 0);
    for (const auto& [edge, count] : sides)
        if (count == 1) ends[edge.first] = ends[edge.second] = 1;
    return ends;
}

}  // namespace

std::optional<double> rimHeight(const Capture& capture, const Scene& scene, const RevolutionSurface& surface,
                                double guess, float floor) {
    double height = guess;
    for (int round = 0; round < 5; ++round) {
        std::vector<std::pair<double, double>> steps = stepsAt(capture, scene, surface, height, floor);
        if (steps.size() < leastSteps) return {};
        std::vector<double> moves, pixels;
        for (const auto& [move, pixel] : steps) {
            moves.push_back(move);
            pixels.push_back(pixel);
        }
        const double move = medianOf(moves), pixel = medianOf(pixels);
        height += move;
        if (std::abs(move) > 0.1 * pixel) continue;
        for (double& m : moves) m = std::abs(m - move);
        return medianOf(moves) < rimAgreement * pixel ? std::optional(height) : std::nullopt;
    }
    return {};
}

std::vector<MeshMend::MovedVertex> evenRim(const Scene& scene, size_t vertices, const RevolutionSurface& surface,
                                           double height, bool low) {
    const double reach = double(rimBand * scene.diagonal), near = double(onSurface * scene.diagonal);
    const std::vector<uint8_t> ends = endsOf(scene.mesh);
    std::vector<MeshMend::MovedVertex> moved;
    for (uint32_t v = 0; v < vertices; ++v) {
        const DVec3 p(scene.mesh.positions[v]);
        const double h = surface.height(p), beyond = low ? height - h : h - height;
        if (!scene.referenced[v] || !(std::abs(beyond) < reach) || !(std::abs(surface.distance(p)) < near)) continue;
        if (beyond < 0 && !ends[v]) continue;
        const DVec3 rim = p + (surface.at(height, surface.angle(p)) - surface.at(h, surface.angle(p)));
        moved.push_back({v, Vec3(rim)});
    }
    return moved;
}

}  // namespace relamp
