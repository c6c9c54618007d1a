// Scans of phones: exports of Polycam, Record3D and 3D Scanner App. All three keep ARKit's world: metres, Y up, poses
// as worldFromCamera with OpenGL's axes (Apple, ARCamera.transform), intrinsics in pixels.
//
// - Polycam's raw data: a file of keyframes/corrected_cameras for each image, t_00 to t_23 row-major. mesh_info.json
//   holds alignmentTransform, column-major: from the cameras' world to that of the mesh (so Nerfstudio reads it).
// - Record3D: metadata.json with poses (qx qy qz qw x y z), K column-major, perFrameIntrinsicCoeffs (fx fy cx cy), and
//   rgb/0.jpg and so on.
// - 3D Scanner App, "All data": frame_00000.json with cameraPoseARFrame and intrinsics, row-major, beside its .jpg.
#include <algorithm>
#include <nlohmann/json.hpp>

#include "base/atomic_file.h"
#include "base/is_there.h"
#include "capture/formats/readers.h"
#include "capture/rigid.h"

namespace relamp {
namespace fs = std::filesystem;
namespace {

constexpr size_t frameFileBytes = size_t(1) << 20;

/// Names of the files of `folder` that `fits` accepts, in the order of their bytes.
std::vector<std::string> filesOf(const fs::path& folder, bool (*fits)(const std::string& name)) {
    std::vector<std::string> names;
    std::error_code failed;
    for (fs::directory_iterator at(folder, failed); !failed && at != fs::directory_iterator(); at.increment(failed)) {
        if (std::string name = at->path().filename().string(); fits(name)) names.push_back(std::move(name));
        if (names.size() > foreignViews) throw Error("holds more than {} files", foreignViews);
    }
    std::sort(names.begin(), names.end());
    return names;
}

Json objectFrom(const std::string& text) {
    Json document = parseJson(text);
    if (!document.is_object()) throw Error("is {}, expected an object", kindOf(document));
    return document;
}

void setPinhole(Camera& camera, double fx, double fy, double cx, double cy) {
    camera.focalX = fx, camera.focalY = fy, camera.centreX = cx, camera.centreY = cy;
    checkIntrinsics(camera, {"fx", "fy", "cx", "cy"});
}

/// A pose of 3 or 4 rows of 4 numbers.
DMat4 poseOfRows(const std::vector<double>& n, const std::string& field) {
    glm::dmat3 axes;
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 3; ++column) axes[column][row] = n[size_t(row) * 4 + size_t(column)];
    return poseFromOpenGl(axes, {n[3], n[7], n[11]}, field);
}

// ---- Polycam

bool isJson(const std::string& name) { return name.ends_with(".json"); }

/// Moves poses into the mesh's world where mesh_info.json says how.
void meetPolycamMesh(const fs::path& folder, ForeignCameras& result) {
    const fs::path file = folder / "mesh_info.json";
    if (!isFile(file)) return;
    withContext("mesh_info.json", [&] {
        const Json document = objectFrom(readBytes(file, frameFileBytes));
        const JsonFields fields(document);
        const Json* list = fields.find("alignmentTransform");
        if (!list) return;
        const auto n = looseNumbers(*list, 16, "alignmentTransform");
        DMat4 whole(1.0);
        for (size_t i = 0; i < 16; ++i) whole[int(i / 4)][int(i % 4)] = n[i];
        DMat4 turn = whole;
        double scale = 1;
        if (const std::string fault = makeRigid(turn, scale); !fault.empty())
            throw Error("alignmentTransform {}", fault);
        for (ForeignView& view : result.views) {
            DMat4& pose = view.camera.worldFromCamera;
            const glm::dvec4 position = whole * pose[3];
            pose = turn * pose;
            pose[3] = position;
        }
        result.otherFiles.push_back(file);
        result.notes.emplace_back("The cameras were moved by alignmentTransform of mesh_info.json, to meet the mesh.");
    });
}

ForeignCameras parsePolycam(const fs::path& cameras, const ForeignFolder& around, Progress& progress) {
    const bool corrected = cameras.filename() == "corrected_cameras";
    ForeignCameras result;
    result.up = Vec3(0, 1, 0);
    for (const std::string& file : filesOf(cameras, isJson))
        withContext(file, [&] {
            progress.check();
            const Json document = objectFrom(readBytes(cameras / file, frameFileBytes));
            const JsonFields fields(document);
            ForeignView view{(corrected ? "corrected_images/" : "images/") + fs::path(file).stem().string(), {}};
            setSize(view.camera, fields.get<double>("width"), fields.get<double>("height"));
            const double k[] = {fields.get<double>("fx"), fields.get<double>("fy"), fields.get<double>("cx"),
                                fields.get<double>("cy")};
            setPinhole(view.camera, k[0], k[1], k[2], k[3]);
            std::vector<double> rows;
            for (int row = 0; row < 3; ++row)
                for (int column = 0; column < 4; ++column)
                    rows.push_back(fields.get<double>(fmt::format("t_{}{}", row, column).c_str()));
            view.camera.worldFromCamera = poseOfRows(rows, "t_00 to t_22");
            result.views.push_back(std::move(view));
        });
    meetPolycamMesh(around.folder(), result);
    return result;
}

std::optional<fs::path> findPolycam(const fs::path& folder) {
    for (const char* name : {"keyframes/corrected_cameras", "keyframes/cameras"}) {
        std::error_code failed;
        fs::directory_iterator at(folder / name, failed);
        for (; !failed && at != fs::directory_iterator(); at.increment(failed))
            if (isJson(at->path().filename().string()) && headOf(at->path()).find("\"t_00\"") != std::string::npos)
                return folder / name;
            else break;
    }
    return std::nullopt;
}

bool ownsNothing(const std::string&) { return false; }

// ---- Record3D

bool isRecord3dHead(std::string_view head) {
    return head.find('{') != head.npos &&
           (head.find("\"K\"") != head.npos || head.find("\"perFrameIntrinsicCoeffs\"") != head.npos) &&
           head.find("\"sfm_data_version\"") == head.npos;
}

ForeignCameras parseRecord3d(const fs::path& file, const ForeignFolder&, Progress& progress) {
    const Json document = objectFrom(readBytes(file, foreignFileBytes));
    const JsonFields fields(document);
    const Json& poses = fields.need("poses");
    if (!poses.is_array()) throw Error("poses is {}, expected a list", kindOf(poses));
    if (poses.size() > foreignViews)
        throw Error("poses has {} entries, expected at most {}", poses.size(), foreignViews);
    const Json* perFrame = fields.find("perFrameIntrinsicCoeffs");
    if (perFrame && (!perFrame->is_array() || perFrame->size() != poses.size())) perFrame = nullptr;
    Camera common;
    setSize(common, fields.get<double>("w"), fields.get<double>("h"));
    if (!perFrame) {
        const auto k = looseNumbers(fields.need("K"), 9, "K");
        const bool byColumns = k[6] != 0 || k[7] != 0;
        setPinhole(common, k[0], k[4], byColumns ? k[6] : k[2], byColumns ? k[7] : k[5]);
    }
    ForeignCameras result;
    result.up = Vec3(0, 1, 0);
    for (size_t i = 0; i < poses.size(); ++i)
        withContext(fmt::format("poses[{}]", i), [&] {
            progress.check();
            ForeignView view{fmt::format("rgb/{}", i), common};
            if (perFrame) {
                const auto k = looseNumbers((*perFrame)[i], 4, "perFrameIntrinsicCoeffs");
                setPinhole(view.camera, k[0], k[1], k[2], k[3]);
            }
            const auto q = looseNumbers(poses[i], 7, "pose");
            view.camera.worldFromCamera = poseFromOpenGl(rotationFromQuaternion(q[3], q[0], q[1], q[2], "qx qy qz qw"),
                                                         {q[4], q[5], q[6]}, "qx qy qz qw");
            result.views.push_back(std::move(view));
        });
    return result;
}

std::optional<fs::path> findRecord3d(const fs::path& folder) {
    for (const char* name : {"metadata.json", "metadata"})
        if (isRecord3dHead(headOf(folder / name))) return folder / name;
    return std::nullopt;
}

bool ownsRecord3d(const std::string& name) { return name == "metadata.json" || name == "metadata"; }

// ---- 3D Scanner App

bool isFrame(const std::string& name) { return name.starts_with("frame_") && name.ends_with(".json"); }
bool isFrameHead(std::string_view head) { return head.find("\"cameraPoseARFrame\"") != head.npos; }

ForeignCameras parseScannerApp(const fs::path& first, const ForeignFolder& around, Progress& progress) {
    ForeignCameras result;
    result.up = Vec3(0, 1, 0);
    const fs::path folder = first.parent_path();
    const auto files = filesOf(folder, isFrame);
    size_t withoutImage = 0;
    for (const std::string& file : files)
        withContext(file, [&] {
            progress.check();
            const std::string name = fs::path(file).stem().string() + ".jpg";
            if (!isFile(around.photograph(name))) return void(++withoutImage);
            const Json document = objectFrom(readBytes(folder / file, frameFileBytes));
            result.otherFiles.push_back(folder / file);
            const JsonFields fields(document);
            ForeignView view{name, {}};
            const auto [width, height] = around.sizeOf(name);
            setSize(view.camera, width, height);
            const auto k = looseNumbers(fields.need("intrinsics"), 9, "intrinsics");
            setPinhole(view.camera, k[0], k[4], k[2], k[5]);
            view.camera.worldFromCamera = poseOfRows(
                looseNumbers(fields.need("cameraPoseARFrame"), 16, "cameraPoseARFrame"), "cameraPoseARFrame");
            result.views.push_back(std::move(view));
        });
    noteLeftOut(result.notes, withoutImage, files.size(), "have no photograph");
    return result;
}

std::optional<fs::path> findScannerApp(const fs::path& folder) {
    const fs::path first = folder / "frame_00000.json";
    return isFrameHead(headOf(first)) ? std::optional(first) : std::nullopt;
}

}  // namespace

const ForeignReader polycamReader{findPolycam, ownsNothing, parsePolycam};
const ForeignReader record3dReader{findRecord3d, ownsRecord3d, parseRecord3d};
const ForeignReader scannerAppReader{findScannerApp, isFrame, parseScannerApp};

}  // namespace relamp
