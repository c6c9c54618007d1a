// Metashape's cameras as "Export Cameras, Agisoft XML" writes them (PhotoScan 1.2 and later).
//
// The lens is that of the Metashape manual, appendix "Camera models", frame cameras: x = X/Z, y = Y/Z, r^2 = x^2 + y^2,
//   x' = x (1 + K1 r^2 + K2 r^4 + K3 r^6 + K4 r^8) + P1 (r^2 + 2 x^2) + 2 P2 x y
//   y' = y (1 + ...)                              + P2 (r^2 + 2 y^2) + 2 P1 x y
//   u = w / 2 + cx + x' f + x' B1 + y' B2,   v = h / 2 + cy + y' f
// so P1 and P2 are OpenCV's p2 and p1. Of an equidistant fisheye x and y are first scaled by atan(R) / R, R^2 = x^2 +
// y^2, which is COLMAP's OPENCV_FISHEYE, with P1 and P2 its THIN_PRISM_FISHEYE. The first pixel's centre is (0.5, 0.5),
// as ours. A camera's <transform> is chunk-from-camera, row-major, Y down and looking along +Z; the component's or the
// chunk's <transform> (rotation, translation, scale) leads on to the world that meshes are exported in.
#include <map>
#include <pugixml.hpp>

#include "base/atomic_file.h"
#include "capture/formats/readers.h"

