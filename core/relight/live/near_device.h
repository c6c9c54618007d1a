// Another place than the processor for the near field of a dragged emitter, such as a graphics card, and the choice
// between the two by measurement.
#pragma once
#include <string>

#include "relight/live/device_blockers.h"
#include "relight/live/near.h"
#include "relight/live/started_device.h"

namespace relamp {

struct NearQuery {
    const NearEmitter& emitter;
    const LiveVertices& vertices;
    const LiveOccluders& occluders;
    const DeviceBlockers& blockers;
    std::span<const uint32_t> wanted;  ///< vertices
    int level = 1;                     ///< of NearEmitter::level
    uint64_t seed = 1;
};

struct NearAnswer {
    float factor = 0, open = 0;
};

/// Form factors as nearFactor() gives them, from the same samples, elsewhere; answers in the order of `wanted`.
class NearDevice : public StartedDevice<NearQuery, std::span<NearAnswer>> {};

/// Near fields on the processor or on a device, whichever was faster. A device that fails is left for good; nothing is
/// lost by it. Shaped emitters and suns stay on the processor.
class NearPlace {
public:
    /// Takes `device` (null: the processor) where it answers as the processor does and is faster, or `force`. Both take
    /// the first samples of `emitter` at all vertices; where it has no triangles, of a small square above them. Throws
    /// Cancelled.
    void choose(const NearEmitter* emitter, const LiveVertices& vertices, const LiveOccluders& occluders,
                const DeviceBlockers& blockers, std::shared_ptr<NearDevice> device, bool force, uint64_t seed,
                Progress& progress);
    /// Begins the first samples of all stale vertices; nothing without a device.
    void start(const std::vector<NearEmitter>& emitters, const LiveVertices& vertices, const LiveOccluders& occluders,
               const DeviceBlockers& blockers, uint64_t seed);
    /// Takes what start() began. What is stale afterwards is left to nearCoarse().
    void finish(std::vector<NearEmitter>& emitters);
    /// Samples of `level` at the chosen vertices; false: nothing was done.
    bool sample(NearEmitter& emitter, const LiveVertices& vertices, const LiveOccluders& occluders,
                const DeviceBlockers& blockers, std::span<const uint32_t> chosen, int level, uint64_t seed);
    bool used() const { return device_ && !device_->gaveUp(); }
    std::string device() const { return used() ? device_->name() : std::string(); }  ///< in use; empty: the processor
    double processorMs() const { return processorMs_; }                              ///< as measured by choose()
    double deviceMs() const { return deviceMs_; }                                    ///< 0: there is none, or it failed

private:
    struct Started {
        size_t emitter = 0;
        std::vector<uint32_t> wanted;
    };
    std::shared_ptr<NearDevice> device_;
    std::vector<Started> started_;
    std::vector<NearAnswer> answers_;
    double processorMs_ = 0, deviceMs_ = 0;

    void fail(const std::exception& error);
};

}  // namespace relamp
