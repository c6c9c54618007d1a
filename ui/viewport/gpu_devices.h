// Everything that a graphics card does for a LiveScene.
#pragma once
#include "relight/live/live_scene.h"

namespace relamp::ui {

/// All of it in one context on the first graphics card that offers OpenGL 4.3; empty where there is none. See
/// openGpuContext().
LiveDevices makeGpuDevices(bool force = false, std::string* why = nullptr);

}  // namespace relamp::ui
