#include "plate/plate_match.h"

#include <glm/exponential.hpp>
#include <optional>

#include "base/random.h"
#include "base/statistics.h"
#include "display/display_image.h"
#include "shot/frame_numbers.h"

namespace relamp {
namespace {

constexpr size_t fewest = 50;
constexpr double modelWeight = 1 / (0.02 * 0.02), knownWeight = 1e12;

/// A surface point that a key frame shows.
struct SurfacePoint {
    Vec3 position;
    Rgb plate;  ///< logarithm
};

/// What one key frame says.
struct KeyEvidence {
    int frame = 1;
    Camera camera;
    Image image;
    std::vector<float> matte;
    float white = 1, saturation = 0;
    std::vector<SurfacePoint> points;
    Rgb againstModel{0};                    ///< median log(plate / model)
    double modelWeight = 0;                 ///< of that; 0: it is not known
    Rgb fromBefore{0}, fromBeforeNoise{0};  ///< median log change since the key frame before, its standard error
};

/// Mean of 3 x 3 pixels about one; none where one of them does not count.
std::optional<Rgb> plateAt(const KeyEvidence& key, int x, int y) {
    if (x < 1 || y < 1 || x >= key.image.width - 1 || y >= key.image.height - 1) return std::nullopt;
    Rgb sum(0);
    for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx) {
            const Rgb& c = key.image.at(x + dx, y + dy);
            const size_t p = size_t(y + dy) * size_t(key.image.width) + size_t(x + dx);
            if (!key.image.usableAt(x + dx, y + dy) || (!key.matte.empty() && key.matte[p] > 0)) return std::nullopt;
            if (key.saturation > 0 && maxChannel(c) >= key.saturation) return std::nullopt;
            sum += c / 9.0f;
        }
    const float least = 0.01f * key.white;
    if (!(sum.x > least && sum.y > least && sum.z > least)) return std::nullopt;
    return glm::log(sum);
}

/// The surface that a pixel shows; none for background and emitters.
std::optional<Vec3> surfaceAt(const RelitScene& scene, const Camera& camera, const Vec2& pixel) {
    const Vec3 eye(camera.position());
    const Hit hit = scene.scene.cameraTracer->closest({eye, camera.rayDirection(pixel), 0, 1e30f});
    if (!hit || scene.emitterOfTriangle[hit.triangle] >= 0) return std::nullopt;
    return scene.scene.pointOf(hit);
}

Rgb medianOf(const std::vector<Rgb>& values) {
    Rgb middle(0);
    for (int c = 0; c < 3; ++c) {
        std::vector<float> channel;
        for (const Rgb& v : values) channel.push_back(v[c]);
        middle[c] = meanMedianOf(std::move(channel));
    }
    return middle;
}

/// Of the median of as many values.
Rgb standardError(const std::vector<Rgb>& values, const Rgb& middle) {
    std::vector<Rgb> away;
    for (const Rgb& v : values) away.push_back(glm::abs(v - middle));
    return medianOf(away) * (1.4826f * 1.2533f / std::sqrt(float(std::max<size_t>(1, values.size()))));
}

/// The surface points that a frame shows, with their pixels.
std::vector<PixelAt> findPoints(const RelitScene& captured, KeyEvidence& key, const PlateMatchOptions& options) {
    std::vector<PixelAt> pixels;
    for (size_t i = 0; i < options.pixels; ++i) {
        const Vec2 u = r2Point(uint32_t(i), Vec2(0.5f));
        const int x = std::min(int(u.x * float(key.camera.width)), key.camera.width - 1);
        const int y = std::min(int(u.y * float(key.camera.height)), key.camera.height - 1);
        const auto plate = plateAt(key, x, y);
        if (!plate) continue;
        const auto surface = surfaceAt(captured, key.camera, Vec2(float(x) + 0.5f, float(y) + 0.5f));
        if (!surface) continue;
        key.points.push_back({*surface, *plate});
        pixels.push_back({x, y});
    }
    return pixels;
}

/// Pixels of a frame against the model as captured; false where too few count.
bool holdAgainstModel(const FrameRenderer& renderer, const std::vector<PixelAt>& pixels, KeyEvidence& key,
                      Progress& progress) {
    const std::vector<Rgb> model = renderer.pixels(key.camera, pixels, progress);
    std::vector<Rgb> differences;
    for (size_t i = 0; i < model.size(); ++i)
        if (model[i].x > 0 && model[i].y > 0 && model[i].z > 0)
            differences.push_back(key.points[i].plate - glm::log(model[i]));
    if (differences.size() < fewest) return false;
    key.againstModel = medianOf(differences);
    key.modelWeight = modelWeight;
    return true;
}

/// None where a file cannot be read; `fault` says why.
std::optional<KeyEvidence> readKey(const PlateKey& key, std::string& fault) {
    KeyEvidence evidence;
    evidence.frame = key.frame;
    evidence.camera = key.camera;
    try {
        evidence.image = key.read(evidence.saturation);
        if (key.matte) evidence.matte = key.matte();
    } catch (const OutOfResources&) { throw; } catch (const Error& error) {
        fault = error.what();
        return std::nullopt;
    }
    evidence.white = 1 / exposureFor(evidence.image, 99);
    return evidence;
}

FrameOptions renderingOf(const PlateMatchOptions& options) {
    FrameOptions rendering;
    rendering.seed = options.seed;
    return rendering;
}

/// The change of what both frames show; false where that is too little.
bool holdAgainst(const RelitScene& captured, const KeyEvidence& before, KeyEvidence& key) {
    std::vector<Rgb> changes;
    for (const SurfacePoint& point : before.points) {
        const auto at = key.camera.project(DVec3(point.position));
        if (!at) continue;
        const auto plate = plateAt(key, int(std::floor(at->x)), int(std::floor(at->y)));
        if (!plate) continue;
        const auto seen = surfaceAt(captured, key.camera, *at);
        const float distance = glm::distance(point.position, Vec3(key.camera.position()));
        if (seen && glm::distance(*seen, point.position) < 0.01f * distance) changes.push_back(*plate - point.plate);
    }
    key.fromBefore = medianOf(changes);
    // Without common surfaces only the model links the two.
    key.fromBeforeNoise =
        changes.size() < fewest ? Rgb(1) : glm::max(standardError(changes, key.fromBefore), Rgb(2e-4f));
    return changes.size() >= fewest;
}

/// Least squares of one channel: the model's word of each key, the change from one to the next.
std::vector<double> joined(const std::vector<KeyEvidence>& keys, int c) {
    const size_t n = keys.size();
    std::vector<double> diagonal(n), above(n, 0), right(n);
    for (size_t k = 0; k < n; ++k) {
        diagonal[k] += keys[k].modelWeight;
        right[k] += keys[k].modelWeight * double(keys[k].againstModel[c]);
        if (k == 0) continue;
        const double noise = double(keys[k].fromBeforeNoise[c]), weight = 1 / (noise * noise);
        const double change = double(keys[k].fromBefore[c]);
        diagonal[k] += weight;
        diagonal[k - 1] += weight;
        above[k - 1] -= weight;
        right[k] += weight * change;
        right[k - 1] -= weight * change;
    }
    for (size_t k = 1; k < n; ++k) {
        const double factor = above[k - 1] / diagonal[k - 1];
        diagonal[k] -= factor * above[k - 1];
        right[k] -= factor * right[k - 1];
    }
    std::vector<double> answer(n);
    for (size_t k = n; k-- > 0;) answer[k] = (right[k] - (k + 1 < n ? above[k] * answer[k + 1] : 0)) / diagonal[k];
    return answer;
}

}  // namespace

