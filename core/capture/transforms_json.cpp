#include "capture/transforms_json.h"

#include <map>
#include <nlohmann/json.hpp>
#include <optional>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/json_fields.h"
#include "base/printable.h"
#include "capture/camera_fault.h"
#include "capture/lighting_states.h"
#include "capture/load_capture.h"
#include "capture/rigid.h"

namespace relamp {
namespace {

using json = Json;

constexpr size_t maxFileBytes = size_t(64) << 20;
constexpr size_t maxFrames = 100'000;
constexpr int largestSide = 1 << 17;

/// The keys of one frame over the global ones, read with checks.
class Keys {
public:
    Keys(const json& global, const json* frame, std::string frameName)
        : global_(global), frame_(frame), frameName_(std::move(frameName)) {}

    const json* find(const char* key) const {
        for (const json* place : {frame_, &global_})
            if (place)
                if (const auto it = place->find(key); it != place->end() && !it->is_null()) return &*it;
        return nullptr;
    }
    bool has(const char* key) const { return find(key) != nullptr; }

    /// A finite number; none when the key is absent.
    std::optional<double> number(const char* key) const {
        const json* value = find(key);
        if (!value) return std::nullopt;
        if (!value->is_number()) fail(key, fmt::format("is {}, expected a number", kindOf(*value)));
        const double x = value->get<double>();
        if (!std::isfinite(x)) fail(key, fmt::format("is {}, expected a finite number", x));
        return x;
    }
    std::optional<double> positive(const char* key) const {
        const auto x = number(key);
        if (x && !(*x > 0)) fail(key, fmt::format("is {}, expected more than 0", *x));
        if (x && *x > 1e9) fail(key, fmt::format("is {}, expected at most 1e9", *x));
        return x;
    }
    std::optional<int> side(const char* key) const {
        const auto x = positive(key);
        if (!x) return std::nullopt;
        if (*x != std::floor(*x) || *x > largestSide)
            fail(key, fmt::format("is {}, expected a whole number from 1 to {}", *x, largestSide));
        return int(*x);
    }
    std::optional<double> angle(const char* key) const {
        const auto x = positive(key);
        if (x && !(*x < piD)) fail(key, fmt::format("is {}, expected radians less than pi", *x));
        return x;
    }
    std::string text(const char* key) const {
        const json* value = find(key);
        if (!value) return "";
        if (!value->is_string()) fail(key, fmt::format("is {}, expected text", kindOf(*value)));
        return value->get<std::string>();
    }
    [[noreturn]] void fail(const char* key, const std::string& what) const {
        // The message names the frame only when the frame, not the globals, holds or lacks the value.
        const bool inFrame = frame_ && (frame_->contains(key) || !global_.contains(key));
        throw Error("{}{} {}", inFrame ? frameName_ + ": " : std::string(), key, what);
    }

private:
    const json& global_;
    const json* frame_;
    std::string frameName_;
};

LensModel readModel(const Keys& keys) {
    if (keys.has("camera_model")) {
        const std::string name = keys.text("camera_model");
        const auto model = lensModelFromName(name);
        if (!model && (name == "EQUIRECTANGULAR" || name == "SPHERICAL"))
            keys.fail("camera_model",
                      fmt::format("is \"{}\", a panorama: views are read from lenses; cut it into perspective images "
                                  "(ns-process-data --camera-type equirectangular does), or give it as --light-probe",
                                  name));
        if (!model)
            keys.fail("camera_model",
                      fmt::format("is \"{}\", expected a COLMAP model such as PINHOLE, OPENCV or OPENCV_FISHEYE",
                                  name.substr(0, 80)));
        return *model;
    }
    if (const json* fisheye = keys.find("is_fisheye"); fisheye && fisheye->is_boolean() && fisheye->get<bool>())
        return LensModel::openCvFisheye;
    for (const char* key : {"k1", "k2", "p1", "p2"})
        if (keys.number(key).value_or(0) != 0) return LensModel::openCv;
    return LensModel::pinhole;
}

/// Coefficient names in the order of Camera::distortion.
std::vector<const char*> coefficientNames(LensModel model) {
    switch (model) {
        case LensModel::simplePinhole:
        case LensModel::pinhole: return {};
        case LensModel::simpleRadial:
        case LensModel::simpleRadialFisheye: return {"k1"};
        case LensModel::radial:
        case LensModel::radialFisheye: return {"k1", "k2"};
        case LensModel::openCv: return {"k1", "k2", "p1", "p2"};
        case LensModel::openCvFisheye: return {"k1", "k2", "k3", "k4"};
        case LensModel::fov: return {"omega"};
        case LensModel::fullOpenCv: return {"k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"};
        case LensModel::brown: return {"k1", "k2", "p1", "p2", "k3", "k4", "skew"};
        case LensModel::thinPrismFisheye: return {"k1", "k2", "p1", "p2", "k3", "k4", "sx1", "sy1"};
    }
    return {};
}

void readIntrinsics(const Keys& keys, Camera& camera, const std::function<std::pair<int, int>()>& size,
                    std::vector<std::string>& ignored) {
    const auto w = keys.side("w"), h = keys.side("h");
    if (w && h) {
        camera.width = *w, camera.height = *h;
    } else {
        const auto [width, height] = size();
        for (const auto& [key, side] : {std::pair{"w", w.value_or(width)}, std::pair{"h", h.value_or(height)}})
            if (side < 1 || side > largestSide)
                keys.fail(key, fmt::format("is {}, expected a whole number from 1 to {}", side, largestSide));
        camera.width = w.value_or(width), camera.height = h.value_or(height);
    }
    const auto fromAngle = [](const std::optional<double>& angle, int pixels) -> std::optional<double> {
        if (!angle) return std::nullopt;
        return 0.5 * pixels / std::tan(0.5 * *angle);
    };
    auto focalX = keys.positive("fl_x"), focalY = keys.positive("fl_y");
    if (!focalX) focalX = fromAngle(keys.angle("camera_angle_x"), camera.width);
    if (!focalY) focalY = fromAngle(keys.angle("camera_angle_y"), camera.height);
    if (!focalX) focalX = focalY;
    if (!focalX) keys.fail("fl_x", "is missing, and camera_angle_x as well");
    camera.focalX = *focalX;
    camera.focalY = focalY.value_or(*focalX);
    camera.centreX = keys.number("cx").value_or(0.5 * camera.width);
    camera.centreY = keys.number("cy").value_or(0.5 * camera.height);
    if (const std::string fault = faultOf(camera, {"fl_x", "fl_y", "cx", "cy"}); !fault.empty())
        keys.fail(fault.substr(0, fault.find(' ')).c_str(), fault.substr(fault.find(' ') + 1));

    camera.model = readModel(keys);
    if (camera.model == LensModel::openCv)
        for (const char* key : {"k3", "k4", "k5", "k6"})
            if (keys.number(key).value_or(0) != 0) camera.model = LensModel::fullOpenCv;
    const auto names = coefficientNames(camera.model);
    for (size_t i = 0; i < names.size(); ++i) camera.distortion[i] = keys.number(names[i]).value_or(0);
    for (const char* key : {"k1", "k2", "k3", "k4", "k5", "k6", "p1", "p2"}) {
        const bool used =
            std::any_of(names.begin(), names.end(), [&](const char* name) { return std::string_view(name) == key; });
        if (!used && keys.number(key).value_or(0) != 0)
            ignored.push_back(
                fmt::format("{} is ignored because {} has no such coefficient", key, lensModelName(camera.model)));
    }
}

DMat4 readMatrix(const Keys& keys, int mirror, bool& mirrors, bool& rescaled) {
    constexpr const char* key = "transform_matrix";
    const json* value = keys.find(key);
    if (!value) keys.fail(key, "is missing");
    if (!value->is_array() || (value->size() != 3 && value->size() != 4))
        keys.fail(key, "is no 4 x 4 matrix (rows of numbers)");
    DMat4 matrix(1.0);
    for (size_t row = 0; row < value->size(); ++row) {
        const json& line = (*value)[row];
        if (!line.is_array() || line.size() != 4) keys.fail(key, fmt::format("row {} is no list of 4 numbers", row));
        for (size_t column = 0; column < 4; ++column) {
            if (!line[column].is_number())
                keys.fail(key,
                          fmt::format("row {} column {} is {}, expected a number", row, column, kindOf(line[column])));
            matrix[int(column)][int(row)] = line[column].get<double>();
        }
    }
    double scale = 1;
    mirrors = mirror >= 0 && glm::determinant(glm::dmat3(matrix)) < 0;
    if (mirrors) matrix[mirror] = -matrix[mirror];
    if (const std::string fault = makeRigid(matrix, scale); !fault.empty())
        keys.fail(key,
                  fault + (fault.starts_with("mirrors") ? "; where a left-handed program wrote it, --mirror x, y or "
                                                          "z names the axis that it reversed"
                                                        : ""));
    rescaled = std::abs(scale - 1) > 1e-3;
    return matrix;
}

std::vector<Exposure> readExposures(const Keys& frameKeys, const json& frame) {
    std::vector<Exposure> exposures;
    const auto it = frame.find("exposures");
    if (it == frame.end() || it->is_null()) return exposures;
    if (!it->is_array()) frameKeys.fail("exposures", fmt::format("is {}, expected a list", kindOf(*it)));
    if (it->size() > 1000)
        frameKeys.fail("exposures", fmt::format("has {} entries, expected at most 1000", it->size()));
    for (size_t i = 0; i < it->size(); ++i) {
        const json& entry = (*it)[i];
        if (!entry.is_object())
            frameKeys.fail("exposures", fmt::format("entry {} is {}, expected an object", i, kindOf(entry)));
        const auto failIn = [&](const char* key, const std::string& what) {
            frameKeys.fail("exposures", fmt::format("entry {}: {} {}", i, key, what));
        };
        const auto positive = [&](const char* key) -> double {
            const auto value = entry.find(key);
            if (value == entry.end() || value->is_null()) return 0;
            if (!value->is_number()) failIn(key, fmt::format("is {}, expected a number", kindOf(*value)));
            const double x = value->get<double>();
            if (!std::isfinite(x) || x <= 0) failIn(key, fmt::format("is {}, expected more than 0", x));
            return x;
        };
        Exposure exposure;
        const auto path = entry.find("file_path");
        if (path == entry.end() || !path->is_string() || path->get<std::string>().empty())
            failIn("file_path", "is missing");
        exposure.filePath = path->get<std::string>();
        exposure.seconds = positive("exposure_time");
        exposure.aperture = positive("aperture");
        exposure.iso = positive("iso");
        exposures.push_back(exposure);
    }
    return exposures;
}

std::string readState(const Keys& keys) {
    if (!keys.has("state")) return "";
    std::string name = keys.text("state");
    if (const std::string fault = faultOfStateName(name); !fault.empty()) keys.fail("state", fault);
    return name;
}

/// What the capture says of its lighting states beside their frames: what environment they have.
void readStates(const json& root, Transforms& transforms) {
    const auto table = root.find("states");
    if (table == root.end() || table->is_null()) return;
    if (!table->is_object()) throw Error("states is {}, expected an object with a key for each", kindOf(*table));
    for (const auto& [name, state] : table->items()) {
        const std::string where = fmt::format("states: \"{}\"", printable(name).substr(0, 80));
        if (!state.is_object()) throw Error("{}: is {}, expected an object", where, kindOf(state));
        if (std::none_of(transforms.frames.begin(), transforms.frames.end(),
                         [&, &key = name](const TransformsFrame& frame) { return frame.state == key; }))
            throw Error("{}: no frame names this state", where);
        const auto environment = state.find("environment");
        if (environment == state.end() || environment->is_null()) continue;
        const std::string kind = textOf(*environment, where + ": environment");
        if (kind != "own" && kind != "none" && kind != "shared" &&
            std::none_of(transforms.frames.begin(), transforms.frames.end(),
                         [&](const TransformsFrame& frame) { return frame.state == kind; }))
            throw Error("{}: environment is \"{}\", expected \"shared\", \"own\", \"none\" or another state", where,
                        printable(kind).substr(0, 80));
        transforms.environments.push_back({name, kind});
    }
}

/// Nerfstudio's keys that say where the mesh may not be.
void noteNerfstudio(const json& root, Transforms& transforms) {
    if (const auto it = root.find("applied_transform"); it != root.end() && it->is_array()) {
        bool identity = true;
        for (size_t row = 0; row < it->size(); ++row)
            for (size_t column = 0; (*it)[row].is_array() && column < (*it)[row].size(); ++column)
                identity = identity && (*it)[row][column] == json(row == column ? 1.0 : 0.0);
        if (!identity)
            transforms.notes.emplace_back(
                "applied_transform says that the cameras were moved from where they were reconstructed; the mesh must "
                "have been moved with them.");
    }
    if (const auto it = root.find("applied_scale"); it != root.end() && it->is_number() && it->get<double>() != 1)
        transforms.notes.push_back(fmt::format(
            "applied_scale says that the cameras were scaled by {:g} from how they were reconstructed; where "
            "the mesh was not, --mesh-scale {:g} brings it to them.",
            it->get<double>(), it->get<double>()));
    if (root.contains("ply_file_path") && transforms.meshPath.empty())
        transforms.notes.emplace_back("ply_file_path names points and is not used; mesh_path would name the mesh.");
}

Vec3 readUp(const json& root) {
    const auto it = root.find("up");
    if (it == root.end() || it->is_null()) return {0, 0, 1};
    try {
        return axisFromName(it->is_string() ? it->get<std::string>() : "");
    } catch (const Error& error) {
        throw Error("up is {}, {}", dumpJson(*it, -1, BadText::replace).substr(0, 80), error.what());
    }
}

}  // namespace

Transforms parseTransforms(const std::string& text, const ImageSize& sizeOf, int mirror) {
    const json root = parseJson(text);
    if (!root.is_object()) throw Error("is {}, expected an object with frames", kindOf(root));
    Transforms result;
    result.up = readUp(root);
    result.meshPath = Keys(root, nullptr, "").text("mesh_path");
    noteNerfstudio(root, result);
    const auto frames = root.find("frames");
    if (frames == root.end()) throw Error("frames is missing");
    if (!frames->is_array()) throw Error("frames is {}, expected a list", kindOf(*frames));
    if (frames->empty()) throw Error("frames is empty, expected at least one");
    if (frames->size() > maxFrames)
        throw Error("frames has {} entries, expected at most {}", frames->size(), maxFrames);
    size_t rescaled = 0;
    std::map<std::string, size_t> ignoredCounts;
    for (size_t i = 0; i < frames->size(); ++i) {
        const json& object = (*frames)[i];
        const std::string name = fmt::format("frame {}", i);
        if (!object.is_object()) throw Error("{}: is {}, expected an object", name, kindOf(object));
        const Keys keys(root, &object, name);
        TransformsFrame frame;
        frame.filePath = Keys(object, nullptr, "").has("file_path") ? keys.text("file_path") : "";
        frame.exposures = readExposures(keys, object);
        frame.maskPath = keys.text("mask_path");
        frame.state = readState(keys);
        if (frame.filePath.empty() && frame.exposures.empty()) throw Error("{}: file_path is missing", name);
        std::vector<std::string> ignored;
        readIntrinsics(
            keys, frame.camera,
            [&] {
                return withContext(name, [&] {
                    return sizeOf(frame.filePath.empty() ? frame.exposures[0].filePath : frame.filePath);
                });
            },
            ignored);
        bool wasRescaled = false, mirrors = false;
        frame.camera.worldFromCamera = readMatrix(keys, mirror, mirrors, wasRescaled);
        if (i > 0 && mirrors != result.leftHanded)
            throw Error("{}: transform_matrix {} the world, those before it {}", name,
                        mirrors ? "mirrors" : "does not mirror", mirrors ? "do not" : "do");
        result.leftHanded = mirrors;
        rescaled += wasRescaled;
        for (const std::string& sentence : ignored) ++ignoredCounts[sentence];
        result.frames.push_back(std::move(frame));
    }
    readStates(root, result);
    if (rescaled)
        result.notes.push_back(fmt::format("{} of {} transform matrices held a uniform scale, which was taken out.",
                                           rescaled, frames->size()));
    for (const auto& [sentence, count] : ignoredCounts)
        result.notes.push_back(fmt::format("{} (in {} frames).", sentence, count));
    return result;
}

Transforms readTransforms(const std::filesystem::path& file, const ImageSize& sizeOf, int mirror) {
    const std::string text = readBytes(file, maxFileBytes);
    return withContext(file.filename().string(), [&] { return parseTransforms(text, sizeOf, mirror); });
}

Json transformsFrame(const Camera& camera, const std::string& filePath) {
    Json rows = Json::array();
    for (int r = 0; r < 4; ++r) {
        Json row = Json::array();
        for (int k = 0; k < 4; ++k) row.push_back(camera.worldFromCamera[k][r]);
        rows.push_back(std::move(row));
    }
    Json frame{{"file_path", filePath},
               {"camera_model", lensModelName(camera.model)},
               {"w", camera.width},
               {"h", camera.height},
               {"fl_x", camera.focalX},
               {"fl_y", camera.focalY},
               {"cx", camera.centreX},
               {"cy", camera.centreY},
               {"transform_matrix", std::move(rows)}};
    const auto names = coefficientNames(camera.model);
    for (size_t i = 0; i < names.size(); ++i) frame[names[i]] = camera.distortion[i];
    return frame;
}

Camera readCameraFile(const std::filesystem::path& file) {
    const std::string text = readBytes(file, maxFileBytes);
    return withContext(file.filename().string(), [&] {
        const json root = parseJson(text);
        if (!root.is_object()) throw Error("is {}, expected an object with the keys of transforms.json", kindOf(root));
        const Keys keys(root, nullptr, "");
        Camera camera;
        std::vector<std::string> ignored;
        readIntrinsics(
            keys, camera, [&]() -> std::pair<int, int> { keys.fail(keys.has("w") ? "h" : "w", "is missing"); },
            ignored);
        bool rescaled = false, mirrors = false;
        camera.worldFromCamera = readMatrix(keys, -1, mirrors, rescaled);
        return camera;
    });
}

}  // namespace relamp
