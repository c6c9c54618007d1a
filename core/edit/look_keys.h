// Keys of a look: set, taken away, moved and eased, as an artist does on a time line.
#pragma once
#include "relight/look_track.h"

namespace relamp {

/// Index of the key at a frame; none: -1.
int keyAt(const Look& look, int frame);

/// Of all keys, of looks and of single values, ascending, each once.
std::vector<int> keyFrames(const Look& look);

/// The look as it stands becomes the key at `frame`; one that is there keeps its ease.
void setKey(Look& look, int frame);
/// Nothing happens where there is none.
void deleteKey(Look& look, int frame);
/// A key that is at `to` already gives way.
void moveKey(Look& look, int from, int to);
void easeKey(Look& look, int frame, KeyEase ease);

/// After an edit at `frame` from `before` to `look`: what changed goes into a key there. A value that has keys of its
/// own gets one of those, everything else goes into the key of the look, where it has any. Lights that came, went or
/// took another name do so in every key; a new light keeps the keys of values that came with it. Nothing is keyed where
/// the edit changed the keys themselves; values that have keys of their own are then what these say at `frame`.
void keyEdit(const Look& before, Look& look, int frame, const LookPivots& pivots = {});

}  // namespace relamp
