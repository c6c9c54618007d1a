// Near fields of emitters on the graphics card: compute shaders of OpenGL 4.3 that trace through boxes.
#pragma once
#include <memory>
#include <string>

#include "relight/live/live_scene.h"
#include "relight/live/near_device.h"

namespace relamp::ui {

class GpuContext;

/// Null for a null context. The thread that makes the first call of it keeps it.
std::shared_ptr<NearDevice> makeGpuNear(std::shared_ptr<GpuContext> context);
/// On the first graphics card that offers OpenGL 4.3; see openGpuContext().
std::shared_ptr<NearDevice> makeGpuNear(bool force = false, std::string* why = nullptr);
/// Everything that a card does for a LiveScene, in one context; empty where there is none.
LiveDevices makeGpuDevices(bool force = false, std::string* why = nullptr);

}  // namespace relamp::ui
