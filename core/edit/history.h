// Undo and redo by value: an entry is a whole look with its estimate, an index moves between entries. One gesture (a
// drag, a slider) is one entry. Knows no window, so that tests and the command line can undo as well.
#pragma once
#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include "relight/look.h"
#include "solve/estimate.h"

namespace relamp {

/// Everything that undo brings back. The heavy parts are shared.
struct Version {
    Look look;
    std::shared_ptr<const Estimate> estimate;     ///< null before the first solve
    std::shared_ptr<const Estimate> distantOnly;  ///< the baseline's estimate, for comparison; null until solved
    /// What estimate and look were made on, of a type that the owner knows; pushed null: as of the present entry. It is
    /// large, so entries go that lead back over more than `mostInputs` others.
    std::shared_ptr<const void> inputs{};
};
inline constexpr size_t mostInputs = 2;

struct HistoryEntry {
    Version version;
    std::string label;  ///< in the user's words: "Move emitter-1"
    std::chrono::system_clock::time_point time;
};

class History {
public:
    /// At most `capacity` entries are kept; the oldest go first.
    explicit History(Version start = {}, std::string label = "Opened", size_t capacity = 1000);

    /// What holds now: the present entry, or the preview of an open gesture.
    const Version& present() const { return gesture_ ? gesture_->preview : entries_[index_].version; }
    /// A new entry after the present one; entries that were undone are dropped. Nothing happens when nothing changed.
    /// Commits an open gesture first.
    void push(const std::string& label, Version version);
    void pushLook(const std::string& label, Look look);

    /// `from`: the look that previews start from, where it is another than the present entry's (a frame between keys).
    void begin(const std::string& label, const Look* from = nullptr);
    /// Shows a look without making an entry. Ignored outside a gesture.
    void preview(Look look);
    void commit();   ///< one entry, if something changed
    void abandon();  ///< back to how it was at begin
    bool inGesture() const { return gesture_ != nullptr; }
    /// The look at begin of the open gesture; the present one outside.
    const Look& gestureStart() const { return gesture_ ? gesture_->start : entries_[index_].version.look; }

    bool canUndo() const { return index_ > 0; }
    bool canRedo() const { return index_ + 1 < entries_.size(); }
    void undo();
    void redo();
    void goTo(size_t entry);
    const std::vector<HistoryEntry>& entries() const { return entries_; }
    size_t index() const { return index_; }

    void markSaved() { savedSerial_ = serials_[index_]; }
    bool unsavedChanges() const { return savedSerial_ != serials_[index_]; }
    /// Rises whenever present() changes.
    uint64_t revision() const { return revision_; }

private:
    struct Gesture {
        std::string label;
        Version preview;
        Look start;
    };
    std::vector<HistoryEntry> entries_;
    std::vector<uint64_t> serials_;  ///< of each entry: tells the saved one after others were dropped
    size_t index_ = 0, capacity_;
    uint64_t nextSerial_ = 1, savedSerial_ = 0, revision_ = 1;
    std::unique_ptr<Gesture> gesture_;
    /// Those that are too many, the oldest first.
    void dropOldest();
};

}  // namespace relamp
