#include "capture/colmap.h"

#include <algorithm>
#include <cstring>
#include <map>
#include <unordered_map>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/is_there.h"
#include "capture/camera_fault.h"
#include "capture/colmap_files.h"

namespace relamp {
namespace fs = std::filesystem;
namespace {

constexpr double maxSide = 1 << 17;

bool isModel(const fs::path& folder) {
    const auto has = [&](const char* name) {
        return isFile(folder / (std::string(name) + ".bin")) || isFile(folder / (std::string(name) + ".txt"));
    };
    return has("cameras") && has("images");
}

/// How many images a model holds, as far as its header or its size tells; for choosing among several.
uintmax_t weightOf(const fs::path& folder) {
    std::error_code ignored;
    for (const char* name : {"images.bin", "images.txt"})
        if (isFile(folder / name)) return fs::file_size(folder / name, ignored);
    return 0;
}

// ---- cameras

/// COLMAP's numbers for its models, and how many parameters each has.
struct ModelOfNumber {
    LensModel model;
    size_t parameters;
};
constexpr ModelOfNumber models[] = {
    {LensModel::simplePinhole, 3},
    {LensModel::pinhole, 4},
    {LensModel::simpleRadial, 4},
    {LensModel::radial, 5},
    {LensModel::openCv, 8},
    {LensModel::openCvFisheye, 8},
    {LensModel::fullOpenCv, 12},
    {LensModel::fov, 5},
    {LensModel::simpleRadialFisheye, 4},
    {LensModel::radialFisheye, 5},
    {LensModel::thinPrismFisheye, 12},
};

size_t parametersOf(LensModel model) {
    for (const ModelOfNumber& m : models)
        if (m.model == model) return m.parameters;
    return 0;
}

bool hasOneFocalLength(LensModel model) {
    return model == LensModel::simplePinhole || model == LensModel::simpleRadial || model == LensModel::radial ||
           model == LensModel::simpleRadialFisheye || model == LensModel::radialFisheye;
}

Camera cameraFrom(LensModel model, double width, double height, const std::vector<double>& parameters) {
    Camera camera;
    for (const auto& [name, side] : {std::pair{"width", width}, std::pair{"height", height}})
        if (!(side >= 1 && side <= maxSide))
            throw Error("{} is {:.0f}, expected 1 to {:.0f} pixels", name, side, maxSide);
    for (size_t i = 0; i < parameters.size(); ++i)
        if (!(std::abs(parameters[i]) <= 1e9))
            throw Error("parameter {} is {}, expected a finite number of at most 1e9", i, parameters[i]);
    camera.width = int(width), camera.height = int(height);
    camera.model = model;
    size_t next = 0;
    camera.focalX = parameters[next++];
    camera.focalY = hasOneFocalLength(model) ? camera.focalX : parameters[next++];
    camera.centreX = parameters[next++];
    camera.centreY = parameters[next++];
    if (const std::string fault = faultOf(
            camera, {"the focal length", "the focal length", "the principal point's x", "the principal point's y"});
        !fault.empty())
        throw Error(fault);
    for (size_t i = 0; next < parameters.size(); ++i) camera.distortion[i] = parameters[next++];
    if (model == LensModel::fov && std::abs(camera.distortion[0]) >= piD)
        throw Error("omega is {}, expected less than pi", camera.distortion[0]);
    return camera;
}

using Cameras = std::map<uint32_t, Camera>;

void addCamera(Cameras& cameras, uint32_t id, const Camera& camera) {
    if (!cameras.emplace(id, camera).second) throw Error("is there twice");
}

Cameras camerasFromBinary(const fs::path& path, const ColmapLimits& limits) {
    ColmapBinary file(path);
    Cameras cameras;
    const uint64_t count = file.count("number of cameras", 24 + 3 * 8, limits.maxViews);
    for (uint64_t i = 0; i < count; ++i) {
        const auto id = file.take<uint32_t>("camera_id");
        withContext(fmt::format("camera {}", id), [&] {
            const auto number = file.take<int32_t>("model");
            if (number < 0 || size_t(number) >= std::size(models))
                throw Error("model is {}, expected 0 (SIMPLE_PINHOLE) to 10 (THIN_PRISM_FISHEYE)", number);
            const auto width = file.take<uint64_t>("width"), height = file.take<uint64_t>("height");
            std::vector<double> parameters(models[number].parameters);
            file.bytes(parameters.data(), parameters.size() * sizeof(double), "parameters");
            addCamera(cameras, id, cameraFrom(models[number].model, double(width), double(height), parameters));
        });
    }
    file.expectEnd();
    return cameras;
}

Cameras camerasFromText(const fs::path& path, const ColmapLimits& limits) {
    const std::string text = readBytes(path, limits.maxTextBytes);
    TextScanner scanner(text);
    Cameras cameras;
    while (const auto words = nextLine(scanner)) {
        ColmapLine line(*words);
        const auto id = uint32_t(line.whole("camera_id", 0xffffffff));
        withContext(fmt::format("camera {}", id), [&] {
            const std::string name(line.word().substr(0, 80));
            const auto model = lensModelFromName(name);
            if (!model || parametersOf(*model) == 0)  // BROWN is none of COLMAP's
                throw Error(
                    "model is \"{}\", expected SIMPLE_PINHOLE, PINHOLE, SIMPLE_RADIAL, OPENCV or another of COLMAP's",
                    name);
            const double width = line.number("width"), height = line.number("height");
            std::vector<double> parameters(parametersOf(*model));
            for (size_t i = 0; i < parameters.size(); ++i)
                parameters[i] = line.number(fmt::format("parameter {} of {}", i, name).c_str());
            if (!line.atEnd()) throw Error("has more than the {} parameters of {}", parameters.size(), name);
            addCamera(cameras, id, cameraFrom(*model, width, height, parameters));
            if (cameras.size() > limits.maxViews) throw Error("there are more than {} cameras", limits.maxViews);
        });
    }
    return cameras;
}

// ---- points

struct PointSum {
    DVec3 position;
    double errors = 0;
    uint32_t seen = 0;
};

struct Points {
    std::unordered_map<uint64_t, uint32_t> indexOf;
    std::vector<PointSum> sums;
    double statedErrors = 0;
    size_t stated = 0;