namespace relamp {
namespace fs = std::filesystem;
namespace {

constexpr size_t mostElements = 2'000'000;

bool isMetashapeHead(std::string_view head) {
    return head.find("<document") != head.npos && head.find("<chunk") != head.npos;
}

/// From the chunk's own axes to those that everything is exported in.
struct ChunkPlace {
    glm::dmat3 rotation{1.0};
    DVec3 translation{0};
    double scale = 1;
    bool given = false;
};

glm::dmat3 rowMajor(const std::vector<double>& n, size_t stride) {
    glm::dmat3 matrix;
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 3; ++column) matrix[column][row] = n[size_t(row) * stride + size_t(column)];
    return matrix;
}

ChunkPlace placeFrom(const pugi::xml_node& transform, const std::string& where) {
    ChunkPlace place;
    if (!transform) return place;
    place.given = true;
    if (const auto node = transform.child("rotation")) {
        const glm::dmat3 matrix = rowMajor(numbersFrom(node.text().get(), 9, where + ": transform: rotation"), 3);
        place.rotation = glm::dmat3(poseFromOpenGl(matrix, DVec3(0), where + ": transform: rotation"));
    }
    if (const auto node = transform.child("translation")) {
        const auto t = numbersFrom(node.text().get(), 3, where + ": transform: translation");
        place.translation = {t[0], t[1], t[2]};
    }
    if (const auto node = transform.child("scale")) {
        place.scale = numberFrom(node.text().get(), where + ": transform: scale");
        if (!(place.scale > 1e-9 && place.scale < 1e9))
            throw Error("{}: transform: scale is {}, expected more than 0", where, place.scale);
    }
    return place;
}

/// Sets model and distortion of an equidistant fisheye: the simplest of COLMAP's that holds it exactly.
void setFisheye(Camera& camera, const BrownLens& l) {
    if (l.skew != 0)
        throw Error("calibration: b2 is {:g}, expected 0 of a fisheye: fix it to 0 in Metashape and optimise again",
                    l.skew * camera.focalX);
    const bool tangential = l.p1 != 0 || l.p2 != 0;
    camera.model = tangential ? LensModel::thinPrismFisheye : LensModel::openCvFisheye;
    if (tangential) camera.distortion = {l.k1, l.k2, l.p1, l.p2, l.k3, l.k4, 0, 0};
    else camera.distortion = {l.k1, l.k2, l.k3, l.k4};
}

/// The lens of a sensor; throws Error for what neither a frame camera nor an equidistant fisheye has.
Camera cameraOfSensor(const pugi::xml_node& sensor) {
    const std::string type = sensor.attribute("type").as_string("frame");
    const bool fisheye = type == "fisheye" || type == "equidistant_fisheye";
    if (type != "frame" && !fisheye)
        throw Error(
            "type is \"{}\", expected \"frame\" or \"fisheye\": export undistorted photographs from Metashape instead",
            type.substr(0, 40));
    pugi::xml_node calibration = sensor.find_child_by_attribute("calibration", "class", "adjusted");
    if (!calibration) calibration = sensor.child("calibration");
    if (!calibration) throw Error("calibration is missing");
    if (calibration.child("fx"))
        throw Error("calibration: fx is a field of PhotoScan before 1.2, expected f: export with a later version");
    const auto value = [&](const char* name, bool needed = false) {
        const pugi::xml_node node = calibration.child(name);
        if (!node && !needed) return 0.0;
        return numberFrom(node.text().get(), std::string("calibration: ") + name);
    };
    pugi::xml_node size = calibration.child("resolution");
    if (!size) size = sensor.child("resolution");
    if (!size) throw Error("resolution is missing");
    Camera camera;
    setSize(camera, numberFrom(size.attribute("width").as_string(), "resolution: width"),
            numberFrom(size.attribute("height").as_string(), "resolution: height"));
    for (const char* name : {"p3", "p4"})
        if (const double p = value(name); p != 0)
            throw Error("calibration: {} is {}, expected 0: fix it to 0 in Metashape and optimise again", name, p);
    const double f = value("f", true);
    camera.focalX = f + value("b1");
    camera.focalY = f;
    camera.centreX = 0.5 * camera.width + value("cx");
    camera.centreY = 0.5 * camera.height + value("cy");
    checkIntrinsics(camera, {"calibration: f + b1", "calibration: f", "calibration: cx", "calibration: cy"});
    const BrownLens lens{
        value("k1"), value("k2"), value("k3"), value("k4"), value("p2"), value("p1"), value("b2") / camera.focalX};
    if (fisheye) setFisheye(camera, lens);
    else setLens(camera, lens);
    checkIntrinsics(camera, {"calibration: f + b1", "calibration: f", "calibration: cx", "calibration: cy"});
    return camera;
}

/// All <camera> elements, those in nested groups too.
std::vector<pugi::xml_node> camerasIn(const pugi::xml_node& chunk) {
    std::vector<pugi::xml_node> found, groups{chunk.child("cameras")};
    for (size_t i = 0; i < groups.size(); ++i)
        for (const pugi::xml_node& node : groups[i].children()) {
            if (std::string_view(node.name()) == "camera") found.push_back(node);
            else if (std::string_view(node.name()) == "group") groups.push_back(node);
        }
    if (found.size() > foreignViews)
        throw Error("cameras: there are {}, expected at most {}", found.size(), foreignViews);
    return found;
}

/// The component that most posed cameras belong to: others lie in worlds of their own.
std::string largestComponent(const std::vector<pugi::xml_node>& cameras) {
    std::map<std::string, size_t> counts;
    for (const pugi::xml_node& camera : cameras)
        if (camera.child("transform")) ++counts[camera.attribute("component_id").as_string()];
    std::string largest;
    size_t most = 0;
    for (const auto& [id, count] : counts)
        if (count > most) most = count, largest = id;
    return largest;
}

class ChunkReader {
public:
    explicit ChunkReader(const pugi::xml_node& chunk) : chunk_(chunk) {}

