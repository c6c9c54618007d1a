// OpenMVG's sfm_data.json, as its library cereal writes it.
//
// Conventions are those of OpenMVG's source: cameras/Camera_*_io.hpp (fields), cameras/Camera_Pinhole_*.hpp (lenses),
// geometry/pose3_io.hpp.
// - rotation is camera-from-world, a list of rows; X_camera = R (X - center), Y down, looking along +Z.
// - The first pixel's centre is (0, 0) (cameras/Camera_undistort_image.hpp), half a pixel from ours.
// - The kind of a lens is told by the name of its coefficients; a polymorphic_name stands only where it is used first.
#include <map>
#include <nlohmann/json.hpp>

#include "base/atomic_file.h"
#include "capture/formats/readers.h"

namespace relamp {
namespace fs = std::filesystem;
namespace {

bool isOpenMvgHead(std::string_view head) { return head.find("\"sfm_data_version\"") != head.npos; }

/// What cereal wraps: value.ptr_wrapper.data of an entry.
JsonFields dataOf(const JsonFields& entry) { return entry.object("value").object("ptr_wrapper").object("data"); }

uint64_t keyOf(const JsonFields& fields, const char* key) { return fields.get<uint64_t>(key); }

Camera cameraOf(const JsonFields& data) {
    Camera camera;
    withContext(data.name("width"), [&] { setSize(camera, data.get<double>("width"), data.get<double>("height")); });
    if (!data.has("focal_length"))
        throw Error("{} is missing: only pinhole cameras and fisheyes are read, no spherical ones",
                    data.name("focal_length"));
    camera.focalX = camera.focalY = data.get<double>("focal_length");
    const auto centre = looseNumbers(data.need("principal_point"), 2, data.name("principal_point"));
    camera.centreX = centre[0] + 0.5, camera.centreY = centre[1] + 0.5;
    const auto k = [&](const char* key, size_t count) { return looseNumbers(data.need(key), count, data.name(key)); };
    if (data.has("disto_k1")) {
        setLens(camera, {.k1 = k("disto_k1", 1)[0]});
    } else if (data.has("disto_k3")) {
        const auto n = k("disto_k3", 3);
        setLens(camera, {.k1 = n[0], .k2 = n[1], .k3 = n[2]});
    } else if (data.has("disto_t2")) {
        const auto n = k("disto_t2", 5);
        setLens(camera, {.k1 = n[0], .k2 = n[1], .k3 = n[2], .p1 = n[3], .p2 = n[4]});
    } else if (data.has("fisheye")) {
        const auto n = k("fisheye", 4);
        camera.model = LensModel::openCvFisheye;
        camera.distortion = {n[0], n[1], n[2], n[3]};
    }
    withContext(data.name("focal_length"), [&] {
        checkIntrinsics(camera, {"focal_length", "focal_length", "principal_point x", "principal_point y"});
    });
    return camera;
}

DMat4 poseOf(const JsonFields& pose) {
    const Json& rows = pose.need("rotation");
    if (!rows.is_array() || rows.size() != 3) throw Error("{} is no list of 3 rows", pose.name("rotation"));
    glm::dmat3 axes;  // rows of camera-from-world are the camera's axes
    for (size_t row = 0; row < 3; ++row) {
        const auto n = looseNumbers(rows[row], 3, pose.name("rotation"));
        axes[int(row)] = DVec3(n[0], n[1], n[2]);
    }
    const auto c = looseNumbers(pose.need("center"), 3, pose.name("center"));
    return poseFromAxes(axes, {c[0], c[1], c[2]}, pose.name("rotation"));
}

ForeignCameras parseOpenMvg(const fs::path& file, const ForeignFolder&, Progress& progress) {
    const Json document = parseJson(readBytes(file, foreignFileBytes));
    if (!document.is_object()) throw Error("is {}, expected an object with views", kindOf(document));
    const JsonFields root(document);
    std::map<uint64_t, Camera> cameras;
    for (const JsonFields& entry : root.list("intrinsics"))
        cameras.emplace(keyOf(entry, "key"), cameraOf(dataOf(entry)));
    std::map<uint64_t, DMat4> poses;
    for (const JsonFields& entry : root.list("extrinsics"))
        poses.emplace(keyOf(entry, "key"), poseOf(entry.object("value")));
    ForeignCameras result;
    const auto views = root.list("views");
    if (views.size() > foreignViews)
        throw Error("views: has {} entries, expected at most {}", views.size(), foreignViews);
    size_t withoutPose = 0;
    const fs::path rootPath = root.get<std::string>("root_path", "");
    for (const JsonFields& entry : views) {
        progress.check();
        const JsonFields view = dataOf(entry);
        const auto pose = poses.find(keyOf(view, "id_pose"));
        const auto camera = cameras.find(keyOf(view, "id_intrinsic"));
        if (pose == poses.end() || camera == cameras.end()) {
            ++withoutPose;
            continue;
        }
        const std::string inside = view.get<std::string>("local_path", "");
        const fs::path local = inside == "/" ? fs::path() : fs::path(inside);
        result.views.push_back(
            {(rootPath / local / view.get<std::string>("filename")).generic_string(), camera->second});
        result.views.back().camera.worldFromCamera = pose->second;
    }
    noteLeftOut(result.notes, withoutPose, views.size(), "have no pose or no intrinsics");
    return result;
}

std::optional<fs::path> findOpenMvg(const fs::path& folder) {
    constexpr const char* names[] = {"sfm_data.json"};
    return findByHead(folder, names, ".json", isOpenMvgHead);
}

bool ownsOpenMvg(const std::string& name) { return name.starts_with("sfm_data") && name.ends_with(".json"); }

}  // namespace

const ForeignReader openMvgReader{findOpenMvg, ownsOpenMvg, parseOpenMvg};

}  // namespace relamp