    void add(uint64_t id, const DVec3& position, double error) {
        for (int c = 0; c < 3; ++c)
            if (!std::isfinite(position[c])) throw Error("{} is {}, expected a finite number", "xyz"[c], position[c]);
        if (!indexOf.emplace(id, uint32_t(sums.size())).second) throw Error("is there twice");
        sums.push_back({position, 0, 0});
        if (error >= 0 && std::isfinite(error)) {  // COLMAP writes -1 where it knows none
            statedErrors += error;
            ++stated;
        }
    }
};

void pointsFromBinary(const fs::path& path, const ColmapLimits& limits, Points& points, Progress& progress) {
    ColmapBinary file(path);
    const uint64_t count = file.count("number of points", 51, limits.maxPoints);
    std::vector<char> track;
    for (uint64_t i = 0; i < count; ++i) {
        if (i % 4096 == 0) progress.check();
        const auto id = file.take<uint64_t>("point3D_id");
        withContext(fmt::format("point {}", id), [&] {
            double xyz[3];
            file.bytes(xyz, sizeof xyz, "xyz");
            uint8_t colour[3];
            file.bytes(colour, sizeof colour, "rgb");
            const auto error = file.take<double>("error");
            points.add(id, {xyz[0], xyz[1], xyz[2]}, error);
            track.resize(size_t(file.count("track length", 8, 0xffffffff)) * 8);
            file.bytes(track.data(), track.size(), "track");
        });
    }
    file.expectEnd();
}

void pointsFromText(const fs::path& path, const ColmapLimits& limits, Points& points, Progress& progress) {
    const std::string text = readBytes(path, limits.maxTextBytes);
    TextScanner scanner(text);
    while (const auto words = nextLine(scanner)) {
        if (points.sums.size() % 4096 == 0) progress.check();
        ColmapLine line(*words);
        const uint64_t id = line.whole("point3D_id", uint64_t(1) << 62);
        withContext(fmt::format("point {}", id), [&] {
            const double x = line.number("x"), y = line.number("y"), z = line.number("z");
            for (const char* field : {"r", "g", "b"}) line.number(field);
            points.add(id, {x, y, z}, line.number("error"));
            if (points.sums.size() > limits.maxPoints) throw Error("there are more than {} points", limits.maxPoints);
        });
    }
}

// ---- images

/// worldFromCamera in OpenGL's axes: COLMAP stores cameraFromWorld, Y down and looking along +Z.
DMat4 poseFrom(const double q[4], const double t[3]) {
    double length = 0;
    for (int i = 0; i < 4; ++i) length += q[i] * q[i];
    if (!std::isfinite(length) || length < 1e-12)
        throw Error("qw qx qy qz are {} {} {} {}, expected a rotation", q[0], q[1], q[2], q[3]);
    for (int c = 0; c < 3; ++c)
        if (!(std::abs(t[c]) <= 1e12))
            throw Error("t{} is {}, expected a finite number of at most 1e12", "xyz"[c], t[c]);
    length = std::sqrt(length);
    const double w = q[0] / length, x = q[1] / length, y = q[2] / length, z = q[3] / length;
    // Rows of cameraFromWorld's rotation are the camera's axes in the world.
    const DVec3 right(1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y));
    const DVec3 down(2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x));
    const DVec3 ahead(2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y));
    const DVec3 position = -(right * t[0] + down * t[1] + ahead * t[2]);
    return DMat4(glm::dvec4(right, 0), glm::dvec4(-down, 0), glm::dvec4(-ahead, 0), glm::dvec4(position, 1));
}

