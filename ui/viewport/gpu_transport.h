// Stored transport summed on the graphics card: compute shaders of OpenGL 4.3 over shader storage buffers, in a context
// of its own that needs no window and no display.
#pragma once
#include <memory>
#include <string>

#include "transport/transport_device.h"

namespace relamp::ui {

class GpuContext;

/// The first graphics card that offers OpenGL 4.3 through EGL; null where there is none. Software renderers sum no
/// faster than the processor does and are passed over unless `force`. The thread that makes the first call of it keeps
/// it: not the window's, whose context it would push aside. `why`: for a null answer, in words.
std::shared_ptr<TransportDevice> makeGpuTransport(bool force = false, std::string* why = nullptr);

/// The same on a context that others may use too; null for a null context.
std::shared_ptr<TransportDevice> makeGpuTransport(std::shared_ptr<GpuContext> context);

}  // namespace relamp::ui
