// What the table of emitters and the inspector share: selecting, editing several at once, adding new ones, and the
// evidence in words.
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "editor.h"
#include "icons.h"

namespace relamp::ui {

/// The emitters an edit of `id` goes to: the whole selection when `id` is part of it.
std::vector<std::string> targetsOf(const Editor& editor, const std::string& id);
/// Click on a row: plain selects alone, Ctrl toggles, Shift extends from the active one in the order of the table.
void selectEmitter(Editor& editor, const std::string& id, bool toggle, bool extend);

/// Emitter as it was when the open drag began.
std::optional<EmitterState> emitterAtStart(const Editor& editor, const std::string& id);
/// Stops against what was recovered; added ones against referenceBrightness().
float stopsOf(const Editor& editor, const EmitterState& emitter);
/// Luminance of the strongest recovered emitter; 1 without one.
float referenceBrightness(const Editor& editor);
/// Emitted power, of a sun its irradiance: pi x luminance x area, less what a shaping takes, image units x square
/// metres, with the area as the look has it.
float powerOf(const Editor& editor, const EmitterState& emitter);
/// Square metres after the look's matrix.
float areaOf(const Editor& editor, const EmitterState& emitter);

// Controls, drawn at the cursor in the width set with SetNextItemWidth; each edit goes to all targets as one entry.
void stopsControl(Editor& editor, const EmitterState& emitter, const char* id);
void kelvinControl(Editor& editor, const EmitterState& emitter, const char* id);
void tintControl(Editor& editor, const EmitterState& emitter, const char* id);
void colourControl(Editor& editor, const EmitterState& emitter, const char* id, float size);
void muteButton(Editor& editor, const EmitterState& emitter, float size);
void soloButton(Editor& editor, const EmitterState& emitter, float size);
/// Inside a popup: reset, duplicate, delete, attach, aim and so on.
void emitterMenu(Editor& editor, const std::string& id);
/// "Add light" with its choices.
void addEmitterButton(Editor& editor, float width = 0);

/// Width, pixels, from which a table of lights shows exposure and colour of its rows; below it names would not be
/// readable, and the inspector alone has them.
float widthForExposures();

/// The columns of a table of lights that there is room for, pixels; their groups stand under the same ones.
struct LightColumns {
    bool titles, exposure, colour, kelvin, power, evidence;
    explicit LightColumns(float room);
    int count() const { return 3 + exposure + colour + kelvin + power + evidence; }
    void setUp(const char* first) const;
};

/// A new light in front of what the camera looks at, facing it.
AddedEmitter newEmitter(const Editor& editor, EmitterShape shape);
void addNewEmitter(Editor& editor, EmitterShape shape);
void resetEmitters(Editor& editor, const std::vector<std::string>& ids, EmitterValue value);
/// Back to how it was recovered, the rest as it is: Alt+G, R, S. A light that was added has no position to go back to.
enum class TransformPart { position, rotation, scale };
void clearTransform(Editor& editor, const std::vector<std::string>& ids, TransformPart part);
void duplicateEmitters(Editor& editor, const std::vector<std::string>& ids);
void deleteEmitters(Editor& editor, const std::vector<std::string>& ids);
/// A button's click task for the viewport; pressed again it disarms.
void armClick(Editor& editor, ClickTask task);

/// "8 views, 1 240 observations"; empty for added ones.
std::string evidenceInShort(const Editor& editor, const EmitterState& emitter);
/// Relative uncertainty of its radiance; negative when unknown.
float uncertaintyOf(const Editor& editor, const EmitterState& emitter);
/// Fraction of its effect that no distant light can imitate; negative when unknown.
float identifiabilityOf(const Editor& editor, const EmitterState& emitter);
inline constexpr float weakIdentifiability = 0.15f;

Icon iconOf(const Editor& editor, const EmitterState& emitter);

}  // namespace relamp::ui
