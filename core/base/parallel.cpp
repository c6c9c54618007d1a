#include "base/parallel.h"

#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>

#ifndef __has_feature
#define __has_feature(feature) 0
#endif
#if defined(__SANITIZE_THREAD__) || __has_feature(thread_sanitizer)
#include <sanitizer/tsan_interface.h>
#endif

namespace relamp {
namespace {

/// Tells ThreadSanitizer what TBB, which is not built with it, guarantees: blocks begin after what came before
/// parallelBlocks, and end before what comes after it. Nothing holds between two blocks.
class Handover {
public:
#if defined(__SANITIZE_THREAD__) || __has_feature(thread_sanitizer)
    Handover() { __tsan_release(&begin_); }
    ~Handover() { __tsan_acquire(&end_); }
    void blockBegins() { __tsan_acquire(&begin_); }
    void blockEnds() { __tsan_release(&end_); }

private:
    char begin_ = 0, end_ = 0;
#else
    void blockBegins() {}
    void blockEnds() {}
#endif
};

struct Block {
    Handover& handover;
    explicit Block(Handover& h) : handover(h) { handover.blockBegins(); }
    ~Block() { handover.blockEnds(); }
};

}  // namespace

struct ThreadLimit::Control {
    explicit Control(int threads) : control(tbb::global_control::max_allowed_parallelism, size_t(threads)) {}
    tbb::global_control control;
};
ThreadLimit::ThreadLimit(int threads) {
    // Each costs memory whether or not there is a core for it.
    constexpr int most = 256;
    if (threads > 0) control_ = std::make_unique<Control>(std::min(threads, most));
}
ThreadLimit::~ThreadLimit() = default;

int availableThreads() { return tbb::info::default_concurrency(); }

void parallelBlocks(size_t count, size_t block, const std::function<void(size_t, size_t)>& body, Progress* progress) {
    if (count == 0) return;
    block = std::max<size_t>(block, 1);
    const size_t blocks = (count + block - 1) / block;
    Handover handover;
    // An exception must reach the caller as itself, and TBB's cancellation must not skip blocks silently.
    tbb::parallel_for(
        tbb::blocked_range<size_t>(0, blocks, 1),
        [&](const tbb::blocked_range<size_t>& range) {
            for (size_t b = range.begin(); b != range.end(); ++b) {
                const Block inside(handover);
                const size_t begin = b * block, end = std::min(count, begin + block);
                body(begin, end);
                if (progress) progress->advance(end - begin);
            }
        },
        tbb::simple_partitioner());
}

}  // namespace relamp
