// Parts of an estimate as components of a page: what the pages of this room share.
#pragma once
#include <string>

#include "solve/estimate.h"

namespace relamp {

/// Three digits a channel.
std::string rgbText(const Rgb& c);

/// A round patch of colour. Brightest channel full, so that an emitter's colour shows whatever its power.
std::string swatch(const Rgb& c);

/// The emitters with radiance, area, how sure, and why they are believed to be emitters; a sentence when there are
/// none.
std::string emittersTable(const Estimate& estimate);

/// The bright patches that are no emitters, with the reason; empty when there are none. `origin`: Capture::origin.
std::string rejectedTable(const Estimate& estimate, const DVec3& origin);

}  // namespace relamp
