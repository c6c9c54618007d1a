#include "capture/load_capture.h"

#include "base/parallel.h"
#include "capture/transforms_json.h"
#include "scene/mesh_io.h"

namespace relamp {
namespace fs = std::filesystem;
namespace {

bool isFile(const fs::path& file) {
    std::error_code ignored;
    return fs::is_regular_file(file, ignored);
}

/// The picture a file_path names: relative to the capture folder, backslashes allowed, and, as in some NeRF data sets,
/// without its ending. Where nothing is found the path is returned as written, for the error message.
fs::path findPicture(const fs::path& folder, const std::string& filePath) {
    const fs::path plain = folder / filePath;
    if (isFile(plain)) return plain;
    std::string slashes = filePath;
    std::replace(slashes.begin(), slashes.end(), '\\', '/');
    for (const fs::path& base : {plain, folder / slashes}) {
        if (isFile(base)) return base;
        for (const char* ending : {".exr", ".hdr", ".png", ".jpg", ".jpeg", ".tif", ".tiff"})
            if (const fs::path named = base.string() + ending; isFile(named)) return named;
    }
    return plain;
}

fs::path findMesh(const fs::path& folder, const std::string& meshPath) {
    if (!meshPath.empty()) {
        if (isFile(folder / meshPath)) return folder / meshPath;
        throw Error("transforms.json: mesh_path names {}, which does not exist", (folder / meshPath).string());
    }
    for (const char* name : {"mesh.ply", "mesh.obj", "mesh.stl", "mesh.off"})
        if (isFile(folder / name)) return folder / name;
    throw Error("transforms.json: mesh_path is missing, and {} holds no mesh.ply, mesh.obj, mesh.stl or mesh.off", folder.string());
}

/// Mask files that belong to a picture by convention, black is ignored.
std::vector<fs::path> masksOf(const fs::path& folder, const fs::path& picture) {
    const std::string name = picture.filename().string(), stem = picture.stem().string();
    std::vector<fs::path> found;
    for (const fs::path& mask : {folder / "masks" / (name + ".png"), picture.parent_path() / "masks" / (name + ".png"),
                                 picture.parent_path() / (stem + "_mask.png")})
        if (isFile(mask)) found.push_back(mask);
    return found;
}

size_t applyMask(Image& image, const fs::path& file, size_t maxPixels) {
    const Image mask = readImage(file, nullptr, true, maxPixels);
    if (mask.width != image.width || mask.height != image.height)
        throw Error("{}: is {} x {} pixels, its picture is {} x {}", file.string(), mask.width, mask.height, image.width, image.height);
    if (image.usable.empty()) image.usable.assign(image.pixels.size(), 1);
    size_t masked = 0;
    for (size_t i = 0; i < mask.pixels.size(); ++i)
        if (image.usable[i] && maxChannel(mask.pixels[i]) < 0.5f) {
            image.usable[i] = 0;
            ++masked;
        }
    return masked;
}

/// Share of full scale from which an integer file counts as clipped: encoders round the last codes.
constexpr float clippedShare = 0.99f;

void describe(const View& view, size_t masked, std::vector<std::string>& notes) {
    const ImageReport& r = view.imageReport;
    if (r.nan + r.infinite + r.negative > 0)
        notes.push_back(fmt::format("{}: {} NaN, {} infinite and {} negative pixels are left out.", view.name, r.nan, r.infinite, r.negative));
    if (r.transparent) notes.push_back(fmt::format("{}: {} transparent pixels are left out.", view.name, r.transparent));
    if (masked) notes.push_back(fmt::format("{}: {} pixels are masked.", view.name, masked));
    size_t usable = 0, lit = 0, clipped = 0;
    for (size_t i = 0; i < view.image.pixels.size(); ++i) {
        if (!view.image.usable.empty() && !view.image.usable[i]) continue;
        ++usable;
        const float brightest = maxChannel(view.image.pixels[i]);
        lit += brightest > 0;
        clipped += view.saturation > 0 && brightest >= view.saturation;
    }
    if (usable == 0) notes.push_back(fmt::format("{}: every pixel is left out.", view.name));
    else if (lit == 0) notes.push_back(fmt::format("{}: is black all over.", view.name));
    else if (clipped == usable) notes.push_back(fmt::format("{}: is clipped all over.", view.name));
}

}  // namespace

Capture loadCapture(const fs::path& folder, const LoadOptions& options, Progress& progress) {
    progress.begin("Reading transforms.json", 1);
    std::error_code ignored;
    if (!fs::is_directory(folder, ignored)) throw Error("{}: is not a folder", folder.string());
    const fs::path file = folder / "transforms.json";
    if (!isFile(file)) throw Error("{}: does not exist", file.string());
    const Transforms transforms =
        readTransforms(file, [&](const std::string& filePath) { return readImageSize(findPicture(folder, filePath)); });

    Capture capture;
    capture.folder = folder;
    capture.notes = transforms.notes;
    progress.begin("Reading the mesh", 1);
    capture.mesh = readMesh(findMesh(folder, transforms.meshPath), &capture.meshReport);
    const Vec3 up = options.fix.up.empty() ? transforms.up : axisFromName(options.fix.up);

    const size_t count = transforms.frames.size();
    capture.views.resize(count);
    std::vector<std::vector<std::string>> notes(count);
    progress.begin(options.images ? "Reading photographs" : "Reading cameras", count);
    parallelFor(
        count, 1,
        [&](size_t i) {
            const TransformsFrame& frame = transforms.frames[i];
            View& view = capture.views[i];
            view.name = frame.filePath;
            view.file = findPicture(folder, frame.filePath);
            view.camera = frame.camera;
            if (!options.images) return;
            withContext(fmt::format("transforms.json: frame {}", i), [&] {
                view.image = readImage(view.file, &view.imageReport, false, options.maxPixels);
                if (view.image.width != view.camera.width || view.image.height != view.camera.height)
                    throw Error("{}: is {} x {} pixels, w and h say {} x {}", view.file.string(), view.image.width, view.image.height,
                                view.camera.width, view.camera.height);
                size_t masked = 0;
                for (const fs::path& mask : masksOf(folder, view.file)) masked += applyMask(view.image, mask, options.maxPixels);
                view.saturation = clippedShare * view.imageReport.clipLevel;
                describe(view, masked, notes[i]);
            });
        },
        &progress);
    orientCapture(capture, up, options.fix.flipCameras);
    for (const auto& sentences : notes) capture.notes.insert(capture.notes.end(), sentences.begin(), sentences.end());
    return capture;
}

}  // namespace relamp
