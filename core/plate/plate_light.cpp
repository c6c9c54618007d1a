#include "plate/plate_light.h"

#include "base/parallel.h"

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

/// Clears `same` about emitters that changed; `emitting`: 1 where a pixel sees one as captured.
void clearEdges(PlateLight& light, const std::vector<Rgb>& after, const std::vector<uint8_t>& emitting) {
    for (int y = 0; y < light.height; ++y)
        for (int x = 0; x < light.width; ++x) {
            const size_t p = size_t(y) * size_t(light.width) + size_t(x);
            if (!emitting[p]) continue;
            const Rgb change = glm::abs(after[p] - light.before[p]);
            if (!(maxChannel(change) > 0.1f * maxChannel(light.before[p]))) continue;
            for (int v = std::max(0, y - edge); v <= std::min(light.height - 1, y + edge); ++v)
                for (int u = std::max(0, x - edge); u <= std::min(light.width - 1, x + edge); ++u)
                    light.same[size_t(v) * size_t(light.width) + size_t(u)] = 0;
        }
}

/// A surface whose ratio means something.
bool hasRatio(const PlateLight& light, size_t p) { return light.distance[p] > 0 && light.same[p]; }

/// Collects rows of both frames.
class PlateLightRows {
public:
    explicit PlateLightRows(const Camera& camera) : camera_(camera), eye_(camera.position()) {
        light_.width = camera.width;
        light_.height = camera.height;
    }
    void add(const Frame& old, const std::vector<Rgb>& after, const std::function<bool(size_t)>& same) {
        light_.before.insert(light_.before.end(), old.beauty.begin(), old.beauty.end());
        after_.insert(after_.end(), after.begin(), after.end());
        for (size_t p = 0; p < old.beauty.size(); ++p) {
            const bool emitter = old.emittersSeen[p][0].emitter >= 0, none = old.depth[p] > 1e29f;
            light_.distance.push_back(none || emitter ? 0.0f : glm::distance(old.position[p], eye_));
            light_.same.push_back(same(p));
            emitting_.push_back(emitter);
        }
    }
    PlateLight take() {
        clearEdges(light_, after_, emitting_);
        // A thousandth of the model's white, not the plate's, which an actor would change.
        Image model(light_.width, light_.height);
        model.pixels = light_.before;
        light_.floor = ratioFloor(model);
        light_.logRatio = std::move(after_);
        parallelFor(light_.logRatio.size(), 1 << 14, [&](size_t p) {
            Rgb& ratio = light_.logRatio[p];
            ratio = ratio == light_.before[p] ? Rgb(0)
                                              : glm::log((glm::max(ratio, Rgb(0)) + light_.floor) /
                                                         (glm::max(light_.before[p], Rgb(0)) + light_.floor));
        });
        return std::move(light_);
    }
    /// Calls rows(first, count) for the whole height.
    template <class Rows>
    void each(Rows&& rows) const {
        for (int row = 0; row < camera_.height; row += stripRows) rows(row, std::min(stripRows, camera_.height - row));
    }

private:
    const Camera& camera_;
    Vec3 eye_;
    PlateLight light_;
    std::vector<Rgb> after_;
    std::vector<uint8_t> emitting_;
};

}  // namespace

PlateLight plateLight(const RelitScene& captured, const RelitScene& look, const Camera& camera,
                      const FrameOptions& options, Progress& progress) {
    FrameOptions beauty = options;
    beauty.groups = false;
    const FrameRenderer before(captured, camera, beauty), after(look, camera, beauty);
    PlateLightRows rows(camera);
    rows.each([&](int first, int count) {
        const Frame old = before.rows(first, count, progress), next = after.rows(first, count, progress);
        rows.add(old, next.beauty, [&](size_t p) { return showsSameSurface(old, next, p); });
    });
    return rows.take();
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

PlateLight plateLight(const RelitScene& captured, const GroupFactors& factors, const Camera& camera,
                      const FrameOptions& options, Progress& progress) {
    const FrameRenderer renderer(captured, camera, options);
    PlateLightRows rows(camera);
    rows.each([&](int first, int count) {
        const Frame old = renderer.rows(first, count, progress);
        std::vector<Rgb> after = old.beauty;
        const auto change = [&](const std::vector<Rgb>& group, const Rgb& factor) {
            if (factor != Rgb(1))
                for (size_t p = 0; p < after.size(); ++p) after[p] += (factor - 1.0f) * group[p];
        };
        change(old.world, factors.world);
        for (size_t e = 0; e < old.byEmitter.size(); ++e) change(old.byEmitter[e], factors.byEmitter[e]);
        for (Rgb& radiance : after) radiance = glm::max(radiance, Rgb(0));
        rows.add(old, after, [](size_t) { return true; });
        progress.advance(size_t(count));  // the frame that need not be rendered
    });
    return rows.take();
}

std::vector<Rgb> steadied(const PlateMoment& frame, const std::vector<PlateMoment>& neighbours) {
    const PlateLight& light = *frame.light;
    std::vector<Rgb> after(light.before.size());
    const Vec3 eye(frame.camera->position());
    parallelFor(size_t(light.height), 4, [&](size_t y) {
        for (int x = 0; x < light.width; ++x) {
            const size_t p = y * size_t(light.width) + size_t(x);
            Rgb sum = frame.weight * light.logRatio[p];
            float total = frame.weight;
            const Vec3 point =
                eye + light.distance[p] * frame.camera->rayDirection(Vec2(float(x) + 0.5f, float(y) + 0.5f));
            for (const PlateMoment& other : neighbours) {
                if (!hasRatio(light, p)) break;
                const auto at = other.camera->project(DVec3(point));
                if (!at) continue;
                const float expected = glm::distance(point, Vec3(other.camera->position()));
                Rgb there(0);
                float weights = 0;
                bilinear(*at, other.light->width, other.light->height, [&](size_t q, float weight) {
                    if (!hasRatio(*other.light, q) || std::abs(other.light->distance[q] - expected) > 0.01f * expected)
                        return;
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
                           ? light.before[p]
                           : (glm::max(light.before[p], Rgb(0)) + light.floor) * glm::exp(mean) - light.floor;
        }
    });
    return after;
}

Image relitPlate(const Image& plate, const Rgb& gain, const PlateLight& light, const std::vector<Rgb>& after,
                 const RatioOptions& options) {
    constexpr float none = 1e30f;
    Image scaled = plate;
    for (Rgb& pixel : scaled.pixels) pixel /= gain;
    Frame old, next;
    old.width = next.width = light.width;
    old.height = next.height = light.height;
    old.beauty = light.before;
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
        const bool unchanged = light.same[p] && light.before[p] == after[p];
        if (!unchanged) relit.pixels[p] = next.beauty[p] * gain;
    }
    return relit;
}

}  // namespace relamp
