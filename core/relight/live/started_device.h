// A device that answers queries elsewhere, such as a graphics card: begun now, taken later.
#pragma once
#include <string>

namespace relamp {

/// Not thread-safe: one thread calls it, from the first start() to its end. The same answers every time.
template <class Query, class Answers>
class StartedDevice {
public:
    virtual ~StartedDevice() = default;
    virtual std::string name() const = 0;
    /// Begins and returns; what the query refers to may change afterwards. Throws Error when the device fails or has no
    /// room.
    virtual void start(const Query& query) = 0;
    /// The answers to the oldest start() that has none yet. Throws Error when the device fails.
    virtual void finish(Answers out) = 0;
    /// Forgets what was started and has no answers yet.
    virtual void forget() = 0;
    /// That, and frees what it holds.
    virtual void clear() = 0;
    /// After it threw: nobody is to ask it again.
    void giveUp() { gaveUp_ = true; }
    bool gaveUp() const { return gaveUp_; }

private:
    bool gaveUp_ = false;
};

}  // namespace relamp
