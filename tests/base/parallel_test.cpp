#include "base/parallel.h"

#include <gtest/gtest.h>

#include <atomic>
#include <bit>
#include <mutex>
#include <set>

#include "base/error.h"
#include "base/random.h"

namespace relamp {
namespace {

float sumOfHarmonicNoise() {
    return parallelSum(1000003, 1000, 0.0f, [](size_t begin, size_t end) {
        float sum = 0;
        for (size_t i = begin; i < end; ++i) sum += unitFloat(mixBits(i)) / float(i + 1);
        return sum;
    });
}

TEST(Parallel, SumOfFloatsHasTheSameBitsOnOneAndManyThreads) {
    const float expected = [] {
        const ThreadLimit limit(1);
        return sumOfHarmonicNoise();
    }();
    for (const int threads : {2, 3, 8, 0}) {
        const ThreadLimit limit(threads);
        EXPECT_EQ(std::bit_cast<uint32_t>(sumOfHarmonicNoise()), std::bit_cast<uint32_t>(expected)) << threads;
    }
}

TEST(Parallel, EveryIndexIsVisitedOnce) {
    for (const size_t count : {size_t(0), size_t(1), size_t(7), size_t(8), size_t(1001)}) {
        std::vector<std::atomic<int>> visits(count);
        parallelFor(count, 8, [&](size_t i) { ++visits[i]; });
        for (const auto& n : visits) ASSERT_EQ(n, 1);
    }
}

TEST(Parallel, BlocksAreTheSameWhateverTheThreads) {
    for (const int threads : {1, 4}) {
        const ThreadLimit limit(threads);
        std::mutex mutex;
        std::set<std::pair<size_t, size_t>> blocks;
        parallelBlocks(25, 10, [&](size_t begin, size_t end) {
            const std::lock_guard lock(mutex);
            blocks.emplace(begin, end);
        });
        EXPECT_EQ(blocks, (std::set<std::pair<size_t, size_t>>{{0, 10}, {10, 20}, {20, 25}}));
    }
}

TEST(Parallel, ExceptionOfABodyReachesTheCallerAsItself) {
    for (const int threads : {1, 4}) {
        const ThreadLimit limit(threads);
        const auto failAt = [](size_t bad) {
            parallelFor(1000, 10, [&](size_t i) {
                if (i == bad) throw OutOfResources("index {}: no room", i);
            });
        };
        try {
            failAt(537);
            FAIL() << "expected an exception";
        } catch (const OutOfResources& error) { EXPECT_STREQ(error.what(), "index 537: no room"); }
    }
}

TEST(Parallel, StopRequestedInABodyEndsOnOneThreadAfterThatBlock) {
    const ThreadLimit limit(1);
    Progress progress;
    size_t blocks = 0;
    EXPECT_THROW(parallelBlocks(
                     1000, 10,
                     [&](size_t, size_t) {
                         if (++blocks == 5) progress.requestStop();
                     },
                     &progress),
                 Cancelled);
    EXPECT_EQ(blocks, 5u);
}

TEST(Parallel, StopRequestedInABodyLetsEachOtherThreadFinishAtMostABlock) {
    Progress progress;
    std::atomic<int> startedAfterStop{0};
    EXPECT_THROW(parallelBlocks(
                     100000, 10,
                     [&](size_t, size_t) {
                         if (progress.stopRequested()) ++startedAfterStop;
                         progress.requestStop();
                     },
                     &progress),
                 Cancelled);
    EXPECT_LE(startedAfterStop, availableThreads());
}

TEST(Parallel, ProgressReachesOneWhenAllIsDone) {
    Progress progress;
    progress.begin("count", 1003);
    parallelFor(
        1003, 10, [](size_t) {}, &progress);
    EXPECT_EQ(progress.fraction(), 1);
}

TEST(Parallel, WorkAlreadyStoppedIsCancelledInItsFirstBlocks) {
    const ThreadLimit limit(1);
    Progress progress;
    progress.requestStop();
    size_t blocks = 0;
    EXPECT_THROW(parallelBlocks(
                     1000, 10, [&](size_t, size_t) { ++blocks; }, &progress),
                 Cancelled);
    EXPECT_LE(blocks, 1u);
}

TEST(Parallel, LoopsMayNest) {
    std::atomic<int> sum{0};
    parallelFor(10, 1, [&](size_t) { parallelFor(100, 7, [&](size_t) { ++sum; }); });
    EXPECT_EQ(sum, 1000);
}

}  // namespace
}  // namespace relamp
