// The environment on matte surfaces that stay in place: their transport baked against the ground alone, and what parts
// block of it now, cell by cell.
#pragma once
#include <algorithm>

#include "relight/live/environment.h"
#include "relight/live/near.h"
#include "relight/live/shadow_device.h"
#include "relight/live/visibility.h"
#include "transport/transport_cache.h"
#include "transport/transport_device.h"

namespace relamp {

class LiveMatte {
public:
    LiveMatte(const LiveGrid& grid, TermTests tests, float error)
        : grid_(grid), tests_(std::move(tests)), error_(error) {}
    /// Visibility and coefficients of all ground vertices. What `cacheFolder` holds of the same bake is taken from
    /// there, the rest is written to it as it comes, so that a stopped bake goes on. Returns the blocks that were
    /// found. Cost about 0.1 ms a vertex and core, from the cache a hundredth. Throws Cancelled.
    size_t bake(const LiveVertices& vertices, const LiveOccluders& occluders, const std::filesystem::path& cacheFolder,
                Progress& progress);
    size_t bytes() const;  ///< of everything stored per vertex
    const TransportStore& store() const { return store_; }
    /// Measures where apply() sums the store: see TransportSums::choose().
    void chooseDevice(std::shared_ptr<TransportDevice> device, bool force, Progress& progress) {
        sums_.choose(store_, grid_.cells(), std::move(device), force, progress);
    }
    const TransportSums& sums() const { return sums_; }
    /// Traces the first samples of a part's whole shadow where that is faster: see ShadowPlace.
    void offerDevice(std::shared_ptr<ShadowDevice> device, bool force) { place_.offer(std::move(device), force); }
    const ShadowPlace& place() const { return place_; }

    /// The list of parts changed: what is known of those with the same name is kept.
    void setParts(const std::vector<std::string>& names);
    /// A part stands elsewhere now (or went): everything it blocked is traced again.
    void markMoved(size_t part);
    /// Vertices leave the ground and no longer block it; `gone` is a sphere that held them. What becomes visible is
    /// seen at once from single rays, the blocks are baked anew by bakeStale().
    void release(const LiveVertices& vertices, const LiveOccluders& occluders, const LivePart& gone,
                 Progress& progress);
    /// Begins on the device what coarse() then takes; nothing without one.
    void start(const LiveVertices& vertices, const LiveOccluders& occluders, const DeviceBlockers& blockers);
    /// Brings stale lists of blocked cells up to date with a ray a cell, those of runs of vertices that `gaze` misses
    /// only if they were never traced. `blockers`: of the device, where place() is open.
    void coarse(const LiveVertices& vertices, const LiveOccluders& occluders, const DeviceBlockers& blockers,
                const Gaze& gaze, Progress& progress);
    /// One batch towards a ray a quarter cell; false when nothing is left.
    bool refine(const LiveVertices& vertices, const LiveOccluders& occluders, Progress& progress);
    /// One batch of blocks that release() left stale; false when there is none. Nothing visible waits for it: the lists
    /// hold the difference.
    bool bakeStale(const LiveVertices& vertices, const LiveOccluders& occluders, Progress& progress);
    bool anyStale() const { return std::find(stale_.begin(), stale_.end(), uint8_t(1)) != stale_.end(); }
    /// Light per vertex into `out` (vertices.count() places; only ground ones are written). `all`: the environment
    /// changed, else only what parts changed.
    void apply(const LiveLight& light, bool all, std::span<Rgb> out);
    /// Quarters that a ground vertex sees now, parts taken away.
    void seenNow(uint32_t vertex, std::span<uint8_t> masks) const;
    /// Whether the baked rays found nothing of the ground anywhere in the cone that holds the part: then nothing of it
    /// stands between a ground vertex and the part either, but for what is thinner than a quarter cell. False while the
    /// part's shadow is stale.
    bool groundClear(size_t part, size_t vertex) const;
    /// Vertices whose view of the environment changed since the last call.
    std::vector<uint32_t> takeChanged();

private:
    static constexpr size_t run = ShadowQuery::run;
    static constexpr size_t manySlots = 8192;  // fewer have little to share
    struct Shadow {
        std::string name;
        std::vector<CellLists> lists;  // per chunk
        std::vector<uint8_t> level;    // per chunk: 0 stale, 1 a ray a cell, 2 a ray a quarter
        std::vector<uint8_t> clear;    // per slot: groundClear
    };
    struct Correction {  // per chunk: what is to be added to the baked light
        std::vector<uint32_t> start;
        std::vector<uint16_t> cell;
        std::vector<float> weight;
    };
    const LiveGrid& grid_;
    TermTests tests_;
    float error_;
    std::vector<uint32_t> vertexOfSlot_, slotOfVertex_;  // sorted so that neighbours with like normals share a block
    std::vector<Vec3> normal_;                           // per slot
    std::vector<float> weightScale_;
    std::vector<uint8_t> masks_;  // per slot: quarters the ground lets through
    bool remasked_ = false;       // masks_ changed since the bake
    TransportStore store_;
    TransportSums sums_;
    std::vector<Shadow> shadows_;
    std::vector<CellLists> freed_;  // per chunk: visible, but not yet in the store
    std::vector<uint8_t> stale_;    // per block: to be baked anew
    std::vector<Correction> corrections_;
    std::vector<uint8_t> combine_, changed_;  // per chunk: corrections to be put together, light to be summed
    std::vector<uint8_t> told_;               // per chunk: takeChanged has not told of it
    std::vector<Rgb> base_;                   // per slot: baked light under the present environment
    bool rebaked_ = false;                    // the store changed since base_ was summed
    ShadowPlace place_;
    std::vector<uint32_t> started_;  // parts
    uint64_t slotsVersion_ = 0;      // of vertexOfSlot_, normal_ and masks_

    size_t slots() const { return vertexOfSlot_.size(); }
    size_t chunks() const { return (slots() + run - 1) / run; }
    std::span<uint8_t> masksOf(size_t slot) {
        return std::span(masks_).subspan(slot * grid_.nibbleBytes(), grid_.nibbleBytes());
    }
    std::span<const uint8_t> masksOf(size_t slot) const {
        return std::span(masks_).subspan(slot * grid_.nibbleBytes(), grid_.nibbleBytes());
    }
    uint64_t keyOf(const LiveVertices& vertices, const LiveOccluders& occluders) const;
    TransportBlock bakeBlock(size_t block, const LiveVertices& vertices, const LiveOccluders& occluders);
    /// From finest to coarsest: a ray a quarter cell; a ray a cell; the latter at a few vertices of a chunk for the
    /// ones beside them.
    enum class Rays { quarter, cell, shared };
    void traceShadow(Shadow& shadow, size_t chunk, Rays rays, const LiveVertices& vertices,
                     const LiveOccluders& occluders, const LivePart& part);
    bool missed(size_t chunk, const LiveVertices& vertices, const Gaze& gaze) const;
    /// Of what a shadow's chunk held before its entries were taken anew.
    void noteShadow(Shadow& shadow, size_t chunk, uint8_t level, bool had, std::span<const uint16_t> before);
    bool whollyStale(size_t part, const LiveOccluders& occluders) const;
    ShadowQuery queryOf(uint32_t part, const LiveVertices& vertices, const LiveOccluders& occluders,
                        const DeviceBlockers& blockers) const;
    void takeAnswers(Shadow& shadow, const ShadowAnswers& answers);
    void combine(size_t chunk);
};

}  // namespace relamp
