#include "capture/formats/foreign.h"

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>

#include "base/is_there.h"
#include "base/text_scanner.h"
#include "capture/colmap_brackets.h"
#include "capture/rigid.h"
#include "image/image_io.h"

namespace relamp {
namespace fs = std::filesystem;
namespace {

/// The mesh of a foreign capture: by the usual names, by those that the programs give, or the only one there is.
fs::path findForeignMesh(const fs::path& folder, const fs::path& beside, std::vector<std::string>& notes) {
    constexpr const char* own[] = {"texturedMesh.obj",    "model.obj",          "model.ply", "export.obj", "raw.obj",
                                   "textured_output.obj", "export_refined.obj", "raw.glb",   "model.glb"};
    const fs::path places[] = {folder, folder / "mesh", beside, beside / ".."};
    if (const auto mesh = findMeshIn(places, own)) return *mesh;
    std::vector<fs::path> meshes;
    std::error_code failed;
    for (fs::directory_iterator at(folder, failed); !failed && at != fs::directory_iterator(); at.increment(failed)) {
        const std::string ending = at->path().extension().string();
        constexpr const char* endings[] = {".ply", ".obj", ".glb", ".gltf", ".stl", ".off"};
        if (std::find(std::begin(endings), std::end(endings), ending) != std::end(endings) && isFile(at->path()))
            meshes.push_back(at->path());
    }
    if (meshes.size() != 1)
        throw Error("{}: holds {} (mesh.ply, .obj, .glb, .gltf, .stl, .off), name it with --mesh", folder.string(),
                    meshes.empty() ? "no mesh" : "several meshes and none of the usual name");
    notes.push_back(fmt::format("{} is taken as the mesh, because there is no other.", meshes[0].filename().string()));
    return meshes[0];
}

std::string withSlashes(std::string name) {
    std::replace(name.begin(), name.end(), '\\', '/');
    return name;
}

/// The last parts of the views' paths, or, where two would have one name, the paths as they are.
std::vector<std::string> shownNames(const std::vector<ForeignView>& views) {
    std::vector<std::string> last, whole;
    for (const ForeignView& view : views) {
        whole.push_back(view.name);
        last.push_back(fs::path(withSlashes(view.name)).filename().string());
    }
    std::vector<std::string> sorted = last;
    std::sort(sorted.begin(), sorted.end());
    const bool unique = std::adjacent_find(sorted.begin(), sorted.end()) == sorted.end() && !sorted.front().empty();
    return unique ? last : whole;
}

}  // namespace

ForeignFolder::ForeignFolder(fs::path folder, const fs::path& cameras, const std::string& images)
    : folder_(std::move(folder)) {
    if (!images.empty()) {
        places_ = {placeOf(folder_, images)};
        return;
    }
    const fs::path beside = cameras.parent_path();
    places_ = {folder_ / "images", folder_, beside / "images", beside, beside / "..", beside / "../images"};
}

fs::path ForeignFolder::photograph(const std::string& name) const {
    const fs::path whole(withSlashes(name)), last = whole.filename();
    for (const fs::path& part : {whole, last})
        for (const fs::path& place : places_)
            if (fs::path file = findImage(place, part.string()); isFile(file)) return file.lexically_normal();
    return places_[0] / last;
}

std::vector<std::string> ForeignFolder::photographs() const {
    std::vector<std::string> names;
    for (const fs::path& place : places_) {
        std::error_code failed;
        for (fs::directory_iterator at(place, failed); !failed && at != fs::directory_iterator();
             at.increment(failed)) {
            std::string ending = at->path().extension().string();
            std::transform(ending.begin(), ending.end(), ending.begin(),
                           [](char c) { return c >= 'A' && c <= 'Z' ? char(c - 'A' + 'a') : c; });
            for (const char* known : {".exr", ".hdr", ".png", ".jpg", ".jpeg", ".tif", ".tiff"})
                if (ending == known) names.push_back(at->path().filename().string());
        }
        if (!names.empty()) break;
    }
    std::sort(names.begin(), names.end());
    return names;
}

std::pair<int, int> ForeignFolder::sizeOf(const std::string& name) const { return readImageSize(photograph(name)); }

CaptureSource sourceFromForeign(const ForeignReader& reader, const fs::path& folder, const fs::path& cameras,
                                const CaptureFix& fix, Progress& progress) {
    const std::string where = cameras.filename().string();
    const ForeignFolder around(folder, cameras, fix.images);
    ForeignCameras read = withContext(where, [&] {
        ForeignCameras result = reader.parse(cameras, around, progress);
        if (result.views.empty()) throw Error("holds no camera with a pose");
        std::sort(result.views.begin(), result.views.end(),
                  [](const ForeignView& a, const ForeignView& b) { return a.name < b.name; });
        for (size_t i = 1; i < result.views.size(); ++i)
            if (result.views[i].name == result.views[i - 1].name)
                throw Error("{} is there twice", result.views[i].name.substr(0, 200));
        return result;
    });
    CaptureSource source;
    source.where = where;
    source.notes = std::move(read.notes);
    source.otherFiles = std::move(read.otherFiles);
    source.mesh =
        fix.mesh.empty() ? findForeignMesh(folder, cameras.parent_path(), source.notes) : placeOf(folder, fix.mesh);
    const std::vector<std::string> names = shownNames(read.views);
    std::vector<Camera> all;
    std::vector<fs::path> photographs;
    std::vector<ColmapView> files;  // by absolute path, so that exposures lie beside them
    for (const ForeignView& view : read.views) {
        all.push_back(view.camera);
        photographs.push_back(around.photograph(view.name));
        files.push_back({uint32_t(files.size()), fs::absolute(photographs.back()).string(), view.camera});
    }
    for (ColmapBracket& bracket : colmapBrackets({}, files)) {
        const uint32_t i = bracket.view.id;
        source.frames.push_back({fmt::format("{}: {}", where, read.views[i].name), names[i], photographs[i],
                                 bracket.view.camera, std::move(bracket.exposures), true});
    }
    if (source.frames.size() < files.size())
        source.notes.push_back(
            fmt::format("{} of {} cameras are exposures of others; the one nearest to +0 stops counts.",
                        files.size() - source.frames.size(), files.size()));
    source.up = read.up ? *read.up : upOfCameras(all);
    if (!read.up && fix.up.empty())
        source.notes.push_back(
            fmt::format("{} does not say what is up: {} is taken, from how the cameras were held; --up says otherwise.",
                        where, nameFromAxis(source.up)));
    return source;
}

// ---- finding

std::string headOf(const fs::path& file, size_t bytes) {
    std::string head;
    if (!isFile(file)) return head;
    std::ifstream in(file, std::ios::binary);
    head.resize(bytes);
    in.read(head.data(), std::streamsize(bytes));
    head.resize(size_t(std::max<std::streamsize>(in.gcount(), 0)));
    return head;
}

std::optional<fs::path> findByHead(const fs::path& folder, std::span<const char* const> names, std::string_view ending,
                                   bool (*isHead)(std::string_view)) {
    for (const char* name : names)
        if (isHead(headOf(folder / name))) return folder / name;
    std::vector<std::string> possible;
    std::error_code failed;
    for (fs::directory_iterator at(folder, failed); !failed && at != fs::directory_iterator(); at.increment(failed))
        if (std::string name = at->path().filename().string(); name.ends_with(ending))
            possible.push_back(std::move(name));
    std::sort(possible.begin(), possible.end());
    if (possible.size() > 64) possible.resize(64);
    for (const std::string& name : possible)
        if (isHead(headOf(folder / name))) return folder / name;
    return std::nullopt;
}

// ---- cameras

DMat4 poseFromOpenGl(const glm::dmat3& rightUpBack, const DVec3& position, const std::string& field) {
    DMat4 pose(glm::dvec4(rightUpBack[0], 0), glm::dvec4(rightUpBack[1], 0), glm::dvec4(rightUpBack[2], 0),
               glm::dvec4(position, 1));
    double scale = 1;
    std::string fault = makeRigid(pose, scale);
    if (fault.empty() && std::abs(scale - 1) > 1e-3)
        fault = fmt::format("has a scale of {:g}, expected a rotation and a translation", scale);
    if (!fault.empty()) throw Error("{} {}", field, fault);
    return pose;
}

DMat4 poseFromAxes(const glm::dmat3& rightDownAhead, const DVec3& position, const std::string& field) {
    return poseFromOpenGl(glm::dmat3(rightDownAhead[0], -rightDownAhead[1], -rightDownAhead[2]), position, field);
}

glm::dmat3 rotationFromQuaternion(double w, double x, double y, double z, const std::string& field) {
    const double length = std::sqrt(w * w + x * x + y * y + z * z);
    if (!(length > 1e-6 && length < 1e6)) throw Error("{} is {} {} {} {}, expected a rotation", field, w, x, y, z);
    w /= length, x /= length, y /= length, z /= length;
    return glm::dmat3(1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y),  // first column
                      2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x),  // second
                      2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y));
}

