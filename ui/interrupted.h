// An estimate that was stopped or killed before its end, as the state folder keeps it: a record in JSON that names the
// capture and the settings, and beside it the solver's checkpoint. One for each capture; the process that estimates
// holds a lock on it (.RECORD.lock).
#pragma once
#include "editor_state.h"
#include "pipeline/pipeline.h"
#include "shot/checkpoint.h"
#include "shot/shot_lock.h"

namespace relamp::ui {

/// What a request means for the pipeline. Throws Error when measured materials or light references cannot be read.
PipelineOptions pipelineOptionsOf(const SolveRequest& request);

/// The place of a capture's record. Empty without a state folder.
std::filesystem::path interruptedRecord(const std::filesystem::path& stateFolder,
                                        const std::filesystem::path& captureFolder);
/// What a record says. Nothing: there is none, it is damaged, its checkpoint is missing, or its process lives.
std::optional<InterruptedEstimate> readInterrupted(const std::filesystem::path& record);
/// All of them, latest first; their checkpoints are not read.
std::vector<InterruptedEstimate> findInterrupted(const std::filesystem::path& stateFolder);
/// The one of the capture that is open, if the same photographs, mesh and settings are behind it.
std::optional<InterruptedEstimate> interruptedFor(const Document& document, const std::filesystem::path& stateFolder);
/// Takes record and checkpoint away.
void discardInterrupted(const std::filesystem::path& record);

/// Keeps a running estimate's checkpoints and their record. Belongs to the solving thread.
class EstimateKeeper {
public:
    /// `what.record` empty, or another process estimates the same capture: nothing is kept.
    EstimateKeeper(InterruptedEstimate what, uint64_t fingerprint, double everySeconds);
    /// Where the interrupted estimate stood; nothing, and the log says why, when its checkpoint does not fit.
    std::optional<SolveCheckpoint> earlier() const;
    void take(const SolveCheckpoint& checkpoint);
    /// It is stopped: what came since the last checkpoint is not lost.
    void stopped();
    /// It has come to its end.
    void finished();

private:
    InterruptedEstimate what_;
    uint64_t fingerprint_ = 0;
    ShotLock lock_;
    CheckpointKeeper keeper_;
    bool recorded_ = false;
};

}  // namespace relamp::ui
