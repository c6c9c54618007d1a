// How the surfaces reflect: the neutral switch, and what kinds of reflection the estimate uses.
#include <cmath>

#include "panels/panels.h"
#include "panels/value_key_menu.h"
#include "widgets.h"

namespace relamp::ui {
namespace {

/// In an artist's words.
std::string nameOf(const Lobe& lobe) {
    const float roughness = std::sqrt(lobe.alpha);
    switch (lobe.kind) {
        case Lobe::Kind::lambert: return "matte";
        case Lobe::Kind::ggx: return fmt::format("metallic, roughness {:.2f}", roughness);
        case Lobe::Kind::ggxDielectric: return fmt::format("gloss, roughness {:.2f}", roughness);
        case Lobe::Kind::measured: return "as measured: " + lobe.name;
        default: break;
    }
    return lobe.name;
}

struct LobeUse {
    std::string name;
    float fraction = 0;  ///< of all reflectance, mean over the observed vertices
    float vertices = 0;  ///< fraction of the observed vertices that use it
};

/// Cost O(lobes x vertices), once an estimate.
const std::vector<LobeUse>& usesOf(const std::shared_ptr<const Estimate>& estimate) {
    static std::weak_ptr<const Estimate> of;
    static std::vector<LobeUse> uses;
    if (of.lock() == estimate) return uses;
    of = estimate;
    uses.clear();
    const Reflectance& r = estimate->reflectance;
    double total = 0;
    std::vector<double> sums(r.lobes(), 0), users(r.lobes(), 0);
    size_t observed = 0;
    for (size_t v = 0; v < r.observed.size(); ++v) observed += r.observed[v] > 0;
    for (size_t k = 0; k < r.lobes(); ++k) {
        for (size_t v = 0; v < r.lobe(k).size(); ++v) {
            if (v < r.observed.size() && !r.observed[v]) continue;
            const float light = luminance(r.lobe(k)[v]);
            sums[k] += double(light);
            users[k] += light > 0.01f;
        }
        total += sums[k];
    }
    for (size_t k = 0; k < r.lobes() && k < r.basis.lobes.size(); ++k)
        if (users[k] > 0)
            uses.push_back({nameOf(r.basis.lobes[k]), float(sums[k] / std::max(total, 1e-12)),
                            float(users[k] / double(std::max<size_t>(1, observed)))});
    return uses;
}

}  // namespace

void drawMaterialsPanel(Editor& editor) {
    const auto estimate = editor.estimate();
    ImGui::BeginDisabled(!estimate);
    bool neutral = editor.look().neutralMaterials;
    if (checkbox("Neutral surfaces", neutral,
                 "Every surface keeps its brightness but loses its colour: what is coloured then is the light"))
        editor.edit(neutral ? "Neutral surfaces" : "Coloured surfaces",
                    [&](Look& look) { look.neutralMaterials = neutral; });
    valueKeyMenu(editor, {{KeyedValue::neutral, {}}});
    ImGui::EndDisabled();
    if (!estimate) return dimWrapped("After the estimate: how matte and how glossy the surfaces were found to be.");
    dimText("Kinds of reflection in use");
    tooltip(
        "Each point of the surface mixes these. The bar shows how much of all reflected light a kind accounts for.");
    for (const LobeUse& use : usesOf(estimate)) {
        bar(double(use.fraction), {0.36f, 0.36f, 0.36f, 1},
            fmt::format("{}  {}", use.name, percent(double(use.fraction))));
        tooltip(fmt::format(
            "{}: {} of the reflectance, used on {} of the surface points that the photographs show.\n{}", use.name,
            percent(double(use.fraction)), percent(double(use.vertices)),
            use.name == "matte"
                ? "Looks the same from every side."
                : "Reflects its environment: blurred when the roughness is near 1, sharp when it is near 0."));
    }
    if (estimate->palette.empty()) return;
    dimText("Palette");
    tooltip(
        "The materials that you said the scene has, most used first: hover over one for its colour and its fraction of "
        "the surfaces.");
    int column = 0;
    for (const PaletteColour& colour : estimate->palette) {
        if (column++ % 8) ImGui::SameLine(0, em(0.25f));
        const Rgb shown = glm::pow(glm::clamp(colour.albedo, Rgb(0), Rgb(1)), Rgb(1 / 2.2f));
        ImGui::PushID(column);
        ImGui::ColorButton("##material", {shown.x, shown.y, shown.z, 1}, ImGuiColorEditFlags_NoTooltip);
        tooltip(fmt::format("Reflects {:.2f} {:.2f} {:.2f} of red, green and blue; {} of the surfaces", colour.albedo.x,
                            colour.albedo.y, colour.albedo.z, percent(double(colour.fraction))));
        ImGui::PopID();
    }
}

}  // namespace relamp::ui
