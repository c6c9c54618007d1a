#include "capture/placement_trials.h"

#include <cmath>

#include "base/parallel.h"
#include "capture/orientation.h"
#include "capture/view_sight.h"

namespace relamp {
namespace {

constexpr float usual = 0.25f;      // stops that photographs of one surface disagree by
constexpr float clearly = 0.6f;     // of what they disagree by now
constexpr float surely = 0.1f;      // stops: below, nothing else is tried
constexpr float mostAgreed = 0.5f;  // stops: above, nothing is offered
constexpr double leastTwice = 0.15, leastCovered = 0.02;
constexpr size_t mostViews = 12;

/// A change of what was read: on the mesh, and on the cameras.
struct Trial {
    PlacementAdvice advice;
    double scale = 1;                  ///< of the mesh about the files' origin
    glm::dmat3 mesh{1.0};              ///< turns or mirrors it
    glm::dmat3 world{1.0}, axes{1.0};  ///< before and behind the cameras' rotation
};

glm::dmat3 mirrorOf(int axis) {
    glm::dmat3 mirror(1.0);
    mirror[axis][axis] = -1;
    return mirror;
}

/// `m` of the files' axes in the world's.
glm::dmat3 inWorld(const glm::dmat3& m, const Mat3& worldFromFile) {
    return glm::dmat3(worldFromFile) * m * glm::transpose(glm::dmat3(worldFromFile));
}

/// The capture as it was read.
Trial unchanged(const Capture& capture) {
    Trial trial;
    trial.advice.scale = capture.metresPerUnit;
    trial.advice.readAs = capture.readAs;
    return trial;
}

Trial scaled(const Capture& capture, double factor, double size) {
    Trial trial = unchanged(capture);
    trial.scale = factor;
    trial.advice.readAs.meshScale *= factor;
    const char* unit = nullptr;
    for (const auto& [per, name] : {std::pair{0.001, "millimetres"}, {0.01, "centimetres"}, {0.1, "decimetres"}})
        if (std::abs(std::min(factor, 1 / factor) / per - 1) < 1e-9) unit = name;
    // The scene keeps the size that suits a place where people take photographs.
    const bool keepsMesh =
        (factor > 1 && size < 50 && size * factor > 50) || (factor < 1 && size > 0.05 && size * factor < 0.05);
    if (keepsMesh) trial.advice.scale /= factor;
    trial.advice.option = fmt::format("--mesh-scale {:g}", trial.advice.readAs.meshScale) +
                          (keepsMesh ? fmt::format(" --scale {:g}", trial.advice.scale) : "");
    trial.advice.words = factor < 1 ? fmt::format("The mesh seems to be in {}, the cameras in metres", unit)
                                    : fmt::format("The cameras seem to be in {}, the mesh in metres", unit);
    trial.advice.button = fmt::format("Read the {} in {}", factor < 1 ? "mesh" : "cameras", unit);
    if (factor < 1 && keepsMesh) {
        trial.advice.words = fmt::format("The cameras seem to be {:g} times too small for the mesh", 1 / factor);
        trial.advice.button = "Scale the cameras to the mesh";
    }
    return trial;
}

std::vector<Trial> turnedMeshes(const Capture& capture) {
    std::vector<Trial> trials;
    const glm::dmat3 turn(rotationToZUp({0, 1, 0}));
    for (const auto& [name, quarter] : {std::pair{"y", turn}, std::pair{"z", glm::transpose(turn)}}) {
        Trial trial = unchanged(capture);
        trial.mesh = quarter;
        trial.advice.readAs.meshUp = name;
        trial.advice.option = fmt::format("--mesh-up {}", name);
        trial.advice.words = "The mesh seems to have another axis up than the cameras";
        trial.advice.button = fmt::format("Read the mesh with {} up", name);
        trials.push_back(trial);
    }
    return trials;
}

Trial flipped(Trial trial) {
    trial.axes = trial.axes * mirrorOf(1) * mirrorOf(2);
    trial.advice.readAs.flipCameras = !trial.advice.readAs.flipCameras;
    return trial;
}

/// Cameras, mesh or both are those of a left-handed program.
std::vector<Trial> mirrored(const Capture& capture) {
    std::vector<Trial> trials;
    const ReadAs& now = capture.readAs;
    const auto add = [&](Trial trial, const char* words, const char* what, const std::string& axis) {
        trial.advice.words = words;
        trial.advice.button = fmt::format("Mirror {} in {}", what, axis);
        trials.push_back(trial);
        if (trial.advice.readAs.mirror == now.mirror) return;
        trials.push_back(flipped(trial));
        trials.back().advice.option += " --flip-cameras";
    };
    for (const char* axis : {"x", "y", "z"}) {
        const glm::dmat3 mirror = mirrorOf(*axis - 'x');
        Trial mesh = unchanged(capture);
        mesh.mesh = inWorld(mirror, now.worldFromMesh);
        mesh.advice.readAs.meshMirror = axis;
        mesh.advice.option = std::string("--mesh-mirror ") + axis;
        if (now.meshMirror == axis) {
            mesh.advice.readAs.meshMirror.clear();
            mesh.advice.option = "no --mesh-mirror";
            add(mesh, "The mesh seems not to be mirrored", "the mesh back", axis);
        } else if (now.meshMirror.empty())
            add(mesh, "The mesh seems to be mirrored, as left-handed programs write it", "the mesh", axis);
        if (now.mirror == axis && !now.leftHanded) {
            Trial back = unchanged(capture);
            back.world = inWorld(mirror, capture.worldFromFile);
            back.axes = mirror;
            back.advice.readAs.mirror.clear();
            back.advice.option = "no --mirror";
            add(back, "The cameras seem not to be mirrored", "the cameras back", axis);
        }
        if (now.mirror == axis) continue;
        const glm::dmat3 change = now.mirror.empty() ? mirror : mirror * mirrorOf(now.mirror[0] - 'x');
        Trial cameras = unchanged(capture);
        cameras.world = inWorld(change, capture.worldFromFile);
        // Left-handed matrices are mirrored in the world alone.
        if (!now.leftHanded) cameras.axes = change;
        cameras.advice.readAs.mirror = axis;
        cameras.advice.option = std::string("--mirror ") + axis;
        add(cameras, "The cameras seem to be mirrored, as left-handed programs write them", "the cameras", axis);
        if (!now.mirror.empty() || !now.meshMirror.empty()) continue;
        cameras.mesh = mesh.mesh;
        cameras.advice.readAs.meshMirror = axis;
        cameras.advice.option += std::string(" --mesh-mirror ") + axis;
        add(cameras, "Cameras and mesh seem to be mirrored, as left-handed programs write them", "cameras and mesh",
            axis);
    }
    return trials;
}

std::vector<size_t> someViews(size_t count) {
    std::vector<size_t> views;
    const size_t some = std::min(count, mostViews);
    for (size_t k = 0; k < some; ++k) views.push_back(k * count / some);
    return views;
}

PlacementScore scoreOf(const Capture& capture, const Trial& trial, const std::vector<size_t>& views,
                       const std::vector<uint8_t>& referenced, size_t stride, Progress& progress) {
    Mesh mesh = capture.mesh;
    for (Vec3& p : mesh.positions) p = Vec3(trial.mesh * (trial.scale * (DVec3(p) + capture.origin)) - capture.origin);
    for (Vec3& n : mesh.normals) n = Vec3(trial.mesh * DVec3(n));
    std::vector<ViewSight> sights(views.size());
    std::vector<ViewCheck> checks(views.size());
    parallelFor(sights.size(), 1, [&](size_t i) {
        const View& view = capture.views[views[i]];
        Camera camera = view.camera;
        DMat4& m = camera.worldFromCamera;
        const DVec3 position = trial.world * (DVec3(m[3]) + capture.origin) - capture.origin;
        m = DMat4(trial.world * glm::dmat3(m) * trial.axes);
        m[3] = glm::dvec4(position, 1);
        sights[i] = lookAt(view, camera, mesh, referenced, stride, checks[i], progress);
    });
    PlacementScore score;
    score.disagreement = disagreement(sights);
    size_t all = 0, twice = 0;
    for (size_t v = 0; v < referenced.size(); ++v) {
        if (!referenced[v]) continue;
        size_t seen = 0;
        for (const ViewSight& sight : sights) seen += sight.sees[v];
        ++all;
        twice += seen >= 2;
    }
    score.seenTwice = double(twice) / double(std::max<size_t>(1, all));
    for (const ViewCheck& check : checks) score.covered += check.meshFraction / double(checks.size());
    return score;
}

}  // namespace

std::optional<PlacementAdvice> betterPlacement(const Capture& capture, const std::vector<uint8_t>& referenced,
                                               size_t stride, const PlacementScore& now, Progress& progress) {
    const bool doubtful = !(now.disagreement < usual) || now.covered < leastCovered;
    if (!doubtful || capture.views.size() < 2 || capture.views[0].image.pixels.empty()) return std::nullopt;
    Vec3 low(1e30f), high(-1e30f);
    for (const Vec3& p : capture.mesh.positions) low = glm::min(low, p), high = glm::max(high, p);
    const double size = double(glm::distance(low, high));
    const std::vector<size_t> views = someViews(capture.views.size());
    const PlacementScore before = scoreOf(capture, unchanged(capture), views, referenced, stride, progress);
    // Photographs of a mesh that few of them see say nothing by agreeing.
    const bool seen = std::isfinite(before.disagreement) && before.covered >= leastCovered;
    const double leastSeen = std::max(leastTwice, 0.5 * (seen ? before.seenTwice : 0.0));
    float least = seen ? std::min(clearly * before.disagreement, mostAgreed) : 2 * mostAgreed;
    std::optional<PlacementAdvice> best;
    const auto attempt = [&](const std::vector<Trial>& trials) {
        for (const Trial& trial : trials) {
            const PlacementScore score = scoreOf(capture, trial, views, referenced, stride, progress);
            // One that is as good says the same in other words, and more of them.
            if (!(score.disagreement < (best ? 0.98f : 1.0f) * least) || score.covered < leastCovered ||
                score.seenTwice < leastSeen)
                continue;
            least = score.disagreement;
            best = trial.advice;
        }
    };
    std::vector<Trial> plain = turnedMeshes(capture), scaledAndTurned;
    for (const double factor : {0.001, 0.01, 0.1, 10.0, 100.0, 1000.0}) {
        const Trial alone = scaled(capture, factor, size);
        plain.push_back(alone);
        for (Trial turned : turnedMeshes(capture)) {
            turned.scale = alone.scale;
            turned.advice.scale = alone.advice.scale;
            turned.advice.readAs.meshScale = alone.advice.readAs.meshScale;
            turned.advice.option = alone.advice.option + " " + turned.advice.option;
            turned.advice.words = alone.advice.words + ", and to have another axis up";
            turned.advice.button = alone.advice.button + fmt::format(", {} up", turned.advice.readAs.meshUp);
            scaledAndTurned.push_back(turned);
        }
    }
    Trial other = flipped(unchanged(capture));
    other.advice.option = "--flip-cameras";
    other.advice.words = "The camera matrices seem to have the other axes (OpenCV's or OpenGL's)";
    other.advice.button = "Flip the cameras";
    plain.push_back(other);
    attempt(plain);
    if (!best || least > surely) attempt(mirrored(capture));
    if (!best || least > surely) attempt(scaledAndTurned);
    if (best)
        best->words = fmt::format("{}: the photographs then agree on the surface much better. Try {}.", best->words,
                                  best->option);
    return best;
}

}  // namespace relamp
