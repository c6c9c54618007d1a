// Near fields of emitters on the graphics card: a compute shader of OpenGL 4.3 that traces through boxes.
#pragma once
#include <memory>
#include <string>

#include "relight/live/near_device.h"

namespace relamp::ui {

class GpuScene;

/// Null for a null scene. The thread that makes the first call of it keeps it.
std::shared_ptr<NearDevice> makeGpuNear(std::shared_ptr<GpuScene> scene);
/// On the first graphics card that offers OpenGL 4.3; see openGpuContext().
std::shared_ptr<NearDevice> makeGpuNear(bool force = false, std::string* why = nullptr);

}  // namespace relamp::ui
