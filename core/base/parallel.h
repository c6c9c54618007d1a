// The only way to more cores (TBB underneath). Work is cut into fixed blocks that do not depend on the number of
// threads, and sums over blocks are added in block order: the same bits on 1 and N threads.
#pragma once
#include <cstddef>
#include <functional>
#include <memory>
#include <vector>

#include "base/progress.h"

namespace relamp {

/// Limits every parallelFor that starts while it lives to `threads`, 256 at most (0: all cores).
class ThreadLimit {
public:
    explicit ThreadLimit(int threads);
    ~ThreadLimit();
    ThreadLimit(const ThreadLimit&) = delete;
    ThreadLimit& operator=(const ThreadLimit&) = delete;

private:
    struct Control;
    std::unique_ptr<Control> control_;
};

/// Cores this process may use.
int availableThreads();

/// Calls body(begin, end) for consecutive blocks of `block` indices covering [0, count). Advances `progress` by the
/// block's size and stops with Cancelled between blocks. An exception in a body is rethrown here.
void parallelBlocks(size_t count, size_t block, const std::function<void(size_t, size_t)>& body,
                    Progress* progress = nullptr);

/// Calls body(i) for every i in [0, count).
template <class Body>
void parallelFor(size_t count, size_t block, Body&& body, Progress* progress = nullptr) {
    parallelBlocks(
        count, block,
        [&](size_t begin, size_t end) {
            for (size_t i = begin; i < end; ++i) body(i);
        },
        progress);
}

/// Sum of partial(begin, end) over fixed blocks, added in order.
template <class T, class Partial>
T parallelSum(size_t count, size_t block, T zero, Partial&& partial, Progress* progress = nullptr) {
    std::vector<T> parts((count + block - 1) / block, zero);
    parallelBlocks(
        count, block, [&](size_t begin, size_t end) { parts[begin / block] = partial(begin, end); }, progress);
    T sum = zero;
    for (const T& part : parts) sum += part;
    return sum;
}

}  // namespace relamp
