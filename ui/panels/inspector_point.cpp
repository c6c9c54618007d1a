// A picked point of the surface: where its light comes from, and what is known about it.
#include <numeric>

#include "base/statistics.h"
#include "display/vertex_images.h"
#include "image/image_io.h"
#include "panels/inspector.h"
#include "widgets.h"

namespace relamp::ui {
namespace {

/// What arrives at the point, as a disc: straight away from the surface in the middle, along the surface at the rim.
void directionDisc(const PointLight& light, float diameter) {
    const ImVec2 at = ImGui::GetCursorScreenPos(), centre{at.x + diameter / 2, at.y + diameter / 2};
    ImGui::InvisibleButton("##directions", {diameter, diameter});
    ImDrawList* list = ImGui::GetWindowDrawList();
    const float radius = diameter / 2 - 1;
    const Vec3 n = light.normal;
    const Vec3 hint = std::abs(n.z) < 0.9f ? Vec3(0, 0, 1) : Vec3(0, 1, 0);
    const Vec3 up = glm::normalize(hint - n * glm::dot(hint, n)), right = glm::cross(up, n);
    // Exposed so that a bright emitter does not make everything else black: the brightest twentieth clips.
    std::vector<float> values;
    for (const Rgb& c : light.incident)
        if (const float v = maxChannel(c); v > 0) values.push_back(v);
    float exposure = 1;
    if (!values.empty()) exposure = 1 / selectRank(values, values.size() * 95 / 100);
    list->AddCircleFilled(centre, radius, IM_COL32(10, 10, 10, 255), 48);
    constexpr int rings = 14;
    // Equal steps of the angle; each cell asks the grid at its middle.
    for (int r = 0; r < rings; ++r) {
        const int sectors = std::max(6, int(std::lround(2 * pi * (r + 0.5f))));
        for (int s = 0; s < sectors; ++s) {
            const float tilt = (r + 0.5f) / rings * pi / 2, turn = 2 * pi * (s + 0.5f) / float(sectors);
            const Vec3 d = n * std::cos(tilt) + (right * std::cos(turn) + up * std::sin(turn)) * std::sin(tilt);
            const size_t cell = size_t(light.grid.cellOf(d));
            if (cell >= light.incident.size()) continue;
            const Rgb c = light.incident[cell] * exposure;
            const ImU32 colour = ImGui::GetColorU32(ImVec4(srgbEncode(std::clamp(c.x, 0.0f, 1.0f)),
                                                           srgbEncode(std::clamp(c.y, 0.0f, 1.0f)),
                                                           srgbEncode(std::clamp(c.z, 0.0f, 1.0f)), 1));
            ImVec2 corner[4];
            int k = 0;
            for (const auto& [dr, ds] : {std::pair{0, 0}, {1, 0}, {1, 1}, {0, 1}}) {
                const float a = 2 * pi * float(s + ds) / float(sectors), length = radius * float(r + dr) / rings;
                corner[k++] = {centre.x + length * std::cos(a), centre.y - length * std::sin(a)};
            }
            list->AddQuadFilled(corner[0], corner[1], corner[2], corner[3], colour);
        }
    }
    list->AddCircle(centre, radius, ImGui::GetColorU32(ImGuiCol_Border), 48);
    tooltip(
        "What this spot sees of the lights. The middle is straight away from the surface, the rim along it; black is "
        "blocked or dark. Up in the world is up here.");
}

/// Where the colour comes from; how sure it is says sigma.
std::string inWords(float confidence) {
    return confidence > 0.75f  ? "Its colour is mostly its own photographs'."
           : confidence > 0.4f ? "Its colour is its own photographs' and, in part, that of the surfaces around it."
           : confidence > 0.1f ? "Its colour is mostly that of the surfaces around it."
                               : "Its colour is that of the surfaces around it.";
}

}  // namespace

std::string nameOfPart(const Editor& editor, size_t emitter) {
    const auto& emitters = editor.emitters();
    return emitter < emitters.size() ? shown(emitters[emitter].name) : fmt::format("Light {}", emitter + 1);
}

void inspectPoint(Editor& editor, const PickedPoint& point) {
    text("Picked spot");
    const auto& capture = editor.state.document.capture;
    const DVec3 place = (capture ? capture->origin : DVec3(0)) + DVec3(point.position);
    fact("Position", placeText(place, editor.state.lengthUnit));
    const auto estimate = editor.estimate();
    if (section("Where its light comes from", "Parts of the light that this spot sends towards the eye")) {
        const auto& light = editor.state.pointLight;
        if (!estimate) dimWrapped("Estimate first.");
        else if (!light) dimText("...");
        else {
            struct Part {
                std::string name;
                Rgb radiance;
                std::string id;
            };
            std::vector<Part> parts{{"Environment", light->fromEnvironment, ""}};
            const auto& emitters = editor.emitters();
            for (size_t e = 0; e < light->fromEmitter.size(); ++e)
                parts.push_back(
                    {nameOfPart(editor, e), light->fromEmitter[e], e < emitters.size() ? emitters[e].id : ""});
            float total = 0;
            for (const Part& part : parts) total += std::max(0.0f, luminance(part.radiance));
            std::stable_sort(parts.begin(), parts.end(), [](const Part& a, const Part& b) {
                return luminance(a.radiance) > luminance(b.radiance);
            });
            const float box = ImGui::GetTextLineHeight() + em(0.25f);
            std::string wanted;
            for (size_t i = 0; i < parts.size(); ++i) {
                const Part& part = parts[i];
                const float fraction = total > 0 ? luminance(part.radiance) / total : 0;
                ImGui::PushID(int(i));
                if (swatch("##colour", lightColour(part.radiance), box,
                           part.id.empty() ? "Colour of this part of the light"
                                           : "Colour of this part of the light. Click selects the light."))
                    wanted = part.id;
                ImGui::SameLine(0, em(0.3f));
                bar(double(fraction), {0.38f, 0.38f, 0.38f, 1},
                    fmt::format("{}  {}", part.name, percent(double(fraction))));
                tooltip(fmt::format("{}: {} of the light this spot sends towards the eye\nradiance {} {} {}", part.name,
                                    percent(double(fraction)), number(part.radiance.x), number(part.radiance.y),
                                    number(part.radiance.z)));
                ImGui::PopID();
            }
            if (total <= 0) dimText("No light arrives here.");
            directionDisc(*light, std::min(ImGui::GetContentRegionAvail().x, em(12)));
            if (!wanted.empty()) {
                editor.pick(std::nullopt);
                editor.state.selection.emitters = {wanted};
                return;
            }
        }
    }
    if (!estimate) return;
    if (section("Surface", "What the estimate knows about this spot")) {
        const Reflectance& r = estimate->reflectance;
        // The image's mesh has the capture's vertices first; others say which one they were copied from.
        uint32_t vertex = point.vertex;
        if (const auto frame = editor.liveFrame(); frame && frame->origin && vertex < frame->origin->size())
            vertex = (*frame->origin)[vertex];
        const LobesAtVertex weights = r.at(vertex);
        if (vertex >= r.observed.size() || !weights.known()) return dimText("This was not part of the capture.");
        const Rgb albedo = weights.albedo();
        fact("Albedo", fmt::format("{:.3f}  {:.3f}  {:.3f}", albedo.x, albedo.y, albedo.z),
             "Fraction of the light that it sends back to all sides, red green blue");
        if (vertex < r.sigma.size())
            fact("Known within", percent(double(std::min(r.sigma[vertex], 1.0f))),
                 "How exactly: two times in three its albedo is off by less than this fraction. Counts the light, its "
                 "own photographs and what was filled in from around it.");
        const float box = ImGui::GetTextLineHeight();
        swatch("##albedo",
               ImVec4(srgbEncode(std::min(1.0f, albedo.x)), srgbEncode(std::min(1.0f, albedo.y)),
                      srgbEncode(std::min(1.0f, albedo.z)), 1),
               box, "Its colour in white light");
        for (size_t k = 1; k < weights.size() && k < r.basis.lobes.size(); ++k)
            if (const Rgb w = weights[k]; maxChannel(w) > 1e-4f) {
                const Lobe& lobe = r.basis.lobes[k];
                const bool common = lobe.kind == Lobe::Kind::ggx || lobe.kind == Lobe::Kind::ggxDielectric;
                fact(common ? fmt::format("{}, roughness {:.2f}", lobe.kind == Lobe::Kind::ggx ? "Metal" : "Gloss",
                                          std::sqrt(lobe.alpha))
                            : lobe.name,
                     fmt::format("{:.3f}  {:.3f}  {:.3f}", w.x, w.y, w.z),
                     "Glossy reflection with this roughness: its strength, red green blue");
            }
        fact("Seen by", fmt::format("{} view{}", r.observed[vertex], r.observed[vertex] == 1 ? "" : "s"),
             "Photographs that show this spot");
        if (vertex < r.confidence.size()) {
            bar(double(r.confidence[vertex]), toScreen(confidenceColour(r.confidence[vertex]) * 0.7f),
                fmt::format("{} from its own photographs", percent(double(r.confidence[vertex]))));
            tooltip(
                "Where its colour comes from, as Confidence (7) shows it. What is filled in from around it can be "
                "right as "
                "well: how exactly it is known says Known within.");
            dimWrapped(r.observed[vertex] ? inWords(r.confidence[vertex])
                                          : "No photograph shows it: its colour is that of the surfaces around it.");
        }
    }
}

}  // namespace relamp::ui
