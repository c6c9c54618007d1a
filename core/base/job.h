// One piece of background work with its result. The window polls it; nothing is called back into the window.
#pragma once
#include <atomic>
#include <exception>
#include <functional>
#include <memory>
#include <optional>
#include <thread>

#include "base/progress.h"

namespace relamp {

/// Runs `work` on a thread of its own from construction on. Destruction stops it and waits.
template <class T>
class Job {
public:
    /// `wake` is called once, on the job's thread, when the result is there.
    Job(std::function<T(Progress&)> work, std::function<void()> wake = {})
        : thread_([this, work = std::move(work), wake = std::move(wake)] {
              try {
                  result_.emplace(work(progress_));
              } catch (...) { error_ = std::current_exception(); }
              done_.store(true, std::memory_order_release);
              if (wake) wake();
          }) {}
    ~Job() { progress_.requestStop(); }
    Job(const Job&) = delete;
    Job& operator=(const Job&) = delete;

    bool done() const { return done_.load(std::memory_order_acquire); }
    Progress& progress() { return progress_; }
    /// The result, once done; throws what the work threw (Cancelled when it was stopped).
    T take() {
        if (thread_.joinable()) thread_.join();
        if (error_) std::rethrow_exception(error_);
        return std::move(*result_);
    }

private:
    Progress progress_;
    std::optional<T> result_;
    std::exception_ptr error_;
    std::atomic<bool> done_{false};
    std::jthread thread_;  // last: starts when everything else stands, joins first
};

}  // namespace relamp
