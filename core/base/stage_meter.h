// What each stage of a long function costs: seconds, and the memory it needs while it runs.
#pragma once
#include <atomic>
#include <cstdint>
#include <string>
#include <thread>
#include <vector>

#include "base/progress.h"

namespace relamp {

struct StageCost {
    std::string name;
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

    /// Ends the stage that runs and begins `name`; an empty name only ends.
    void begin(const std::string& name);
    void end() { begin(""); }
    const std::string& current() const { return name_; }
    const std::vector<StageCost>& stages() const { return stages_; }

private:
    Progress& progress_;
    std::vector<StageCost> stages_;
    std::string name_;
    double since_ = 0;
    size_t atStart_ = 0;
    std::atomic<size_t> highest_{0};
    std::jthread watcher_;
    void look();
};

/// Bytes the program has allocated and not given back. 0 where the allocator keeps no books.
size_t allocatedBytes();

}  // namespace relamp
