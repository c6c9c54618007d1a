// A camera of a USD text file: its transforms and its parents', evaluated frame by frame.
#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/quaternion.hpp>
#include <set>

#include "base/error.h"
#include "plate/plate_camera.h"
#include "plate/usd_text.h"

namespace relamp {
namespace {

constexpr double maxFrames = 1e5;

/// The matrix of one operation, for columns.
DMat4 matrixOf(const std::string& op, const std::vector<double>& v, const std::string& where) {
    const size_t colon = op.find(':', 8);
    const std::string kind = op.substr(8, colon == std::string::npos ? std::string::npos : colon - 8);
    const auto need = [&](size_t count) {
        if (v.size() != count) throw Error("{}: {} has {} numbers, expected {}", where, op, v.size(), count);
    };
    DMat4 m(1.0);
    if (kind == "transform") {
        need(16);
        for (int i = 0; i < 16; ++i) m[i / 4][i % 4] = v[size_t(i)];
    } else if (kind == "translate") {
        need(3);
        m[3] = glm::dvec4(v[0], v[1], v[2], 1);
    } else if (kind == "scale") {
        need(3);
        for (int i = 0; i < 3; ++i) m[i][i] = v[size_t(i)];
    } else if (kind == "orient") {
        need(4);
        m = DMat4(glm::mat3_cast(glm::normalize(glm::dquat(v[0], v[1], v[2], v[3]))));
    } else if (kind.starts_with("rotate")) {
        const std::string axes = kind.substr(6);
        need(axes.size());
        for (size_t i = 0; i < axes.size(); ++i) {
            if (axes[i] < 'X' || axes[i] > 'Z') throw Error("{}: {} is unknown", where, op);
            DVec3 about(0);
            about[axes[i] - 'X'] = 1;
            const double degrees = v[axes.size() == 1 ? 0 : size_t(axes[i] - 'X')];
            m = glm::rotate(DMat4(1.0), glm::radians(degrees), about) * m;
        }
    } else {
        throw Error("{}: {} is unknown", where, op);
    }
    return m;
}

/// From the prim's space into its parent's; `reset`: parents above do not count.
DMat4 localTransform(const UsdPrim& prim, double time, bool& reset) {
    DMat4 m(1.0);
    for (std::string op : prim.order) {
        if (op == "!resetXformStack!") {
            reset = true;
            continue;
        }
        const bool inverse = op.starts_with("!invert!");
        if (inverse) op = op.substr(8);
        const auto value = prim.values.find(op);
        if (!op.starts_with("xformOp:") || value == prim.values.end())
            throw Error("{}: xformOpOrder names {}, which is not there", prim.path, op);
        const DMat4 step = matrixOf(op, value->second.value(time), prim.path);
        m = m * (inverse ? glm::inverse(step) : step);
    }
    return m;
}

DMat4 worldTransform(const UsdStage& stage, size_t prim, double time) {
    DMat4 m(1.0);
    bool reset = false;
    for (int p = int(prim); p >= 0 && !reset; p = stage.prims[size_t(p)].parent)
        m = localTransform(stage.prims[size_t(p)], time, reset) * m;
    return m;
}

void addTimes(const UsdPrim& prim, std::set<double>& times) {
    for (const auto& [name, value] : prim.values)
        if (value.sampled)
            for (const auto& sample : value.at) times.insert(sample.first);
}

std::set<double> timesOf(const UsdStage& stage, size_t prim) {
    std::set<double> times;
    for (int p = int(prim); p >= 0; p = stage.prims[size_t(p)].parent) addTimes(stage.prims[size_t(p)], times);
    return times;
}

size_t chosen(const UsdStage& stage, const std::string& name) {
    std::vector<size_t> cameras, moving, named;
    for (size_t p = 0; p < stage.prims.size(); ++p) {
        if (stage.prims[p].type != "Camera") continue;
        cameras.push_back(p);
        if (timesOf(stage, p).size() > 1) moving.push_back(p);
        if (stage.prims[p].name == name || stage.prims[p].path == name) named.push_back(p);
    }
    if (cameras.empty()) throw Error("holds no camera");
    if (name.empty() && cameras.size() == 1) return cameras[0];
    if (name.empty() && moving.size() == 1) return moving[0];
    if (named.size() == 1) return named[0];
    std::string names;
    for (size_t i = 0; i < cameras.size() && i < 8; ++i) names += (i ? ", " : "") + stage.prims[cameras[i]].path;
    throw Error("{}; it has {}{}; name one behind the file: FILE#NAME",
                name.empty()    ? "holds several cameras"
                : named.empty() ? "has no camera " + name
                                : "has several " + name,
                names, cameras.size() > 8 ? ", ..." : "");
}

double lensValue(const UsdPrim& prim, const char* name, double time, double fallback) {
    const auto value = prim.values.find(name);
    if (value == prim.values.end()) return fallback;
    const std::vector<double> numbers = value->second.value(time);
    return numbers.size() == 1 ? numbers[0] : fallback;
}

/// USD's own values stand where the file gives none: a focal length of 50 on 20.955 x 15.2908.
TrackedCamera cameraAt(const UsdStage& stage, size_t p, double time) {
    const UsdPrim& prim = stage.prims[p];
    TrackedCamera camera;
    camera.worldFromCamera = worldTransform(stage, p, time);
    for (int c = 0; c < 3; ++c) {
        const double length = glm::length(DVec3(camera.worldFromCamera[c]));
        if (!(length > 1e-12)) throw Error("{}: its transform at time {} is flat", prim.path, time);
        camera.worldFromCamera[c] /= length;
    }
    const double focal = lensValue(prim, "focalLength", time, 50);
    const double across = lensValue(prim, "horizontalAperture", time, 20.955);
    const double down = lensValue(prim, "verticalAperture", time, 15.2908);
    if (!(focal > 0) || !(across > 0) || !(down > 0))
        throw Error("{}: focalLength {} with apertures {} x {}, expected more than 0", prim.path, focal, across, down);
    camera.halfWidth = across / (2 * focal);
    camera.halfHeight = down / (2 * focal);
    camera.centre = {-lensValue(prim, "horizontalApertureOffset", time, 0) / across,
                     lensValue(prim, "verticalApertureOffset", time, 0) / down};
    return camera;
}

}  // namespace

CameraTrack readUsdCamera(const std::filesystem::path& file, const std::string& name) {
    const UsdStage stage = readUsdText(file);
    return withContext(file.filename().string(), [&] {
        CameraTrack track;
        const size_t prim = chosen(stage, name);
        track.up = stage.upAxis == "Z" ? "z" : stage.upAxis == "Y" ? "y" : "";
        track.metresPerUnit = stage.metresPerUnit;
        const std::set<double> times = timesOf(stage, prim);
        track.still = times.empty();
        if (track.still) {
            track.byFrame.emplace(0, cameraAt(stage, prim, 0));
            return track;
        }
        const double first = std::floor(*times.begin()), last = std::ceil(*times.rbegin());
        if (!(last - first < maxFrames) || std::abs(first) > 1e9 || std::abs(last) > 1e9)
            throw Error("{}: its time samples reach from {} to {}, expected at most {} frames", stage.prims[prim].path,
                        first, last, maxFrames);
        for (double t = first; t <= last; ++t) track.byFrame.emplace(int(t), cameraAt(stage, prim, t));
        return track;
    });
}

}  // namespace relamp
