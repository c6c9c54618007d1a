#include "plate/relight_plate.h"

#include <nlohmann/json.hpp>

#include "base/json_fields.h"
#include "image/image_io.h"
#include "shot/frame_numbers.h"

namespace relamp {
namespace {

constexpr int matteSamples = 256;

/// "1001 to 1004, 1010"
std::string rangesOf(const std::vector<int>& numbers) {
    std::string text;
    size_t ranges = 0;
    for (size_t i = 0; i < numbers.size();) {
        size_t end = i;
        while (end + 1 < numbers.size() && numbers[end + 1] == numbers[end] + 1) ++end;
        if (++ranges > 8) return text + ", ...";
        text += fmt::format("{}{}", text.empty() ? "" : ", ", numbers[i]);
        if (end > i) text += fmt::format(" to {}", numbers[end]);
        i = end + 1;
    }
    return text;
}

/// Numbers between the first and the last that are not among the keys.
template <class Map>
std::vector<int> gapsOf(const Map& numbered) {
    std::vector<int> gaps;
    if (numbered.empty()) return gaps;
    int expected = numbered.begin()->first;
    for (const auto& one : numbered) {
        for (; expected < one.first && gaps.size() < 1000; ++expected) gaps.push_back(expected);
        expected = one.first + 1;
    }
    return gaps;
}

float coverageOf(const RelitScene& scene, const Camera& camera) {
    constexpr int side = 48;
    int seen = 0;
    const Vec3 eye(camera.position());
    for (int y = 0; y < side; ++y)
        for (int x = 0; x < side; ++x) {
            const Vec2 pixel((float(x) + 0.5f) / side * float(camera.width),
                             (float(y) + 0.5f) / side * float(camera.height));
            if (scene.scene.cameraTracer->closest({eye, camera.rayDirection(pixel), 0, 1e30f})) ++seen;
        }
    return float(seen) / (side * side);
}

Json numbersOf(const Vec3& v) { return Json::array({v.x, v.y, v.z}); }

}  // namespace

PlateRequest plateRequest(const PlateLook& look) {
    PlateRequest request;
    request.plate = look.files;
    request.cameras = look.cameras;
    request.track = {look.lens, look.rotation, look.offset};
    request.curve = plateCurve(look.curve);
    request.match = plateMatching(look.match);
    request.matte = look.matte;
    request.relightMatte = look.relightMatte;
    return request;
}

Plate openPlate(const Capture& capture, const PlateRequest& request, Progress& progress) {
    Plate plate;
    const PlateFiles files = plateFiles(request.plate, "--plate");
    const auto [width, height] = readImageSize(files.begin()->second);
    const PlateCameras cameras =
        readPlateCameras(capture, request.cameras, files, width, height, request.track, progress);
    plate.notes = cameras.notes;
    PlateFiles mattes;
    if (!request.matte.empty()) mattes = plateFiles(request.matte, "--matte");
    const bool oneMatte = mattes.size() == 1 && !numberPlace(request.matte.filename().string());
    std::vector<int> withoutCamera, withoutMatte, withoutPlate;
    for (const auto& [number, file] : files) {
        const auto camera = cameras.byFrame.find(number);
        if (camera == cameras.byFrame.end()) {
            withoutCamera.push_back(number);
            continue;
        }
        PlateFrame frame{number, file, {}, camera->second};
        const auto matte = oneMatte ? mattes.begin() : mattes.find(number);
        if (matte != mattes.end()) frame.matte = matte->second;
        else if (!request.matte.empty()) {
            withoutMatte.push_back(number);
            continue;
        }
        plate.frames.push_back(std::move(frame));
    }
    for (const auto& one : cameras.byFrame)
        if (!files.contains(one.first) && one.first > files.begin()->first && one.first < files.rbegin()->first)
            withoutPlate.push_back(one.first);
    const std::vector<int> gaps = gapsOf(files);
    const std::string track = request.cameras.filename().string();
    if (plate.frames.empty() && withoutMatte.empty())
        throw Error("--plate-camera {}: has frames {} to {}, the plate {} to {}; --plate-camera-offset moves them",
                    track, cameras.byFrame.empty() ? 0 : cameras.byFrame.begin()->first,
                    cameras.byFrame.empty() ? 0 : cameras.byFrame.rbegin()->first, files.begin()->first,
                    files.rbegin()->first);
    if (!withoutCamera.empty())
        plate.faults.push_back(fmt::format("{}: has no camera for frames {}", track, rangesOf(withoutCamera)));
    if (!withoutMatte.empty())
        plate.faults.push_back(fmt::format("{}: there is no matte for frames {}", request.matte.filename().string(),
                                           rangesOf(withoutMatte)));
    if (!gaps.empty())
        plate.faults.push_back(
            fmt::format("{}: frames {} are missing", request.plate.filename().string(), rangesOf(gaps)));
    else if (!withoutPlate.empty())
        plate.notes.push_back(
            fmt::format("{}: has cameras for frames {}, which have no plate", track, rangesOf(withoutPlate)));
    return plate;
}

PlateRelighter::PlateRelighter(const Plate& plate, const PlateRequest& request, RelitLooks& looks,
                               const FrameOptions& options, Progress& progress)
    : plate_(plate), request_(request), looks_(looks), options_(options) {
    if (request.match == PlateMatching::off) return;
    PlateMatchOptions matching;
    matching.kind = request.match;
    matching.seed = options.seed;
    std::vector<PlateKey> keys;
    for (const size_t k : keyFramesOf(plate.frames.size(), matching.keyFrames)) {
        const PlateFrame& frame = plate.frames[k];
        PlateKey key{frame.number, frame.camera, {}, {}};
        key.read = [this, &frame, &progress](float& saturation) { return read(frame, saturation, progress); };
        if (!frame.matte.empty())
            key.matte = [&frame, &progress] {
                return readMatte(frame.matte, frame.camera.width, frame.camera.height, [&] { progress.check(); });
            };
        keys.push_back(std::move(key));
    }
    gains_ = matchPlate(looks.captured(progress), keys, matching, progress);
}

Image PlateRelighter::read(const PlateFrame& frame, float& saturation, Progress& progress) const {
    Image image = readPlate(frame.file, request_.curve, saturation, [&] { progress.check(); });
    if (image.width != frame.camera.width || image.height != frame.camera.height)
        throw Error("{}: is {} x {} pixels, the plate's first frame {} x {}", frame.file.string(), image.width,
                    image.height, frame.camera.width, frame.camera.height);
    return image;
}

std::optional<MatteLight> PlateRelighter::lightAt(const MattePlace& place, const RelitScene& captured,
                                                  const RelitScene& look, const Camera& camera) const {
    constexpr int steps = 6;
    const float step = 0.25f * glm::distance(place.middle, place.foot);
    const Vec3 towards = glm::normalize(Vec3(camera.position()) - place.middle);
    for (int i = 0; i < steps; ++i) {
        MatteLight light{place};
        light.place.middle += float(i) * step * towards;
        light.before = irradianceCube(captured, light.place.middle, matteSamples, options_.seed);
        if (std::all_of(light.before.begin(), light.before.end(),
                        [](const Rgb& face) { return !(maxChannel(face) > 0); }))
            continue;
        light.after = irradianceCube(look, light.place.middle, matteSamples, options_.seed);
        return light;
    }
    return std::nullopt;
}

const PlateLight& PlateRelighter::lightOf(size_t index, Progress& progress) {
    const auto held = lights_.find(index);
    if (held != lights_.end()) return held->second;
    const PlateFrame& frame = plate_.frames[index];
    progress.begin(fmt::format("Light of frame {}", frame.number), size_t(frame.camera.height) * 2);
    const Look look = looks_.lookAt(frame.number);
    PlateLight light;
    if (const auto factors = groupFactors(looks_.captured(progress), look))
        light = plateLight(looks_.captured(progress), *factors, frame.camera, options_, progress);
    else
        light =
            plateLight(looks_.captured(progress), looks_.at(frame.number, progress), frame.camera, options_, progress);
    return lights_.emplace(index, std::move(light)).first->second;
}

RelitPlate PlateRelighter::relit(size_t index, Progress& progress) {
    const PlateFrame& frame = plate_.frames.at(index);
    RelitPlate result;
    const Image plate = read(frame, result.saturation, progress);
    std::vector<float> matte;
    if (!frame.matte.empty())
        matte = readMatte(frame.matte, frame.camera.width, frame.camera.height, [&] { progress.check(); });
    result.gain = gains_.at(frame.number);
    result.covered = coverageOf(looks_.captured(progress), frame.camera);
    const Look look = looks_.lookAt(frame.number);
    if (look == Look{} || !(result.covered > 0)) {
        result.image = plate;
        return result;
    }
    const size_t reach = size_t(std::max(0, request_.neighbours));
    const size_t first = index > reach ? index - reach : 0, last = std::min(plate_.frames.size() - 1, index + reach);
    std::erase_if(lights_, [&](const auto& held) { return held.first < first || held.first > last; });
    lightOf(index, progress);
    // Falls off evenly: a frame that comes or goes changes the mean by little.
    const auto weightAt = [&](size_t n) { return float(request_.neighbours + 1 - std::abs(int(n) - int(index))); };
    std::vector<PlateMoment> neighbours;
    for (size_t n = first; n <= last; ++n)
        if (n != index && looks_.lookAt(plate_.frames[n].number) == look)
            neighbours.push_back({&lightOf(n, progress), &plate_.frames[n].camera, weightAt(n)});
    const PlateLight& light = lightOf(index, progress);
    RatioOptions ratio{request_.ratio};
    ratio.saturation = result.saturation;
    ratio.floor = light.floor;
    result.image =
        relitPlate(plate, result.gain, light, steadied({&light, &frame.camera, weightAt(index)}, neighbours), ratio);
    if (matte.empty()) return result;
    std::vector<Rgb> factors;
    if (request_.relightMatte) {
        const RelitScene& captured = looks_.captured(progress);
        if (const auto place = mattePlaceOf(captured, frame.camera, matte)) {
            if (const auto there = lightAt(*place, captured, looks_.at(frame.number, progress), frame.camera)) {
                factors = matteFactors(*there, frame.camera, matte);
                result.matteLight = there;
            }
        }
    }
    for (size_t p = 0; p < matte.size(); ++p) {
        if (!(matte[p] > 0)) continue;
        const Rgb kept = factors.empty() ? plate.pixels[p] : plate.pixels[p] * factors[p];
        result.image.pixels[p] = matte[p] >= 1 ? kept : glm::mix(result.image.pixels[p], kept, matte[p]);
    }
    return result;
}

std::string matteLightJson(int frame, const MatteLight& light, const DVec3& origin) {
    const Vec3 shift(origin);
    Json document{{"frame", frame},
                  {"foot", numbersOf(light.place.foot + shift)},
                  {"place", numbersOf(light.place.middle + shift)},
                  {"directions", Json::array({"+X", "-X", "+Y", "-Y", "+Z", "-Z"})},
                  {"before", Json::array()},
                  {"after", Json::array()}};
    for (const Rgb& face : light.before) document["before"].push_back(numbersOf(face));
    for (const Rgb& face : light.after) document["after"].push_back(numbersOf(face));
    return dumpJson(document, 1) + "\n";
}

}  // namespace relamp
