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

constexpr size_t mostSizes = 24;

/// The size that most of them have, the earliest of several. Throws Error when none can be read.
std::pair<int, int> sizeOf(const PlateFiles& files) {
    std::vector<const std::filesystem::path*> listed;
    for (const auto& one : files) listed.push_back(&one.second);
    std::vector<std::pair<std::pair<int, int>, int>> counted;
    std::optional<Error> first;
    for (const size_t k : keyFramesOf(listed.size(), mostSizes)) try {
            const std::pair<int, int> size = readImageSize(*listed[k]);
            const auto known =
                std::find_if(counted.begin(), counted.end(), [&](const auto& one) { return one.first == size; });
            if (known != counted.end()) ++known->second;
            else counted.emplace_back(size, 1);
        } catch (const OutOfResources&) { throw; } catch (const Error& error) {
            if (!first) first = error;
        }
    if (counted.empty()) throw *first;
    const auto most = std::max_element(counted.begin(), counted.end(),
                                       [](const auto& a, const auto& b) { return a.second < b.second; });
    return most->first;
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
    plate.first = files.begin()->first;
    plate.last = files.rbegin()->first;
    const auto [width, height] = sizeOf(files);
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
    const std::vector<int> gaps = gapsOf(files);
    for (const auto& one : cameras.byFrame)
        if (!files.contains(one.first) && !std::binary_search(gaps.begin(), gaps.end(), one.first))
            withoutPlate.push_back(one.first);
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
    if (!withoutPlate.empty())
        plate.notes.push_back(
            fmt::format("{}: has cameras for frames {}, which have no plate", track, rangesOf(withoutPlate)));
    return plate;
}

PlateRelighter::PlateRelighter(const Plate& plate, const PlateRequest& request, RelitLooks& looks,
                               const FrameOptions& options, Progress& progress)
    : plate_(plate), request_(request), looks_(looks), options_(options) {
    if (request.match == PlateMatching::off) return;
    std::vector<PlateKey> keys;
    for (const size_t k : keyFramesOf(plate.frames.size(), PlateMatchOptions{}.keyFrames))
        keys.push_back(keyOf(plate.frames[k], progress));
    gains_ = matchPlate(looks.captured(progress), keys, matching(), progress);
}

PlateMatchOptions PlateRelighter::matching() const {
    PlateMatchOptions matching;
    matching.kind = request_.match;
    matching.seed = options_.seed;
    return matching;
}

PlateKey PlateRelighter::keyOf(const PlateFrame& frame, Progress& progress) const {
    PlateKey key{frame.number, frame.camera, {}, {}};
    key.read = [this, &frame, &progress](float& saturation) { return read(frame, saturation, progress); };
    if (!frame.matte.empty())
        key.matte = [&frame, &progress] {
            return readMatte(frame.matte, frame.camera.width, frame.camera.height, [&] { progress.check(); });
        };
    return key;
}

void PlateRelighter::matchFrame(size_t index, Progress& progress) {
    const int number = plate_.frames[index].number;
    if (!gains_.breathes || gains_.keys.contains(number) || !tried_.insert(number).second) return;
    size_t first = index, last = index;
    while (first > 0 && !gains_.keys.contains(plate_.frames[first].number)) --first;
    while (last + 1 < plate_.frames.size() && !gains_.keys.contains(plate_.frames[last].number)) ++last;
    std::vector<PlateKey> frames;
    for (size_t n = first; n <= last; ++n) {
        frames.push_back(keyOf(plate_.frames[n], progress));
        tried_.insert(plate_.frames[n].number);
    }
    matchBetween(looks_.captured(progress), frames, matching(), gains_, progress);
}

