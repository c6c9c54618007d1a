// Another place than the processor for the shadow that a dragged part throws into the environment, and the choice
// between the two by measurement.
#pragma once
#include <functional>
#include <span>
#include <string>

#include "relight/live/device_blockers.h"
#include "relight/live/near.h"
#include "relight/live/started_device.h"
#include "relight/live/visibility.h"

namespace relamp {

/// Which cells a part hides from each slot of LiveMatte.
struct ShadowQuery {
    static constexpr size_t run = 64;  ///< slots of a chunk
    const LiveGrid& grid;
    std::span<const uint32_t> vertexOfSlot;  ///< EditedPart::none: nothing
    std::span<const Vec3> normal;            ///< per slot
    std::span<const uint8_t> masks;          ///< grid.nibbleBytes() a slot
    uint64_t version = 0;                    ///< another one where these changed
    const LiveVertices& vertices;
    const LiveOccluders& occluders;
    const DeviceBlockers& blockers;
    uint32_t part = 0;
};

/// What traceCone() gives with a ray a cell, for all slots.
struct ShadowAnswers {
    static constexpr uint32_t none = ~0u;
    static constexpr uint32_t whole = 1u << 31;
    std::vector<uint32_t> first;    ///< per chunk: its first entry; none: the device had no room for it
    std::vector<uint32_t> slot;     ///< per slot: number of entries, `whole` where traceCone() gave true
    std::vector<uint16_t> entries;  ///< of a slot behind those of the one before, each slot from an even place
};

/// Not thread-safe: one thread calls it, from the first start() to its end. The same entries every time.
class ShadowDevice : public StartedDevice<ShadowQuery, ShadowAnswers&> {};

/// Shadows of parts on the processor or on a device. The first part whose whole shadow is wanted is traced on both: the
/// device stays where it answers as the processor does and is faster, or `force`. One that fails is left for good.
class ShadowPlace {
public:
    void offer(std::shared_ptr<ShadowDevice> device, bool force);
    bool open() const { return device_ && !device_->gaveUp(); }  ///< a device is used, or not yet measured
    bool measured() const { return measured_; }
    /// Traces with the device after the processor took `processorMs`; `same`: what fraction of the slots agrees.
    void measure(const ShadowQuery& query, double processorMs, const std::function<double(const ShadowAnswers&)>& same);
    /// Forgets what was started: work was stopped in between.
    void forget();
    /// False, and nothing begun, without a device.
    bool start(const ShadowQuery& query);
    /// Null where the device failed.
    const ShadowAnswers* finish();
    std::string device() const { return open() && measured_ ? device_->name() : std::string(); }  ///< in use
    double processorMs() const { return processorMs_; }  ///< a whole shadow; 0: not measured
    double deviceMs() const { return deviceMs_; }        ///< 0: there is none, or it failed

private:
    std::shared_ptr<ShadowDevice> device_;
    bool force_ = false, measured_ = false;
    size_t pending_ = 0;
    ShadowAnswers answers_;
    double processorMs_ = 0, deviceMs_ = 0;

    void fail(const std::exception& error);
};

}  // namespace relamp
