#include "view_mode.h"

#include <algorithm>

#include "editor_state.h"

namespace relamp::ui {

bool ViewModeInfo::shows(Paint paint) const {
    return std::any_of(strips.begin(), strips.end(), [&](const StripInfo& s) { return s.paint == paint; });
}

std::span<const ViewModeInfo> viewModes() {
    using V = ViewportState;
    static const ViewModeInfo modes[] = {
        {.mode = ViewMode::photograph,
         .id = "view.mode1",
         .name = "Photograph",
         .explanation =
             "What the photographs show, painted on the mesh; the photograph itself when you look through a view.",
         .key = '1',
         .strips = {{Paint::photographs, Needs::photographs}}},
        // Photographs or grey stand in until there is an estimate.
        {.mode = ViewMode::relit,
         .id = "view.mode2",
         .name = "Relit",
         .explanation = "The scene under the present light: your edits, live.",
         .key = '2',
         .strips = {{Paint::model, Needs::nothing}},
         .restImage = true},
        {.mode = ViewMode::difference,
         .id = "view.mode3",
         .name = "Difference",
         .explanation = "Model against photographs: grey is equal, orange the model is too bright, blue too dark. Full "
                        "colour at a factor of two.",
         .key = '3',
         .strips = {{Paint::difference}},
         .legend = Legend::difference,
         .display = true},
        {.mode = ViewMode::clusters,
         .id = "view.mode4",
         .name = "Emitters",
         .explanation = "Surfaces that were found to shine, a colour for each light.",
         .key = '4',
         .strips = {{Paint::clusters}},
         .legend = Legend::emitters,
         .display = true},
        {.mode = ViewMode::correction,
         .id = "view.mode5",
         .name = "Albedo chroma",
         .explanation = "Surface colour without its brightness. Light colour that was mistaken for paint shows up "
                        "here. Left: with lights as lights; right: distant light only.",
         .key = '5',
         .strips = {{Paint::correction, Needs::estimate, "Albedo chroma, with lights"},
                    {Paint::distantCorrection, Needs::distantEstimate, "Albedo chroma, distant only"}},
         .dividers = {&V::splitAt}},
        {.mode = ViewMode::albedo,
         .id = "view.mode6",
         .name = "Albedo",
         .explanation = "Surface colour under white light, with all light and shadow taken out.",
         .key = '6',
         .strips = {{Paint::albedo}}},
        {.mode = ViewMode::confidence,
         .id = "view.mode7",
         .name = "Confidence",
         .explanation =
             "Where the surface colour comes from: yellow from its own photographs, purple from the surfaces "
             "around it. How exactly it is known, Known within says of a clicked spot.",
         .key = '7',
         .strips = {{Paint::confidence}},
         .legend = Legend::confidence,
         .display = true},
        {.mode = ViewMode::irradiance,
         .id = "view.mode8",
         .name = "One light",
         .explanation = "Light of the selected light alone on a white surface, with its shadows.",
         .key = '8',
         .strips = {{Paint::irradiance, Needs::emitter}},
         .legend = Legend::oneLight},
        {.mode = ViewMode::wipe,
         .id = "view.mode9",
         .name = "Wipe",
         .explanation = "Photograph, model and distant-only model side by side. Drag the dividers.",
         .key = '9',
         .strips = {{Paint::photographs, Needs::photographs, "Photograph"},
                    {Paint::model, Needs::estimate, "Model, with lights"},
                    {Paint::distantModel, Needs::distantEstimate, "Model, distant only"}},
         .dividers = {&V::wipeLeft, &V::wipeRight}},
        {.mode = ViewMode::compare,
         .id = "view.mode0",
         .name = "Before and after",
         .explanation = "Left: the scene as recovered, or a snapshot of the look. Right: the present look. Drag the "
                        "divider.",
         .key = '0',
         .strips = {{Paint::before, Needs::estimate, "Before"}, {Paint::model, Needs::estimate, "Present look"}},
         .dividers = {&V::compareAt}},
    };
    return modes;
}

const ViewModeInfo& infoOf(ViewMode mode) {
    const auto modes = viewModes();
    const auto at = std::find_if(modes.begin(), modes.end(), [&](const ViewModeInfo& m) { return m.mode == mode; });
    return at == modes.end() ? modes.front() : *at;
}

}  // namespace relamp::ui
