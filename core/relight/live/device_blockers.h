// What blocks light, as a device traces it: trees of boxes beside Embree's.
#pragma once
#include "relight/live/parts.h"
#include "scene/box_tree.h"

namespace relamp {

/// What blocks, as a device traces it.
struct DeviceBlockers {
    struct Blocker {
        std::shared_ptr<const RayTracer> tracer;  ///< whose triangles these are; keeps its address from being reused
        std::shared_ptr<const BoxTree> tree;
    };
    std::vector<Blocker> blockers;  ///< entry 0 the ground, in the world; the others as LiveOccluders::parts, each in
                                    ///< its own frame; a null tree: nothing

    /// Builds the trees that are new. Cost: see BoxTree::of.
    void follow(const LiveOccluders& occluders, const Mesh& mesh, const std::vector<uint32_t>& partOfTriangle);
};

}  // namespace relamp
