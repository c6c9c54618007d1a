#include "capture/photograph_reader.h"

#include "base/is_there.h"
#include "scene/mesh_io.h"

namespace relamp {
namespace fs = std::filesystem;
namespace {

/// Whether something has this name, be it a folder, a link that leads nowhere or closed to this user: a mask that is
/// there and cannot be read is no mask that is missing.
bool isNamed(const fs::path& file) {
    std::error_code failed;
    return fs::exists(fs::symlink_status(file, failed)) || failed == std::errc::permission_denied;
}

/// Mask files that belong to an image, because the file of the cameras names them or by convention; black is ignored.
std::vector<fs::path> masksOf(const fs::path& folder, const FrameSource& frame) {
    const fs::path& image = frame.file;
    const std::string name = image.filename().string(), stem = image.stem().string();
    std::vector<fs::path> found;
    if (!frame.mask.empty()) found.push_back(frame.mask);
    for (const fs::path& mask : {folder / "masks" / (name + ".png"), image.parent_path() / "masks" / (name + ".png"),
                                 image.parent_path() / (stem + "_mask.png")})
        if (isNamed(mask) && mask.lexically_normal() != frame.mask.lexically_normal()) found.push_back(mask);
    return found;
}

size_t applyMask(Image& image, const fs::path& file, size_t maxPixels, const Progress& progress) {
    const Image mask = readImage(file, nullptr, true, maxPixels, [&] { progress.check(); });
    if (mask.width != image.width || mask.height != image.height)
        throw Error("{}: is {} x {} pixels, its image is {} x {}", file.string(), mask.width, mask.height, image.width,
                    image.height);
    if (image.usable.empty()) image.usable.assign(image.pixels.size(), 1);
    size_t masked = 0;
    for (size_t i = 0; i < mask.pixels.size(); ++i)
        if (image.usable[i] && maxChannel(mask.pixels[i]) < 0.5f) {
            image.usable[i] = 0;
            ++masked;
        }
    return masked;
}

/// Fraction of full scale from which an integer file counts as clipped: encoders round the last codes.
constexpr float clippedFraction = 0.99f;

void describe(const View& view, size_t masked, std::vector<std::string>& notes) {
    const ImageReport& r = view.imageReport;
    if (r.nan + r.infinite + r.negative > 0)
        notes.push_back(fmt::format("{}: {} NaN, {} infinite and {} negative pixels are left out.", view.name, r.nan,
                                    r.infinite, r.negative));
    if (r.transparent)
        notes.push_back(fmt::format("{}: {} transparent pixels are left out.", view.name, r.transparent));
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

/// Whether the frames' exposures are to be merged: asked for, or there is no HDR image to read instead.
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
        if (frame.exposures.empty())
            throw Error(
                "{}: exposures is missing, though other frames are merged from brackets: one scale for all needs them",
                frame.where);
    return true;
}

fs::path exposureFile(const fs::path& folder, const Exposure& exposure, const CaptureFix& fix) {
    const fs::path named = exposure.filePath;
    if (named.is_absolute()) return named;
    return findImage(fix.images.empty() ? folder : placeOf(folder, fix.images), exposure.filePath);
}

std::vector<Bracket> bracketsOf(const fs::path& folder, const CaptureSource& source, const CaptureFix& fix) {
    std::vector<Bracket> sets;
    ExposureReference reference;
    for (const FrameSource& frame : source.frames) {
        Bracket set;
        for (size_t i = 0; i < frame.exposures.size(); ++i) {
            const Exposure& e = frame.exposures[i];
            const fs::path file = exposureFile(folder, e, fix);
            set.push_back(withContext(fmt::format("{}: exposures entry {}", frame.where, i), [&] {
                // What the capture says wins; EXIF is asked only where it says nothing of the time.
                const ExposureTags tags =
                    e.seconds > 0 ? ExposureTags{e.seconds, e.aperture, e.iso} : readExposureTags(file);
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
        notes.push_back(fmt::format("{}: is {} x {} pixels, the model's camera {} x {}; the camera was scaled.",
                                    view.name, image.width, image.height, camera.width, camera.height));
        camera.width = image.width, camera.height = image.height;
        return;
    }
    throw Error("{}: is {} x {} pixels, w and h say {} x {}", view.file.string(), image.width, image.height,
                camera.width, camera.height);
}

View withoutPixels(const FrameSource& frame) {
    View view;
    view.name = frame.name;
    view.file = frame.file;
    view.camera = frame.camera;
    view.state = frame.stateIndex;
    return view;
}

}  // namespace

InputFiles captureFiles(const fs::path& folder, const CaptureFix& fix, Progress& progress) {
    const CaptureSource source = captureSource(folder, fix, progress);
    InputFiles files;
    if (isFile(source.cameras)) files.add(source.cameras);
    else files.addFolder(source.cameras);
    for (const fs::path& file : source.otherFiles) files.add(file);
    files.add(source.mesh);
    for (const fs::path& file : filesBesideMesh(source.mesh)) files.add(file);
    for (const FrameSource& frame : source.frames) {
        files.add(frame.file);
        for (const Exposure& exposure : frame.exposures) files.add(exposureFile(folder, exposure, fix));
        for (const fs::path& mask : masksOf(folder, frame)) files.add(mask);
    }
    return files;
}

PhotographReader::PhotographReader(const fs::path& folder, const LoadOptions& options, Progress& progress)
    : PhotographReader(captureSource(folder, options.fix, progress), folder, options, progress) {}

PhotographReader::PhotographReader(CaptureSource source, const fs::path& folder, const LoadOptions& options,
                                   Progress& progress)
    : folder_(folder), options_(options), source_(std::move(source)) {
    bracketOptions_.maxPixels = options.maxPixels;
    if (!options.images || !wantsBrackets(source_, options.fix)) return;
    sets_ = bracketsOf(folder, source_, options.fix);
    response_ = responseOf(sets_, bracketOptions_, progress);
    notes_.push_back(response_.linear
                         ? "Brackets are linear (camera raw) and were merged as they are."
                         : fmt::format("Brackets were merged with one response curve for all views, from {} places.",
                                       response_.samples));
}

View PhotographReader::readCamera(size_t i, std::vector<std::string>& notes) const {
    const FrameSource& frame = source_.frames.at(i);
    View view = withoutPixels(frame);
    if (!frame.fitSize || !isFile(view.file)) return view;
    const auto [width, height] = readImageSize(view.file);
    Image shape;  // no pixels, because none are asked for
    shape.width = width, shape.height = height;
    checkSize(shape, view, frame, notes);
    return view;
}

View PhotographReader::read(size_t i, std::vector<std::string>& notes, Progress& progress) const {
    const FrameSource& frame = source_.frames.at(i);
    View view = withoutPixels(frame);
    withContext(frame.where, [&] {
        if (merges()) {
            MergedBracket merged = mergeBracket(sets_[i], response_, bracketOptions_, progress);
            view.image = std::move(merged.image);
            view.imageReport.integer = true;
            view.saturation = merged.saturation;
            if (!merged.shifts.empty()) {
                int most = 0;
                for (const PixelShift& s : merged.shifts) most = std::max({most, std::abs(s.x), std::abs(s.y)});
                notes.push_back(
                    fmt::format("{}: hand-held exposures were shifted by up to {} pixels.", view.name, most));
            }
            if (merged.ghosts)
                notes.push_back(fmt::format("{}: {} pixels changed between the exposures and are left out.", view.name,
                                            merged.ghosts));
            if (merged.clippedPixels)
                notes.push_back(fmt::format("{}: {} pixels are clipped in the shortest exposure.", view.name,
                                            merged.clippedPixels));
        } else {
            view.image = readImage(view.file, &view.imageReport, false, options_.maxPixels, [&] { progress.check(); });
            view.saturation = clippedFraction * view.imageReport.clipLevel;
        }
        checkSize(view.image, view, frame, notes);
        size_t masked = 0;
        for (const fs::path& mask : masksOf(folder_, frame))
            masked += applyMask(view.image, mask, options_.maxPixels, progress);
        describe(view, masked, notes);
        applyPhotometric(options_.fix.photometric, view);
    });
    return view;
}

}  // namespace relamp