void setLens(Camera& camera, const BrownLens& l) {
    if (l.k4 != 0 || l.skew != 0) {
        camera.model = LensModel::brown;
        camera.distortion = {l.k1, l.k2, l.p1, l.p2, l.k3, l.k4, l.skew, 0};
    } else if (l.k3 != 0) {
        camera.model = LensModel::fullOpenCv;
        camera.distortion = {l.k1, l.k2, l.p1, l.p2, l.k3, 0, 0, 0};
    } else if (l.k1 != 0 || l.k2 != 0 || l.p1 != 0 || l.p2 != 0) {
        camera.model = LensModel::openCv;
        camera.distortion = {l.k1, l.k2, l.p1, l.p2, 0, 0, 0, 0};
    } else {
        camera.model = LensModel::pinhole;
        camera.distortion = {};
    }
}

void setSize(Camera& camera, double width, double height) {
    constexpr double maxSide = 1 << 17;
    for (const auto& [name, side] : {std::pair{"width", width}, std::pair{"height", height}})
        if (!(side >= 1 && side <= maxSide) || side != std::floor(side))
            throw Error("{} is {}, expected a whole number from 1 to {:.0f}", name, side, maxSide);
    camera.width = int(width), camera.height = int(height);
}

void checkIntrinsics(const Camera& camera, const IntrinsicNames& names) {
    if (const std::string fault = faultOf(camera, names); !fault.empty()) throw Error(fault);
    for (const double k : camera.distortion)
        if (!(std::abs(k) <= 1e9)) throw Error("distortion is {}, expected at most 1e9", k);
}

