// Parts of an estimate as pieces of a page: what the pages of this room share.
#pragma once
#include <string>

#include "solve/estimate.h"

namespace relamp {

/// Three digits a channel.
std::string rgbText(const Rgb& c);

/// A round patch of colour. Brightest channel full, so that a lamp's colour shows whatever its power.
std::string swatch(const Rgb& c);

/// The lamps with radiance, area, how sure, and why they are believed to be lamps; a sentence when there are none.
std::string lampsTable(const Estimate& estimate);

/// The bright patches that are no lamps, with the reason; empty when there are none. `origin`: Capture::origin.
std::string rejectedTable(const Estimate& estimate, const DVec3& origin);

}  // namespace relamp