    ForeignCameras read() {
        const std::vector<pugi::xml_node> cameras = camerasIn(chunk_);
        component_ = largestComponent(cameras);
        place_ = placeFrom(chunk_.child("transform"), "chunk");
        if (const auto component = chunk_.child("components").find_child_by_attribute("id", component_.c_str());
            component && component.child("transform"))
            place_ = placeFrom(component.child("transform"), "component " + component_);
        for (const pugi::xml_node& camera : cameras) add(camera);
        noteLeftOut(result_.notes, withoutPose_, cameras.size(), "have no pose");
        noteLeftOut(result_.notes, disabled_, cameras.size(), "are disabled");
        noteLeftOut(result_.notes, elsewhere_, cameras.size(), "belong to another component");
        noteLeftOut(result_.notes, rigs_, cameras.size(), "take their pose from another camera of a rig");
        if (place_.given)
            result_.notes.push_back(fmt::format(
                "The chunk's rotation, translation and scale ({:g}) were applied; the mesh must be exported in the "
                "same coordinates.",
                place_.scale));
        if (glm::length(place_.translation) > 1e6)
            result_.notes.emplace_back(
                "The cameras are in geocentric coordinates; a mesh exported in a map projection or in local "
                "coordinates does not fit them.");
        return std::move(result_);
    }

private:
    void add(const pugi::xml_node& node) {
        const std::string label = node.attribute("label").as_string();
        const std::string enabled = node.attribute("enabled").as_string("true");
        if (enabled == "false" || enabled == "0") return void(++disabled_);
        const pugi::xml_node transform = node.child("transform");
        if (!transform && node.attribute("master_id")) return void(++rigs_);
        if (!transform) return void(++withoutPose_);
        if (node.attribute("component_id").as_string() != component_) return void(++elsewhere_);
        if (label.empty()) throw Error("camera {}: label is missing", node.attribute("id").as_string());
        withContext("camera " + label.substr(0, 200), [&] {
            if (node.child("rolling_shutter"))
                throw Error("rolling_shutter is there, expected one pose: switch the compensation off in Metashape");
            ForeignView view{label, sensor(node.attribute("sensor_id").as_string())};
            const auto m = numbersFrom(transform.text().get(), 16, "transform");
            for (size_t i = 12; i < 16; ++i)
                if (std::abs(m[i] - (i == 15)) > 1e-6) throw Error("transform has a last row other than 0 0 0 1");
            const DVec3 inChunk(m[3], m[7], m[11]);
            view.camera.worldFromCamera =
                poseFromAxes(place_.rotation * rowMajor(m, 4),
                             place_.rotation * inChunk * place_.scale + place_.translation, "transform");
            result_.views.push_back(std::move(view));
        });
    }
    /// Read when a posed camera needs it, so that a spherical sensor nobody uses is no error.
    const Camera& sensor(const std::string& id) {
        if (const auto known = sensors_.find(id); known != sensors_.end()) return known->second;
        const pugi::xml_node node = chunk_.child("sensors").find_child_by_attribute("sensor", "id", id.c_str());
        if (!node) throw Error("sensor_id is \"{}\", which is not among the sensors", id.substr(0, 40));
        return sensors_.emplace(id, withContext("sensor " + id, [&] { return cameraOfSensor(node); })).first->second;
    }

    pugi::xml_node chunk_;
    std::string component_;
    ChunkPlace place_;
    std::map<std::string, Camera> sensors_;
    ForeignCameras result_;
    size_t withoutPose_ = 0, disabled_ = 0, elsewhere_ = 0, rigs_ = 0;
};

ForeignCameras parseMetashape(const fs::path& cameras, const ForeignFolder&, Progress&) {
    const std::string text = readBytes(cameras, foreignFileBytes);
    size_t elements = 0;
    for (size_t i = 0; i + 1 < text.size(); ++i) elements += text[i] == '<' && text[i + 1] != '/';
    if (elements > mostElements) throw Error("holds more than {} elements", mostElements);
    pugi::xml_document document;
    if (const auto result = document.load_buffer(text.data(), text.size()); !result)
        throw Error("is not valid XML (byte {}: {})", result.offset, result.description());
    const pugi::xml_node root = document.child("document");
    pugi::xml_node chunk = root.child("chunk");
    if (!chunk) throw Error("document: chunk is missing");
    ForeignCameras result = ChunkReader(chunk).read();
    if (chunk.next_sibling("chunk")) result.notes.emplace_back("The file holds several chunks; the first is read.");
    return result;
}

std::optional<fs::path> findMetashape(const fs::path& folder) {
    constexpr const char* names[] = {"cameras.xml"};
    return findByHead(folder, names, ".xml", isMetashapeHead);
}

bool ownsMetashape(const std::string& name) { return name.ends_with(".xml"); }

}  // namespace

const ForeignReader metashapeReader{findMetashape, ownsMetashape, parseMetashape};

}  // namespace relamp
