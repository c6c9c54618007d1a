#include "base/stage_meter.h"

#include <gtest/gtest.h>

#include <cstring>

namespace relamp {
namespace {

TEST(StageMeter, BooksEveryStageOnceWithItsTimeInOrder) {
    Progress progress;
    StageMeter meter(progress);
    meter.begin(Stage::visibility);
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    meter.begin(Stage::light);
    meter.begin(Stage::visibility);
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    meter.end();
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
    ASSERT_EQ(meter.stages().size(), 2u);
    EXPECT_EQ(meter.stages()[0].stage, Stage::visibility);
    EXPECT_EQ(meter.stages()[1].stage, Stage::light);
    EXPECT_GE(meter.stages()[0].seconds, 0.04);  // both runs of it
    EXPECT_LE(meter.stages()[0].seconds + meter.stages()[1].seconds, progress.seconds());
}

TEST(StageMeter, TellsTheMostMemoryThatAStageHeld) {
    const size_t before = allocatedBytes();
    std::vector<char> probe(size_t(8) << 20, 1);
    if (allocatedBytes() < before + probe.size()) GTEST_SKIP() << "this allocator keeps no books";
    Progress progress;
    StageMeter meter(progress);
    meter.begin(Stage::scene);
    {
        std::vector<char> block(size_t(64) << 20, 1);
        std::this_thread::sleep_for(std::chrono::milliseconds(60));  // until it was looked at
    }
    meter.begin(Stage::rows);
    std::vector<char> block(size_t(4) << 20, 1);
    meter.end();
    EXPECT_NEAR(meter.stages()[0].mib, 64, 1);
    EXPECT_NEAR(meter.stages()[1].mib, 4, 1);
}

}  // namespace
}  // namespace relamp
