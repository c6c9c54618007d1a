#include "base/stage_meter.h"

#ifdef RELAMP_SANITIZED
#include <sanitizer/allocator_interface.h>
#else
#include <malloc.h>
#endif

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <mutex>

namespace relamp {

size_t allocatedBytes() {
#ifdef RELAMP_SANITIZED
    return __sanitizer_get_current_allocated_bytes();  // the C library's own books are not even set up then
#else
    const auto books = ::mallinfo2();
    return books.uordblks + books.hblkhd;
#endif
}

StageMeter::StageMeter(Progress& progress) : progress_(progress) {
    watcher_ = std::jthread([this](std::stop_token stop) {
        std::mutex mutex;
        std::condition_variable_any wake;
        std::unique_lock lock(mutex);
        while (!stop.stop_requested()) {
            look();
            wake.wait_for(lock, stop, std::chrono::milliseconds(10), [] { return false; });
        }
    });
}

StageMeter::~StageMeter() = default;

void StageMeter::look() {
    const size_t now = allocatedBytes();
    size_t seen = highest_.load();
    while (now > seen && !highest_.compare_exchange_weak(seen, now)) {}
}

void StageMeter::begin(std::optional<Stage> next) {
    look();
    const double now = progress_.seconds();
    if (current_) {
        auto stage =
            std::find_if(stages_.begin(), stages_.end(), [&](const StageCost& s) { return s.stage == *current_; });
        if (stage == stages_.end()) stage = stages_.insert(stages_.end(), {*current_, 0, 0});
        stage->seconds += now - since_;
        const size_t highest = highest_;
        stage->mib = std::max(stage->mib, highest > atStart_ ? double(highest - atStart_) / (1 << 20) : 0.0);
    }
    current_ = next;
    since_ = now;
    atStart_ = allocatedBytes();
    highest_ = atStart_;
}

}  // namespace relamp
