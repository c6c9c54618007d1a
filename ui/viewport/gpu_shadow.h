// Shadows of dragged parts in the environment on the graphics card.
#pragma once
#include <memory>
#include <string>

#include "relight/live/shadow_device.h"

namespace relamp::ui {

class GpuScene;

/// Null for a null scene. The thread that makes the first call of it keeps it.
std::shared_ptr<ShadowDevice> makeGpuShadow(std::shared_ptr<GpuScene> scene);
/// On the first graphics card that offers OpenGL 4.3; see openGpuContext().
std::shared_ptr<ShadowDevice> makeGpuShadow(bool force = false, std::string* why = nullptr);

}  // namespace relamp::ui
