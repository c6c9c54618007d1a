// Another place than the processor to sum stored transport, such as a graphics card, and the choice between the two by
// measurement.
#pragma once
#include <array>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "base/progress.h"
#include "transport/transport_store.h"

namespace relamp {

/// Sums a TransportStore elsewhere. Not thread-safe: one thread calls it, from the first load() to its end. Answers as
/// TransportStore::apply() to 1e-3 of the brightest vertex, and the same bits every time.
class TransportDevice {
public:
    virtual ~TransportDevice() = default;
    virtual std::string name() const = 0;
    /// Takes a copy of `store`; returns at once when it holds this version. Throws Error when there is no room.
    void load(const TransportStore& store) {
        if (held_ == store.version()) return;
        held_ = none;
        take(store);
        held_ = store.version();
    }
    /// As TransportStore::apply() of the loaded store. Throws Error when the device fails.
    virtual void apply(const std::array<std::vector<float>, 3>& coefs, std::span<Rgb> out) = 0;
    /// After it threw: nobody is to ask it again.
    void giveUp() { gaveUp_ = true; }
    bool gaveUp() const { return gaveUp_; }

protected:
    virtual void take(const TransportStore& store) = 0;

private:
    static constexpr uint64_t none = ~uint64_t(0);
    uint64_t held_ = none;
    bool gaveUp_ = false;
};

/// Sums on the processor or on a device, whichever was faster. A device that fails is left for good; nothing is lost by
/// it.
class TransportSums {
public:
    /// Takes `device` (null: the processor) where it answers as the processor does and its median of three is the lower
    /// one, or `force`. `cells`: length of one channel's coefficients. Cost: eight passes over the store. Throws
    /// Cancelled.
    void choose(const TransportStore& store, size_t cells, std::shared_ptr<TransportDevice> device, bool force,
                Progress& progress);
    /// As TransportStore::apply().
    void apply(const TransportStore& store, const std::array<std::vector<float>, 3>& coefs, std::span<Rgb> out);
    std::string device() const { return device_ ? device_->name() : std::string(); }  ///< in use; empty: the processor
    double processorMs() const { return processorMs_; }                               ///< as measured by choose()
    double deviceMs() const { return deviceMs_; }  ///< 0: there is none, or it failed

private:
    std::shared_ptr<TransportDevice> device_;
    double processorMs_ = 0, deviceMs_ = 0;
};

}  // namespace relamp
