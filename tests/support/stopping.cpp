#include "support/stopping.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <thread>

namespace relamp::test {

void expectStopsHalfWay(const std::function<void(Progress&)>& part, const std::string& stage, double fraction) {
    using Clock = std::chrono::steady_clock;
    Progress progress;
    std::atomic<bool> ended{false};
    Clock::time_point asked{};
    std::thread watcher([&] {
        while (!ended) {
            if (progress.fraction() > fraction && (stage.empty() || progress.label() == stage)) {
                asked = Clock::now();
                progress.requestStop();
                return;
            }
            std::this_thread::sleep_for(std::chrono::microseconds(200));
        }
    });
    bool cancelled = false;
    Clock::time_point returned{};
    try {
        part(progress);
    } catch (const Cancelled&) { cancelled = true; }
    returned = Clock::now();
    ended = true;
    watcher.join();
    ASSERT_TRUE(progress.stopRequested())
        << "the function ended before it could be stopped: make the test's input larger";
    EXPECT_TRUE(cancelled);
    EXPECT_LT(std::chrono::duration<double>(returned - asked).count(), stopBoundSeconds);
}

}  // namespace relamp::test
