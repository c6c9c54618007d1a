#include "shot/checkpoint.h"

#include <gtest/gtest.h>

#include "support/shapes.h"
#include "support/temporary_folder.h"

namespace relamp {
namespace {

namespace fs = std::filesystem;

SolveCheckpoint someCheckpoint() {
    SolveCheckpoint c;
    c.step = 3;
    c.seconds = 12.5;
    for (size_t i = 0; i < 16; ++i) c.leaves.push_back(LightLeaves::uniform(2)[i]);
    c.leafRadiance.assign(16, Rgb(1, 2, 3));
    c.timeline.push_back({1.5, "light", 2, 0.25, 0.1});
    c.noBounceBecause = "an open scene";
    c.plan.choices.bounce = false;
    c.plan.choices.lastDigits = c.plan.choices.mattePointsInDetail = true;
    c.lightUnfinished = true;
    c.plan.leftOut.push_back({Omission::distantLight, "it is black", 3, 40});
    return c;
}

TEST(Checkpoint, IsReadBackAsItWasWritten) {
    const test::TemporaryFolder folder;
    const fs::path file = checkpointFile(folder.path() / "x.relamp");
    EXPECT_EQ(file.filename(), ".x.relamp.checkpoint");
    EXPECT_EQ(checkpointFile(folder.path() / "x.relamp/"), file);
    writeCheckpoint(file, 77, someCheckpoint());
    const FoundCheckpoint found = readCheckpoint(file, 77);
    ASSERT_TRUE(found.checkpoint) << found.refused;
    EXPECT_EQ(found.checkpoint->step, 3u);
    EXPECT_EQ(found.checkpoint->seconds, 12.5);
    EXPECT_EQ(found.checkpoint->leafRadiance, someCheckpoint().leafRadiance);
    EXPECT_EQ(found.checkpoint->timeline[0].stage, "light");
    EXPECT_EQ(found.checkpoint->noBounceBecause, "an open scene");
    EXPECT_FALSE(found.checkpoint->plan.choices.bounce);
    EXPECT_TRUE(found.checkpoint->plan.choices.lastDigits && found.checkpoint->plan.choices.mattePointsInDetail &&
                found.checkpoint->lightUnfinished);
    EXPECT_EQ(found.checkpoint->plan.leftOut[0].savedMib, 40);
}

TEST(Checkpoint, AForeignOrDamagedOneIsRefusedWithASentence) {
    const test::TemporaryFolder folder;
    const fs::path file = folder.path() / "c";
    EXPECT_NE(readCheckpoint(file, 1).refused.find("there is no checkpoint"), std::string::npos);
    writeCheckpoint(file, 77, someCheckpoint());
    const FoundCheckpoint foreign = readCheckpoint(file, 78);
    EXPECT_FALSE(foreign.checkpoint);
    EXPECT_NE(foreign.refused.find("another capture"), std::string::npos) << foreign.refused;
    const std::string good = test::TemporaryFolder::read(file);
    for (size_t at = 0; at < good.size(); at += 41) {
        std::string bad = good;
        bad[at] = char(bad[at] ^ 0x20);
        folder.write("c", bad);
        const FoundCheckpoint found = readCheckpoint(file, 77);
        EXPECT_FALSE(found.checkpoint) << at;
        EXPECT_NE(found.refused.find(file.string()), std::string::npos) << at;
    }
    for (const size_t kept : {size_t(0), size_t(20), good.size() / 2, good.size() - 1}) {
        folder.write("c", good.substr(0, kept));
        EXPECT_FALSE(readCheckpoint(file, 77).checkpoint) << kept;
    }
}

TEST(Checkpoint, OneWhoseFieldsAreOthersIsRefusedAsOfAnotherVersion) {
    const test::TemporaryFolder folder;
    const fs::path file = folder.path() / "c";
    writeCheckpoint(file, 77, someCheckpoint());
    const std::string good = test::TemporaryFolder::read(file);
    // The layout stands behind eight letters and the version; before there was one, zeros did.
    for (const char first : {'\0', char(good[12] ^ 1)}) {
        std::string other = good;
        other[12] = first;
        if (!first) other[13] = other[14] = other[15] = 0;
        folder.write("c", other);
        const FoundCheckpoint found = readCheckpoint(file, 77);
        EXPECT_FALSE(found.checkpoint);
        EXPECT_NE(found.refused.find("another version of relamp"), std::string::npos) << found.refused;
    }
}

TEST(Checkpoint, TheFingerprintKnowsInputsAndOptions) {
    Capture capture;
    capture.mesh = test::squareAbove(1, 0, 0, 0);
    capture.views.resize(1);
    capture.views[0].image = Image(4, 3, Rgb(0.5f));
    const SolveOptions options;
    const uint64_t print = solveFingerprint(capture, options, false);
    EXPECT_EQ(print, solveFingerprint(capture, options, false));
    EXPECT_NE(print, solveFingerprint(capture, options, true));
    SolveOptions other = options;
    other.seed = 2;
    EXPECT_NE(print, solveFingerprint(capture, other, false));
    other = options;
    other.gauge.emitter = "emitter-2";
    EXPECT_NE(print, solveFingerprint(capture, other, false));
    Capture changed = capture;
    changed.views[0].image.pixels[11].z += 1e-6f;
    EXPECT_NE(print, solveFingerprint(changed, options, false));
    changed = capture;
    changed.mesh.positions[0].x += 1e-6f;
    EXPECT_NE(print, solveFingerprint(changed, options, false));
    changed = capture;
    changed.views[0].camera.worldFromCamera[3][0] += 1e-9;
    EXPECT_NE(print, solveFingerprint(changed, options, false));
}

TEST(Checkpoint, TheKeeperTakesItsFileAwayAndOutlivesAFullDisk) {
    const test::TemporaryFolder folder;
    const fs::path file = folder.path() / "c";
    CheckpointKeeper keeper(file, 5);
    keeper.take(someCheckpoint());
    EXPECT_TRUE(readCheckpoint(file, 5).checkpoint);
    SolveCheckpoint soon = someCheckpoint();
    soon.step = 4;
    soon.seconds += 1;
    keeper.take(soon);
    EXPECT_EQ(readCheckpoint(file, 5).checkpoint->step, 3u) << "not more often than every two seconds";
    soon.seconds += 2;
    keeper.take(soon);
    EXPECT_EQ(readCheckpoint(file, 5).checkpoint->step, 4u);
    keeper.remove();
    EXPECT_EQ(folder.entries(), 0u);
    CheckpointKeeper nowhere(folder.path() / "absent/c", 5);
    EXPECT_NO_THROW(nowhere.take(someCheckpoint()));
}

}  // namespace
}  // namespace relamp
