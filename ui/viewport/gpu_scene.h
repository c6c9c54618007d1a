// A scene on the graphics card: vertices, and the boxes that shadow rays are traced through. Its programs share it.
#pragma once
#include "relight/live/device_blockers.h"
#include "relight/live/near.h"
#include "viewport/gpu_context.h"

namespace relamp::ui {

class GpuScene {
public:
    explicit GpuScene(std::shared_ptr<GpuContext> context_) : context(std::move(context_)) {}
    /// Brings what changed since the last call. The context is current. Throws Error when there is no room.
    void take(const DeviceBlockers& blockers, const LiveVertices& vertices);
    void clear();

    /// Nodes of a tree.
    struct Place {
        uint32_t begin = 0, end = 0;
    };
    const std::shared_ptr<GpuContext> context;
    GpuBuffer nodes, triangles, positions, normals;
    std::vector<Place> places;  ///< of DeviceBlockers::blockers

private:
    std::vector<std::shared_ptr<const BoxTree>> trees_;  ///< that the card holds, one behind the other
    std::shared_ptr<const Mesh> mesh_;                   ///< whose vertices it holds

    void takeTrees(const DeviceBlockers& blockers);
};

/// On the first graphics card that offers OpenGL 4.3; see openGpuContext().
std::shared_ptr<GpuScene> openGpuScene(bool force, std::string* why);

}  // namespace relamp::ui
