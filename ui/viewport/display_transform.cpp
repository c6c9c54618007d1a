#include "viewport/display_transform.h"

#include <OpenColorIO/OpenColorIO.h>

#include <cstdlib>
#include <sstream>

#include "base/error.h"
#include "base/log.h"
#include "base/parallel.h"
#include "viewport/shader_sources.h"

namespace OCIO = OCIO_NAMESPACE;

namespace relamp::ui {
namespace {

/// ACES2065-1 from linear Rec.709 (D65 adapted to the ACES white, Bradford), rows.
constexpr double acesFromRec709[16] = {0.439632981919491,
                                       0.382988698151554,
                                       0.177378319928955,
                                       0,
                                       0.0897764429588424,
                                       0.813439428748981,
                                       0.0967841282921771,
                                       0,
                                       0.0175411703831727,
                                       0.111546553302387,
                                       0.87091227631444,
                                       0,
                                       0,
                                       0,
                                       0,
                                       1};

/// What configurations call linear Rec.709.
constexpr const char* rec709Names[] = {"lin_rec709",
                                       "Linear Rec.709 (sRGB)",
                                       "lin_rec709_scene",
                                       "lin_rec709_srgb",
                                       "Linear Rec.709",
                                       "Utility - Linear - sRGB",
                                       "Utility - Linear - Rec.709",
                                       "Linear BT.709",
                                       "lin_srgb",
                                       "Linear"};

}  // namespace

struct DisplayTransform::Impl {
    OCIO::ConstConfigRcPtr config;
    std::string display, source, defaultView;
    std::vector<std::string> views;

