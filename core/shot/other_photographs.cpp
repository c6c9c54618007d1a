#include "shot/other_photographs.h"

#include "base/parallel.h"
#include "capture/photograph_reader.h"
#include "shot/ratio_frame.h"

namespace relamp {
namespace {

constexpr float leastAlbedo = 0.02f;  // darker surfaces tell nothing about light

Rgb notBlack(const Rgb& albedo) { return glm::max(albedo, Rgb(leastAlbedo)); }

/// Calls back with the four pixels around a place that are trusted, and how much each counts.
template <class Take>
void aroundPixel(const PhotographGeometry& g, const Vec2& place, Take&& take) {
    const float x = place.x - 0.5f, y = place.y - 0.5f;
    const int x0 = int(std::floor(x)), y0 = int(std::floor(y));
    for (int k = 0; k < 4; ++k) {
        const int px = x0 + k % 2, py = y0 + k / 2;
        if (px < 0 || py < 0 || px >= g.width || py >= g.height) continue;
        const float fx = x - float(x0), fy = y - float(y0);
        take(px, py, (k % 2 ? fx : 1 - fx) * (k / 2 ? fy : 1 - fy) * g.weight(px, py));
    }
}

}  // namespace

bool OtherPhotographs::glossyAt(const Hit& hit) const {
    constexpr float matteEnough = 0.01f;  // of all light that lobes reflect
    const LobesAtHit weights = captured_.weightsAt(hit);
    float gloss = 0;
    for (size_t k = 1; k < weights.size(); ++k) gloss += lobeAlbedo(captured_.basis.lobes[k]) * maxChannel(weights[k]);
    return gloss > matteEnough;
}

void OtherPhotographs::add(const View& view, Progress& progress) {
    Seen seen{
        view.camera, view.image, {}, geometryOfView(view, captured_.scene, captured_.emitterOfTriangle, progress)};
    const Camera& camera = view.camera;
    const Vec3 origin(camera.position());
    const float spread = 1 / float(std::max(camera.focalX, camera.focalY));
    std::vector<uint8_t> glossy(size_t(camera.height), 0);
    parallelFor(size_t(camera.height), 8, [&](size_t y) {
        progress.check();
        for (int x = 0; x < camera.width; ++x) {
            if (!(seen.geometry.weight(x, int(y)) > 0)) continue;
            const Vec3 d = camera.rayDirection(Vec2(float(x) + 0.5f, float(y) + 0.5f));
            const Hit hit = captured_.scene.cameraTracer->closest({origin, d, 0, 1e30f});
            if (!hit) continue;
            seen.light.at(x, int(y)) /= notBlack(captured_.albedoAt(hit, d, spread));
            if (!glossy[y] && glossyAt(hit)) glossy[y] = 1;
        }
    });
    if (std::find(glossy.begin(), glossy.end(), 1) != glossy.end()) seen.photograph = view.image;
    floors_ += ratioFloor(view.image);
    views_.push_back(std::move(seen));
}

std::vector<OtherPhotographs::Sight> OtherPhotographs::sightsOf(const Vec3& point, const Vec3& normal) const {
    constexpr float slanted = 0.1f;  // cosine, below which a view tells nothing
    constexpr float rim = 0.04f;     // of the image's width, over which a view fades out
    const float offset = captured_.scene.tracer->surfaceOffset() * 4;
    std::vector<Sight> sights;
    for (size_t i = 0; i < views_.size(); ++i) {
        const Seen& view = views_[i];
        const Vec3 eye(view.camera.position()), to = eye - point;
        const float distance = glm::length(to), cosine = glm::dot(to, normal) / distance;
        if (!(cosine > slanted)) continue;
        const std::optional<Vec2> at = view.camera.project(DVec3(point));
        if (!at) continue;
        const float inside = std::min(std::min(at->x, float(view.camera.width) - at->x),
                                      std::min(at->y, float(view.camera.height) - at->y));
        if (!(inside > 1)) continue;
        float trust = 0;
        aroundPixel(view.geometry, *at, [&](int, int, float weight) { trust += weight; });
        trust *= std::min(1.0f, inside / (rim * float(view.camera.width)));
        if (!(trust > 0.02f)) continue;
        const Vec3 d = to / distance;
        if (captured_.scene.tracer->occluded({point + offset * normal, d, 0, distance - 2 * offset})) continue;
        const float focal = float(std::min(view.camera.focalX, view.camera.focalY)) / distance;
        sights.push_back({i, *at, trust, cosine * focal * focal});
    }
    return sights;
}

Image OtherPhotographs::rows(const Camera& camera, int first, const Frame& old, const FrameRenderer& renderer,
                             Progress& progress) const {
    Image image(old.width, old.height);
    image.usable.assign(image.pixels.size(), 0);
    const Vec3 origin(camera.position());
    struct Compared {
        size_t pixel = 0;  ///< of `image`
        size_t view = 0;
        PixelAt at;
        float trust = 0;
    };
    std::vector<std::vector<Compared>> compared(static_cast<size_t>(old.height));
    const float black = floor();
    // Where views hardly show a surface, the model shows through.
    const auto put = [&](size_t p, const Rgb& seen, float trust) {
        const Rgb model = old.beauty[p] + black, shown = glm::max(seen, Rgb(0)) + black;
        image.pixels[p] = glm::max(model * glm::pow(shown / model, Rgb(std::min(1.0f, trust))) - black, Rgb(0));
        image.usable[p] = 1;
    };
    parallelFor(size_t(old.height), 4, [&](size_t row) {
        progress.check();
        for (int x = 0; x < old.width; ++x) {
            const size_t p = row * size_t(old.width) + size_t(x);
            if (old.alpha[p] < 0.999f || (!old.emittersSeen.empty() && old.emittersSeen[p][0].emitter >= 0)) continue;
            const Vec3 d = camera.rayDirection(Vec2(float(x) + 0.5f, float(first) + float(row) + 0.5f));
            const Hit hit = captured_.scene.cameraTracer->closest({origin, d, 0, 1e30f});
            if (!hit || captured_.emitterOfTriangle[hit.triangle] >= 0) continue;
            Vec3 normal = captured_.scene.mesh.faceNormal(hit.triangle);
            if (glm::dot(normal, d) > 0) normal = -normal;
            const std::vector<Sight> sights = sightsOf(captured_.scene.pointOf(hit), normal);
            if (sights.empty()) continue;
            float finest = 0, trust = 0;
            for (const Sight& s : sights) {
                finest = std::max(finest, s.fineness * s.trust);
                trust = std::max(trust, s.trust);
            }
            const auto counts = [&](const Sight& s) {
                const float f = s.fineness * s.trust / finest;
                return f * f * f;
            };
            if (glossyAt(hit)) {
                const Sight& best =
                    *std::max_element(sights.begin(), sights.end(),
                                      [&](const Sight& a, const Sight& b) { return counts(a) < counts(b); });
                compared[row].push_back({p, best.view, {int(best.pixel.x), int(best.pixel.y)}, best.trust});
                continue;
            }
            Rgb sum(0);
            float all = 0;
            for (const Sight& s : sights)
                aroundPixel(views_[s.view].geometry, s.pixel, [&](int px, int py, float weight) {
                    sum += counts(s) * weight * views_[s.view].light.at(px, py);
                    all += counts(s) * weight;
                });
            if (all > 0) put(p, sum / all * notBlack(old.albedo[p]), trust);
        }
    });
    for (size_t view = 0; view < views_.size(); ++view) {
        std::vector<Compared> here;
        std::vector<PixelAt> at;
        for (const std::vector<Compared>& row : compared)
            for (const Compared& c : row)
                if (c.view == view && views_[view].geometry.weight(c.at.x, c.at.y) > 0) {
                    here.push_back(c);
                    at.push_back(c.at);
                }
        if (here.empty()) continue;
        const std::vector<Rgb> model = renderer.pixels(views_[view].camera, at, progress);
        for (size_t i = 0; i < here.size(); ++i)
            put(here[i].pixel,
                (views_[view].photograph.at(at[i].x, at[i].y) + black) / (model[i] + black) * old.beauty[here[i].pixel],
                here[i].trust);
    }
    return image;
}

StatePhotographs::StatePhotographs(const Capture& capture, const std::filesystem::path& folder, const CaptureFix& fix,
                                   std::optional<size_t> state)
    : capture_(capture), folder_(folder), fix_(fix), state_(state) {
    if (state_ || capture.states.size() < 2) return;
    std::vector<size_t> views(capture.states.size(), 0);
    for (const View& view : capture.views) ++views[view.state];
    state_ = size_t(std::max_element(views.begin(), views.end()) - views.begin());
}

const OtherPhotographs& StatePhotographs::in(std::optional<size_t> state, const RelitScene& captured,
                                             Progress& progress) {
    if (held_ && of_ == &captured) return *held_;
    held_.emplace(captured);
    of_ = &captured;
    LoadOptions options;
    options.fix = fix_;
    const PhotographReader reader(folder_, options, progress);
    std::vector<std::string> notes;
    for (size_t i = 0; i < capture_.views.size(); ++i)
        if (!state || capture_.views[i].state == *state) {
            View view = reader.read(i, notes, progress);
            view.camera = capture_.views[i].camera;
            held_->add(view, progress);
        }
    return *held_;
}

}  // namespace relamp
