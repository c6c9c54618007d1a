#include "plate_player.h"

#include <glm/gtc/packing.hpp>

#include "base/parallel.h"
#include "shot/relit_looks.h"
#include "viewport/photograph.h"

namespace relamp::ui {
namespace {

constexpr int longestSide = 1280;

/// An error of the command line without the option's name.
std::string inWindowWords(std::string words) {
    for (const char* option : {"--plate-camera ", "--plate ", "--matte "})
        if (words.starts_with(option)) words = words.substr(std::string(option).size());
    if (const size_t at = words.find("; --plate-camera-offset moves them"); at != std::string::npos)
        words = words.substr(0, at) + "; an offset of the camera moves them";
    if (const size_t at = words.find("; --plate-lens FILE gives the lens"); at != std::string::npos)
        words = words.substr(0, at) + "; a lens file gives it";
    return words;
}

/// From a few frames: what is shown need not be matched as well as what is rendered.
PlateGains gainsOf(const OpenPlate& open, const Scene& scene, const Estimate& estimate, Progress& progress) {
    if (open.request.match == PlateMatching::off) return {};
    PlateMatchOptions options;
    options.kind = PlateMatching::shot;
    options.keyFrames = 4;
    options.pixels = 400;
    std::vector<PlateKey> keys;
    for (const size_t k : keyFramesOf(open.plate.frames.size(), options.keyFrames)) {
        const PlateFrame& frame = open.plate.frames[k];
        PlateKey key{frame.number, frame.camera, {}, {}};
        key.read = [&open, &frame, &progress](float& saturation) {
            return readPlate(frame.file, open.request.curve, saturation, [&] { progress.check(); });
        };
        if (!frame.matte.empty())
            key.matte = [&frame, &progress] {
                return readMatte(frame.matte, frame.camera.width, frame.camera.height, [&] { progress.check(); });
            };
        keys.push_back(std::move(key));
    }
    return matchPlate(applyLook(scene, estimate, Look{}, progress), keys, options, progress);
}

}  // namespace

std::shared_ptr<const OpenPlate> openPlateOf(const PlateLook& look, const std::shared_ptr<const Capture>& capture,
                                             const std::shared_ptr<const Scene>& scene,
                                             const std::shared_ptr<const Estimate>& estimate, Progress& progress) {
    const auto open = std::make_shared<OpenPlate>();
    open->look = look;
    open->capture = capture;
    open->estimate = estimate;
    progress.begin("Opening the plate", 0);
    try {
        open->request = plateRequest(look);
        open->plate = openPlate(*capture, open->request, progress);
        if (open->plate.frames.empty())
            throw Error(open->plate.faults.empty() ? "no frame can be used" : open->plate.faults.front());
    } catch (const std::exception& error) {
        open->plate = {};
        open->trouble = inWindowWords(error.what());
        return open;
    }
    std::erase_if(open->plate.frames, [&](const PlateFrame& frame) {
        progress.check();
        try {
            const auto [width, height] = readImageSize(frame.file);
            if (width == frame.camera.width && height == frame.camera.height) return false;
            open->plate.faults.push_back(fmt::format("{}: is {} x {} pixels, the first frame {} x {}",
                                                     frame.file.filename().string(), width, height, frame.camera.width,
                                                     frame.camera.height));
        } catch (const Error& error) { open->plate.faults.push_back(error.what()); }
        return true;
    });
    try {
        if (estimate && scene && !open->plate.frames.empty()) open->gains = gainsOf(*open, *scene, *estimate, progress);
        for (const std::string& fault : open->gains.faults)
            open->plate.notes.push_back(fault + "; left out of the colour matching");
    } catch (const std::exception& error) {
        open->plate.notes.push_back(std::string("Its colours were not matched: ") + error.what());
    }
    return open;
}

const PlateFrame* OpenPlate::at(int number) const {
    if (plate.frames.empty()) return nullptr;
    const auto after = std::upper_bound(plate.frames.begin(), plate.frames.end(), number,
                                        [](int n, const PlateFrame& frame) { return n < frame.number; });
    return after == plate.frames.begin() ? &plate.frames.front() : &*std::prev(after);
}

PlateImage shownPlate(Image image, const PlateFrame& frame, const Rgb& gain) {
    View view;
    view.name = frame.file.filename().string();
    view.camera = frame.camera;
    view.image = std::move(image);
    if (gain != Rgb(1))
        for (Rgb& pixel : view.image.pixels) pixel /= glm::max(gain, Rgb(1e-6f));
    PlateImage out;
    out.frame = frame.number;
    const std::vector<Vec4> pixels = straightened(view, longestSide, out.width, out.height);
    out.pixels.resize(pixels.size());
    parallelFor(pixels.size(), 1 << 14, [&](size_t p) { out.pixels[p] = glm::packHalf4x16(pixels[p]); });
    return out;
}

PlateImage readPlateImage(const OpenPlate& plate, const PlateFrame& frame, Progress& progress) {
    float saturation = 0;
    Image image = readPlate(frame.file, plate.request.curve, saturation, [&] { progress.check(); });
    return shownPlate(std::move(image), frame, plate.gains.at(frame.number));
}

Vec4 PlateImage::at(size_t pixel) const { return glm::unpackHalf4x16(pixels[pixel]); }

void PlatePlayer::keep(std::shared_ptr<const PlateImage> image, bool ahead, size_t mostBytes) {
    ++read_;
    const size_t more = image->bytes();
    if (ahead && bytes_ + more > mostBytes) {
        passing_[image->frame] = std::move(image);
        return;
    }
    // Those far from the new one go first.
    while (!kept_.empty() && bytes_ + more > mostBytes) {
        const auto first = kept_.begin(), last = std::prev(kept_.end());
        const auto gone = image->frame - first->first > last->first - image->frame ? first : last;
        bytes_ -= gone->second->bytes();
        kept_.erase(gone);
    }
    bytes_ += more;
    kept_[image->frame] = std::move(image);
}

std::shared_ptr<const PlateImage> PlatePlayer::held(int frame) const {
    for (const auto* images : {&kept_, &passing_})
        if (const auto found = images->find(frame); found != images->end()) return found->second;
    return nullptr;
}

void PlatePlayer::take(bool ahead, size_t mostBytes) {
    if (!reading_ || !reading_->done()) return;
    const std::unique_ptr<Job<PlateImage>> finished = std::move(reading_);
    auto image = std::make_shared<PlateImage>();
    image->frame = readingFrame_;
    try {
        *image = finished->take();
    } catch (const Cancelled&) { return; } catch (const std::exception& error) {
        trouble_ = error.what();
    }
    keep(std::move(image), ahead, mostBytes);
}

std::string PlatePlayer::show(const std::shared_ptr<const OpenPlate>& plate, int frame, bool ahead, size_t mostBytes) {
    if (plate != plate_) {
        reading_.reset();
        kept_.clear();
        passing_.clear();
        bytes_ = 0;
        shown_.reset();
        plate_ = plate;
    }
    take(ahead, mostBytes);
    const PlateFrame* wanted = plate ? plate->at(frame) : nullptr;
    ready_ = true;
    if (!wanted) {
        shown_.reset();
        return std::exchange(trouble_, {});
    }
    const PlateFrame* next = wanted;
    const PlateFrame* const end = plate->plate.frames.data() + plate->plate.frames.size();
    const PlateFrame* const soon = wanted + std::min<ptrdiff_t>(mostAhead, end - 1 - wanted);
    std::erase_if(passing_,
                  [&](const auto& one) { return !ahead || one.first < wanted->number || one.first > soon->number; });
    if (const auto image = held(wanted->number)) {
        shown_ = image;
        while (ahead && next <= soon && held(next->number)) ++next;
        wanted = ahead && next <= soon ? next : nullptr;
    } else {
        ready_ = false;
    }
    if (wanted && !reading_) {
        readingFrame_ = wanted->number;
        reading_ = std::make_unique<Job<PlateImage>>(
            [plate, wanted](Progress& progress) { return readPlateImage(*plate, *wanted, progress); }, wake_);
    }
    return std::exchange(trouble_, {});
}

}  // namespace relamp::ui
