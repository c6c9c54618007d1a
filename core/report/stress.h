// Stiff and extreme variants of a capture and of small synthetic worlds, each solved at draft quality: does every case
// end in finite numbers, solved equations and an answer that does not care about units, order or scale?
#pragma once
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <utility>
#include <vector>

#include "base/progress.h"
#include "capture/capture.h"

namespace relamp {

struct StressCase {
    std::string name;      ///< "capture: images x 1e-6", "world: power ratio 1e6"
    bool finite = false;   ///< every number of the estimate is finite, or the input was refused with a sentence
    bool refused = false;  ///< an Error: nothing was estimated, `reason` is its sentence
    double kkt = 0;        ///< relative KKT residual of the last lighting program
    std::string reason;    ///< why it was refused, kkt is above 1e-6, or an invariance was missed; empty: all is well
    std::vector<std::pair<std::string, double>>
        figures;  ///< "difference": from the answer it should equal, relative; "emitters"; "seconds"
    /// Finite, and either solved to 1e-6 with every invariance kept, or a reason is given.
    bool holds() const { return finite && (kkt <= 1e-6 || !reason.empty()); }
};

struct StressReport {
    std::vector<StressCase> cases;
    double seconds = 0;
    double finiteFraction() const;  ///< in [0, 1]; 1 without cases
};

struct StressOptions {
    bool worlds = true;     ///< the synthetic worlds
    int longestSide = 240;  ///< photographs are shrunk to this many pixels
    std::string only;       ///< only cases whose name holds this text; empty: all
};

/// Runs every case one after the other. `capture` has its photographs; null: the synthetic worlds alone. A variant that
/// is refused or fails is a row of the table, never an exception. Cost: about 16 draft solves of the capture and 40 of
/// a mesh of 900 vertices. Throws Cancelled.
StressReport runStress(const Capture* capture, const StressOptions& options, Progress& progress);

/// `{cases: [{name, finite, refused, kkt, reason, figures}], finite_fraction, seconds}`.
nlohmann::json stressJson(const StressReport& report);
/// A table for people, a line a case.
std::string stressText(const StressReport& report);

}  // namespace relamp
