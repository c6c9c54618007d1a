// Stopping a long function half way, from another thread.
#pragma once
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <functional>
#include <thread>

#include "base/progress.h"

namespace relamp::test {

/// The promise is 100 ms from the request to the return; the bound is wide because a busy machine may run us late, and
/// sanitizers ten times slower.
#ifdef RELAMP_SANITIZED
inline constexpr double stopBoundSeconds = 5;
#else
inline constexpr double stopBoundSeconds = 0.5;
#endif

/// Runs `part`, asks it to stop once it is at `share` of the stage named `stage` (empty: of any), and expects Cancelled
/// soon.
inline void expectStopsHalfWay(const std::function<void(Progress&)>& part, const std::string& stage = "",
                               double fraction = 0.3) {
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
