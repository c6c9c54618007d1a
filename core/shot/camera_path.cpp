#include "shot/camera_path.h"

#include <glm/gtc/quaternion.hpp>
#include <nlohmann/json.hpp>

#include "base/atomic_file.h"
#include "base/box.h"
#include "base/json_fields.h"
#include "capture/load_capture.h"
#include "capture/transforms_json.h"
#include "shot/frame_jobs.h"

namespace relamp {
namespace {

constexpr int maxPathFrames = 1'000'000;

int countOf(const std::string& text, const std::string& option) {
    if (text.empty() || text.size() > 7 || text.find_first_not_of("0123456789") != std::string::npos)
        throw BadOption("--camera {}: '{}' is not a number of frames", option, text);
    const int count = std::stoi(text);
    if (count < 1 || count > maxPathFrames)
        throw BadOption("--camera {}: expected 1 to {} frames", option, maxPathFrames);
    return count;
}

/// Where the views look: minimises the sum of squared distances to their axes.
DVec3 lookedAt(const Capture& capture) {
    glm::dmat3 sum(0.0);
    DVec3 right(0);
    for (const View& view : capture.views) {
        const DVec3 d = view.camera.forward();
        const glm::dmat3 across = glm::dmat3(1.0) - glm::outerProduct(d, d);
        sum += across;
        right += across * view.camera.position();
    }
    if (glm::determinant(sum) > 1e-4 * std::pow(double(capture.views.size()), 3)) return glm::inverse(sum) * right;
    Box box;
    for (const Vec3& p : capture.mesh.positions)
        if (isFinite(p)) box.grow(p);
    return DVec3(box.centre());
}

std::vector<Camera> turntable(const Capture& capture, int count) {
    const DVec3 centre = lookedAt(capture);
    std::vector<Camera> cameras(size_t(count), capture.views.at(0).camera);
    for (int i = 0; i < count; ++i) {
        const double angle = 2 * piD * i / count, c = std::cos(angle), s = std::sin(angle);
        const glm::dmat3 turn(DVec3(c, s, 0), DVec3(-s, c, 0), DVec3(0, 0, 1));
        DMat4& pose = cameras[size_t(i)].worldFromCamera;
        const DVec3 eye = centre + turn * (DVec3(pose[3]) - centre);
        pose = DMat4(turn * glm::dmat3(pose));
        pose[3] = glm::dvec4(eye, 1);
    }
    return cameras;
}

/// Catmull-Rom between b and c, t in [0, 1].
template <class T>
T spline(const T& a, const T& b, const T& c, const T& d, double t) {
    return 0.5 * ((2.0 * b) + (c - a) * t + (2.0 * a - 5.0 * b + 4.0 * c - d) * (t * t) +
                  (3.0 * b - a - 3.0 * c + d) * (t * t * t));
}

struct Key {
    DVec3 eye;
    glm::dvec4 turn;              ///< quaternion, on the same half as the one before
    std::array<double, 12> lens;  ///< focal lengths, centre, distortion
};

Camera cameraOn(const std::vector<Key>& keys, const Camera& first, double at) {
    const int last = int(keys.size()) - 1, i = std::clamp(int(at), 0, std::max(0, last - 1));
    const double t = last == 0 ? 0 : at - i;
    const auto key = [&](int k) -> const Key& { return keys[size_t(std::clamp(k, 0, last))]; };
    const Key &b = key(i), &c = key(i + 1);
    // Beyond the ends the path goes on straight.
    const auto before = [&](auto member) { return i > 0 ? key(i - 1).*member : 2.0 * b.*member - c.*member; };
    const auto after = [&](auto member) { return i + 2 <= last ? key(i + 2).*member : 2.0 * c.*member - b.*member; };
    Camera camera = first;
    const DVec3 eye = spline(before(&Key::eye), b.eye, c.eye, after(&Key::eye), t);
    const glm::dvec4 turn = glm::normalize(spline(before(&Key::turn), b.turn, c.turn, after(&Key::turn), t));
    camera.worldFromCamera = DMat4(glm::mat3_cast(glm::dquat(turn.w, turn.x, turn.y, turn.z)));
    camera.worldFromCamera[3] = glm::dvec4(eye, 1);
    const auto lens = [&](size_t k) { return b.lens[k] + (c.lens[k] - b.lens[k]) * t; };
    camera.focalX = lens(0), camera.focalY = lens(1), camera.centreX = lens(2), camera.centreY = lens(3);
    for (size_t k = 0; k < camera.distortion.size(); ++k) camera.distortion[k] = lens(4 + k);
    return camera;
}

std::vector<Camera> throughViews(const Capture& capture, const std::string& list, int count,
                                 const std::string& option) {
    std::vector<Key> keys;
    const Camera* first = nullptr;
    for (size_t at = 0; at <= list.size();) {
        const size_t comma = std::min(list.find(',', at), list.size());
        const std::string number = list.substr(at, comma - at);
        if (number.empty() || number.size() > 7 || number.find_first_not_of("0123456789") != std::string::npos)
            throw BadOption("--camera {}: '{}' is not a view's number", option, number);
        const size_t view = size_t(std::stoi(number));
        if (view >= capture.views.size())
            throw BadOption("--camera {}: view {} does not exist, expected 0 to {}", option, view,
                            capture.views.size() - 1);
        const Camera& camera = capture.views[view].camera;
        if (!first) first = &camera;
        if (camera.model != first->model)
            throw BadOption("--camera {}: view {} has another kind of lens", option, view);
        const glm::dquat q = glm::quat_cast(glm::dmat3(camera.worldFromCamera));
        Key key{camera.position(), glm::dvec4(q.x, q.y, q.z, q.w), {}};
        if (!keys.empty() && glm::dot(keys.back().turn, key.turn) < 0) key.turn = -key.turn;
        // Another size is the same lens scaled.
        const double sx = double(first->width) / camera.width, sy = double(first->height) / camera.height;
        key.lens = {camera.focalX * sx, camera.focalY * sy, camera.centreX * sx, camera.centreY * sy};
        std::copy(camera.distortion.begin(), camera.distortion.end(), key.lens.begin() + 4);
        keys.push_back(key);
        at = comma + 1;
    }
    std::vector<Camera> cameras;
    cameras.reserve(size_t(count));
    for (int i = 0; i < count; ++i)
        cameras.push_back(cameraOn(keys, *first, count > 1 ? double(i) * double(keys.size() - 1) / (count - 1) : 0));
    return cameras;
}

}  // namespace

bool isCameraPath(const std::string& text) { return text.starts_with("turntable:") || text.starts_with("path:"); }

std::vector<Camera> cameraPath(const Capture& capture, const std::string& text) {
    const size_t colon = text.find(':'), second = text.rfind(':');
    if (text.starts_with("turntable:")) return turntable(capture, countOf(text.substr(colon + 1), text));
    if (second == colon) throw BadOption("--camera {}: expected path:V,V,...:N", text);
    return throughViews(capture, text.substr(colon + 1, second - colon - 1), countOf(text.substr(second + 1), text),
                        text);
}

CameraFile readCameraPath(const Capture& capture, const std::filesystem::path& file) {
    CameraFile result;
    nlohmann::json document;
    if (std::error_code ignored; std::filesystem::is_regular_file(file, ignored)) {
        const std::string text = readBytes(file, size_t(64) << 20);
        withContext(file.string(), [&] { document = parseJson(text); });
    }
    if (document.is_object() && document.contains("frames")) {
        result.sequence = true;
        withContext(file.string(), [&] {
            if (document["frames"].is_array())
                for (auto& frame : document["frames"])
                    if (frame.is_object()) frame.emplace("file_path", "none");
            const auto noSize = [](const std::string&) -> std::pair<int, int> { throw Error("w or h is missing"); };
            for (const TransformsFrame& frame :
                 parseTransforms(dumpJson(document, -1, BadText::replace), noSize).frames)
                result.cameras.push_back(frame.camera);
        });
        if (result.cameras.empty()) throw Error("{}: frames: is empty, expected a camera", file.string());
    } else {
        result.cameras.push_back(readCameraFile(file));
    }
    for (Camera& camera : result.cameras) {
        camera.worldFromCamera = DMat4(glm::dmat3(capture.worldFromFile)) * camera.worldFromCamera;
        camera.worldFromCamera[3] = glm::dvec4(camera.position() * capture.metresPerUnit - capture.origin, 1);
    }
    return result;
}

}  // namespace relamp
