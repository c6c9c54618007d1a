#include "editor_state.h"

#include <algorithm>

namespace relamp::ui {

const char* nameOf(ViewMode mode) {
    static const char* const names[] = {"",           "Photograph", "Relit",      "Difference", "Emitters",
                                        "Correction", "Albedo",     "Confidence", "One light",  "Wipe"};
    return names[int(mode)];
}

const char* explain(ViewMode mode) {
    static const char* const texts[] = {
        "",
        "What the photographs show, painted on the mesh; the photograph itself when you look through a view.",
        "The scene under the present light: your edits, live.",
        "Model against photographs: grey is equal, orange the model is too bright, blue too dark. Full colour at a "
        "factor of two.",
        "Surfaces that were found to shine, a colour for each light.",
        "Surface colour without its brightness. Light colour that was mistaken for paint shows up here. Left: with "
        "lights as lights; right: distant light only.",
        "Surface colour under white light, with all light and shadow taken out.",
        "How sure the surface colour is: yellow rests on its own photographs, purple was filled in from around it.",
        "Light of the selected emitter alone on a white surface, with its shadows.",
        "Photograph, model and distant-only model side by side. Drag the dividers."};
    return texts[int(mode)];
}

std::string Document::name() const {
    const std::filesystem::path& path = shotFolder.empty() ? captureFolder : shotFolder;
    std::filesystem::path last = path.filename();
    if (last.empty()) last = path.parent_path().filename();
    return last.string();
}

bool Selection::has(const std::string& id) const {
    return std::find(emitters.begin(), emitters.end(), id) != emitters.end();
}

}  // namespace relamp::ui
