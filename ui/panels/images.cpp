#include "panels/images.h"

#include <atomic>
#include <map>
#include <thread>

#include "base/error.h"
#include "display/display_image.h"
#include "image/environment_map.h"
#include "image/image_io.h"
#include "relight/relit_scene.h"
#include "thumbnails.h"
#include "widgets.h"

namespace relamp::ui {
namespace {

const std::string photographKey = "photograph:";

/// Filled by a thread of its own, which may outlive the window.
struct Reading {
    std::atomic<bool> done{false};
    Image display;
    int width = 0, height = 0;  // of what was read
    std::string error;
};

std::map<std::string, std::shared_ptr<Reading>>& readings() {
    static std::map<std::string, std::shared_ptr<Reading>> all;
    return all;
}

/// What `read` gives, at most `longestSide` pixels; the first call with a key starts a thread.
std::shared_ptr<Reading> readOnce(const std::string& key, int longestSide, const std::function<Image()>& read) {
    auto& reading = readings()[key];
    if (!reading) {
        reading = std::make_shared<Reading>();
        std::thread([reading, longestSide, read] {
            try {
                const Image image = read();
                reading->width = image.width;
                reading->height = image.height;
                reading->display = displayImage(image, longestSide);
            } catch (const std::exception& error) { reading->error = error.what(); } catch (...) {
                reading->error = "It cannot be read.";
            }
            reading->done = true;
        }).detach();
    }
    if (!reading->done) stayAwake();
    return reading;
}

PhotographImage photographOf(const std::string& key, const std::function<Image()>& read) {
    const std::shared_ptr<Reading> reading = readOnce(key, 2048, read);
    if (!reading->done) return {0, 0, 0, true, {}};
    if (!reading->error.empty()) return {0, 0, 0, false, reading->error};
    return {thumbnail(key, [&] { return std::move(reading->display); }), reading->width, reading->height, false, {}};
}

/// Latitude-longitude image of an environment as it is seen behind the scene.
Image shownOf(const DistantLight& light) {
    constexpr int width = 256, points = 4;  // of an axis of a pixel
    if (!light.backdrop()) return latLongFromCells(light.cells(), light.grid(), width);
    Image image(width, width / 2);
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < width; ++x)
            for (int k = 0; k < points * points; ++k) {
                const Vec2 inside = (Vec2(k % points, k / points) + 0.5f) / float(points);
                const Vec2 place = (Vec2(x, y) + inside) / Vec2(float(width), float(image.height));
                image.at(x, y) += light.background(directionFromLatLong(place)) / float(points * points);
            }
    return image;
}

}  // namespace

Image displayImage(const Image& linear, int longestSide, float exposure) {
    if (linear.width < 1 || linear.height < 1) return {};
    const float scale = std::min(1.0f, float(longestSide) / float(std::max(linear.width, linear.height)));
    Image small =
        shrunk(linear, std::max(1, int(float(linear.width) * scale)), std::max(1, int(float(linear.height) * scale)));
    if (!(exposure > 0)) exposure = exposureFor(small);
    for (Rgb& c : small.pixels)
        for (int k = 0; k < 3; ++k) c[k] = srgbEncode(std::clamp(c[k] * exposure, 0.0f, 1.0f));
    return small;
}

uint64_t viewImage(const Document& document, size_t view) {
    static std::weak_ptr<const Capture> shownCapture;
    static float exposure = 0;
    if (!document.capture || view >= document.capture->views.size()) return 0;
    if (shownCapture.lock() != document.capture) {
        shownCapture = document.capture;
        exposure = 0;
        dropThumbnails("view:");
    }
    return thumbnail(fmt::format("view:{}", view), [&] {
        // One exposure for all, so that a view that is too dark looks too dark.
        if (!(exposure > 0))
            exposure = exposureFor(
                shrunk(document.capture->views[0].image, std::min(128, document.capture->views[0].image.width),
                       std::min(96, document.capture->views[0].image.height)),
                97);
        return displayImage(document.capture->views[view].image, 256, exposure);
    });
}

EnvironmentImage recoveredEnvironmentImage(const std::shared_ptr<const Estimate>& estimate,
                                           const EnvironmentLook& look) {
    static std::weak_ptr<const Estimate> shownEstimate;
    static EnvironmentLook shownLook;
    if (!estimate || estimate->environment.empty()) return {};
    EnvironmentLook asRecovered;
    asRecovered.state = look.state, asRecovered.mixState = look.mixState, asRecovered.mix = look.mix;
    if (shownEstimate.lock() != estimate || !(shownLook == asRecovered)) {
        shownEstimate = estimate;
        shownLook = asRecovered;
        dropThumbnails("env:recovered");
    }
    return {thumbnail("env:recovered",
                      [&] {
                          std::shared_ptr<const DistantLight> light;
                          try {
                              light = distantOfLook(*estimate, asRecovered);
                          } catch (const Error&) {  // a state that the photographs do not have: frames say so
                              light = distantOfLook(*estimate, {});
                          }
                          return displayImage(shownOf(*light), 256);
                      }),
            false,
            {}};
}

EnvironmentImage environmentImage(const std::filesystem::path& file) {
    if (file.empty()) return {};
    const std::shared_ptr<Reading> reading =
        readOnce("env:" + file.string(), 256, [file] { return readEnvironment(file); });
    if (!reading->done) return {0, true, {}};
    if (!reading->error.empty()) return {0, false, reading->error};
    return {thumbnail("env:" + file.string(), [&] { return reading->display; }), false, {}};
}

void dropPhotographs() {
    std::erase_if(readings(), [](const auto& entry) { return entry.first.starts_with(photographKey); });
    dropThumbnails(photographKey);
}

PhotographImage viewPhotograph(const Document& document, size_t view) {
    static std::weak_ptr<const Capture> shownCapture;
    if (!document.capture || view >= document.capture->views.size()) return {};
    if (shownCapture.lock() != document.capture) dropPhotographs();
    shownCapture = document.capture;
    const Camera& camera = document.capture->views[view].camera;
    const std::string key = fmt::format("{}{}", photographKey, view);
    PhotographImage shown =
        photographOf(key, [capture = document.capture, view] { return capture->views[view].image; });
    shown.width = camera.width;
    shown.height = camera.height;
    return shown;
}

PhotographImage filePhotograph(const std::filesystem::path& file) {
    return photographOf(photographKey + file.string(), [file] { return readImage(file); });
}

std::string captionOf(const std::filesystem::path& file, float width) {
    const auto fits = [&](const std::string& words) { return ImGui::CalcTextSize(words.c_str()).x <= width; };
    const std::string whole = shown(file.filename()), stem = shown(file.stem());
    if (fits(whole)) return whole;
    if (fits(stem)) return stem;
    for (size_t i = 1; i < stem.size(); ++i) {
        if ((static_cast<unsigned char>(stem[i]) & 0xC0) == 0x80) continue;  // inside a character
        if (const std::string end = "..." + stem.substr(i); fits(end)) return end;
    }
    return {};
}

}  // namespace relamp::ui
