#include "scan/scan.h"

#include "base/printable.h"
#include "base/statistics.h"
#include "image/image_io.h"

namespace relamp {
namespace {

constexpr size_t leastMatches = 100;

GreyImage readGrey(const std::filesystem::path& file, size_t maxPixels) {
    const Image image = readImage(file, nullptr, false, maxPixels);
    GreyImage grey{image.width, image.height, std::vector<float>(image.pixels.size())};
    for (size_t i = 0; i < grey.values.size(); ++i) grey.values[i] = luminance(image.pixels[i]);
    return grey;
}

std::array<int, 2> sizeOf(const ScanOptions& options, const ScanCalibration& calibration, const ScanBits& bits) {
    std::array<int, 2> size = options.projectorSize;
    if (size[0] <= 0 && calibration.projector) size = {calibration.projector->width, calibration.projector->height};
    for (size_t axis : {size_t(0), size_t(1)}) {
        if (size[axis] <= 0) size[axis] = 1 << bits[axis];
        if (size[axis] > 1 << bits[axis])
            throw Error("a projector of {} x {} pixels has more than the {} and {} bits can tell apart", size[0],
                        size[1], bits[0], bits[1]);
    }
    return size;
}

void noteLost(ScanResult& result, const ScanCameraFigures& camera) {
    if (!camera.lost.absent.empty()) {
        std::string names;
        for (size_t place : camera.lost.absent) names += (names.empty() ? "" : "; ") + nameOfPlace(result.bits, place);
        result.notes.push_back(
            fmt::format("{}: {} missing: {}", camera.name, counted(camera.lost.absent.size(), "photograph"), names));
    }
    for (int axis : {0, 1})
        for (int bit : camera.lost.bits[size_t(axis)])
            result.notes.push_back(fmt::format(
                "{}: bit {} of the {} axis has neither pattern nor inverse: codes along it are exact to {} pixels of "
                "the projector before the fit",
                camera.name, bit + 1, axis == 0 ? "first" : "second", 1 << (result.bits[size_t(axis)] - bit)));
}

void decodeAll(const ScanCalibration& calibration, const ScanInput& input, const ScanOptions& options,
               ScanResult& result, Progress& progress) {
    DecodeOptions decode = options.decode;
    decode.projectorSize = result.projectorSize;
    for (size_t c = 0; c < input.size(); ++c) {
        const ScanCamera& camera = calibration.cameras[c];
        withContext(camera.name, [&] {
            DecodedView view = decodePatterns(input[c], decode, progress);
            if (view.width != camera.camera.width || view.height != camera.camera.height)
                throw Error("photographs are {} x {} pixels, the calibration is for {} x {}", view.width, view.height,
                            camera.camera.width, camera.camera.height);
            if (view.decoded == 0) throw Error("no pixel's code can be read: are the photographs in order?");
            result.views.push_back(std::move(view));
        });
        const DecodedView& view = result.views.back();
        ScanCameraFigures figures;
        figures.name = camera.name;
        figures.pixels = view.places.size();
        figures.lit = view.lit;
        figures.decoded = view.decoded;
        figures.coarse = view.coarse;
        figures.photographNoise = view.noise;
        figures.global = view.global;
        figures.slope = view.slope;
        figures.lost = view.lost;
        noteLost(result, figures);
        result.cameras.push_back(std::move(figures));
    }
}

/// Triangulates every camera; figures of pairs go to the cameras.
void triangulate(const std::vector<RangeSource>& sources, const ScanOptions& options, ScanResult& result,
                 Progress& progress) {
    result.ranges.clear();
    const Camera* projector = result.projector ? &*result.projector : nullptr;
    for (size_t c = 0; c < sources.size(); ++c) {
        std::vector<PairFigures> pairs;
        result.ranges.push_back(measureRange(sources, c, projector, {options.mostGap}, pairs, progress));
        ScanCameraFigures& camera = result.cameras[c];
        camera.matched = 0;
        camera.medianGap = 0;
        for (size_t other = 0; other < sources.size(); ++other)
            if (pairs[other].used > camera.matched) {
                camera.matched = pairs[other].used;
                camera.medianGap = pairs[other].medianGap;
            }
        camera.projectorGap = pairs.back().medianGap;
        camera.points = result.ranges.back().count();
    }
}

/// The projector from the points of the camera that has most.
void calibrateProjector(ScanResult& result, const ScanCalibration& calibration, Progress& progress) {
    size_t best = 0;
    for (size_t c = 1; c < result.cameras.size(); ++c)
        if (result.cameras[c].matched > result.cameras[best].matched) best = c;
    const RangeImage& range = result.ranges[best];
    const DVec3 eye = calibration.cameras[best].camera.position();
    std::vector<SeenPoint> points;
    for (size_t i = 0; i < range.distance.size(); ++i)
        if (range.distance[i] > 0)
            points.push_back(
                {eye + double(range.distance[i]) * range.directions[i], glm::dvec2(result.views[best].places[i])});
    result.resection = resect(points, result.projectorSize[0], result.projectorSize[1], progress);
    if (!result.resection.camera) {
        result.notes.push_back("the projector is not calibrated: " + result.resection.reason);
        return;
    }
    // Codes that a fit misses by pixels are not those of a projector with a lens.
    if (result.resection.median > 4) {
        result.notes.push_back(
            fmt::format("the projector is not calibrated: half of the points miss their codes by {:.1f} "
                        "pixels or more",
                        result.resection.median));
        return;
    }
    result.projector = result.resection.camera;
    result.projectorFrom = ProjectorFrom::resection;
}

}  // namespace

ScanInput openScan(const ScanCalibration& calibration, ScanOptions& options,
                   std::vector<ScanPhotographs>& photographs) {
    std::vector<std::filesystem::path> folders;
    for (const ScanCamera& camera : calibration.cameras) folders.push_back(camera.folder);
    photographs = findScanPhotographs(folders, options.bits);
    ScanInput input;
    for (size_t c = 0; c < photographs.size(); ++c) {
        PatternStack stack;
        stack.bits = options.bits;
        for (const auto& file : photographs[c].files) stack.there.push_back(!file.empty());
        const Camera& camera = calibration.cameras[c].camera;
        stack.pixels = size_t(camera.width) * size_t(camera.height);
        for (const auto& file : photographs[c].files) {
            if (file.empty()) continue;
            const auto [width, height] = readImageSize(file);
            if (width != camera.width || height != camera.height)
                throw Error("{}: is {} x {} pixels, the calibration of '{}' says {} x {}", file.string(), width, height,
                            calibration.cameras[c].name, camera.width, camera.height);
        }
        stack.read = [files = photographs[c].files, most = options.maxPixels](size_t place) {
            return readGrey(files[place], most);
        };
        input.push_back(std::move(stack));
    }
    return input;
}

ScanResult scanSurface(const ScanCalibration& calibration, const ScanInput& input, const ScanOptions& options,
                       Progress& progress) {
    if (input.size() == 1 && !calibration.projector)
        throw Error("one camera alone needs a calibrated projector: `projector` in cameras.json");
    const double began = progress.seconds();
    ScanResult result;
    result.bits = input.front().bits;
    result.projectorSize = sizeOf(options, calibration, result.bits);
    decodeAll(calibration, input, options, result, progress);

    std::vector<CodeIndex> indices;
    indices.reserve(result.views.size());
    for (const DecodedView& view : result.views) indices.emplace_back(view, result.projectorSize);
    std::vector<RangeSource> sources;
    for (size_t c = 0; c < input.size(); ++c)
        sources.push_back({&calibration.cameras[c].camera, &result.views[c], &indices[c]});
    result.projector = calibration.projector;
    if (result.projector) result.projectorFrom = ProjectorFrom::calibration;
    triangulate(sources, options, result, progress);
    size_t matched = 0;
    for (const ScanCameraFigures& camera : result.cameras) matched = std::max(matched, camera.matched);
    if (input.size() > 1 && matched < leastMatches && !result.projector)
        throw Error(
            "{} of one camera see what another sees, expected {} or more: are the photographs in order, and of "
            "one scan?",
            counted(matched, "pixel"), leastMatches);
    if (!result.projector) {
        calibrateProjector(result, calibration, progress);
        if (result.projector) triangulate(sources, options, result, progress);
    }
    std::vector<RangeView> views;
    for (size_t c = 0; c < input.size(); ++c) {
        RangeImage& range = result.ranges[c];
        const Camera& camera = calibration.cameras[c].camera;
        const Smoothing smoothing = smoothRange(range, camera, 2, options.mesh.slope, progress);
        result.cameras[c].noise = smoothing.noise;
        result.cameras[c].filled = smoothing.filled;
        result.cameras[c].points = range.count() - smoothing.filled;
        views.push_back({&camera, &range, result.cameras[c].noise});
    }
    result.mesh = meshRanges(views, options.mesh, progress);
    result.seconds = progress.seconds() - began;
    return result;
}

}  // namespace relamp
