// What each stage of a long function costs: seconds, and the memory it needs while it runs.
#pragma once
#include <atomic>
#include <cstdint>
#include <optional>
#include <thread>
#include <vector>

#include "base/progress.h"
#include "base/stage.h"

namespace relamp {

struct StageCost {
    Stage stage = Stage::other;
    double seconds = 0;  ///< pauses not counted; the sum over all runs of the stage
    double mib = 0;  ///< most memory allocated at one time beyond what was allocated when the stage began; the largest
                     ///< over its runs
};

/// One stage at a time. A thread looks at the allocator's books every 10 ms while a stage runs; the answer of the work
/// measured is not touched.
class StageMeter {
public:
    explicit StageMeter(Progress& progress);
    ~StageMeter();
    StageMeter(const StageMeter&) = delete;
    StageMeter& operator=(const StageMeter&) = delete;

    /// Ends the stage that runs and begins `stage`; none only ends.
    void begin(std::optional<Stage> stage);
    void end() { begin({}); }
    std::optional<Stage> current() const { return current_; }
    const std::vector<StageCost>& stages() const { return stages_; }

private:
    Progress& progress_;
    std::vector<StageCost> stages_;
    std::optional<Stage> current_;
    double since_ = 0;
    size_t atStart_ = 0;
    std::atomic<size_t> highest_{0};
    std::jthread watcher_;
    void look();
};

/// Bytes the program has allocated and not given back. 0 where the allocator keeps no books.
size_t allocatedBytes();

}  // namespace relamp