/// Collects the views and the reprojection errors while an images file is read.
class ViewReader {
public:
    ViewReader(const Cameras& cameras, Points& points, ColmapModel& model)
        : cameras_(cameras), points_(points), model_(model) {}

    ColmapView begin(uint32_t id, const double q[4], const double t[3], uint64_t cameraId, const std::string& name) {
        const auto camera = cameras_.find(uint32_t(cameraId));
        if (cameraId > 0xffffffff || camera == cameras_.end())
            throw Error("camera_id is {}, which the cameras file does not hold", cameraId);
        if (name.empty()) throw Error("name is empty");
        ColmapView view;
        view.id = id;
        view.name = name;
        view.camera = camera->second;
        view.camera.worldFromCamera = poseFrom(q, t);
        return view;
    }
    void observe(ColmapView& view, double x, double y, uint64_t pointId) {
        if (!std::isfinite(x) || !std::isfinite(y))
            throw Error("a 2D point is at {} {}, expected finite numbers", x, y);
        const auto found = points_.indexOf.find(pointId);
        if (found == points_.indexOf.end()) {
            if (points_.sums.empty()) return;
            throw Error("a 2D point names point {}, which the points file does not hold", pointId);
        }
        PointSum& point = points_.sums[found->second];
        ++view.observations;
        if (!view.camera.project(point.position)) ++model_.behind;
        // By the formula alone, because COLMAP counts points on a branch that folds back as well.
        const auto pixel = view.camera.projectByFormula(point.position);
        if (!pixel || !std::isfinite(pixel->x) || !std::isfinite(pixel->y)) return;
        const double error = std::hypot(pixel->x - x, pixel->y - y);
        view.errorPixels += error;
        point.errors += error;
        ++point.seen;
    }
    void end(ColmapView& view) {
        model_.observations += view.observations;
        if (view.observations) view.errorPixels /= double(view.observations);
        model_.views.push_back(std::move(view));
    }

private:
    const Cameras& cameras_;
    Points& points_;
    ColmapModel& model_;
};

constexpr uint64_t noPoint = ~uint64_t(0);

void imagesFromBinary(const fs::path& path, const ColmapLimits& limits, ViewReader& reader, Progress& progress) {
    ColmapBinary file(path);
    const uint64_t count = file.count("number of images", 73, limits.maxViews);
    struct Observation {
        double x, y;
        uint64_t point;
    };
    std::vector<Observation> some;
    for (uint64_t i = 0; i < count; ++i) {
        const auto id = file.take<uint32_t>("image_id");
        withContext(fmt::format("image {}", id), [&] {
            double pose[7];
            file.bytes(pose, sizeof pose, "pose");
            const auto cameraId = file.take<uint32_t>("camera_id");
            const std::string name = file.text("name");
            ColmapView view = reader.begin(id, pose, pose + 4, cameraId, name);
            uint64_t left = file.count("number of 2D points", sizeof(Observation), noPoint);
            while (left) {
                progress.check();
                some.resize(size_t(std::min<uint64_t>(left, 4096)));
                file.bytes(some.data(), some.size() * sizeof(Observation), "2D points");
                for (const Observation& o : some)
                    if (o.point != noPoint) reader.observe(view, o.x, o.y, o.point);
                left -= some.size();
            }
            reader.end(view);
        });
    }
    file.expectEnd();
}

