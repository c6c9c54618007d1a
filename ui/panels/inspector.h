// Parts of the inspector, one for each kind of thing that can be selected.
#pragma once
#include "editor.h"

namespace relamp::ui {

void inspectEmitter(Editor& editor, const EmitterState& emitter);
/// Its section "Beam"; nothing for a light without a shape of its own.
void inspectBeam(Editor& editor, const EmitterState& emitter);
void inspectPoint(Editor& editor, const PickedPoint& point);
void inspectView(Editor& editor, int view);
void inspectScene(Editor& editor);
/// How well light references agreed; nothing where there were none.
void inspectLightReferences(const Estimate& estimate);

/// Position, rotation and scale out of a matrix without shear: rotation in degrees about x, then y, then z.
struct Placement {
    Vec3 degrees{0}, scale{1};
};
Placement placementOf(const Mat4& matrix);
Mat3 rotationOf(const Vec3& degrees);

}  // namespace relamp::ui
