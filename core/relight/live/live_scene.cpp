#include "relight/live/live_scene.h"

#include <algorithm>
#include <chrono>

#include "base/error.h"
#include "brdf/layered_albedo.h"
#include "relight/backdrop.h"
#include "relight/live/state.h"

namespace relamp {
namespace {

using Clock = std::chrono::steady_clock;
constexpr size_t fewestLevelVertices = 1500;  // of a level of detail: a smaller one hides shadows and saves nothing
double secondsSince(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

/// Environments that terms of the transport are chosen against, beside the constant one and the sun: the recovered one
/// and a sky over dark ground.
TermTests testsFor(const Estimate& estimate, int side) {
    const LiveLight recovered =
        liveLight(DistantLight(DirectionGrid{estimate.environmentSide}, estimate.environment), side);
    const DirectionGrid grid{side};
    std::vector<float> captured(recovered.cells.size()), sky(recovered.cells.size());
    for (size_t c = 0; c < captured.size(); ++c) {
        captured[c] = std::max(0.0f, luminance(recovered.cells[c]));
        const Vec3 d = grid.direction(int(c));
        sky[c] = d.z < 0 ? 0.1f : 1 + 3 * std::max(0.0f, glm::dot(d, glm::normalize(Vec3(1, 2, 2))));
    }
    return TermTests(side, {captured, sky});
}

}  // namespace

LiveScene::State::State(std::shared_ptr<const Scene> scene_, std::shared_ptr<const Estimate> estimate_,
                        const LiveOptions& options_)
    : scene(std::move(scene_)),
      estimate(std::move(estimate_)),
      options(options_),
      grid(options.gridSide),
      matte(grid, testsFor(*estimate, options.gridSide), options.error),
      carried(grid),
      gloss(grid, *estimate) {
    occluders.offset = scene->tracer->surfaceOffset();
    lobesReflect = hemisphericalAlbedos(estimate->reflectance.basis);
}

PartsApart LiveScene::State::apartOf(const Look& next) const {
    PartsApart out{true, apart.components};
    const auto add = [&](uint32_t seed) {
        if (seed >= scene->component.size()) return;  // editGeometry says so
        const uint32_t component = scene->component[seed];
        if (std::find(out.components.begin(), out.components.end(), component) == out.components.end())
            out.components.push_back(component);
    };
    for (const PartLook& p : next.parts) add(p.seedVertex);
    for (const AddedEmitter& a : next.added)
        if (infoOf(a.shape).geometry == EmitterShapeInfo::Geometry::component) add(a.seedVertex);
    return out;
}

std::shared_ptr<const DistantLight> LiveScene::State::unturnedOf(const EnvironmentLook& next) const {
    const auto sourceOf = [](EnvironmentLook of) {
        of.yawDegrees = of.exposureStops = 0;
        of.tint = Rgb(1);
        of.sides = evenSides;
        return of;
    };
    const EnvironmentLook bare = sourceOf(next);
    return unturned && bare == sourceOf(look.environment) ? unturned : distantOfLook(*estimate, bare);
}

void LiveScene::State::takeEnvironment(const EnvironmentLook& next, std::shared_ptr<const DistantLight> nextUnturned) {
    const Rgb nextGain = next.tint * std::exp2(next.exposureStops);
    const bool swapped = nextUnturned != unturned || next.yawDegrees != look.environment.yawDegrees ||
                         next.sides != look.environment.sides;
    if (swapped) {
        unturned = std::move(nextUnturned);
        plain = sided(next.yawDegrees == 0 || unturned->black() ? unturned : turned(*unturned, next.yawDegrees),
                      next.sides);
        light = liveLight(*plain, options.gridSide);
        pyramidStale = true;
        gloss.markDistant();
        newLight = true;
    }
    if (swapped || nextGain != gain) {
        std::vector<Rgb> cells = plain->cells();
        if (nextGain != Rgb(1))
            for (Rgb& c : cells) c *= nextGain;
        distant = nextGain == Rgb(1) ? plain
                                     : std::make_shared<const DistantLight>(plain->grid(), std::move(cells),
                                                                            brighter(plain->backdrop(), nextGain));
        gain = nextGain;
        newValues = true;
    }
}

GlossInputs LiveScene::State::glossInputs() {
    if (pyramidStale && !gloss.empty()) {
        pyramid = EnvironmentPyramid(*plain);
        pyramidStale = false;
    }
    return {vertices, matte, carried, near, occluders, pyramid, eye};
}

void LiveScene::State::sumLight() {
    matte.apply(light, newLight, distantMatte);
    carried.apply(vertices, light, newLight, distantMatte);
    if (!gloss.empty()) {
        const std::vector<uint32_t> changed = matte.takeChanged();
        if (stirred.empty() || matte.anyStale()) gloss.markDistant(changed);
        else gloss.markDistant(changed, stirred, glossInputs());
    }
    gloss.markDistant(carried.takeChanged());
}

void LiveScene::State::followBlockers() {
    if (nearPlace.used() || matte.place().open()) blockers.follow(occluders, *vertices.mesh, geometry.partOfTriangle);
    else blockers = {};
}

void LiveScene::State::coarse(Progress& progress) {
    const auto start = Clock::now();
    const bool geometryMoved = newGeometry;
    if (newGeometry) {
        for (size_t e = 0; e < near.size(); ++e) gloss.markShadowed(e, near[e]);
        for (const LivePart& component : released) matte.release(vertices, occluders, component, progress);
        released.clear();
        followBlockers();
        matte.start(vertices, occluders, blockers);
        nearPlace.start(near, vertices, occluders, blockers, options.seed);
        if (!eye.orthographic && eye.halfAngle > 0)
            nearLevels.gaze = {eye.position, eye.forward, std::cos(eye.halfAngle)};
        else nearLevels.gaze = {};
        matte.coarse(vertices, occluders, blockers, nearLevels.gaze, progress);
        carried.coarse(vertices, occluders, progress);
        nearPlace.finish(near);
        for (NearEmitter& e : near)
            nearCoarse(
                e, vertices, occluders, [&](size_t v) { return matte.groundClear(e.part, v); }, options.seed, progress,
                &nearLevels, &scene->graph);
        report.lightBetween = size_t(std::count_if(nearLevels.between.begin(), nearLevels.between.end(),
                                                   [](uint8_t between) { return between != 0; }));
    }
    if (newGeometry || newLight) sumLight();
    if (newLight && !geometryMoved) report.lightMs = 1e3 * secondsSince(start);
    const auto glossStart = Clock::now();
    report.glossyVertices = gloss.coarse(glossInputs(), progress);
    if (newEye) report.eyeMs = 1e3 * secondsSince(glossStart);
    if (geometryMoved) report.moveMs = 1e3 * secondsSince(start);
    newGeometry = newLight = newEye = newValues = false;
    finished = false;
}

bool LiveScene::State::refineBatch(Progress& progress) {
    SampleElsewhere onDevice;
    if (nearPlace.used())
        onDevice = [this](NearEmitter& e, std::span<const uint32_t> chosen, int level) {
            return nearPlace.sample(e, vertices, occluders, blockers, chosen, level, options.seed);
        };
    for (NearEmitter& e : near)
        if (nearRefine(e, vertices, scene->graph, occluders, options.seed, progress, onDevice)) return true;
    if (matte.refine(vertices, occluders, progress)) return true;
    if (carried.refine(vertices, occluders, progress)) return true;
    sumLight();
    if (gloss.refine(glossInputs(), progress)) return true;
    return matte.bakeStale(vertices, occluders, progress);
}

LiveScene::LiveScene(std::shared_ptr<const Scene> scene, std::shared_ptr<const Estimate> estimate,
                     const LiveOptions& options, Progress& progress)
    : state_(std::make_unique<State>(std::move(scene), std::move(estimate), options)) {
    State& s = *state_;
    if (options.gridSide < 8 || options.gridSide > 64 || (options.gridSide & (options.gridSide - 1)))
        throw Error("live relighting: the grid's side is {}, expected 8, 16, 32 or 64", options.gridSide);
    const auto start = Clock::now();
    const PartsApart apart = s.apartOf({});
    s.takeGeometry({}, editGeometry(*s.scene, *s.estimate, {}, apart, &s.closed), apart);
    s.report.cachedBlocks = s.matte.bake(s.vertices, s.occluders, options.cacheFolder, progress);
    std::vector<uint8_t> stays(s.scene->mesh.vertexCount());
    for (size_t v = 0; v < stays.size(); ++v) stays[v] = s.vertices.kind[v] == LiveVertices::ground;
    s.nearLevels.levels = LiveLevels(s.scene->mesh, s.scene->graph, stays, fewestLevelVertices);
    s.matte.chooseDevice(options.devices.sums, options.forceDevice, progress);
    s.matte.offerDevice(options.devices.shadows, options.forceDevice);
    if (options.devices.near || options.devices.shadows)
        s.blockers.follow(s.occluders, *s.vertices.mesh, s.geometry.partOfTriangle);
    s.nearPlace.choose(s.near.empty() ? nullptr : &s.near[0], s.vertices, s.occluders, s.blockers, options.devices.near,
                       options.forceDevice, options.seed, progress);
    s.matte.setParts(s.partNames);
    s.takeEnvironment({}, s.unturnedOf({}));
    if (s.estimate->interreflection) {
        BounceOptions bounce;
        bounce.rays = 128;
        bounce.seed = options.seed;
        s.bounceRays = traceBounce(*s.scene, bounce, progress);
    }
    s.report.bakeSeconds = secondsSince(start);
    s.coarse(progress);
    s.makeFrame();
}

LiveScene::~LiveScene() = default;

void LiveScene::setLook(const Look& look) {
    State& s = *state_;
    // Everything that can fail comes first.
    PartsApart apart = s.apartOf(look);
    EditedGeometry edited = editGeometry(*s.scene, *s.estimate, look, apart, &s.closed);
    std::shared_ptr<const DistantLight> environment = s.unturnedOf(look.environment);
    const bool materials = look.neutralMaterials != s.look.neutralMaterials;
    s.takeGeometry(look, std::move(edited), std::move(apart));
    s.takeEnvironment(look.environment, std::move(environment));
    if (materials) {
        s.gloss.setVertices(s.vertices, s.near.size(), look.neutralMaterials);
        s.newValues = true;
    }
    s.look = look;
}

void LiveScene::setEye(const Eye& eye) {
    State& s = *state_;
    const bool sameRays = s.eye.position == eye.position && s.eye.orthographic == eye.orthographic &&
                          (!eye.orthographic || s.eye.forward == eye.forward);
    const bool sameImage = s.eye.halfAngle == eye.halfAngle && (eye.halfAngle == 0 || s.eye.forward == eye.forward);
    if (sameRays && sameImage) return;
    s.eye = eye;
    if (sameRays) s.gloss.markImage();
    else s.gloss.markAll();
    s.newEye = true;
}

bool LiveScene::refine(double seconds, Progress& progress) {
    State& s = *state_;
    const auto start = Clock::now();
    progress.check();
    if (s.newGeometry || s.newLight || s.newEye || s.newValues) {
        s.coarse(progress);
        if (secondsSince(start) >= seconds) {
            s.makeFrame();
            return false;
        }
    } else if (s.finished) {
        return true;
    }
    bool left = true;
    while (left && secondsSince(start) < seconds) left = s.refineBatch(progress);
    s.sumLight();
    s.gloss.coarse(s.glossInputs(), progress);
    s.finished = !left;
    s.makeFrame();
    return s.finished;
}

std::shared_ptr<const LiveFrame> LiveScene::frame() const { return state_->frame; }

}  // namespace relamp
