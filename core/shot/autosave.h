// Work that would be lost with the process: the look and where it belongs, written every few seconds while there are
// unsaved edits, and found again after a crash. One file a process, locked while it lives.
#pragma once
#include <chrono>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "relight/look.h"

namespace relamp {

/// An entry of the undo history.
struct AutosavedStep {
    std::string label;
    Look look;
};

/// What an autosave holds.
struct AutosavedWork {
    std::filesystem::path captureFolder;
    std::filesystem::path shotFolder;  ///< empty: never saved
    std::filesystem::path
        estimateShot;  ///< a shot that holds the unsaved estimate; empty: none, or it is in shotFolder
    Look look;
    std::vector<AutosavedStep> steps;  ///< that led to the look, oldest first, made on the same estimate; for undo
    std::string stage;                 ///< what ran in the background ("estimating light"), or empty
    std::string time;                  ///< local time of the save, "2026-11-21 14:03:11"
};

/// A work found after a crash, with its file. While it lives no other process is offered the same work.
struct FoundWork {
    std::filesystem::path file;
    AutosavedWork work;
    std::shared_ptr<void> hold;
};

/// The autosave of this process. Thread-safe is not needed: the window's thread owns it.
class Autosave {
public:
    /// Creates `folder` when needed. Throws nothing: a folder that cannot be written leaves autosaving off (see
    /// working()).
    explicit Autosave(std::filesystem::path folder);
    ~Autosave();
    Autosave(const Autosave&) = delete;
    Autosave& operator=(const Autosave&) = delete;

    bool working() const { return lock_ >= 0; }
    /// Whole or not at all. Throws Error when the disk is full.
    void write(const AutosavedWork& work);
    /// The work is safe elsewhere or was given up: nothing is left to recover.
    void clear();
    /// Folder for a shot with an unsaved estimate. Each estimate has its own, so that the work on disk always goes with
    /// the one it names.
    std::filesystem::path estimateFolder(int number) const;
    /// Removes the estimates but this one.
    void keepEstimate(const std::filesystem::path& folder);

    /// Works of processes that are gone, latest first. Damaged files are skipped and kept; what belongs to no work is
    /// removed.
    std::vector<FoundWork> findLost() const;
    /// Removes a found work and its estimates.
    static void discard(const FoundWork& found);

private:
    std::filesystem::path folder_, stem_;
    int lock_ = -1;
};

}  // namespace relamp