PlateMatching plateMatching(const std::string& name) {
    if (name == "auto") return PlateMatching::automatic;
    if (name == "shot") return PlateMatching::shot;
    if (name == "frames") return PlateMatching::frames;
    if (name == "off") return PlateMatching::off;
    throw BadOption("--plate-match {}: unknown, expected auto, shot, frames or off", name);
}

Rgb PlateGains::at(int frame) const {
    if (const auto own = between.find(frame); own != between.end()) return own->second;
    if (keys.empty()) return Rgb(1);
    const auto above = keys.lower_bound(frame);
    if (above == keys.end()) return keys.rbegin()->second;
    if (above == keys.begin() || above->first == frame) return above->second;
    const auto below = std::prev(above);
    const float t = float(frame - below->first) / float(above->first - below->first);
    return glm::exp(glm::mix(glm::log(below->second), glm::log(above->second), t));
}

std::vector<size_t> keyFramesOf(size_t count, size_t most) {
    std::vector<size_t> chosen;
    const size_t keys = std::min(count, std::max<size_t>(1, most));
    for (size_t k = 0; k < keys; ++k) chosen.push_back(keys == 1 ? 0 : k * (count - 1) / (keys - 1));
    return chosen;
}

PlateGains matchPlate(const RelitScene& captured, const std::vector<PlateKey>& keys, const PlateMatchOptions& options,
                      Progress& progress) {
    PlateGains gains;
    if (options.kind == PlateMatching::off || keys.empty()) return gains;
    const FrameRenderer renderer(captured, keys.front().camera, renderingOf(options));
    progress.begin("Matching the plate's colours", keys.size());
    std::vector<KeyEvidence> evidence;
    for (const PlateKey& key : keys) {
        std::string fault;
        std::optional<KeyEvidence> next = readKey(key, fault);
        if (!next) gains.faults.push_back(fault);
        else if (holdAgainstModel(renderer, findPoints(captured, *next, options), *next, progress)) {
            if (!evidence.empty()) holdAgainst(captured, evidence.back(), *next);
            next->image = {};
            next->matte = {};
            evidence.push_back(std::move(*next));
        }
        progress.advance();
    }
    if (evidence.empty()) return gains;
    std::vector<Rgb> logs(evidence.size());
    for (int c = 0; c < 3; ++c) {
        const std::vector<double> answer = joined(evidence, c);
        for (size_t k = 0; k < answer.size(); ++k) logs[k][c] = float(answer[k]);
    }
    const Rgb middle = medianOf(logs);
    std::vector<Rgb> away, noise;
    for (size_t k = 0; k < logs.size(); ++k) {
        away.push_back(glm::abs(logs[k] - middle));
        if (k > 0) noise.push_back(evidence[k].fromBeforeNoise);
    }
    gains.spread = maxChannel(medianOf(away)) * 1.4826f;
    gains.noise = medianOf(noise) * std::sqrt(float(logs.size()) / 4);
    gains.breathes =
        options.kind == PlateMatching::frames || (options.kind == PlateMatching::automatic && logs.size() > 1 &&
                                                  gains.spread > std::max(0.005f, 3 * maxChannel(gains.noise)));
    if (!gains.breathes) gains.keys.emplace(evidence.front().frame, glm::exp(middle));
    else
        for (size_t k = 0; k < logs.size(); ++k) gains.keys.emplace(evidence[k].frame, glm::exp(logs[k]));
    return gains;
}

