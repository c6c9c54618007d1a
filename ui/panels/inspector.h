// Parts of the inspector, one for each kind of thing that can be selected.
#pragma once
#include "editor.h"
#include "relight/placement.h"

namespace relamp::ui {

void inspectEmitter(Editor& editor, const EmitterState& emitter);
/// Its section "Beam"; nothing for a light without a shape of its own.
void inspectBeam(Editor& editor, const EmitterState& emitter);
/// The section "Falls on": the objects that the lights `targets` light.
void inspectLink(Editor& editor, const EmitterState& emitter, const std::vector<std::string>& targets);
/// What the light of an emitter, counted as in PointLight, is called.
std::string nameOfPart(const Editor& editor, size_t emitter);
void inspectPoint(Editor& editor, const PickedPoint& point);
void inspectView(Editor& editor, int view);
void inspectScene(Editor& editor);
/// How well light references agreed; nothing where there were none.
void inspectLightReferences(const Estimate& estimate);

}  // namespace relamp::ui
