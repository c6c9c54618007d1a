#include "base/progress.h"

namespace relamp {

void Progress::begin(const std::string& label, size_t count) {
    check();
    {
        std::lock_guard lock(mutex_);
        label_ = label;
    }
    done_ = 0;
    count_ = count;
    tell();
}

void Progress::advance(size_t steps) {
    check();
    done_ += steps;
    const int64_t now = int64_t(seconds() * 1000);
    int64_t last = lastToldMs_.load();
    if (now - last >= 100 && lastToldMs_.compare_exchange_strong(last, now)) tell();
}

double Progress::seconds() const {
    const int64_t now = (Clock::now() - start_) / std::chrono::nanoseconds(1);
    const int64_t pause = paused_ ? now - pausedSince_ : 0;
    return earlier_ + double(now - pausedTotal_ - pause) * 1e-9;
}

void Progress::setPaused(bool paused) {
    std::lock_guard lock(pauseMutex_);
    if (paused == paused_) return;
    const int64_t now = (Clock::now() - start_) / std::chrono::nanoseconds(1);
    if (paused) pausedSince_ = now;
    else pausedTotal_ += now - pausedSince_;
    paused_ = paused;
    resumed_.notify_all();
}

void Progress::waitWhilePaused() const {
    std::unique_lock lock(pauseMutex_);
    // A stop may come from a signal handler, which cannot notify: look for it now and then.
    while (paused_ && !stop_) resumed_.wait_for(lock, std::chrono::milliseconds(50));
}

void Progress::setListener(Listener listener) {
    std::lock_guard lock(mutex_);
    listener_ = std::move(listener);
}

std::string Progress::label() const {
    std::lock_guard lock(mutex_);
    return label_;
}

double Progress::fraction() const {
    const size_t count = count_;
    return count ? std::min(1.0, double(done_) / double(count)) : 0.0;
}

void Progress::tell() {
    std::lock_guard lock(mutex_);
    if (listener_) listener_(label_, fraction());
}

}  // namespace relamp
