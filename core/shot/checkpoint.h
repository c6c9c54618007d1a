// The file that a solve leaves behind while it runs, from which a killed one goes on.
#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "capture/capture.h"
#include "solve/solve.h"

namespace relamp {

/// Beside the shot that is being made: ".NAME.relamp.checkpoint".
std::filesystem::path checkpointFile(const std::filesystem::path& shot);

/// A number of everything the answer rests on: photographs, masks, cameras, mesh, options, the program's version. Not
/// of threads and time. Reads all pixels once, about 10 ms.
uint64_t solveFingerprint(const Capture& capture, const SolveOptions& options, bool everything);

/// Whole or not at all, flushed to disk. Throws Error naming the file, OutOfResources.
void writeCheckpoint(const std::filesystem::path& file, uint64_t fingerprint, const SolveCheckpoint& checkpoint);

struct FoundCheckpoint {
    std::optional<SolveCheckpoint> checkpoint;
    std::string refused;  ///< why there is none: a sentence
};

/// Never throws for what stands in the file: damaged, of another version, or of other inputs or options, it is refused.
FoundCheckpoint readCheckpoint(const std::filesystem::path& file, uint64_t fingerprint);

/// Writes a solve's checkpoints as they come, not more often than every `everySeconds`, and takes the file away in the
/// end. A full disk stops the writing with one warning, not the solve.
class CheckpointKeeper {
public:
    CheckpointKeeper(std::filesystem::path file, uint64_t fingerprint, double everySeconds = 2)
        : file_(std::move(file)), fingerprint_(fingerprint), everySeconds_(everySeconds) {}
    void take(const SolveCheckpoint& checkpoint);
    /// The solve is stopped: writes the last checkpoint that came too soon after another, if there is one.
    void flush();
    /// The solve has ended well.
    void remove();

private:
    std::filesystem::path file_;
    uint64_t fingerprint_ = 0;
    double everySeconds_ = 2;
    double last_ = -1e9;
    std::optional<SolveCheckpoint> waiting_;  ///< came too soon to be written
    bool failed_ = false;
    void write(const SolveCheckpoint& checkpoint);
};

}  // namespace relamp