// ---- numbers

double numberFrom(std::string_view word, const std::string& field) {
    if (word.empty()) throw Error("{} is missing", field);
    const auto value = TextScanner::number(word);
    if (!value || !(std::abs(*value) <= 1e12))
        throw Error("{} is \"{}\", expected a finite number", field, word.substr(0, 40));
    return *value;
}

std::vector<double> numbersFrom(std::string_view text, size_t count, const std::string& field) {
    TextScanner scanner(text);
    std::vector<double> numbers;
    for (std::string_view word = scanner.word(); !word.empty(); word = scanner.word()) {
        if (numbers.size() == count) throw Error("{} holds more than {} numbers", field, count);
        numbers.push_back(numberFrom(word, field));
    }
    if (numbers.size() < count) throw Error("{} holds {} numbers, expected {}", field, numbers.size(), count);
    return numbers;
}

double looseNumber(const Json& value, const std::string& field) {
    if (value.is_string()) return numberFrom(value.get_ref<const std::string&>(), field);
    if (!value.is_number()) throw Error("{} is {}, expected a number", field, kindOf(value));
    const double x = value.get<double>();
    if (!(std::abs(x) <= 1e12)) throw Error("{} is {:g}, expected a finite number of at most 1e12", field, x);
    return x;
}

std::vector<double> looseNumbers(const Json& value, size_t count, const std::string& field) {
    if (!value.is_array() || value.size() != count) throw Error("{} is no list of {} numbers", field, count);
    std::vector<double> numbers;
    for (const Json& element : value) numbers.push_back(looseNumber(element, field));
    return numbers;
}

void noteLeftOut(std::vector<std::string>& notes, size_t count, size_t all, const char* why) {
    if (count) notes.push_back(fmt::format("{} of {} cameras {} and are left out.", count, all, why));
}

}  // namespace relamp
