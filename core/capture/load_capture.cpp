#include "capture/load_capture.h"

#include "base/parallel.h"
#include "capture/brackets.h"
#include "capture/colmap_brackets.h"
#include "capture/colmap.h"
#include "capture/transforms_json.h"
#include "scene/mesh_io.h"
#include "scene/smooth_normals.h"

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

/// A place the user names: in the capture folder, in the current one, or absolute.
fs::path placeOf(const fs::path& folder, const std::string& named) {
    std::error_code ignored;
    if (fs::path(named).is_absolute() || fs::exists(folder / named, ignored)) return folder / named;
    return fs::exists(named, ignored) ? fs::path(named) : folder / named;
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

/// One photograph before it is read.
struct FrameSource {
    std::string where;   ///< for errors: "transforms.json: frame 3"
    std::string name;
    fs::path file;
    Camera camera;
    std::vector<Exposure> exposures;
    bool fitSize = false;  ///< a picture of the same shape and another size scales the camera
};

/// What the files say before pictures and mesh are opened.
struct CaptureSource {
    std::string where = "transforms.json";   ///< for errors
    std::vector<FrameSource> frames;
    fs::path mesh;
    Vec3 up{0, 0, 1};
    std::vector<std::string> notes;
    std::optional<ReconstructionFigures> reconstruction;
    std::vector<DVec3> points;
};

CaptureSource fromTransforms(const fs::path& folder, const CaptureFix& fix) {
    const fs::path file = folder / "transforms.json";
    if (!isFile(file)) throw Error("{}: does not exist", file.string());
    const auto pictures = [&](const std::string& filePath) { return findPicture(fix.images.empty() ? folder : placeOf(folder, fix.images), filePath); };
    Transforms transforms = readTransforms(file, [&](const std::string& filePath) { return readImageSize(pictures(filePath)); });
    CaptureSource source;
    source.notes = std::move(transforms.notes);
    source.up = transforms.up;
    source.mesh = fix.mesh.empty() ? findMesh(folder, transforms.meshPath) : placeOf(folder, fix.mesh);
    for (size_t i = 0; i < transforms.frames.size(); ++i) {
        TransformsFrame& frame = transforms.frames[i];
        const std::string& name = frame.filePath.empty() ? frame.exposures[0].filePath : frame.filePath;
        source.frames.push_back({fmt::format("transforms.json: frame {}", i), name, pictures(name), frame.camera, std::move(frame.exposures)});
    }
    return source;
}

/// The mesh of a COLMAP capture by the names its own tools give.
fs::path findColmapMesh(const fs::path& folder, const fs::path& model) {
    for (const fs::path& place : {folder, folder / "dense", folder / "dense/0", model, model / "..", model / "../.."})
        for (const char* name : {"mesh.ply", "mesh.obj", "mesh.stl", "mesh.off", "meshed-poisson.ply", "meshed-delaunay.ply"})
            if (isFile(place / name)) return (place / name).lexically_normal();
    throw Error("{}: holds no mesh (mesh.ply, mesh.obj, meshed-poisson.ply, dense/meshed-delaunay.ply ...), name it with --mesh", folder.string());
}

fs::path findColmapPictures(const fs::path& folder, const fs::path& model, const std::string& first) {
    for (const fs::path& place : {folder / "images", folder, model / "images", model / "../images", model / "../../images"})
        if (isFile(place / first)) return place.lexically_normal();
    throw Error("{}: no folder with {} is found (images, ../images, ../../images), name it with --images", folder.string(), first);
}

CaptureSource fromColmap(const fs::path& folder, const fs::path& modelFolder, const CaptureFix& fix, Progress& progress) {
    const ColmapModel model = withContext(modelFolder.string(), [&] { return readColmapModel(modelFolder, {}, progress); });
    CaptureSource source;
    source.where = modelFolder.string();
    source.mesh = fix.mesh.empty() ? findColmapMesh(folder, modelFolder) : placeOf(folder, fix.mesh);
    const fs::path pictures = fix.images.empty() ? findColmapPictures(folder, modelFolder, model.views[0].name) : placeOf(folder, fix.images);
    std::vector<Camera> cameras;
    for (const ColmapView& view : model.views) cameras.push_back(view.camera);
    for (const ColmapBracket& b : colmapBrackets(pictures, model.views))
        source.frames.push_back({b.view.name, b.view.name, findPicture(pictures, b.view.name), b.view.camera, b.exposures, true});
    if (source.frames.size() < model.views.size())
        source.notes.push_back(fmt::format("{} images are exposures of views that the model holds already; of each view the pose of the exposure nearest to +0 stops counts.", model.views.size() - source.frames.size()));
    source.up = Vec3(guessUp(cameras).value_or(DVec3(0, 0, 1)));
    // An axis within two degrees is meant.
    for (int c = 0; c < 3; ++c)
        if (std::abs(source.up[c]) > 0.9994f) {
            Vec3 axis(0);
            axis[c] = source.up[c] < 0 ? -1.0f : 1.0f;
            source.up = axis;
        }
    source.notes.push_back(fmt::format("{}: {} cameras, {} images, {} points; reprojection error {:.3f} pixels (the model says {:.3f}).", modelFolder.string(), model.cameras,
                                       model.views.size(), model.points.size(), model.errorPixels, model.statedErrorPixels));
    if (fix.up.empty()) source.notes.push_back(fmt::format("COLMAP does not say what is up: {} is taken, from how the cameras were held; --up says otherwise.", nameFromAxis(source.up)));
    source.reconstruction = {model.points.size(), model.observations, model.errorPixels, model.statedErrorPixels, model.behind};
    const size_t stride = std::max<size_t>(1, model.points.size() / 20000);
    for (size_t i = 0; i < model.points.size(); i += stride) source.points.emplace_back(model.points[i]);
    return source;
}

/// Whether the frames' exposures are to be merged: asked for, or there is no HDR picture to read instead.
bool wantsBrackets(const CaptureSource& source, const CaptureFix& fix) {
    size_t with = 0;
    bool wanted = fix.fromBrackets;
    for (const FrameSource& frame : source.frames) {
        with += !frame.exposures.empty();
        const std::string ending = frame.file.extension().string();
        const bool hdr = ending == ".exr" || ending == ".hdr" || ending == ".EXR" || ending == ".HDR";
        if (frame.exposures.size() >= 2 && (!hdr || !isFile(frame.file))) wanted = true;
    }
    if (!wanted) return false;
    if (with == 0) throw Error("{}: no frame has exposures, so there are no brackets to merge", source.where);
    for (const FrameSource& frame : source.frames)
        if (frame.exposures.empty()) throw Error("{}: exposures is missing, though other frames are merged from brackets: one scale for all needs them", frame.where);
    return true;
}

std::vector<Bracket> bracketsOf(const fs::path& folder, const CaptureSource& source, const CaptureFix& fix) {
    std::vector<Bracket> sets;
    ExposureReference reference;
    for (const FrameSource& frame : source.frames) {
        Bracket set;
        for (size_t i = 0; i < frame.exposures.size(); ++i) {
            const Exposure& e = frame.exposures[i];
            const fs::path named = e.filePath;
            const fs::path file = named.is_absolute() ? named : findPicture(fix.images.empty() ? folder : placeOf(folder, fix.images), e.filePath);
            set.push_back(withContext(fmt::format("{}: exposures entry {}", frame.where, i), [&] {
                // What the capture says wins; EXIF is asked only where it says nothing of the time.
                const ExposureTags tags = e.seconds > 0 ? ExposureTags{e.seconds, e.aperture, e.iso} : readExposureTags(file);
                BracketPhoto photo = bracketPhoto(file, tags, reference);
                std::error_code unknown;
                photo.reference = fs::equivalent(file, frame.file, unknown);
                return photo;
            }));
        }
        sets.push_back(std::move(set));
    }
    return sets;
}

void checkSize(const Image& image, View& view, const FrameSource& frame, std::vector<std::string>& notes) {
    Camera& camera = view.camera;
    if (image.width == camera.width && image.height == camera.height) return;
    const double sx = double(image.width) / camera.width, sy = double(image.height) / camera.height;
    if (frame.fitSize && std::abs(camera.width * sy - image.width) <= 1.5) {
        camera.focalX *= sx, camera.centreX *= sx;
        camera.focalY *= sy, camera.centreY *= sy;
        notes.push_back(fmt::format("{}: is {} x {} pixels, the model's camera {} x {}; the camera was scaled.", view.name, image.width, image.height, camera.width, camera.height));
        camera.width = image.width, camera.height = image.height;
        return;
    }
    throw Error("{}: is {} x {} pixels, w and h say {} x {}", view.file.string(), image.width, image.height, camera.width, camera.height);
}

/// Counted from `origin`, and with a hundredth of the mesh's diagonal for a radius of 0.
std::vector<ProxyLight> placedProxies(std::vector<ProxyLight> proxies, const Mesh& mesh, const DVec3& origin) {
    Vec3 low(1e30f), high(-1e30f);
    for (const Triangle& t : mesh.triangles)
        for (uint32_t v : t) {
            low = glm::min(low, mesh.positions[v]);
            high = glm::max(high, mesh.positions[v]);
        }
    for (ProxyLight& p : proxies) {
        p.centre -= origin;
        if (p.radius == 0) p.radius = 0.01f * glm::length(high - low);
    }
    return proxies;
}

}  // namespace

