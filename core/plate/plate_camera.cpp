#include "plate/plate_camera.h"

#include <nlohmann/json.hpp>

#include "base/atomic_file.h"
#include "base/is_there.h"
#include "base/json_fields.h"
#include "capture/camera_fault.h"
#include "capture/colmap.h"
#include "capture/load_capture.h"
#include "capture/transforms_json.h"
#include "shot/frame_numbers.h"

namespace relamp {
namespace fs = std::filesystem;
namespace {

/// Cameras with whole lenses, by the plate's numbers before any offset; poses as the file has them.
struct LensTrack {
    std::map<int, Camera> byFrame;
    std::optional<Camera> still;
};

/// Names of images to numbers: those in the names where all have one of their own, else in the order of the plate.
std::map<int, Camera> byNames(std::vector<std::pair<std::string, Camera>> named, const PlateFiles& files, int offset,
                              const std::string& where) {
    std::map<int, Camera> numbers;
    for (const auto& [name, camera] : named)
        if (const auto number = numberInName(name)) numbers.emplace(*number, camera);
    if (numbers.size() == named.size()) return numbers;
    if (named.size() != files.size())
        throw Error("{}: has {} cameras whose images bear no numbers, the plate {} frames", where, named.size(),
                    files.size());
    numbers.clear();
    auto file = files.begin();
    for (const auto& [name, camera] : named) numbers.emplace((file++)->first - offset, camera);
    return numbers;
}

LensTrack fromTransforms(const fs::path& file, const PlateFiles& files, int offset, int width, int height) {
    LensTrack track;
    Json document = parseJson(readBytes(file, size_t(256) << 20), file.filename().string());
    if (!document.is_object() || !document.contains("frames")) {
        track.still = readCameraFile(file);
        return track;
    }
    withContext(file.filename().string(), [&] {
        bool allNamed = document["frames"].is_array();
        if (allNamed)
            for (auto& frame : document["frames"])
                if (frame.is_object() && frame.emplace("file_path", "none").second) allNamed = false;
        std::vector<std::pair<std::string, Camera>> named;
        const auto size = [&](const std::string&) { return std::pair(width, height); };
        for (const TransformsFrame& frame : parseTransforms(dumpJson(document, -1, BadText::replace), size).frames)
            named.emplace_back(allNamed ? frame.filePath : std::string(), frame.camera);
        track.byFrame = byNames(std::move(named), files, offset, "frames");
    });
    return track;
}

/// The lens of a track that has fields of view alone: a pinhole at the plate's size.
Camera pinhole(const TrackedCamera& tracked, int width, int height, const fs::path& file, std::string& note) {
    Camera camera;
    camera.width = width;
    camera.height = height;
    if (!(tracked.halfWidth > 0) && !(tracked.halfHeight > 0)) return camera;
    camera.focalX = tracked.halfWidth > 0 ? width / (2 * tracked.halfWidth) : 0;
    camera.focalY = tracked.halfHeight > 0 ? height / (2 * tracked.halfHeight) : camera.focalX;
    if (!(camera.focalX > 0)) camera.focalX = camera.focalY;
    // The gate of a tracked camera is often another shape than the plate; pixels are square then.
    if (std::abs(camera.focalY / camera.focalX - 1) > 0.02) {
        note = fmt::format("{}: the gate is another shape than the plate; its width counts", file.filename().string());
        camera.focalY = camera.focalX;
    }
    camera.centreX = width * (0.5 + tracked.centre.x);
    camera.centreY = height * (0.5 + tracked.centre.y);
    return camera;
}

/// The lens at another size of the same shape; throws Error for another shape.
void scaleTo(Camera& camera, int width, int height, const std::string& where) {
    const double sx = double(width) / camera.width, sy = double(height) / camera.height;
    if (std::abs(sx / sy - 1) > 0.005)
        throw Error("{}: the camera has {} x {} pixels, the plate {} x {}: another shape", where, camera.width,
                    camera.height, width, height);
    camera.focalX *= sx, camera.centreX *= sx, camera.width = width;
    camera.focalY *= sy, camera.centreY *= sy, camera.height = height;
}

/// The file as text with a pose where a camera file needs one.
Camera readLens(const fs::path& file, int width, int height) {
    const std::string text = readBytes(file, size_t(1) << 20), name = file.filename().string();
    return withContext(name, [&] {
        Json lens = parseJson(text);
        if (!lens.is_object()) throw Error("expected an object with the keys of transforms.json");
        Json identity = Json::array();
        for (int r = 0; r < 4; ++r)
            for (int c = 0; c < 4; ++c) identity[size_t(r)][size_t(c)] = r == c ? 1 : 0;
        lens["frames"] = Json::array({Json{{"file_path", "none"}, {"transform_matrix", identity}}});
        lens.erase("transform_matrix");
        const auto size = [&](const std::string&) { return std::pair(width, height); };
        Camera camera = parseTransforms(dumpJson(lens, -1, BadText::replace), size).frames.at(0).camera;
        scaleTo(camera, width, height, "w");
        return camera;
    });
}

LensTrack fromTrack(const CameraTrack& tracked, const fs::path& file, int width, int height,
                    std::vector<std::string>& notes) {
    LensTrack track;
    std::string note;
    for (const auto& [frame, at] : tracked.byFrame) {
        Camera camera = pinhole(at, width, height, file, note);
        camera.worldFromCamera = at.worldFromCamera;
        if (tracked.still) track.still = camera;
        else track.byFrame.emplace(frame, camera);
    }
    if (!note.empty()) notes.push_back(note);
    return track;
}

std::string lower(std::string text) {
    for (char& c : text) c = char(std::tolower(static_cast<unsigned char>(c)));
    return text;
}

}  // namespace

PlateCameras readPlateCameras(const Capture& capture, const fs::path& given, const PlateFiles& files, int width,
                              int height, const PlateCameraOptions& options, Progress& progress) {
    PlateCameras result;
    const std::string text = given.string();
    const size_t mark = text.rfind('#');
    const bool marked = mark != std::string::npos && lower(text.substr(0, mark)).ends_with(".usda");
    const fs::path file = marked ? fs::path(text.substr(0, mark)) : given;
    const std::string ending = lower(file.extension().string());
    DMat4 turn{glm::dmat3(capture.worldFromFile)};
    double unit = capture.metresPerUnit;
    LensTrack track;
    std::error_code ignored;
    if (fs::is_directory(file, ignored)) {
        const auto model = findColmapModel(file);
        if (!model) throw Error("--plate-camera {}: is a folder without a COLMAP model", file.string());
        std::vector<std::pair<std::string, Camera>> named;
        for (const ColmapView& view : readColmapModel(*model, {}, progress).views)
            named.emplace_back(view.name, view.camera);
        track.byFrame = byNames(std::move(named), files, options.offset, model->string());
    } else if (!isFile(file)) {
        throw Error("--plate-camera {}: {}", file.string(), whyNoFile(file));
    } else if (ending == ".chan") {
        track = fromTrack(readChan(file, options.rotationOrder), file, width, height, result.notes);
    } else if (ending == ".usda" || ending == ".usd") {
        const CameraTrack read = readUsdCamera(file, marked ? text.substr(mark + 1) : "");
        track = fromTrack(read, file, width, height, result.notes);
        if (!read.up.empty()) turn = DMat4(glm::dmat3(rotationToZUp(axisFromName(read.up))));
        if (read.metresPerUnit > 0) unit = read.metresPerUnit;
    } else if (ending == ".json") {
        track = fromTransforms(file, files, options.offset, width, height);
    } else {
        throw Error("--plate-camera {}: expected .chan, .usda, .json or the folder of a COLMAP model", file.string());
    }
    const std::optional<Camera> lens =
        options.lens.empty() ? std::nullopt : std::optional(readLens(options.lens, width, height));
    const auto place = [&](Camera camera, const std::string& where) {
        if (lens) {
            const DMat4 pose = camera.worldFromCamera;
            camera = *lens;
            camera.worldFromCamera = pose;
        } else {
            if (!(camera.focalX > 0)) throw Error("{}: has no field of view; --plate-lens FILE gives the lens", where);
            scaleTo(camera, width, height, where);
        }
        if (const std::string fault = faultOf(camera, {"focal length", "focal length", "centre", "centre"});
            !fault.empty())
            throw Error("{}: {}", where, fault);
        camera.worldFromCamera = turn * camera.worldFromCamera;
        camera.worldFromCamera[3] = glm::dvec4(camera.position() * unit - capture.origin, 1);
        for (int c = 0; c < 4; ++c)
            for (int r = 0; r < 3; ++r)
                if (!(std::abs(camera.worldFromCamera[c][r]) < 1e7))
                    throw Error("{}: the camera stands beyond 10 000 km", where);
        return camera;
    };
    const std::string name = file.filename().string();
    if (track.still) {
        const Camera still = place(*track.still, name);
        for (const auto& one : files) result.byFrame.emplace(one.first, still);
    }
    for (const auto& [frame, camera] : track.byFrame)
        result.byFrame.emplace(frame + options.offset, place(camera, fmt::format("{}: frame {}", name, frame)));
    return result;
}

}  // namespace relamp
