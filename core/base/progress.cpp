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

double Progress::seconds() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }

void Progress::setListener(Listener listener) {
    std::lock_guard lock(mutex_);
    listener_ = std::move(listener);
}

std::string Progress::label() const {
    std::lock_guard lock(mutex_);
    return label_;
}

double Progress::share() const {
    const size_t count = count_;
    return count ? std::min(1.0, double(done_) / double(count)) : 0.0;
}

void Progress::tell() {
    std::lock_guard lock(mutex_);
    if (listener_) listener_(label_, share());
}

}  // namespace relamp
