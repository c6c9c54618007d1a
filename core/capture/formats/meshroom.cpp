// Meshroom's cameras (AliceVision's SfMData as JSON): cameras.sfm, or any .sfm. Numbers may be texts.
//
// Conventions are those of AliceVision's source: src/aliceVision/sfmDataIO/jsonIO.cpp (fields by version),
// camera/Distortion*.cpp (lenses), mesh/Mesh.cpp (meshes).
// - rotation is camera-from-world, stored column by column; X_camera = R (X - center), Y down, looking along +Z.
// - The first pixel's centre is (0, 0) (camera/cameraUndistortImage.hpp), half a pixel from ours.
// - Before 1.2.0 pxFocalLength is one number, before 1.2.2 two; then focalLength is millimetres on sensorWidth, and
//   pixelRatio is fx / fy before 1.2.5, fy / fx from then on; from 1.2.11 focalLength is that of y.
// - Before 1.2.1 principalPoint counts from the image's corner, then from its middle.
// - From 1.2.3 on meshes are written in OpenGL's world, y and z negated; poses are not. Cameras are turned to meet
// them.
#include <array>
#include <map>
#include <nlohmann/json.hpp>

#include "base/atomic_file.h"
#include "capture/formats/readers.h"

namespace relamp {
namespace fs = std::filesystem;
namespace {

using Version = std::array<int, 3>;

bool isMeshroomHead(std::string_view head) {
    const size_t first = head.find_first_not_of(" \t\r\n\xef\xbb\xbf");
    return first != head.npos && head[first] == '{' && head.find("\"version\"") != head.npos &&
           (head.find("\"views\"") != head.npos || head.find("\"featuresFolders\"") != head.npos ||
            head.find("\"intrinsics\"") != head.npos);
}

/// An id as text: files hold numbers as well as texts.
std::string idOf(const JsonFields& object, const char* key) {
    const Json* value = object.find(key);
    if (!value) return "";
    if (value->is_string()) return value->get<std::string>();
    if (!value->is_number_integer()) throw Error("{} is {}, expected an id", object.name(key), kindOf(*value));
    return dumpJson(*value);
}

double number(const JsonFields& object, const char* key) { return looseNumber(object.need(key), object.name(key)); }
double number(const JsonFields& object, const char* key, double fallback) {
    return object.has(key) ? number(object, key) : fallback;
}
std::string text(const JsonFields& object, const char* key) { return object.get<std::string>(key, ""); }

/// Lens coefficients by the name of the distortion.
void setDistortion(Camera& camera, const std::string& kind, const JsonFields& intrinsic) {
    const Json* list = intrinsic.find("distortionParams");
    std::vector<double> k;
    if (list && !list->is_string())  // boost writes an empty list as ""
        k = looseNumbers(*list, std::min<size_t>(list->size(), 16), intrinsic.name("distortionParams"));
    const auto expect = [&](size_t count) {
        if (k.size() != count && !k.empty())
            throw Error("{} holds {} numbers, expected {} for {}", intrinsic.name("distortionParams"), k.size(), count,
                        kind);
        k.resize(count, 0);
    };
    if (kind == "none" || kind == "pinhole") {
        setLens(camera, {});
    } else if (kind == "radialk1" || kind == "radial1") {
        expect(1);
        setLens(camera, {.k1 = k[0]});
    } else if (kind == "radialk3" || kind == "radial3") {
        expect(3);
        setLens(camera, {.k1 = k[0], .k2 = k[1], .k3 = k[2]});
    } else if (kind == "brown") {
        expect(5);
        setLens(camera, {.k1 = k[0], .k2 = k[1], .k3 = k[2], .p1 = k[3], .p2 = k[4]});
    } else if (kind == "fisheye" || kind == "fisheye4") {
        expect(4);
        camera.model = LensModel::openCvFisheye;
        camera.distortion = {k[0], k[1], k[2], k[3]};
    } else if (kind == "fisheye1") {
        expect(1);
        camera.model = LensModel::fov;
        camera.distortion = {k[0]};
        if (!(std::abs(k[0]) < piD))
            throw Error("{} is {}, expected less than pi", intrinsic.name("distortionParams"), k[0]);
    } else {
        throw Error(
            "{}: the distortion is \"{}\", expected none, radialk1, radialk3, brown, fisheye or fisheye1: "
            "export undistorted images (PrepareDenseScene) instead",
            intrinsic.name("type"), kind.substr(0, 40));
    }
}

/// Focal lengths in pixels.
void setFocal(Camera& camera, const JsonFields& intrinsic, const Version& version) {
    if (version < Version{1, 2, 2}) {
        const Json& f = intrinsic.need("pxFocalLength");
        if (f.is_array()) {
            const auto both = looseNumbers(f, 2, intrinsic.name("pxFocalLength"));
            camera.focalX = both[0], camera.focalY = both[1];
        } else {
            camera.focalX = camera.focalY = looseNumber(f, intrinsic.name("pxFocalLength"));
        }
        return;
    }
    const double sensor = number(intrinsic, "sensorWidth", 36), ratio = number(intrinsic, "pixelRatio", 1);
    for (const auto& [name, value] : {std::pair{"sensorWidth", sensor}, std::pair{"pixelRatio", ratio}})
        if (!(value > 1e-6)) throw Error("{} is {}, expected more than 0", intrinsic.name(name), value);
    const double f = number(intrinsic, "focalLength") / sensor * camera.width;
    camera.focalX = version < Version{1, 2, 11} ? f : f / ratio;
    camera.focalY = version < Version{1, 2, 5} ? f / ratio : version < Version{1, 2, 11} ? f * ratio : f;
}

Camera cameraOf(const JsonFields& intrinsic, const Version& version) {
    std::string type = text(intrinsic, "type"), kind = type;
    if (version >= Version{1, 2, 8}) {
        if (type != "pinhole")
            throw Error("{} is \"{}\", expected \"pinhole\"", intrinsic.name("type"), type.substr(0, 40));
        kind = text(intrinsic, "distortionType");
        if (const std::string inverse = text(intrinsic, "undistortionType"); !inverse.empty() && inverse != "none")
            throw Error("{} is \"{}\", expected \"none\"", intrinsic.name("undistortionType"), inverse.substr(0, 40));
    }
    Camera camera;
    withContext(intrinsic.name("width"),
                [&] { setSize(camera, number(intrinsic, "width"), number(intrinsic, "height")); });
    setFocal(camera, intrinsic, version);
    const auto centre = looseNumbers(intrinsic.need("principalPoint"), 2, intrinsic.name("principalPoint"));
    const bool fromCorner = version < Version{1, 2, 1};
    camera.centreX = centre[0] + (fromCorner ? 0 : 0.5 * camera.width) + 0.5;
    camera.centreY = centre[1] + (fromCorner ? 0 : 0.5 * camera.height) + 0.5;
    setDistortion(camera, kind, intrinsic);
    withContext(intrinsic.name("intrinsic"), [&] {
        checkIntrinsics(camera, {"focalLength", "focalLength", "principalPoint x", "principalPoint y"});
    });
    return camera;
}

Version versionOf(const JsonFields& root) {
    const auto parts = looseNumbers(root.need("version"), 3, "version");
    for (const double part : parts)
        if (!(part >= 0 && part < 1000)) throw Error("version holds {}, expected 0 to 999", part);
    return {int(parts[0]), int(parts[1]), int(parts[2])};
}

ForeignCameras parseMeshroom(const fs::path& file, const ForeignFolder&, Progress& progress) {
    const Json document = parseJson(readBytes(file, foreignFileBytes));
    if (!document.is_object()) throw Error("is {}, expected an object with views", kindOf(document));
    const JsonFields root(document);
    const Version version = versionOf(root);
    std::map<std::string, Camera> cameras;
    for (const JsonFields& intrinsic : root.list("intrinsics"))
        cameras.emplace(idOf(intrinsic, "intrinsicId"), cameraOf(intrinsic, version));
    std::map<std::string, DMat4> poses;
    const bool turned = version >= Version{1, 2, 3};
    for (const JsonFields& entry : root.list("poses")) {
        const JsonFields transform = entry.object("pose").object("transform");
        const auto r = looseNumbers(transform.need("rotation"), 9, transform.name("rotation"));
        const auto c = looseNumbers(transform.need("center"), 3, transform.name("center"));
        // Stored by columns, camera-from-world: three numbers in a row are an axis of the world seen by the camera.
        glm::dmat3 axes(r[0], r[3], r[6], r[1], r[4], r[7], r[2], r[5], r[8]);
        DVec3 position(c[0], c[1], c[2]);
        if (turned) {
            for (int i = 0; i < 3; ++i) axes[i] = DVec3(axes[i].x, -axes[i].y, -axes[i].z);
            position = DVec3(position.x, -position.y, -position.z);
        }
        poses.emplace(idOf(entry, "poseId"), poseFromAxes(axes, position, transform.name("rotation")));
    }
    ForeignCameras result;
    const auto views = root.list("views");
    if (views.size() > foreignViews)
        throw Error("views: has {} entries, expected at most {}", views.size(), foreignViews);
    size_t withoutPose = 0, rigs = 0;
    for (const JsonFields& view : views) {
        progress.check();
        const std::string rig = idOf(view, "rigId"), poseId = idOf(view, "poseId");
        if (!rig.empty() && rig != "4294967295") {
            ++rigs;
            continue;
        }
        const auto pose = poses.find(poseId.empty() ? idOf(view, "viewId") : poseId);
        if (pose == poses.end()) {
            ++withoutPose;
            continue;
        }
        const std::string id = idOf(view, "intrinsicId");
        const auto camera = cameras.find(id);
        if (camera == cameras.end())
            throw Error("{} is {}, which is not among the intrinsics", view.name("intrinsicId"), id.substr(0, 40));
        result.views.push_back({view.get<std::string>("path"), camera->second});
        result.views.back().camera.worldFromCamera = pose->second;
    }
    noteLeftOut(result.notes, withoutPose, views.size(), "have no pose");
    noteLeftOut(result.notes, rigs, views.size(), "belong to a rig");
    if (turned)
        result.notes.emplace_back(
            "The cameras were turned by 180 degrees about x, because Meshroom writes its meshes so.");
    return result;
}

std::optional<fs::path> findMeshroom(const fs::path& folder) {
    constexpr const char* names[] = {"cameras.sfm", "sfm.sfm"};
    return findByHead(folder, names, ".sfm", isMeshroomHead);
}

bool ownsMeshroom(const std::string& name) { return name.ends_with(".sfm"); }

}  // namespace

const ForeignReader meshroomReader{findMeshroom, ownsMeshroom, parseMeshroom};

}  // namespace relamp