    OCIO::ConstProcessorRcPtr processor(const std::string& wanted) const {
        const std::string view = std::find(views.begin(), views.end(), wanted) != views.end() ? wanted : defaultView;
        OCIO::DisplayViewTransformRcPtr transform = OCIO::DisplayViewTransform::Create();
        transform->setDisplay(display.c_str());
        transform->setView(view.c_str());
        for (const char* name : rec709Names)
            if (config->getColorSpace(name)) {
                transform->setSrc(name);
                return config->getProcessor(transform);
            }
        if (!config->hasRole("aces_interchange")) {
            transform->setSrc(OCIO::ROLE_SCENE_LINEAR);
            return config->getProcessor(transform);
        }
        OCIO::MatrixTransformRcPtr matrix = OCIO::MatrixTransform::Create();
        matrix->setMatrix(acesFromRec709);
        transform->setSrc("aces_interchange");
        OCIO::GroupTransformRcPtr group = OCIO::GroupTransform::Create();
        group->appendTransform(matrix);
        group->appendTransform(transform);
        return config->getProcessor(group);
    }
};

DisplayTransform::DisplayTransform(const std::string& file) : impl_(std::make_unique<Impl>()) {
    try {
        if (file.empty()) {
            const char* text = shaderSource("relamp.ocio");
            if (!text) throw Error("the built-in display configuration is missing from this program");
            std::istringstream in{std::string(text)};
            impl_->config = OCIO::Config::CreateFromStream(in);
            impl_->source = "built in";
        } else {
            impl_->config = OCIO::Config::CreateFromFile(file.c_str());
            impl_->source = file;
        }
        impl_->config->validate();
        impl_->display = impl_->config->getDefaultDisplay();
        const char* display = impl_->display.c_str();
        for (int i = 0; i < impl_->config->getNumViews(display); ++i)
            impl_->views.emplace_back(impl_->config->getView(display, i));
        impl_->defaultView = impl_->config->getDefaultView(display);
        if (impl_->views.empty()) throw Error("{}: the display {} has no views", file, impl_->display);
        impl_->processor(impl_->defaultView);
    } catch (const OCIO::Exception& error) {
        throw Error("{}: {}", file.empty() ? "built-in display configuration" : file, error.what());
    }
}

DisplayTransform::~DisplayTransform() = default;
const std::vector<std::string>& DisplayTransform::views() const { return impl_->views; }
const std::string& DisplayTransform::defaultView() const { return impl_->defaultView; }
const std::string& DisplayTransform::source() const { return impl_->source; }

DisplayShader DisplayTransform::shader(const std::string& view) const {
    try {
        OCIO::GpuShaderDescRcPtr description = OCIO::GpuShaderDesc::CreateShaderDesc();
        description->setLanguage(OCIO::GPU_LANGUAGE_GLSL_4_0);
        description->setFunctionName("displayTransform");
        description->setResourcePrefix("ocio_");
        impl_->processor(view)->getDefaultGPUProcessor()->extractGpuShaderInfo(description);
        DisplayShader shader;
        shader.source = description->getShaderText();
        for (unsigned i = 0; i < description->getNum3DTextures(); ++i) {
            const char *texture = nullptr, *sampler = nullptr;
            unsigned edge = 0;
            OCIO::Interpolation interpolation = OCIO::INTERP_LINEAR;
            description->get3DTexture(i, texture, sampler, edge, interpolation);
            const float* values = nullptr;
            description->get3DTextureValues(i, values);
            shader.luts.push_back({sampler, int(edge), int(edge), int(edge), 3, 3,
                                   interpolation == OCIO::INTERP_NEAREST,
                                   std::vector<float>(values, values + size_t(3) * edge * edge * edge)});
        }
        for (unsigned i = 0; i < description->getNumTextures(); ++i) {
            const char *texture = nullptr, *sampler = nullptr;
            unsigned width = 0, height = 0;
            OCIO::GpuShaderDesc::TextureType channel = OCIO::GpuShaderDesc::TEXTURE_RGB_CHANNEL;
            OCIO::Interpolation interpolation = OCIO::INTERP_LINEAR;
            description->getTexture(i, texture, sampler, width, height, channel, interpolation);
            const float* values = nullptr;
            description->getTextureValues(i, values);
            const int channels = channel == OCIO::GpuShaderDesc::TEXTURE_RED_CHANNEL ? 1 : 3;
            // A table of one row is a 1D sampler in the shader text.
            const bool flat = shader.source.find("sampler1D " + std::string(sampler)) != std::string::npos;
            shader.luts.push_back({sampler, int(width), int(height), 1, flat ? 1 : 2, channels,
                                   interpolation == OCIO::INTERP_NEAREST,
                                   std::vector<float>(values, values + size_t(channels) * width * height)});
        }
        return shader;
    } catch (const OCIO::Exception& error) { throw Error("{}: view {}: {}", impl_->source, view, error.what()); }
}

void DisplayTransform::apply(const std::string& view, float stops, Rgb* pixels, size_t count) const {
    if (!count) return;
    try {
        const OCIO::ConstCPUProcessorRcPtr cpu = impl_->processor(view)->getDefaultCPUProcessor();
        const float factor = std::exp2(stops);
        parallelBlocks(count, 1 << 14, [&](size_t begin, size_t end) {
            for (size_t i = begin; i < end; ++i) pixels[i] *= factor;
            OCIO::PackedImageDesc description(&pixels[begin], long(end - begin), 1, 3);
            cpu->apply(description);
        });
    } catch (const OCIO::Exception& error) { throw Error("{}: view {}: {}", impl_->source, view, error.what()); }
}

Image DisplayTransform::apply(const std::string& view, float stops, Image image) const {
    apply(view, stops, image.pixels.data(), image.pixels.size());
    return image;
}

const DisplayTransform& displayTransform() {
    static const DisplayTransform transform = [] {
        const char* file = std::getenv("OCIO");
        if (file && *file) try {
                return DisplayTransform(file);
            } catch (const Error& error) {
                logWarning("The colour configuration in $OCIO cannot be used, the built-in one serves instead. {}",
                           error.what());
            }
        return DisplayTransform("");
    }();
    return transform;
}

Rgb falseColour(float light) {
    // Cold below middle grey, green on it, warm above; black and white at the ends.
    static const Rgb bands[] = {{0.05f, 0.02f, 0.10f},
                                {0.22f, 0.05f, 0.38f},
                                {0.20f, 0.16f, 0.60f},
                                {0.13f, 0.33f, 0.70f},
                                {0.10f, 0.50f, 0.66f},
                                {0.16f, 0.60f, 0.52f},
                                {0.33f, 0.66f, 0.30f},
                                {0.62f, 0.72f, 0.20f},
                                {0.86f, 0.74f, 0.16f},
                                {0.93f, 0.57f, 0.13f},
                                {0.90f, 0.36f, 0.12f},
                                {0.82f, 0.15f, 0.14f},
                                {1, 1, 1}};
    const float stops = light > 0 ? std::log2(light / 0.18f) : -100.0f;
    return bands[int(std::clamp(std::floor(stops + 0.5f), float(falseColourLow), float(falseColourHigh))) -
                 falseColourLow];
}

}  // namespace relamp::ui
