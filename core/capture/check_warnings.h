// What the figures of a check give cause to warn of. Inner part of the check, not a door.
#pragma once
#include "capture/check.h"

namespace relamp {

/// Fewest vertices on which a statement about a view's exposure rests.
constexpr size_t enoughVertices = 50;

/// Fills `warnings`, a sentence each, from the figures that are there. O(views).
void warn(const Capture& capture, CaptureCheck& check);

}  // namespace relamp
