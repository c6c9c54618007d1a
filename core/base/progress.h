// Progress of a long function and the way to stop it. One object goes down through every stage; the window or the
// command line polls it from another thread.
#pragma once
#include <atomic>
#include <chrono>
#include <functional>
#include <mutex>
#include <string>

#include "base/error.h"

namespace relamp {

/// Thread-safe. Stages call begin(), then advance(); both throw Cancelled once requestStop() was called or, where a
/// stage says so, the stage itself asks outOfTime() and returns its best answer so far.
class Progress {
public:
    using Listener = std::function<void(const std::string& label, double share)>;

    /// Starts a stage of `count` steps. The listener, if any, is told.
    void begin(const std::string& label, size_t count);
    /// Counts `steps` as done. Throws Cancelled when a stop was requested.
    void advance(size_t steps = 1);
    /// Throws Cancelled when a stop was requested.
    void check() const {
        if (stop_.load(std::memory_order_relaxed)) throw Cancelled{};
    }
    void requestStop() { stop_.store(true, std::memory_order_relaxed); }
    bool stopRequested() const { return stop_.load(std::memory_order_relaxed); }

    /// Seconds since construction.
    double seconds() const;
    /// A wall-clock budget; 0 is none. Iterative stages end early with their best answer when it is used up.
    void setBudget(double seconds) { budgetSeconds_ = seconds; }
    bool outOfTime() const { return budgetSeconds_ > 0 && seconds() > budgetSeconds_; }

    void setListener(Listener listener);
    std::string label() const;
    double share() const;

private:
    using Clock = std::chrono::steady_clock;
    Clock::time_point start_ = Clock::now();
    std::atomic<bool> stop_{false};
    std::atomic<size_t> done_{0}, count_{0};
    std::atomic<int64_t> lastToldMs_{0};
    double budgetSeconds_ = 0;
    mutable std::mutex mutex_;
    std::string label_;
    Listener listener_;
    void tell();
};

}  // namespace relamp