Image PlateRelighter::read(const PlateFrame& frame, float& saturation, Progress& progress) const {
    Image image = readPlate(frame.file, request_.curve, saturation, [&] { progress.check(); });
    if (image.width != frame.camera.width || image.height != frame.camera.height)
        throw Error("{}: is {} x {} pixels, the plate {} x {}", frame.file.string(), image.width, image.height,
                    frame.camera.width, frame.camera.height);
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

std::pair<size_t, size_t> PlateRelighter::around(size_t index) const {
    const size_t reach = size_t(std::max(0, request_.neighbours));
    return {index > reach ? index - reach : 0, std::min(plate_.frames.size() - 1, index + reach)};
}

std::set<int> PlateRelighter::groupsOf(size_t index, const RelitScene& captured) const {
    std::set<int> groups;
    const auto [first, last] = around(index);
    for (size_t n = first; n <= last; ++n)
        if (const auto factors = groupFactors(captured, looks_.lookAt(plate_.frames[n].number)))
            groups.merge(factors->changed());
    return groups;
}

void PlateRelighter::findLights(size_t first, size_t last, size_t index, const Look& look, Progress& progress) {
    const auto outside = [&](const auto& held) { return held.first < first || held.first > last; };
    std::erase_if(grounds_, outside);
    std::erase_if(lights_, [&](const auto& held) { return outside(held) || !(held.second.look == look); });
    const RelitScene& captured = looks_.captured(progress);
    const std::optional<GroupFactors> factors = groupFactors(captured, look);
    const RelitScene* lit = nullptr;
    if (!factors) lit = &looks_.at(plate_.frames[index].number, progress);
    size_t rows = 0;
    for (size_t n = first; n <= last; ++n)
        if (!lights_.contains(n)) rows += size_t(plate_.frames[n].camera.height) * (!grounds_.contains(n) + !factors);
    progress.begin(fmt::format("Light of frame {}", plate_.frames[index].number), rows);
    for (size_t n = first; n <= last; ++n) {
        if (lights_.contains(n)) continue;
        const Camera& camera = plate_.frames[n].camera;
        std::shared_ptr<const PlateGround>& ground = grounds_[n];
        if (!ground)
            ground = std::make_shared<const PlateGround>(plateGround(
                captured, camera, groupsOf(n, captured), request_.unsure != PlateUnsure::model, options_, progress));
        lights_.emplace(n, HeldLight{look, factors ? plateLight(ground, *factors)
                                                   : plateLight(ground, *lit, camera, options_, progress)});
    }
}

RelitPlate PlateRelighter::relit(size_t index, Progress& progress) {
    const PlateFrame& frame = plate_.frames.at(index);
    RelitPlate result;
    const Image plate = read(frame, result.saturation, progress);
    std::vector<float> matte;
    if (!frame.matte.empty())
        matte = readMatte(frame.matte, frame.camera.width, frame.camera.height, [&] { progress.check(); });
    matchFrame(index, progress);
    result.gain = gains_.at(frame.number);
    result.covered = coverageOf(looks_.captured(progress), frame.camera);
    const Look look = looks_.lookAt(frame.number);
    if (look == Look{} || !(result.covered > 0)) {
        result.image = plate;
        return result;
    }
    const auto [first, last] = around(index);
    findLights(first, last, index, look, progress);
    // Falls off evenly: a frame that comes or goes changes the mean by little.
    const auto weightAt = [&](size_t n) { return float(request_.neighbours + 1 - std::abs(int(n) - int(index))); };
    std::vector<PlateMoment> neighbours;
    for (const auto& [n, held] : lights_)
        if (n != index) neighbours.push_back({&held.light, &plate_.frames[n].camera, weightAt(n)});
    const PlateLight& light = lights_.at(index).light;
    RatioOptions ratio{request_.ratio};
    ratio.saturation = result.saturation;
    ratio.floor = light.ground->floor;
    std::vector<Rgb> after = steadied({&light, &frame.camera, weightAt(index)}, neighbours);
    after = whereUnsure(request_.unsure, light, std::move(after));
    result.image = relitPlate(plate, result.gain, light, after, ratio);
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
