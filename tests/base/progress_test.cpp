#include "base/progress.h"

#include <gtest/gtest.h>

#include <thread>
#include <vector>

namespace relamp {
namespace {

TEST(Progress, ShareCountsFromZeroToOneInEveryStage) {
    Progress progress;
    EXPECT_EQ(progress.fraction(), 0);
    progress.begin("first", 4);
    EXPECT_EQ(progress.label(), "first");
    progress.advance();
    EXPECT_EQ(progress.fraction(), 0.25);
    progress.advance(3);
    EXPECT_EQ(progress.fraction(), 1);
    progress.begin("second", 10);
    EXPECT_EQ(progress.label(), "second");
    EXPECT_EQ(progress.fraction(), 0);
}

TEST(Progress, ShareNeverExceedsOneAndAnEmptyStageIsZero) {
    Progress progress;
    progress.begin("stage", 2);
    progress.advance(5);
    EXPECT_EQ(progress.fraction(), 1);
    progress.begin("empty", 0);
    EXPECT_EQ(progress.fraction(), 0);
}

TEST(Progress, StopMakesEveryCallThrowCancelled) {
    Progress progress;
    progress.begin("stage", 2);
    EXPECT_NO_THROW(progress.check());
    progress.requestStop();
    EXPECT_TRUE(progress.stopRequested());
    EXPECT_THROW(progress.check(), Cancelled);
    EXPECT_THROW(progress.advance(), Cancelled);
    EXPECT_THROW(progress.begin("next", 1), Cancelled);
    EXPECT_EQ(progress.label(), "stage");
}

TEST(Progress, StopFromAnotherThreadEndsALoop) {
    Progress progress;
    progress.begin("endless", 1);
    std::thread stopper([&] { progress.requestStop(); });
    EXPECT_THROW(for (;;) progress.advance(), Cancelled);
    stopper.join();
}

TEST(Progress, ListenerHearsTheStartOfEachStage) {
    Progress progress;
    std::vector<std::string> heard;
    progress.setListener([&](const std::string& label, double fraction) {
        heard.push_back(label);
        EXPECT_GE(fraction, 0);
        EXPECT_LE(fraction, 1);
    });
    progress.begin("one", 3);
    progress.begin("two", 3);
    EXPECT_EQ(heard, (std::vector<std::string>{"one", "two"}));
}

TEST(Progress, ListenerIsNotFloodedByManySmallSteps) {
    Progress progress;
    size_t told = 0;
    progress.setListener([&](const std::string&, double) { ++told; });
    progress.begin("stage", 100000);
    for (int k = 0; k < 100000; ++k) progress.advance();
    EXPECT_LE(double(told), 2 + progress.seconds() * 10);
}

TEST(Progress, BudgetIsUsedUpOnlyWhenSetAndPassed) {
    Progress progress;
    EXPECT_FALSE(progress.outOfTime());
    progress.setBudget(3600);
    EXPECT_FALSE(progress.outOfTime());
    progress.setBudget(1e-6);
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    EXPECT_TRUE(progress.outOfTime());
    EXPECT_NO_THROW(progress.check());
}

TEST(Progress, CountsStepsOfManyThreads) {
    Progress progress;
    progress.begin("stage", 4000);
    std::vector<std::thread> threads;
    for (int t = 0; t < 4; ++t)
        threads.emplace_back([&] {
            for (int k = 0; k < 500; ++k) progress.advance();
        });
    for (std::thread& thread : threads) thread.join();
    EXPECT_EQ(progress.fraction(), 0.5);
}

TEST(Progress, APausedStageWaitsAndItsClockStandsStill) {
    Progress progress;
    progress.begin("stage", 1000000);
    std::atomic<size_t> steps{0};
    std::jthread worker([&](std::stop_token stop) {
        while (!stop.stop_requested()) {
            progress.advance();
            ++steps;
            std::this_thread::sleep_for(std::chrono::microseconds(100));
        }
    });
    while (steps < 3) std::this_thread::yield();
    progress.setPaused(true);
    std::this_thread::sleep_for(std::chrono::milliseconds(20));  // the step under way ends
    const size_t held = steps;
    const double clock = progress.seconds();
    std::this_thread::sleep_for(std::chrono::milliseconds(60));
    EXPECT_EQ(steps, held);
    EXPECT_EQ(progress.seconds(), clock);
    progress.setPaused(false);
    while (steps == held) std::this_thread::yield();
    EXPECT_GT(progress.seconds(), 0);
}

TEST(Progress, AStopEndsAPause) {
    Progress progress;
    progress.setPaused(true);
    std::jthread stopper([&] {
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
        progress.requestStop();
    });
    EXPECT_THROW(progress.check(), Cancelled);
}

TEST(Progress, OnlyDispensableWorkEndsWithTheBudget) {
    Progress progress;
    progress.setBudget(1e-9);
    EXPECT_TRUE(progress.outOfTime());
    EXPECT_NO_THROW(progress.check());
    {
        const Progress::Dispensable outer(progress);
        EXPECT_THROW(progress.check(), OutOfTime);
        { const Progress::Dispensable inner(progress); }
        EXPECT_THROW(progress.advance(), OutOfTime);
    }
    EXPECT_NO_THROW(progress.advance());
    progress.setBudget(0);
    const Progress::Dispensable unlimited(progress);
    EXPECT_NO_THROW(progress.check());
}

TEST(Progress, TakesOverTheTimeOfAnEarlierRun) {
    Progress progress;
    progress.takeOver(100);
    EXPECT_GE(progress.seconds(), 100);
    progress.setBudget(50);
    EXPECT_TRUE(progress.outOfTime());
}

}  // namespace
}  // namespace relamp
