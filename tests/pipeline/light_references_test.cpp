// Grey cards, charts and mirror balls of a small scene whose truth is known, good ones and bad ones.
#include <gtest/gtest.h>

#include "base/statistics.h"
#include "image/environment_map.h"
#include "pipeline/marked_reference.h"
#include "pipeline/pipeline.h"
#include "pipeline/probe_stage.h"
#include "solve/chart.h"
#include "support/known_world.h"

namespace relamp {
namespace {

namespace fs = std::filesystem;

/// The known world with things laid on its floor, its photographs balanced otherwise.
class ReferenceWorld {
public:
    test::TemporaryFolder folder;
    test::KnownWorld truth;
    Capture capture;
    PipelineOptions options;
    Progress progress;

    /// `backdrop`: what lies beside the scene is black, so that nothing tells the scale; else its lamp does.
    explicit ReferenceWorld(bool backdrop, Rgb balance = Rgb(1), bool lamp = true)
        : truth(test::paintKnownWorld(folder / "capture", lamp && !backdrop, 6, 14)) {
        options.solve = solveOptionsFor("draft");
        options.texture = 0;
        options.solve.bounce = SolveOptions::Bounce::off;  // its surfaces do not light each other
        options.reproduce = options.registration = options.photometric = false;
        capture = loadCapture(folder / "capture", {}, progress);
        scene = std::make_shared<const Scene>(test::sceneOf(truth.mesh));
        for (View& view : capture.views)
            for (size_t p = 0; p < view.image.pixels.size(); ++p) {
                const Hit hit = hitOf(view, Vec2(p % 96, p / 96) + 0.5f);
                view.image.pixels[p] *= balance;
                if (!hit && backdrop) view.image.pixels[p] = Rgb(0);
            }
    }
    /// A flat thing on the floor: its albedo where it lies.
    void lay(const std::function<std::optional<Rgb>(const Vec3&)>& thing) {
        for (View& view : capture.views)
            for (size_t p = 0; p < view.image.pixels.size(); ++p) {
                const Hit hit = hitOf(view, Vec2(p % 96, p / 96) + 0.5f);
                if (!hit || scene->pointOf(hit).z > 1e-3f) continue;
                const Vec3 point = scene->pointOf(hit);
                if (const auto albedo = thing(point))
                    view.image.pixels[p] *= *albedo / test::KnownWorld::albedoAt(point);
            }
    }
    Vec2 pixelOf(const Vec3& point) const { return capture.views[0].camera.project(DVec3(point)).value(); }
    void mark(const MarkedReference& reference) { takeReference(reference, options); }

