#include "scan/scan_calibration.h"

#include <nlohmann/json.hpp>

#include <set>

#include "base/atomic_file.h"
#include "base/json_fields.h"
#include "capture/camera_fault.h"

namespace relamp {
namespace {

constexpr size_t mostCameras = 64;
constexpr int mostSide = 65536;

double metresPerUnit(const JsonFields& fields) {
    const auto unit = fields.get<std::string>("units", "metre");
    if (unit == "metre" || unit == "meter" || unit == "m") return 1;
    if (unit == "centimetre" || unit == "centimeter" || unit == "cm") return 0.01;
    if (unit == "millimetre" || unit == "millimeter" || unit == "mm") return 0.001;
    throw Error("units: '{}' is unknown, expected metre, centimetre or millimetre", unit);
}

/// Of OpenCV's 3 x 3 matrices, by rows.
glm::dmat3 matrixOf(const JsonFields& fields, const char* key) {
    const Json& rows = fields.need(key);
    glm::dmat3 m(0);
    if (!rows.is_array() || rows.size() != 3) throw Error("{}: expected three rows", fields.name(key));
    for (int r = 0; r < 3; ++r) {
        const DVec3 row = pointOf(rows[size_t(r)], fmt::format("{}[{}]", fields.name(key), r));
        for (int c = 0; c < 3; ++c) m[c][r] = row[c];
    }
    return m;
}

DVec3 vectorOf(const JsonFields& fields, const char* key) { return pointOf(fields.need(key), fields.name(key)); }

void takeDistortion(const JsonFields& fields, Camera& camera) {
    const char* key = fields.has("distortion") ? "distortion" : "distortion_k1k2p1p2k3";
    const Json* list = fields.find(key);
    if (!list) return;
    if (!list->is_array() || list->size() > 8)
        throw Error("{}: expected at most eight numbers (k1 k2 p1 p2 k3 k4 k5 k6)", fields.name(key));
    for (size_t i = 0; i < list->size(); ++i) {
        camera.distortion[i] = numberOf((*list)[i], fmt::format("{}[{}]", fields.name(key), i));
        if (camera.distortion[i] != 0) camera.model = LensModel::fullOpenCv;
    }
}

Camera scanCameraOf(const JsonFields& fields, double unit) {
    Camera camera;
    camera.width = fields.get<int>("width");
    camera.height = fields.get<int>("height");
    for (const char* key : {"width", "height"})
        if (const int side = key[0] == 'w' ? camera.width : camera.height; side < 1 || side > mostSide)
            throw Error("{}: is {}, expected 1 to {} pixels", fields.name(key), side, mostSide);
    const glm::dmat3 k = matrixOf(fields, "K"), r = matrixOf(fields, "R");
    camera.focalX = k[0][0];
    camera.focalY = k[1][1];
    camera.centreX = k[2][0] + 0.5;
    camera.centreY = k[2][1] + 0.5;
    if (std::abs(k[1][0]) > 1e-6 * std::abs(k[0][0]))
        throw Error("{}: a skew of {}, expected 0", fields.name("K"), k[1][0]);
    const std::string fault = faultOf(camera, {"K[0][0]", "K[1][1]", "K[0][2]", "K[1][2]"});
    if (!fault.empty()) throw Error("{}", fields.name(fault.c_str()));
    const glm::dmat3 square = glm::transpose(r) * r;
    for (int c = 0; c < 3; ++c)
        for (int i = 0; i < 3; ++i)
            if (!(std::abs(square[c][i] - (c == i ? 1 : 0)) < 1e-3) || !(glm::determinant(r) > 0))
                throw Error("{}: is no rotation", fields.name("R"));
    takeDistortion(fields, camera);
    const glm::dmat3 turned = glm::transpose(r);
    const DVec3 position = -(turned * vectorOf(fields, "t")) * unit;
    camera.worldFromCamera =
        DMat4(glm::dvec4(turned[0], 0), glm::dvec4(-turned[1], 0), glm::dvec4(-turned[2], 0), glm::dvec4(position, 1));
    return camera;
}

/// A name that can be a file's.
std::string plainName(const std::string& name, const std::string& where) {
    const bool plain = !name.empty() && name.size() < 100 && name[0] != '.' &&
                       name.find_first_of("/\\") == std::string::npos &&
                       std::none_of(name.begin(), name.end(), [](char c) { return uint8_t(c) < 32 || c == 127; });
    if (!plain) throw Error("{}: expected a name that a file can have", where);
    return name;
}

}  // namespace

ScanCalibration readScanCalibration(const std::filesystem::path& file) {
    return withContext(file.string(), [&] {
        const Json document = parseJson(readBytes(file, size_t(1) << 24));
        const JsonFields fields(document);
        const double unit = metresPerUnit(fields);
        ScanCalibration calibration;
        std::set<std::string> names;
        fields.need("views");
        const std::vector<JsonFields> views = fields.list("views");
        if (views.empty()) throw Error("views: holds no camera");
        if (views.size() > mostCameras)
            throw Error("views: {} cameras, expected at most {}", views.size(), mostCameras);
        for (const JsonFields& view : views) {
            ScanCamera camera;
            camera.name = plainName(view.get<std::string>("name"), view.name("name"));
            if (!names.insert(camera.name).second)
                throw Error("{}: '{}' names two cameras", view.name("name"), camera.name);
            const std::filesystem::path image = view.get<std::string>("image", camera.name + "/white");
            camera.folder = file.parent_path() / image.parent_path();
            camera.camera = scanCameraOf(view, unit);
            calibration.cameras.push_back(std::move(camera));
        }
        if (fields.has("projector")) calibration.projector = scanCameraOf(fields.object("projector"), unit);
        return calibration;
    });
}

}  // namespace relamp
