#include "edit/history.h"

namespace relamp {

History::History(Version start, std::string label, size_t capacity) : capacity_(std::max<size_t>(2, capacity)) {
    entries_.push_back({std::move(start), std::move(label), std::chrono::system_clock::now()});
    serials_.push_back(0);
}

void History::push(const std::string& label, Version version) {
    commit();
    const Version& now = entries_[index_].version;
    if (!version.inputs) version.inputs = now.inputs;
    if (version.look == now.look && version.estimate == now.estimate && version.distantOnly == now.distantOnly &&
        version.inputs == now.inputs)
        return;
    entries_.resize(index_ + 1);
    serials_.resize(index_ + 1);
    entries_.push_back({std::move(version), label, std::chrono::system_clock::now()});
    serials_.push_back(nextSerial_++);
    dropOldest();
    index_ = entries_.size() - 1;
    ++revision_;
}

void History::dropOldest() {
    size_t first = entries_.size() > capacity_ ? entries_.size() - capacity_ : 0, others = 0;
    for (size_t i = entries_.size() - 1; i > first; --i)
        if (entries_[i - 1].version.inputs != entries_[i].version.inputs && ++others > mostInputs) first = i;
    entries_.erase(entries_.begin(), entries_.begin() + std::ptrdiff_t(first));
    serials_.erase(serials_.begin(), serials_.begin() + std::ptrdiff_t(first));
}

void History::pushLook(const std::string& label, Look look) {
    commit();
    Version version = entries_[index_].version;
    version.look = std::move(look);
    push(label, std::move(version));
}

void History::begin(const std::string& label, const Look* from) {
    commit();
    gesture_ = std::make_unique<Gesture>(Gesture{label, entries_[index_].version, {}});
    if (from) gesture_->preview.look = *from;
    gesture_->start = gesture_->preview.look;
}

void History::preview(Look look) {
    if (!gesture_ || gesture_->preview.look == look) return;
    gesture_->preview.look = std::move(look);
    ++revision_;
}

void History::commit() {
    if (!gesture_) return;
    const std::unique_ptr<Gesture> gesture = std::move(gesture_);
    gesture_ = nullptr;
    if (gesture->preview.look == gesture->start) {
        ++revision_;
        return;
    }
    push(gesture->label, std::move(gesture->preview));
}

void History::abandon() {
    if (!gesture_) return;
    gesture_ = nullptr;
    ++revision_;
}

void History::undo() {
    if (gesture_) return abandon();
    if (canUndo()) goTo(index_ - 1);
}

void History::redo() {
    if (!gesture_ && canRedo()) goTo(index_ + 1);
}

void History::goTo(size_t entry) {
    if (gesture_) abandon();
    if (entry >= entries_.size() || entry == index_) return;
    index_ = entry;
    ++revision_;
}

}  // namespace relamp