Capture loadCapture(const fs::path& folder, const LoadOptions& options, Progress& progress) {
    std::error_code ignored;
    if (!fs::is_directory(folder, ignored)) throw Error("{}: is not a folder", folder.string());
    const CaptureFix& fix = options.fix;
    const std::optional<fs::path> colmap = !fix.colmap.empty()                     ? std::optional(placeOf(folder, fix.colmap))
                                           : !isFile(folder / "transforms.json") ? findColmapModel(folder)
                                                                                  : std::nullopt;
    progress.begin(colmap ? "Reading the COLMAP model" : "Reading transforms.json", 1);
    CaptureSource source = colmap ? fromColmap(folder, *colmap, fix, progress) : fromTransforms(folder, fix);

    Capture capture;
    capture.folder = folder;
    capture.notes = std::move(source.notes);
    capture.reconstruction = source.reconstruction;
    capture.points = std::move(source.points);
    progress.begin("Reading the mesh", 1);
    capture.mesh = readMesh(source.mesh, &capture.meshReport);
    const Vec3 up = fix.up.empty() ? source.up : axisFromName(fix.up);

    const size_t count = source.frames.size();
    capture.views.resize(count);
    std::vector<std::vector<std::string>> notes(count);
    std::vector<Bracket> sets;
    if (options.images && wantsBrackets(source, fix)) sets = bracketsOf(folder, source, fix);
    BracketOptions bracketOptions;
    bracketOptions.maxPixels = options.maxPixels;
    const ResponseCurve response = sets.empty() ? ResponseCurve{} : responseOf(sets, bracketOptions, progress);
    if (!sets.empty())
        capture.notes.push_back(response.linear ? "Brackets are linear (camera raw) and were merged as they are."
                                                : fmt::format("Brackets were merged with one response curve for all views, from {} places.", response.samples));

    const auto readView = [&](size_t i) {
        const FrameSource& frame = source.frames[i];
        View& view = capture.views[i];
        view.name = frame.name;
        view.file = frame.file;
        view.camera = frame.camera;
        if (!options.images) {
            if (frame.fitSize && isFile(view.file)) {
                const auto [width, height] = readImageSize(view.file);
                Image shape;  // no pixels, because none are asked for
                shape.width = width, shape.height = height;
                checkSize(shape, view, frame, notes[i]);
            }
            return;
        }
        withContext(frame.where, [&] {
            if (!sets.empty()) {
                MergedBracket merged = mergeBracket(sets[i], response, bracketOptions, progress);
                view.image = std::move(merged.image);
                view.imageReport.integer = true;
                view.saturation = merged.saturation;
                if (!merged.shifts.empty()) {
                    int most = 0;
                    for (const PixelShift& s : merged.shifts) most = std::max({most, std::abs(s.x), std::abs(s.y)});
                    notes[i].push_back(fmt::format("{}: hand-held exposures were shifted by up to {} pixels.", view.name, most));
                }
                if (merged.ghosts) notes[i].push_back(fmt::format("{}: {} pixels changed between the exposures and are left out.", view.name, merged.ghosts));
                if (merged.clippedPixels) notes[i].push_back(fmt::format("{}: {} pixels are clipped in the shortest exposure.", view.name, merged.clippedPixels));
            } else {
                view.image = readImage(view.file, &view.imageReport, false, options.maxPixels);
                view.saturation = clippedShare * view.imageReport.clipLevel;
            }
            checkSize(view.image, view, frame, notes[i]);
            size_t masked = 0;
            for (const fs::path& mask : masksOf(folder, view.file)) masked += applyMask(view.image, mask, options.maxPixels);
            describe(view, masked, notes[i]);
        });
    };
    if (sets.empty()) {
        progress.begin(options.images ? "Reading photographs" : "Reading cameras", count);
        parallelFor(count, 1, readView, &progress);
    } else {
        for (size_t i = 0; i < count; ++i) readView(i);  // each is merged on all cores
    }
    orientCapture(capture, up, fix);
    capture.proxies = placedProxies(fix.proxies, capture.mesh, capture.origin);
    if (fix.smoothNormals > 0) capture.mesh.normals = smoothedNormals(capture.mesh, fix.smoothNormals);
    addProxies(capture.proxies, capture.mesh);
    for (const auto& sentences : notes) capture.notes.insert(capture.notes.end(), sentences.begin(), sentences.end());
    return capture;
}

}  // namespace relamp
