#include "viewport/gpu_devices.h"

#include "viewport/gpu_near.h"
#include "viewport/gpu_scene.h"
#include "viewport/gpu_shadow.h"
#include "viewport/gpu_transport.h"

namespace relamp::ui {

LiveDevices makeGpuDevices(bool force, std::string* why) {
    const std::shared_ptr<GpuScene> scene = openGpuScene(force, why);
    if (!scene) return {};
    return {makeGpuTransport(scene->context), makeGpuNear(scene), makeGpuShadow(scene)};
}

}  // namespace relamp::ui
