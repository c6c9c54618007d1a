#include "plate/plate_light.h"

#include "base/parallel.h"
#include "relight/model_confidence.h"

namespace relamp {
namespace {

constexpr int stripRows = 64;

/// Neighbouring pixels of an image position with their bilinear weights.
template <class Visit>
void bilinear(const Vec2& at, int width, int height, Visit&& visit) {
    const float x = at.x - 0.5f, y = at.y - 0.5f;
    const int left = int(std::floor(x)), top = int(std::floor(y));
    for (int dy = 0; dy < 2; ++dy)
        for (int dx = 0; dx < 2; ++dx) {
            const int column = left + dx, row = top + dy;
            if (column < 0 || row < 0 || column >= width || row >= height) continue;
            const float weight = (1 - std::abs(x - float(column))) * (1 - std::abs(y - float(row)));
            if (weight > 0) visit(size_t(row) * size_t(width) + size_t(column), weight);
        }
}

constexpr int edge = 2;
constexpr float confident = 0.25f;

/// Sums of values with their weights, row by row.
struct WeightedImage {
    int width = 0, height = 0;
    std::vector<Rgb> sum;
    std::vector<float> weight;
};

WeightedImage halved(const WeightedImage& from) {
    WeightedImage to{(from.width + 1) / 2, (from.height + 1) / 2, {}, {}};
    to.sum.assign(size_t(to.width) * size_t(to.height), Rgb(0));
    to.weight.assign(to.sum.size(), 0);
    for (int y = 0; y < from.height; ++y)
        for (int x = 0; x < from.width; ++x) {
            const size_t p = size_t(y) * size_t(from.width) + size_t(x);
            const size_t q = size_t(y / 2) * size_t(to.width) + size_t(x / 2);
            to.sum[q] += from.sum[p];
            to.weight[q] += from.weight[p];
        }
    return to;
}

/// Weighted means everywhere: where a pixel's weight is less than 1, the rest comes from the next coarser image.
WeightedImage filledIn(WeightedImage image) {
    if (image.width <= 1 && image.height <= 1) {
        image.sum[0] = image.weight[0] > 0 ? image.sum[0] / image.weight[0] : Rgb(0);
        return image;
    }
    const WeightedImage coarse = filledIn(halved(image));
    parallelFor(size_t(image.height), 16, [&](size_t y) {
        for (int x = 0; x < image.width; ++x) {
            const size_t p = y * size_t(image.width) + size_t(x);
            const float own = std::min(1.0f, image.weight[p]);
            Rgb around(0);
            float weights = 0;
            bilinear(Vec2(float(x) + 0.5f, float(y) + 0.5f) * 0.5f, coarse.width, coarse.height,
                     [&](size_t q, float weight) {
                         around += weight * coarse.sum[q];
                         weights += weight;
                     });
            const Rgb mean = image.weight[p] > 0 ? image.sum[p] / image.weight[p] : Rgb(0);
            image.sum[p] = own * mean + (1 - own) * around / weights;
        }
    });
    return image;
}

/// Clears `same` about emitters that changed.
void clearEdges(const PlateGround& ground, const std::vector<Rgb>& after, std::vector<uint8_t>& same) {
    for (int y = 0; y < ground.height; ++y)
        for (int x = 0; x < ground.width; ++x) {
            const size_t p = size_t(y) * size_t(ground.width) + size_t(x);
            if (!ground.emits[p]) continue;
            const Rgb change = glm::abs(after[p] - ground.before[p]);
            if (!(maxChannel(change) > 0.1f * maxChannel(ground.before[p]))) continue;
            for (int v = std::max(0, y - edge); v <= std::min(ground.height - 1, y + edge); ++v)
                for (int u = std::max(0, x - edge); u <= std::min(ground.width - 1, x + edge); ++u)
                    same[size_t(v) * size_t(ground.width) + size_t(u)] = 0;
        }
}

/// A surface whose ratio means something.
bool hasRatio(const PlateLight& light, size_t p) {
    return light.ground->distance[p] > 0 && !light.ground->emits[p] && light.same[p];
}

PlateLight lightOf(std::shared_ptr<const PlateGround> ground, std::vector<Rgb> after, std::vector<uint8_t> same) {
    PlateLight light;
    clearEdges(*ground, after, same);
    light.same = std::move(same);
    light.logRatio = std::move(after);
    const float floor = ground->floor;
    parallelFor(light.logRatio.size(), 1 << 14, [&](size_t p) {
        Rgb& ratio = light.logRatio[p];
        const Rgb& before = ground->before[p];
        ratio =
            ratio == before ? Rgb(0) : glm::log((glm::max(ratio, Rgb(0)) + floor) / (glm::max(before, Rgb(0)) + floor));
    });
    light.ground = std::move(ground);
    return light;
}

Vec3 centreRay(const Camera& camera, size_t p) {
    const int y = int(p / size_t(camera.width)), x = int(p % size_t(camera.width));
    return camera.rayDirection(Vec2(float(x) + 0.5f, float(y) + 0.5f));
}

}  // namespace

PlateGround plateGround(const RelitScene& captured, const Camera& camera, const std::set<int>& groups, bool confidence,
                        const FrameOptions& options, Progress& progress) {
    FrameOptions rendering = options;
    rendering.groups = !groups.empty();
    const FrameRenderer renderer(captured, camera, rendering);
    const Vec3 eye(camera.position());
    PlateGround ground;
    ground.width = camera.width;
    ground.height = camera.height;
    for (int row = 0; row < camera.height; row += stripRows) {
        const Frame frame = renderer.rows(row, std::min(stripRows, camera.height - row), progress);
        ground.before.insert(ground.before.end(), frame.beauty.begin(), frame.beauty.end());
        for (const int group : groups) {
            const std::vector<Rgb>& part = group < 0 ? frame.world : frame.byEmitter.at(size_t(group));
            std::vector<Rgb>& kept = ground.groups[group];
            kept.insert(kept.end(), part.begin(), part.end());
        }
        for (size_t p = 0; p < frame.beauty.size(); ++p) {
            ground.distance.push_back(frame.depth[p] > 1e29f ? 0.0f : glm::distance(frame.position[p], eye));
            ground.emits.push_back(frame.emittersSeen[p][0].emitter >= 0);
        }
    }
    // A thousandth of the model's white, not the plate's, which an actor would change.
    Image model(ground.width, ground.height);
    model.pixels = ground.before;
    ground.floor = ratioFloor(model);
    if (confidence) ground.confidence = modelConfidence(captured, camera, 0, camera.height);
    return ground;
}

PlateLight plateLight(std::shared_ptr<const PlateGround> ground, const RelitScene& look, const Camera& camera,
                      const FrameOptions& options, Progress& progress) {
    FrameOptions beauty = options;
    beauty.groups = false;
    const FrameRenderer renderer(look, camera, beauty);
    const Vec3 eye(camera.position()), forward(camera.forward());
    std::vector<Rgb> after;
    std::vector<uint8_t> same;
    after.reserve(ground->before.size());
    same.reserve(ground->before.size());
    for (int row = 0; row < camera.height; row += stripRows) {
        const Frame frame = renderer.rows(row, std::min(stripRows, camera.height - row), progress);
        for (size_t i = 0; i < frame.beauty.size(); ++i) {
            const size_t p = same.size();
            const bool none = frame.depth[i] > 1e29f, other = !(ground->distance[p] > 0);
            const Vec3 away = ground->distance[p] * centreRay(camera, p);
            same.push_back(none || other ? none == other
                                         : glm::distance(eye + away, frame.position[i]) <=
                                               surfaceTolerance * glm::dot(away, forward));
        }
        after.insert(after.end(), frame.beauty.begin(), frame.beauty.end());
    }
    return lightOf(std::move(ground), std::move(after), std::move(same));
}

std::optional<GroupFactors> groupFactors(const RelitScene& captured, const Look& look) {
    Look plain;
    plain.environment.exposureStops = look.environment.exposureStops;
    plain.environment.tint = look.environment.tint;
    for (const EmitterLook& e : look.emitters) {
        EmitterLook same;
        same.id = e.id;
        same.name = e.name;
        same.enabled = e.enabled;
        same.powerScale = e.powerScale;
        plain.emitters.push_back(same);
    }
    if (!(plain == look)) return std::nullopt;
    GroupFactors factors{look.environment.tint * std::exp2(look.environment.exposureStops), {}};
    factors.byEmitter.assign(captured.emitters.size(), Rgb(1));
    for (const EmitterLook& e : look.emitters)
        for (size_t i = 0; i < captured.emitters.size(); ++i)
            if (captured.emitters[i].id == e.id) factors.byEmitter[i] = e.enabled ? e.powerScale : Rgb(0);
    return factors;
}

std::set<int> GroupFactors::changed() const {
    std::set<int> groups;
    if (world != Rgb(1)) groups.insert(-1);
    for (size_t e = 0; e < byEmitter.size(); ++e)
        if (byEmitter[e] != Rgb(1)) groups.insert(int(e));
    return groups;
}

PlateLight plateLight(std::shared_ptr<const PlateGround> ground, const GroupFactors& factors) {
    std::vector<Rgb> after = ground->before;
    for (const int group : factors.changed()) {
        const Rgb more = (group < 0 ? factors.world : factors.byEmitter[size_t(group)]) - 1.0f;
        const std::vector<Rgb>& part = ground->groups.at(group);
        for (size_t p = 0; p < after.size(); ++p) after[p] += more * part[p];
    }
    for (Rgb& radiance : after) radiance = glm::max(radiance, Rgb(0));
    std::vector<uint8_t> same(after.size(), 1);
    return lightOf(std::move(ground), std::move(after), std::move(same));
}

std::vector<Rgb> steadied(const PlateMoment& frame, const std::vector<PlateMoment>& neighbours) {
    const PlateLight& light = *frame.light;
    const PlateGround& ground = *light.ground;
    std::vector<Rgb> after(ground.before.size());
    const Vec3 eye(frame.camera->position());
    parallelFor(size_t(ground.height), 4, [&](size_t y) {
        for (int x = 0; x < ground.width; ++x) {
            const size_t p = y * size_t(ground.width) + size_t(x);
            Rgb sum = frame.weight * light.logRatio[p];
            float total = frame.weight;
            const Vec3 point =
                eye + ground.distance[p] * frame.camera->rayDirection(Vec2(float(x) + 0.5f, float(y) + 0.5f));
            for (const PlateMoment& other : neighbours) {
                if (!hasRatio(light, p)) break;
                const auto at = other.camera->project(DVec3(point));
                if (!at) continue;
                const float expected = glm::distance(point, Vec3(other.camera->position()));
                const PlateGround& seen = *other.light->ground;
                Rgb there(0);
                float weights = 0;
                bilinear(*at, seen.width, seen.height, [&](size_t q, float weight) {
                    if (!hasRatio(*other.light, q) || std::abs(seen.distance[q] - expected) > 0.01f * expected) return;
                    there += weight * other.light->logRatio[q];
                    weights += weight;
                });
                if (weights < 0.5f) continue;
                there /= weights;
                sum += other.weight * there;
                total += other.weight;
            }
            const Rgb mean = sum / total;
            after[p] = mean == Rgb(0)
                           ? ground.before[p]
                           : (glm::max(ground.before[p], Rgb(0)) + ground.floor) * glm::exp(mean) - ground.floor;
        }
    });
    return after;
}

PlateUnsure plateUnsure(const std::string& name) {
    if (name == "model") return PlateUnsure::model;
    if (name == "smooth") return PlateUnsure::smooth;
    if (name == "keep") return PlateUnsure::keep;
    throw BadOption("--plate-unsure {}: unknown, expected model, smooth or keep", name);
}

std::vector<Rgb> whereUnsure(PlateUnsure unsure, const PlateLight& light, std::vector<Rgb> after) {
    const PlateGround& ground = *light.ground;
    if (unsure == PlateUnsure::model || ground.confidence.empty()) return after;
    const auto stays = [&](size_t p) { return !(ground.distance[p] > 0) || ground.emits[p] || !light.same[p]; };
    std::vector<Rgb> own(after.size(), Rgb(0));
    std::vector<float> weight(after.size(), 0);
    parallelFor(after.size(), 1 << 14, [&](size_t p) {
        if (stays(p)) return;
        weight[p] = std::min(1.0f, ground.confidence[p] / confident);
        if (after[p] != ground.before[p])
            own[p] = glm::log((glm::max(after[p], Rgb(0)) + ground.floor) /
                              (glm::max(ground.before[p], Rgb(0)) + ground.floor));
    });
    WeightedImage factors{ground.width, ground.height, own, weight};
    for (size_t p = 0; p < own.size(); ++p) factors.sum[p] *= weight[p];
    if (unsure == PlateUnsure::smooth) factors = filledIn(std::move(factors));
    parallelFor(after.size(), 1 << 14, [&](size_t p) {
        if (stays(p) || weight[p] >= 1) return;
        const Rgb around = unsure == PlateUnsure::keep ? Rgb(0) : factors.sum[p];
        const Rgb factor = weight[p] * own[p] + (1 - weight[p]) * around;
        after[p] = factor == Rgb(0)
                       ? ground.before[p]
                       : (glm::max(ground.before[p], Rgb(0)) + ground.floor) * glm::exp(factor) - ground.floor;
    });
    return after;
}

Image relitPlate(const Image& plate, const Rgb& gain, const PlateLight& light, const std::vector<Rgb>& after,
                 const RatioOptions& options) {
    constexpr float none = 1e30f;
    const PlateGround& ground = *light.ground;
    Image scaled = plate;
    for (Rgb& pixel : scaled.pixels) pixel /= gain;
    Frame old, next;
    old.width = next.width = ground.width;
    old.height = next.height = ground.height;
    old.beauty = ground.before;
    next.beauty = after;
    // Surfaces that differ: one of the two shows none.
    old.depth.assign(old.beauty.size(), none);
    old.position.assign(old.beauty.size(), Vec3(0));
    next.position = old.position;
    next.depth = old.depth;
    for (size_t p = 0; p < next.depth.size(); ++p)
        if (!light.same[p]) next.depth[p] = 1;
    next.world.assign(next.beauty.size(), Rgb(0));
    RatioOptions scaledOptions = options;
    scaledOptions.saturation = options.saturation / maxChannel(gain);
    applyRatio(scaledOptions, scaled, 0, old, next);
    Image relit = plate;
    for (size_t p = 0; p < relit.pixels.size(); ++p) {
        // Where the light is what it was, so is the plate, to the last bit.
        const bool unchanged = light.same[p] && ground.before[p] == after[p];
        if (!unchanged) relit.pixels[p] = next.beauty[p] * gain;
    }
    return relit;
}

}  // namespace relamp
