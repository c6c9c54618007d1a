#include "base/job.h"

#include <gtest/gtest.h>

namespace relamp {
namespace {

TEST(Job, givesItsResultAndWakesOnce) {
    std::atomic<int> woken{0};
    Job<int> job([](Progress&) { return 42; }, [&] { ++woken; });
    EXPECT_EQ(job.take(), 42);
    EXPECT_TRUE(job.done());
    EXPECT_EQ(woken, 1);
}

TEST(Job, handsOnWhatTheWorkThrew) {
    Job<int> job([](Progress&) -> int { throw Error("the disk is on fire"); });
    EXPECT_THROW(job.take(), Error);
}

TEST(Job, aStopReachesTheWork) {
    Job<int> job([](Progress& progress) -> int {
        for (;;) {
            progress.check();
            std::this_thread::yield();
        }
    });
    EXPECT_FALSE(job.done());
    job.progress().requestStop();
    EXPECT_THROW(job.take(), Cancelled);
}

TEST(Job, destructionStopsAndWaits) {
    std::atomic<bool> ended{false};
    {
        Job<int> job([&](Progress& progress) -> int {
            try {
                for (;;) progress.check();
            } catch (const Cancelled&) {
                ended = true;
                throw;
            }
        });
    }
    EXPECT_TRUE(ended);
}

}  // namespace
}  // namespace relamp
