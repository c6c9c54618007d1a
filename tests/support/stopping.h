// Stopping a long function half way, from another thread.
#pragma once
#include <functional>
#include <string>

#include "base/progress.h"

namespace relamp::test {

/// The promise is 100 ms from the request to the return; the bound is wide because a busy machine may run us late, and
/// sanitizers ten times slower.
#ifdef RELAMP_SANITIZED
inline constexpr double stopBoundSeconds = 5;
#else
inline constexpr double stopBoundSeconds = 0.5;
#endif

/// Runs `part`, asks it to stop once it is at `fraction` of the stage named `stage` (empty: of any), and expects
/// Cancelled soon.
void expectStopsHalfWay(const std::function<void(Progress&)>& part, const std::string& stage = "",
                        double fraction = 0.3);

}  // namespace relamp::test
