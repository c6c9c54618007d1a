// Progress of a long function and the way to stop it. One object goes down through every stage; the window or the
// command line polls it from another thread.
#pragma once
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <string>

#include "base/error.h"

namespace relamp {

/// Thread-safe. Stages call begin(), then advance(); both throw Cancelled once requestStop() was called or, where a
/// stage says so, the stage itself asks outOfTime() and returns its best answer so far.
class Progress {
public:
    using Listener = std::function<void(const std::string& label, double fraction)>;

    /// Starts a stage of `count` steps. The listener, if any, is told.
    void begin(const std::string& label, size_t count);
    /// Counts `steps` as done. Throws Cancelled when a stop was requested.
    void advance(size_t steps = 1);
    /// Throws Cancelled when a stop was requested; waits while paused.
    void check() const {
        if (paused_.load(std::memory_order_relaxed)) waitWhilePaused();
        if (stop_.load(std::memory_order_relaxed)) throw Cancelled{};
        if (dispensable_.load(std::memory_order_relaxed) > 0 && outOfTime()) throw OutOfTime{};
    }
    /// While it lives, check(), begin() and advance() throw OutOfTime once the budget is used up: for work that can be
    /// given up in the middle.
    class Dispensable {
    public:
        explicit Dispensable(Progress& progress) : progress_(progress) { ++progress_.dispensable_; }
        ~Dispensable() { --progress_.dispensable_; }
        Dispensable(const Dispensable&) = delete;
        Dispensable& operator=(const Dispensable&) = delete;

    private:
        Progress& progress_;
    };
    /// May be called from a signal handler. A paused job ends too, within 50 ms.
    void requestStop() { stop_.store(true, std::memory_order_relaxed); }
    bool stopRequested() const { return stop_.load(std::memory_order_relaxed); }
    /// Holds every thread at its next check until resumed or stopped.
    void setPaused(bool paused);
    bool paused() const { return paused_.load(std::memory_order_relaxed); }

    /// Seconds since construction, pauses not counted, and those taken over.
    double seconds() const;
    /// Seconds that an earlier run, which this one goes on from, has used. Before the work starts.
    void takeOver(double seconds) { earlier_ = seconds; }
    /// A wall-clock budget; 0 is none. Iterative stages end early with their best answer when it is used up.
    void setBudget(double seconds) { budgetSeconds_ = seconds; }
    bool hasBudget() const { return budgetSeconds_ > 0; }
    bool outOfTime() const { return budgetSeconds_ > 0 && seconds() > budgetSeconds_; }

    void setListener(Listener listener);
    std::string label() const;
    double fraction() const;

private:
    using Clock = std::chrono::steady_clock;
    Clock::time_point start_ = Clock::now();
    std::atomic<bool> stop_{false}, paused_{false};
    std::atomic<int64_t> pausedSince_{0}, pausedTotal_{0};  // nanoseconds
    std::atomic<int> dispensable_{0};
    double earlier_ = 0;
    std::atomic<size_t> done_{0}, count_{0};
    std::atomic<int64_t> lastToldMs_{0};
    double budgetSeconds_ = 0;
    mutable std::mutex mutex_, pauseMutex_;
    mutable std::condition_variable resumed_;
    std::string label_;
    Listener listener_;
    void tell();
    void waitWhilePaused() const;
};

}  // namespace relamp
