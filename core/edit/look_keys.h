// Keys of a look: set, taken away, moved and eased, as an artist does on a time line.
#pragma once
#include "relight/look.h"

namespace relamp {

/// Index of the key at a frame; none: -1.
int keyAt(const Look& look, int frame);

/// The look as it stands becomes the key at `frame`; one that is there keeps its ease.
void setKey(Look& look, int frame);
/// Nothing happens where there is none.
void deleteKey(Look& look, int frame);
/// A key that is at `to` already gives way.
void moveKey(Look& look, int from, int to);
void easeKey(Look& look, int frame, KeyEase ease);

/// After an edit at `frame` from `before` to `look`: what changed goes into a key there. Lights that came, went or took
/// another name do so in every key. Nothing happens without keys, where the edit changed nothing, and where it changed
/// the keys themselves.
void keyEdit(const Look& before, Look& look, int frame);

}  // namespace relamp
