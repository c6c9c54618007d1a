#include "panels/images.h"

#include <atomic>
#include <map>
#include <thread>

#include "base/error.h"
#include "display/display_image.h"
#include "image/environment_map.h"
#include "image/image_io.h"
#include "thumbnails.h"
#include "widgets.h"

namespace relamp::ui {
namespace {

/// Filled by a thread of its own, which may outlive the window.
struct Reading {
    std::atomic<bool> done{false};
    Image display;
    std::string error;
};

std::map<std::filesystem::path, std::shared_ptr<Reading>>& readings() {
    static std::map<std::filesystem::path, std::shared_ptr<Reading>> all;
    return all;
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

EnvironmentImage recoveredEnvironmentImage(const std::shared_ptr<const Estimate>& estimate) {
    static std::weak_ptr<const Estimate> shownEstimate;
    if (!estimate || estimate->environment.empty()) return {};
    if (shownEstimate.lock() != estimate) {
        shownEstimate = estimate;
        dropThumbnails("env:recovered");
    }
    return {thumbnail("env:recovered",
                      [&] {
                          return displayImage(
                              latLongFromCells(estimate->environment, DirectionGrid{estimate->environmentSide}, 256),
                              256);
                      }),
            false,
            {}};
}

EnvironmentImage environmentImage(const std::filesystem::path& file) {
    if (file.empty()) return {};
    auto& all = readings();
    auto& reading = all[file];
    if (!reading) {
        reading = std::make_shared<Reading>();
        std::thread([reading, file] {
            try {
                reading->display = displayImage(readEnvironment(file), 256);
            } catch (const std::exception& error) { reading->error = error.what(); } catch (...) {
                reading->error = "It cannot be read.";
            }
            reading->done = true;
        }).detach();
    }
    if (!reading->done) {
        stayAwake();
        return {0, true, {}};
    }
    if (!reading->error.empty()) return {0, false, reading->error};
    return {thumbnail("env:" + file.string(), [&] { return reading->display; }), false, {}};
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