void imagesFromText(const fs::path& path, const ColmapLimits& limits, ViewReader& reader, Progress& progress) {
    const std::string text = readBytes(path, limits.maxTextBytes);
    TextScanner scanner(text);
    size_t count = 0;
    while (const auto words = nextLine(scanner)) {
        progress.check();
        ColmapLine line(*words);
        const auto id = uint32_t(line.whole("image_id", 0xffffffff));
        withContext(fmt::format("image {}", id), [&] {
            if (++count > limits.maxViews) throw Error("there are more than {} images", limits.maxViews);
            double q[4], t[3];
            constexpr const char* fields[] = {"qw", "qx", "qy", "qz", "tx", "ty", "tz"};
            for (int i = 0; i < 7; ++i) (i < 4 ? q[i] : t[i - 4]) = line.number(fields[i]);
            const uint64_t cameraId = line.whole("camera_id", 0xffffffff);
            ColmapView view = reader.begin(id, q, t, cameraId, line.rest());
            // The line after it holds the 2D points, and is empty where there are none.
            TextScanner points(scanner.line());
            for (std::string_view word = points.word(); !word.empty(); word = points.word()) {
                const auto x = TextScanner::number(word), y = TextScanner::number(points.word());
                const auto point = TextScanner::integer(points.word());
                if (!x || !y || !point) throw Error("the line of 2D points holds something else than X Y POINT3D_ID");
                if (*point >= 0) reader.observe(view, *x, *y, uint64_t(*point));
            }
            reader.end(view);
        });
    }
}

}  // namespace

std::optional<fs::path> findColmapModel(const fs::path& folder) {
    if (isModel(folder)) return folder;
    for (const char* place : {"sparse", "colmap/sparse", "."}) {
        std::optional<fs::path> best;
        std::error_code failed;
        if (isModel(folder / place)) return folder / place;
        for (int i = 0; i < 100; ++i)
            if (fs::path one = folder / place / std::to_string(i);
                isModel(one) && (!best || weightOf(one) > weightOf(*best)))
                best = std::move(one);
        if (best) return best->lexically_normal();
    }
    return std::nullopt;
}

ColmapModel readColmapModel(const fs::path& folder, const ColmapLimits& limits, Progress& progress) {
    const auto pick = [&](const char* name) -> fs::path {
        for (const char* ending : {".bin", ".txt"})
            if (fs::path file = folder / (std::string(name) + ending); isFile(file)) return file;
        return {};
    };
    const fs::path cameraFile = pick("cameras"), imageFile = pick("images"), pointFile = pick("points3D");
    if (cameraFile.empty()) throw Error("{}: holds no cameras.bin or cameras.txt", folder.string());
    if (imageFile.empty()) throw Error("{}: holds no images.bin or images.txt", folder.string());
    const auto in = [](const fs::path& file, auto&& part) { return withContext(file.filename().string(), part); };
    const auto binary = [](const fs::path& file) { return file.extension() == ".bin"; };

    ColmapModel model;
    model.folder = folder;
    progress.begin("Reading the COLMAP model", 3);
    const Cameras cameras = in(cameraFile, [&] {
        return binary(cameraFile) ? camerasFromBinary(cameraFile, limits) : camerasFromText(cameraFile, limits);
    });
    model.cameras = cameras.size();
    progress.advance();
    Points points;
    if (!pointFile.empty())
        in(pointFile, [&] {
            binary(pointFile) ? pointsFromBinary(pointFile, limits, points, progress)
                              : pointsFromText(pointFile, limits, points, progress);
        });
    progress.advance();
    ViewReader reader(cameras, points, model);
    in(imageFile, [&] {
        binary(imageFile) ? imagesFromBinary(imageFile, limits, reader, progress)
                          : imagesFromText(imageFile, limits, reader, progress);
        if (model.views.empty()) throw Error("holds no image");
        std::sort(model.views.begin(), model.views.end(),
                  [](const ColmapView& a, const ColmapView& b) { return a.name < b.name; });
        for (size_t i = 1; i < model.views.size(); ++i)
            if (model.views[i].name == model.views[i - 1].name) throw Error("{} is there twice", model.views[i].name);
    });
    progress.advance();

    double sum = 0;
    size_t seen = 0;
    for (const PointSum& p : points.sums) {
        model.points.push_back(p.position);
        if (!p.seen) continue;
        sum += p.errors / p.seen;
        ++seen;
    }
    if (seen) model.errorPixels = sum / double(seen);
    if (points.stated) model.statedErrorPixels = points.statedErrors / double(points.stated);
    return model;
}

}  // namespace relamp
