#include "relight/live/device_blockers.h"

namespace relamp {

void DeviceBlockers::follow(const LiveOccluders& occluders, const Mesh& mesh,
                            const std::vector<uint32_t>& partOfTriangle) {
    std::vector<Blocker> now(std::max<size_t>(1, occluders.parts.size()));
    for (uint32_t b = 0; b < now.size(); ++b) {
        now[b].tracer = b ? occluders.parts[b].tracer : occluders.ground;
        if (!now[b].tracer) continue;
        for (const Blocker& old : blockers)
            if (old.tracer == now[b].tracer) now[b].tree = old.tree;
        if (!now[b].tree)
            now[b].tree = std::make_shared<const BoxTree>(
                BoxTree::of(partMesh(mesh, partOfTriangle, b, b ? occluders.parts[b].inverse : Mat4(1))));
    }
    blockers = std::move(now);
}

}  // namespace relamp