void matchBetween(const RelitScene& captured, const std::vector<PlateKey>& frames, const PlateMatchOptions& options,
                  PlateGains& gains, Progress& progress) {
    if (frames.empty()) return;
    const FrameRenderer renderer(captured, frames.front().camera, renderingOf(options));
    progress.begin("Matching the plate's colours", frames.size());
    std::vector<KeyEvidence> evidence;
    for (const PlateKey& frame : frames) {
        std::string fault;
        if (std::optional<KeyEvidence> next = readKey(frame, fault)) {
            const std::vector<PixelAt> pixels = findPoints(captured, *next, options);
            const bool linked = !evidence.empty() && holdAgainst(captured, evidence.back(), *next);
            if (const auto known = gains.keys.find(frame.frame); known != gains.keys.end()) {
                next->againstModel = glm::log(known->second);
                next->modelWeight = knownWeight;
            } else if (!linked) {
                holdAgainstModel(renderer, pixels, *next, progress);
            }
            next->image = {};
            next->matte = {};
            evidence.push_back(std::move(*next));
        }
        progress.advance();
    }
    if (std::none_of(evidence.begin(), evidence.end(), [](const KeyEvidence& key) { return key.modelWeight > 0; }))
        return;
    for (int c = 0; c < 3; ++c) {
        const std::vector<double> answer = joined(evidence, c);
        for (size_t k = 0; k < answer.size(); ++k)
            if (!gains.keys.contains(evidence[k].frame))
                gains.between[evidence[k].frame][c] = std::exp(float(answer[k]));
    }
}

}  // namespace relamp
