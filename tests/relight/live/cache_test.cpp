// Baked transport that outlives the program.
#include <gtest/gtest.h>

#include <fstream>

#include "base/log.h"
#include "relight/live/live_scene.h"
#include "support/estimates.h"
#include "support/stopping.h"
#include "support/temporary_folder.h"

namespace relamp {
namespace {

struct Room {
    std::shared_ptr<const Scene> scene;
    std::shared_ptr<Estimate> estimate;
};

Room room(float boxHeight = 0.8f, int cuts = 40) {
    Mesh mesh = test::sheet({-2, -2, 0}, {4, 0, 0}, {0, 4, 0}, cuts, cuts);
    test::append(mesh, test::box({-0.4f, -0.4f, 0.01f}, {0.4f, 0.4f, boxHeight}, 6));
    const std::vector<uint32_t> emitter = test::append(mesh, test::squareAbove(0.4f, 0.9f, 0.5f, 2, 2));
    Room r;
    r.scene = std::make_shared<const Scene>(test::sceneOf(mesh));
    r.estimate = std::make_shared<Estimate>(test::matteEstimate(
        *r.scene, Rgb(0.5f, 0.4f, 0.3f), Rgb(1), test::emittersOf(*r.scene, {emitter}, {Rgb(20, 24, 30)})));
    return r;
}

std::shared_ptr<const LiveFrame> frameOf(const Room& r, const LiveOptions& options) {
    Progress progress;
    LiveScene live(r.scene, r.estimate, options, progress);
    while (!live.refine(1, progress)) {}
    return live.frame();
}

TEST(LiveCache, TheSecondBakeIsReadAndGivesTheSameBits) {
    const test::TemporaryFolder folder;
    const Room r = room();
    LiveOptions cached;
    cached.cacheFolder = folder.path();
    const auto fresh = frameOf(r, {}), first = frameOf(r, cached), second = frameOf(r, cached);
    EXPECT_EQ(first->report.cachedBlocks, 0u);
    EXPECT_GE(second->report.cachedBlocks * 16, r.scene->mesh.vertexCount() - 9);
    EXPECT_EQ(fresh->radiance, first->radiance);
    EXPECT_EQ(fresh->radiance, second->radiance);
}

TEST(LiveCache, AnotherSceneAnotherErrorOrAnotherGridIsBakedAnew) {
    const test::TemporaryFolder folder;
    LiveOptions options;
    options.cacheFolder = folder.path();
    frameOf(room(), options);
    EXPECT_EQ(frameOf(room(0.9f), options)->report.cachedBlocks, 0u);
    LiveOptions other = options;
    other.error = 0.02f;
    EXPECT_EQ(frameOf(room(), other)->report.cachedBlocks, 0u);
    other = options;
    other.gridSide = 16;
    EXPECT_EQ(frameOf(room(), other)->report.cachedBlocks, 0u);
    EXPECT_GT(frameOf(room(), options)->report.cachedBlocks, 0u);
}

TEST(LiveCache, AStoppedBakeGoesOnWhereItStood) {
    const test::TemporaryFolder folder;
    const Room r = room(0.8f, 110);
    LiveOptions options;
    options.cacheFolder = folder.path();
    test::expectStopsHalfWay([&](Progress& progress) { LiveScene live(r.scene, r.estimate, options, progress); },
                             "Transport of the environment", 0.4);
    const auto rest = frameOf(r, options);
    EXPECT_GT(rest->report.cachedBlocks, 0u);
    EXPECT_LT(rest->report.cachedBlocks * 16, r.scene->mesh.vertexCount());
    EXPECT_EQ(rest->radiance, frameOf(r, {})->radiance);
}

TEST(LiveCache, ADamagedFileCostsTimeAndNothingElse) {
    const test::TemporaryFolder folder;
    const Room r = room();
    LiveOptions options;
    options.cacheFolder = folder.path();
    const auto first = frameOf(r, options);
    for (const auto& entry : std::filesystem::directory_iterator(folder.path())) {
        std::fstream file(entry.path(), std::ios::in | std::ios::out | std::ios::binary);
        file.seekp(std::streamoff(std::filesystem::file_size(entry.path()) / 2));
        file << "not what it was";
    }
    std::vector<std::string> lines;
    setLogSink([&](LogLevel, const std::string& line) { lines.push_back(line); });
    const auto again = frameOf(r, options);
    setLogSink({});
    EXPECT_EQ(again->radiance, first->radiance);
    EXPECT_FALSE(lines.empty());
    EXPECT_GT(again->report.cachedBlocks, 0u);
}

}  // namespace
}  // namespace relamp
