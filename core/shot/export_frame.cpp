#include "shot/export_frame.h"

#include <cctype>
#include <optional>

#include "base/log.h"
#include "display/display_image.h"
#include "relight/model_confidence.h"
#include "shot/other_photographs.h"

namespace relamp {
namespace {

constexpr size_t pixelsInStrip = size_t(1) << 19;

int stripRowsOf(int width) { return std::max(16, int(pixelsInStrip / size_t(width)) / 16 * 16); }

std::string extensionOf(const std::filesystem::path& file) {
    std::string extension = file.extension().string();
    for (char& c : extension) c = char(std::tolower(static_cast<unsigned char>(c)));
    return extension;
}

std::string numbersOf(const DMat4& m) {
    std::string text;
    for (int c = 0; c < 4; ++c)
        for (int r = 0; r < 4; ++r) text += fmt::format("{}{}", text.empty() ? "" : " ", m[c][r]);
    return text;
}

/// Follows beauty against groups over the strips of a frame.
struct GroupCheck {
    bool detail = false;  ///< the beauty is a relit photograph
    double worst = 0, brightest = 1e-12;
    void add(FrameStrip& strip) {
        worst = std::max(worst, closeGroups(strip, detail));
        for (const Rgb& b : strip.frame.beauty) brightest = std::max(brightest, double(maxChannel(b)));
    }
    double relative() const { return worst / brightest; }
};

using RowsOf = std::function<FrameStrip(int first, int count)>;

std::vector<std::string> namesOf(const RelitScene& relit) {
    std::vector<std::string> names;
    for (const RelitEmitter& e : relit.emitters) names.push_back(e.name);
    return names;
}

double writeLayers(const std::filesystem::path& file, const Camera& camera, const FrameLayers& layers,
                   const FrameFileOptions& options, const RowsOf& rowsOf, const std::function<void()>& between = {},
                   const std::optional<ImageBox>& region = {}) {
    std::map<std::string, std::string> header = options.header;
    Camera placed = camera;
    placed.worldFromCamera[3] += glm::dvec4(layers.origin(), 0);
    header.merge(cameraHeader(placed));
    header.merge(layers.header());
    header.emplace("Software", "relamp " RELAMP_VERSION);
    GroupCheck groups{options.ratio != Ratio::none};
    header["compression"] = options.exr.compression;
    std::vector<ChannelPart> parts = layers.parts(options.multipart);
    if (options.exr.floats)
        for (ChannelPart& part : parts)
            for (ChannelFormat& channel : part.channels) channel.half = false;
    const ImageBox box = region.value_or(ImageBox{0, 0, camera.width, camera.height});
    writeChannelRows(file, box.width, box.height, stripRowsOf(box.width), parts,
                     [&](int first, int count, const std::vector<float*>& out) {
                         FrameStrip strip = rowsOf(first, count);
                         groups.add(strip);
                         layers.fill(strip, out);
                     },
                     header, between, {box.left, box.top, camera.width, camera.height});
    return groups.relative();
}

double writeImage(const std::filesystem::path& file, const Camera& camera, const FrameFileOptions& options,
                  std::optional<float> exposure, const RowsOf& rowsOf) {
    GroupCheck groups{options.ratio != Ratio::none};
    const DisplayView view = options.view;
    const bool hdr = extensionOf(file) == ".hdr", displayed = options.display && !hdr;
    writeColourRows(
        file, camera.width, camera.height, stripRowsOf(camera.width),
        [&](int first, int count, Rgb* out) {
            FrameStrip strip = rowsOf(first, count);
            groups.add(strip);
            if (displayed) {
                std::copy(strip.frame.beauty.begin(), strip.frame.beauty.end(), out);
                return options.display(out, strip.frame.beauty.size());
            }
            if (view == DisplayView::automatic && !exposure) {
                Image seen(strip.frame.width, count);
                seen.pixels = strip.frame.beauty;
                exposure = exposureFor(seen);
            }
            const float factor = view == DisplayView::automatic && !hdr ? *exposure : 1.0f;
            for (size_t p = 0; p < strip.frame.beauty.size(); ++p) out[p] = strip.frame.beauty[p] * factor;
        },
        displayed || view == DisplayView::raw);
    return groups.relative();
}

/// Puts rows of an image that is the beauty already into a strip; what was rendered of it is scaled to them.
void finish(FrameStrip& strip, const Image& finished, int first, int count) {
    Frame& frame = strip.frame;
    const size_t pixels = size_t(count) * size_t(finished.width);
    const Rgb* beauty = &finished.pixels[size_t(first) * size_t(finished.width)];
    for (size_t p = 0; p < frame.beauty.size(); ++p) {
        Rgb factor(0);
        for (int c = 0; c < 3; ++c)
            if (const float own = frame.beauty[p][c]; own > 0) factor[c] = beauty[p][c] / own;
        frame.world[p] *= factor;
        for (auto& group : frame.byEmitter) group[p] *= factor;
    }
    frame.width = finished.width;
    frame.height = count;
    frame.beauty.assign(beauty, beauty + pixels);
    frame.alpha.assign(pixels, 1);
    if (frame.world.empty()) frame.world = frame.beauty;
}

}  // namespace

DisplayView displayView(const std::string& name) {
    if (name == "standard") return DisplayView::standard;
    if (name == "auto") return DisplayView::automatic;
    if (name == "raw") return DisplayView::raw;
    throw BadOption("--view {}: unknown, expected standard, auto or raw", name);
}

bool isLossless(const ExrFormat& format) {
    return format.compression != "pxr24" && !format.compression.starts_with("dwa");
}

ExrFormat exrFormat(const std::string& compression, const std::string& depth, const std::string& layers) {
    if (std::find(std::begin(exrCompressions), std::end(exrCompressions), compression) == std::end(exrCompressions))
        throw BadOption("--exr-compression {}: unknown, expected none, rle, zips, zip, piz, pxr24, dwaa or dwab",
                        compression);
    if (depth != "half" && depth != "float") throw BadOption("--exr-depth {}: unknown, expected half or float", depth);
    const ExrFormat format{compression, depth == "float"};
    if (!isLossless(format) && layerRequest(layers).cryptomatte)
        throw BadOption("--exr-compression {}: would change the numbers of the cryptomatte in --layers", compression);
    return format;
}

void checkLayers(const std::string& layers) { layerRequest(layers); }

std::map<std::string, std::string> cameraHeader(const Camera& camera) {
    const DMat4 cameraFromWorld = glm::inverse(camera.worldFromCamera);
    constexpr double near = 0.01, far = 1000;
    DMat4 ndcFromCamera(0.0);
    ndcFromCamera[0][0] = 2 * camera.focalX / camera.width;
    ndcFromCamera[1][1] = 2 * camera.focalY / camera.height;
    ndcFromCamera[2] = {1 - 2 * camera.centreX / camera.width, 2 * camera.centreY / camera.height - 1,
                        -(far + near) / (far - near), -1};
    ndcFromCamera[3][2] = -2 * far * near / (far - near);
    return {{"worldtocamera", numbersOf(cameraFromWorld)}, {"worldtoNDC", numbersOf(ndcFromCamera * cameraFromWorld)}};
}

double writeFrameFile(const std::filesystem::path& file, const Camera& camera, const FrameSources& sources,
                      const FrameOptions& options, const FrameFileOptions& fileOptions, Progress& progress) {
    LayerRequest request = layerRequest(fileOptions.layers);
    if (sources.finished) {
        if (request.residual && !request.all) throw BadOption("--layers residual: a plate has none");
        request.residual = false;
        if (sources.finished->width != camera.width || sources.finished->height != camera.height)
            throw Error("{}: the plate is {} x {} pixels, the camera {} x {}", file.string(), sources.finished->width,
                        sources.finished->height, camera.width, camera.height);
    } else if (!sources.photograph) {
        if (fileOptions.ratio != Ratio::none && (!sources.others || sources.others->empty()))
            throw BadOption("--ratio: there is no photograph");
        if (request.residual && !request.all)
            throw BadOption(
                "--layers residual: the camera is not one of the capture's views at its own size, so there is no "
                "photograph");
        if (request.residual)
            logInfo("{}: without residual, because the camera is none of the capture's", file.string());
        request.residual = false;
    } else if (sources.photograph->width != camera.width || sources.photograph->height != camera.height) {
        throw Error("{}: the photograph is {} x {} pixels, the camera {} x {}", file.string(),
                    sources.photograph->width, sources.photograph->height, camera.width, camera.height);
    }
    const bool exr = extensionOf(file) == ".exr";
    if (!exr) request = {};
    const RelitScene& look = *sources.look;
    const RelitScene& captured = sources.captured ? *sources.captured : look;
    const bool ratioed = fileOptions.ratio != Ratio::none && !sources.finished;
    const bool needsCaptured = &captured != &look && (ratioed || request.residual || request.correction);
    const bool needsModel = !sources.finished || (exr && !fileOptions.layers.empty());
    const FrameRenderer renderer(look, camera, options);
    std::optional<FrameRenderer> before;
    if (needsCaptured) before.emplace(captured, camera, options);
    RatioOptions ratio{fileOptions.ratio};
    ratio.saturation = sources.saturation;
    if (ratioed) ratio.floor = sources.photograph ? ratioFloor(*sources.photograph) : sources.others->floor();
    progress.begin(file.filename().string(), size_t(camera.height) * (needsCaptured ? 2 : 1));
    const RowsOf rowsOf = [&](int first, int count) {
        FrameStrip strip;
        if (needsModel) strip.frame = renderer.rows(first, count, progress);
        std::optional<Frame> old;
        if (needsCaptured) old = before->rows(first, count, progress);
        const Frame& model = old ? *old : strip.frame;
        if (request.correction) strip.correction = bakedFactor(model);
        if (request.confidence) strip.confidence = modelConfidence(look, camera, first, count);
        if (request.residual) {
            const Rgb* photo = &sources.photograph->pixels[size_t(first) * size_t(camera.width)];
            for (size_t p = 0; p < model.beauty.size(); ++p) strip.residual.push_back(photo[p] - model.beauty[p]);
        }
        if (sources.finished) finish(strip, *sources.finished, first, count);
        if (ratioed && !sources.photograph) {
            const Image seen = sources.others->rows(camera, first, model, before ? *before : renderer, progress);
            applyRatio(ratio, seen, 0, Frame(model), strip.frame);
        } else if (ratioed) {
            if (old) applyRatio(ratio, *sources.photograph, first, *old, strip.frame);
            else applyRatio(ratio, *sources.photograph, first, Frame(strip.frame), strip.frame);
        }
        return strip;
    };
    if (exr)
        return writeLayers(file, camera, FrameLayers(request, fileOptions.naming, namesOf(look), sources.origin),
                           fileOptions, rowsOf, [&] { progress.check(); });
    const std::optional<float> exposure =
        sources.photograph ? std::optional<float>(exposureFor(*sources.photograph)) : std::nullopt;
    return writeImage(file, camera, fileOptions, exposure, rowsOf);
}

double writeFrame(const std::filesystem::path& file, const Frame& frame, const RelitScene& relit, const Camera& camera,
                  const std::string& layers, const DVec3& origin, const std::optional<ImageBox>& region,
                  const FrameFileOptions& how) {
    LayerRequest request = layerRequest(layers);
    if (request.residual && !request.all) throw BadOption("--layers residual: needs the photograph");
    request.residual = false;
    Camera sized = camera;
    if (!region) sized.width = frame.width, sized.height = frame.height;
    const Camera shown = region ? cropped(camera, *region) : sized;
    const RowsOf rowsOf = [&](int first, int count) {
        FrameStrip strip;
        strip.frame = frame.rows(first, count);
        if (request.correction && !strip.frame.emittersSeen.empty()) strip.correction = bakedFactor(strip.frame);
        if (request.confidence) strip.confidence = modelConfidence(relit, shown, first, count);
        return strip;
    };
    if (extensionOf(file) == ".exr") {
        FrameFileOptions options;
        options.exr = how.exr;
        return writeLayers(file, sized, FrameLayers(request, LayerNaming::blender, namesOf(relit), origin), options,
                           rowsOf, {}, region);
    }
    sized.width = frame.width, sized.height = frame.height;
    return writeImage(file, sized, how, std::nullopt, rowsOf);
}

}  // namespace relamp