    Estimate solve() {
        StageMeter meter{progress};
        takeMirrorBalls(options, capture);
        Prepared prepared = prepare(capture, options, meter, progress);
        return solvePrepared(capture, *prepared.scene, prepared, options, meter, progress);
    }
    /// Found over true albedo of the floor where no card lies, median per channel.
    Rgb scaleOf(const Estimate& found) const {
        Rgb scale(0);
        for (int c = 0; c < 3; ++c) {
            std::vector<float> ratios;
            for (size_t v = 0; v < truth.albedo.size(); ++v)
                if (truth.mesh.positions[v].z < 1e-3f && truth.mesh.positions[v].y < 0 &&
                    found.reflectance.observed[v] > 1)
                    ratios.push_back(found.reflectance.weight[0][v][c] / truth.albedo[v][c]);
            scale[c] = medianOf(std::move(ratios));
        }
        return scale;
    }

private:
    std::shared_ptr<const Scene> scene;
    Hit hitOf(const View& view, const Vec2& pixel) const {
        return scene->tracer->closest({Vec3(view.camera.position()), view.camera.rayDirection(pixel), 0, 1e30f});
    }
};

constexpr Vec3 cardAt(0.72f, 0.25f, 0);
constexpr float cardRadius = 0.17f;
std::optional<Rgb> greyCard(const Vec3& p) {
    return glm::distance(p, cardAt) < cardRadius ? std::optional(Rgb(0.18f)) : std::nullopt;
}
MarkedReference greyMark(const ReferenceWorld& world, float albedo) {
    return {MarkedReference::Kind::grey, 0, {world.pixelOf(cardAt)}, 2.5f, Rgb(albedo)};
}

/// 24 patches of 0.13 m on the floor, dark skin first.
constexpr Vec3 chartAt(-0.1f, 0.25f, 0), chartRight(0.13f, 0, 0), chartDown(0, 0.13f, 0);
std::optional<Rgb> chartCard(const Vec3& p) {
    static const std::vector<KnownPatch> patches = chartPatches(0, {Vec2(0, 0), Vec2(5, 0), Vec2(5, 3), Vec2(0, 3)});
    const int x = int(std::floor((p.x - chartAt.x) / 0.13f + 0.5f)),
              y = int(std::floor((p.y - chartAt.y) / 0.13f + 0.5f));
    if (x < 0 || x > 5 || y < 0 || y > 3) return std::nullopt;
    return patches[size_t(6 * y + x)].albedo;
}
MarkedReference chartMark(const ReferenceWorld& world) {
    MarkedReference mark;
    mark.kind = MarkedReference::Kind::chart;
    for (const Vec3& corner : {chartAt, chartAt + 5.0f * chartRight, chartAt + 5.0f * chartRight + 3.0f * chartDown,
                               chartAt + 3.0f * chartDown})
        mark.points.push_back(world.pixelOf(corner));
    return mark;
}
size_t leftOut(const Estimate& found) {
    return size_t(std::count_if(found.patches.begin(), found.patches.end(), [](const PatchFit& p) { return !p.used; }));
}

TEST(LightReferences, AFlatGreyCardTellsScaleAndWhiteBalance) {
    ReferenceWorld world(true, Rgb(1.25f, 1, 0.7f));
    world.lay(greyCard);
    world.mark(greyMark(world, 0.18f));
    const Estimate found = world.solve();
    EXPECT_EQ(found.gauge.kind, "known albedo");
    const Rgb scale = world.scaleOf(found);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(scale[c], 1, 0.04f) << c;
    EXPECT_FALSE(found.patches.at(0).doubtful) << found.patches[0].words;
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(found.patches[0].found[c], 0.18f, 0.02f * 0.18f) << c;
}

TEST(LightReferences, AWrongGreyCardIsLeftOutWhereALampTellsTheScale) {
    ReferenceWorld world(false);
    world.lay(greyCard);
    world.mark(greyMark(world, 0.5f));
    const Estimate found = world.solve();
    EXPECT_EQ(found.gauge.kind, "emitter");
    EXPECT_FALSE(found.patches.at(0).used);
    EXPECT_NE(found.patches[0].words.find("left out"), std::string::npos) << found.patches[0].words;
    const Rgb scale = world.scaleOf(found);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(scale[c], 1, 0.08f) << c;
}

TEST(LightReferences, AChartTellsScaleAndWhiteBalanceAndAWrongGreyBesideItIsLeftOut) {
    ReferenceWorld world(true, Rgb(1.25f, 1, 0.7f));
    world.lay(chartCard);
    world.lay(greyCard);
    world.mark(chartMark(world));
    world.mark(greyMark(world, 0.5f));
    const Estimate found = world.solve();
    EXPECT_EQ(found.gauge.kind, "known albedo");
    ASSERT_EQ(found.patches.size(), 25u);
    EXPECT_FALSE(found.patches[24].used) << found.patches[24].words;
    EXPECT_LE(leftOut(found), 4u);
    const Rgb scale = world.scaleOf(found);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(scale[c], 1, 0.04f) << c;
}

TEST(LightReferences, AChartThatIsMarkedTheWrongWayRoundDoesNotSetTheScale) {
    ReferenceWorld world(false);
    world.lay(chartCard);
    MarkedReference mark = chartMark(world);
    std::rotate(mark.points.begin(), mark.points.begin() + 2, mark.points.end());
    world.mark(mark);
    const Estimate found = world.solve();
    EXPECT_GT(leftOut(found), 12u);
    const Rgb scale = world.scaleOf(found);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(scale[c], 1, 0.08f) << c;
}

/// Relative root mean square difference of the environment from the sky.
double environmentError(const Estimate& found) {
    const DirectionGrid grid{found.environmentSide};
    double squares = 0, all = 0;
    for (int c = 0; c < grid.cells(); c += 7) {
        const DVec3 sky(test::KnownWorld::sky(grid.direction(c))), off = DVec3(found.environment[size_t(c)]) - sky;
        squares += glm::dot(off, off);
        all += glm::dot(sky, sky);
    }
    return std::sqrt(squares / all);
}

/// A ball of reflectance 0.6 before the first view's camera, photographed in twice its size.
void photographBall(const Camera& of, const std::function<Rgb(const Vec3&)>& sky, const fs::path& file) {
    Camera camera = of;
    constexpr int larger = 2;
    camera.width *= larger, camera.height *= larger;
    for (double* value : {&camera.focalX, &camera.focalY, &camera.centreX, &camera.centreY}) *value *= larger;
    const DVec3 eye = camera.position(), centre = eye + 1.2 * camera.forward();
    constexpr double radius = 0.3;
    Image image(camera.width, camera.height);
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x)
            for (int k = 0; k < 4; ++k) {
                const DVec3 d(camera.rayDirection(
                    Vec2(float(x) + 0.25f + 0.5f * float(k % 2), float(y) + 0.25f + 0.5f * float(k / 2))));
                const double along = glm::dot(centre - eye, d),
                             across = glm::dot(centre - eye, centre - eye) - along * along;
                Vec3 shown(d);
                const bool ball = across < radius * radius;
                if (ball) {
                    const DVec3 normal =
                        (along * d - std::sqrt(radius * radius - across) * d - (centre - eye)) / radius;
                    shown = Vec3(d - 2 * glm::dot(d, normal) * normal);
                }
                image.at(x, y) += (ball ? 0.6f : 0.05f) / 4 * sky(shown);
            }
    writeImage(file, image);
}

TEST(LightReferences, AMirrorBallHalvesTheErrorOfTheEnvironmentAndOneOfAnotherPlaceIsLeftOut) {
    ReferenceWorld world(false, Rgb(1), false), without(false, Rgb(1), false);
    const Camera& camera = world.capture.views[0].camera;
    photographBall(camera, test::KnownWorld::sky, world.folder / "ball.exr");
    photographBall(
        camera,
        [](const Vec3& d) {
            return int(std::floor(4 * d.x + 9) + std::floor(4 * d.y + 9)) % 2 ? Rgb(6, 2, 0.3f)
                                                                              : Rgb(0.02f, 0.1f, 0.3f);
        },
        world.folder / "other.exr");
    for (const char* file : {"ball.exr", "other.exr"})
        world.mark({MarkedReference::Kind::mirrorBall, 0, {Vec2(96, 72)}, 49, Rgb(0.18f), world.folder / file});
    const Estimate found = world.solve();
    ASSERT_EQ(found.probes.size(), 2u);
    EXPECT_TRUE(found.probes[0].used) << found.probes[0].words;
    EXPECT_FALSE(found.probes[1].used) << found.probes[1].words;
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(found.probes[0].gain[c], 1 / 0.6f, 0.05f) << c;
    EXPECT_LT(environmentError(found), 0.5 * environmentError(without.solve()));
}

TEST(LightReferences, AProbeOfARoomIsTrustedThoughItsWallsLightTheFloor) {
    test::TemporaryFolder folder;
    const test::KnownWorld truth = test::paintKnownWorld(folder / "room", true, 6, 24, true);
    PipelineOptions options;
    options.solve = solveOptionsFor("draft");
    options.registration = options.photometric = false;
    Progress progress;
    StageMeter meter{progress};
    Capture capture = loadCapture(folder / "room", {}, progress);
    const Prepared prepared = prepare(capture, options, meter, progress);
    LightProbe probe;
    probe.name = "sky";
    probe.latLong = Image(128, 64);
    for (int y = 0; y < 64; ++y)
        for (int x = 0; x < 128; ++x)
            probe.latLong.at(x, y) =
                test::KnownWorld::sky(directionFromLatLong(Vec2((float(x) + 0.5f) / 128, (float(y) + 0.5f) / 64)));
    FittedProbes used;
    const std::vector<ProbeFit> fits =
        fitProbes({probe}, *prepared.scene, *prepared.samples, prepared.clusters, options.solve, used, progress);
    ASSERT_EQ(fits.size(), 1u);
    EXPECT_TRUE(fits[0].used) << fits[0].words;
    EXPECT_FALSE(fits[0].contradicted) << fits[0].words;
}

}  // namespace
}  // namespace relamp
