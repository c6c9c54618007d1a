// The button that separates light from surfaces, and its settings in plain words.
#include <cmath>

#include "panels/panels.h"
#include "widgets.h"

namespace relamp::ui {
namespace {

struct Choice {
    const char* value;
    const char* label;
    const char* explanation;
};
constexpr Choice qualities[] = {
    {"draft", "Draft", "For a first look, in a fraction of the time: coarse environment, soft contact shadows."},
    {"standard", "Standard", "The usual choice: fine enough for production frames."},
    {"fine", "Fine",
     "For the final shot: more detail in the environment and more rounds for glossy surfaces; takes two to four times "
     "as long."},
};

/// The photograph's pixel that shows the picked point, for the white patch.
bool pixelOfPick(const Editor& editor, int& view, Vec2& pixel) {
    const auto& point = editor.state.selection.point;
    const auto& capture = editor.state.document.capture;
    if (!point || !capture) return false;
    const auto sees = [&](int v) {
        if (v < 0 || size_t(v) >= capture->views.size()) return false;
        const Camera& camera = capture->views[size_t(v)].camera;
        if (glm::dot(Vec3(camera.position()) - point->position, point->normal) <= 0) return false;
        const auto at = camera.project(DVec3(point->position));
        if (!at || at->x < 0 || at->y < 0 || at->x >= float(camera.width) || at->y >= float(camera.height))
            return false;
        if (const Scene* scene = editor.state.document.scene.get(); scene && scene->tracer) {
            const Vec3 from = point->position + point->normal * 2.0f * scene->tracer->surfaceOffset(),
                       to = Vec3(camera.position());
            const float distance = glm::distance(from, to);
            if (scene->tracer->occluded({from, (to - from) / distance, 0, distance})) return false;
        }
        view = v;
        pixel = *at;
        return true;
    };
    if (sees(editor.state.selection.view)) return true;
    for (size_t v = 0; v < capture->views.size(); ++v)
        if (sees(int(v))) return true;
    return false;
}

void gaugeSettings(Editor& editor) {
    GaugeChoice& gauge = editor.state.solve.gauge;
    using Kind = GaugeChoice::Kind;
    constexpr const char* labels[] = {"Automatic", "White patch", "Known light", "Known surfaces"};
    constexpr const char* explanations[] = {
        ("A bright light on a dark wall looks like a dim light on a bright wall. Light that is seen directly in the "
         "photographs settles it; where none is seen, an ordinary brightness of the surfaces is assumed."),
        "You know one spot that is white: a sheet of paper, a grey card. Its brightness then settles everything else.",
        "You know how bright one light is, in the units of the photographs.",
        "You know how bright the surfaces are on average: 0.2 is a dark room, 0.5 an ordinary one, 0.8 a white one."};
    dimText("Brightness scale");
    tooltip("How light and surface brightness are told apart");
    ImGui::SetNextItemWidth(-FLT_MIN);
    if (ImGui::BeginCombo("##gauge", labels[int(gauge.kind)])) {
        for (const Kind kind : {Kind::automatic, Kind::whitePatch, Kind::emitter, Kind::albedo}) {
            if (ImGui::Selectable(labels[int(kind)], gauge.kind == kind)) gauge.kind = kind;
            tooltip(explanations[int(kind)]);
        }
        ImGui::EndCombo();
    }
    tooltip(explanations[int(gauge.kind)]);
    if (gauge.kind == Kind::albedo) {
        ImGui::SetNextItemWidth(-FLT_MIN);
        ImGui::SliderFloat("##albedo", &gauge.albedo, 0.02f, 0.98f, "mean surface brightness %.2f",
                           ImGuiSliderFlags_AlwaysClamp);
        tooltip("Fraction of the light that the surfaces send back on average: 0 is black, 1 is white");
    } else if (gauge.kind == Kind::emitter) {
        ImGui::SetNextItemWidth(-FLT_MIN);
        if (ImGui::BeginCombo(
                "##light", gauge.emitter.empty() ? "choose a light" : shown(editor.namesOf({gauge.emitter})).c_str())) {
            for (const EmitterState& e : editor.emitters())
                if (e.recovered && ImGui::Selectable((shown(e.name) + "##" + e.id).c_str(), e.id == gauge.emitter)) {
                    gauge.emitter = e.id;
                    if (!(maxChannel(gauge.radiance) > 0)) gauge.radiance = e.recoveredRadiance;
                }
            if (editor.emitters().empty()) dimText("Estimate once first: lights must be found before one can be named");
            ImGui::EndCombo();
        }
        tooltip("The light whose brightness you know");
        ImGui::SetNextItemWidth(-FLT_MIN);
        if (ImGui::DragFloat3("##radiance", &gauge.radiance.x, 0.05f, 0, 1e6f, "%.3g"))
            gauge.radiance = glm::max(gauge.radiance, Rgb(0));
        tooltip("Its radiance, red green blue: the value a pixel has that sees the light directly and unclipped");
    } else if (gauge.kind == Kind::whitePatch) {
        const int views = editor.state.document.capture ? int(editor.state.document.capture->views.size()) : 0;
        int view = gauge.view;
        ImGui::SetNextItemWidth(-FLT_MIN);
        if (ImGui::SliderInt("##view", &view, 0, std::max(0, views - 1), "view %d", ImGuiSliderFlags_AlwaysClamp))
            gauge.view = view;
        tooltip(views > 0 && gauge.view < views
                    ? "Photograph in which the patch is seen, counted from 0: " +
                          shown(editor.state.document.capture->views[size_t(gauge.view)].name)
                    : "Photograph in which the patch is seen");
        ImGui::SetNextItemWidth(-FLT_MIN);
        ImGui::DragFloat2("##pixel", &gauge.pixel.x, 1, 0, 65536, "pixel %.0f");
        tooltip("Where it is seen: pixels from the left and from the top");
        int seenIn = 0;
        Vec2 pixel{0};
        const bool usable = pixelOfPick(editor, seenIn, pixel);
        ImGui::BeginDisabled(!usable);
        if (iconTextButton("Use the picked point", Icon::dropper,
                           usable ? "Takes the surface point that you clicked in the viewport"
                                  : "Click the white surface in the viewport first",
                           false, ImGui::GetContentRegionAvail().x)) {
            gauge.view = seenIn;
            gauge.pixel = pixel;
        }
        ImGui::EndDisabled();
        ImGui::SetNextItemWidth(-FLT_MIN);
        ImGui::SliderFloat("##white", &gauge.whiteAlbedo, 0.02f, 1, "reflects %.2f", ImGuiSliderFlags_AlwaysClamp);
        tooltip("Fraction of the light the patch sends back: paper 0.9, grey card 0.18");
    }
}

/// A prior's strength: as the photographs say, or the artist. `chosen`: what the last estimate took, null before one.
void strengthSetting(const char* label, const char* id, float& factor, const PriorStrength* chosen,
                     const char* explanation) {
    ImGui::PushID(id);
    bool automatic = factor == 0;
    const std::string words =
        std::string(explanation) + " Normally photographs that are left out decide: what predicts them best is taken.";
    if (checkbox(label, automatic, words)) factor = automatic ? 0.0f : chosen ? chosen->factor : 1.0f;
    if (factor > 0) {
        ImGui::SetNextItemWidth(-FLT_MIN);
        ImGui::SliderFloat("##factor", &factor, 0.05f, 20, "%.2f x the usual",
                           ImGuiSliderFlags_AlwaysClamp | ImGuiSliderFlags_Logarithmic);
        tooltip(words);
    } else if (chosen) {
        dimText(fmt::format("  {:.3g} x the usual{}", chosen->factor,
                            chosen->chosenBy == "photographs" ? ", chosen by the photographs"
                            : chosen->trials.empty()          ? ""
                                                              : ", confirmed by the photographs")
                    .c_str());
    }
    ImGui::PopID();
}

constexpr Choice bases[] = {
    {"built-in", "Usual: matte, plastic, metal", "Matte, and metal and plastic at six roughnesses: enough for most."},
    {"wide", "Wide: 55 lobes",
     "Covers measured materials: adds Schlick, Cook-Torrance, Ward and Lafortune lobes, of which a surface may mix "
     "three. "
     "Takes several times as long."},
    {"lambert", "Matte only", "No gloss but that of the measured materials below."},
};
constexpr Choice bounces[] = {
    {"auto", "Automatic", "Tried, and kept where the photographs are explained better with it."},
    {"off", "Off", "Surfaces light nothing. Faster; too bright a light or too bright surfaces in corners."},
    {"on", "On", "Taken to be there, whatever the photographs say."},
};

constexpr Choice textures[] = {
    {"", "Automatic", "Made where photographs are finer than the mesh, and kept where they agree on it."},
    {"0", "None", "Colours per vertex: a print that is finer than the mesh is blurred."},
    {"2048", "2048 texels wide at most", "Made in any case."},
    {"4096", "4096 texels wide at most", "Made in any case."},
    {"8192", "8192 texels wide at most", "Made in any case. Takes up to 3 GiB of memory."},
};

bool usualAdvanced(const SolveRequest& solve) {
    return solve.basis == "built-in" && solve.merl.empty() && solve.bounce == SolveOptions::Bounce::automatic &&
           !solve.meshTriangles && !solve.texture;
}

/// A row of choices that are kept as an index.
template <size_t N>
size_t choose(const char* id, const char* title, const Choice (&choices)[N], size_t present) {
    ImGui::SetNextItemWidth(-FLT_MIN);
    if (ImGui::BeginCombo(id, fmt::format("{}: {}", title, choices[present].label).c_str())) {
        for (size_t i = 0; i < N; ++i) {
            if (ImGui::Selectable(choices[i].label, i == present)) present = i;
            tooltip(choices[i].explanation);
        }
        ImGui::EndCombo();
    }
    tooltip(choices[present].explanation);
    return present;
}

/// What few captures need: lobes, bounced light, texture, size of the mesh.
void advancedSettings(SolveRequest& solve) {
    const bool open =
        ImGui::TreeNode("##advanced", "%s", usualAdvanced(solve) ? "Advanced" : "Advanced (something is changed)");
    tooltip("Kinds of gloss, bounced light, texture, size of the mesh: the usual values suit nearly every capture");
    if (!open) return;
    size_t basis = 0;
    for (size_t i = 0; i < std::size(bases); ++i)
        if (solve.basis == bases[i].value) basis = i;
    solve.basis = bases[choose("##basis", "Gloss", bases, basis)].value;
    std::string merl = solve.merl.string();
    ImGui::SetNextItemWidth(-FLT_MIN);
    if (inputText("##merl", merl, "Folder of measured materials")) solve.merl = merl;
    tooltip(
        "Folder with .binary files of the MERL database. Their gloss joins the choice; a surface may then mix three "
        "lobes. Empty: none.");
    using Bounce = SolveOptions::Bounce;
    solve.bounce = Bounce(choose("##bounce", "Bounced light", bounces, size_t(solve.bounce)));
    size_t texture = 0;
    for (size_t i = 1; i < std::size(textures); ++i)
        if (solve.texture == std::atoi(textures[i].value)) texture = i;
    texture = choose("##texture", "Texture", textures, texture);
    if (texture == 0) solve.texture.reset();
    else solve.texture = std::atoi(textures[texture].value);
    bool automatic = !solve.meshTriangles;
    const std::string mesh =
        "Meshes of more than 300 000 triangles are estimated on a simpler one, and what is found is carried back.";
    if (checkbox("Size of the mesh: automatic", automatic, mesh)) {
        if (automatic) solve.meshTriangles.reset();
        else solve.meshTriangles = 150000;
    }
    if (solve.meshTriangles) {
        int thousands = int(*solve.meshTriangles / 1000);
        ImGui::SetNextItemWidth(-FLT_MIN);
        if (ImGui::SliderInt("##triangles", &thousands, 0, 1000,
                             thousands > 0 ? "%d 000 triangles at most" : "all triangles",
                             ImGuiSliderFlags_AlwaysClamp))
            solve.meshTriangles = size_t(thousands) * 1000;
        tooltip("More triangles show finer detail and take longer. 0: the mesh as it is.");
    }
    ImGui::TreePop();
}

}  // namespace

void drawUnobservedLights(Editor& editor) {
    const Document& document = editor.state.document;
    const auto& job = editor.job();
    const bool searching = job && job->kind == JobStatus::Kind::search;
    if (searching) {
        bar(job->whole.value_or(-1), progressColour, timeLeftWords(*job));
        if (!job->stage.empty()) dimText(elided(job->stage, ImGui::GetContentRegionAvail().x, false));
        ImGui::BeginDisabled(job->stopping);
        if (button("Stop", "Stops; nothing changes", -FLT_MIN)) editor.cancelJob();
        ImGui::EndDisabled();
    } else {
        ImGui::BeginDisabled(!document.samples || job);
        if (button("Find off-camera light",
                   "A light outside all photographs leaves shading that falls off and shadows: tries places for it, up "
                   "to a minute. Where one is found, a small sphere joins the scene, "
                   "and its power is estimated with the rest. Undo brings the present estimate and its edits back.",
                   -FLT_MIN))
            editor.findUnobservedLight();
        ImGui::EndDisabled();
    }
    const UnobservedSearch& last = editor.state.unobservedSearch;
    const bool told = !searching && !last.words.empty() && last.capture == document.captureFolder;
    if (told && document.fix.proxies.empty()) dimWrapped(shown(last.words));
    if (const auto& light = editor.state.plan.suspectedLight; light && !searching && !told) {
        wrapped(fmt::format("A light that no photograph shows may stand near {}",
                            placeText(light->position, editor.state.lengthUnit)));
        tooltip("While it is not known, its light is taken for the environment's. " + inWords(*light));
    }
    for (size_t i = 0; i < document.fix.proxies.size(); ++i) {
        const ProxyLight& proxy = document.fix.proxies[i];
        if (proxy.observed()) continue;  // a light of the photographs, which has its place in the list of lights
        ImGui::PushID(int(i));
        wrapped(fmt::format("Light at {}{}", placeText(DVec3(proxy.centre), editor.state.lengthUnit),
                            proxy.found ? ", +- " + placeText(DVec3(proxy.sigma), editor.state.lengthUnit)
                                        : std::string(", as you said")));
        tooltip(told && proxy.found && i + 1 == document.fix.proxies.size()
                    ? shown(last.words)
                    : "It stands in the mesh as a small sphere; the estimate finds its power");
        ImGui::BeginDisabled(job.has_value());
        if (button("Remove",
                   "Takes this light away. The estimate from before it comes back; where there is none, the capture is "
                   "read again. Can be undone.",
                   -FLT_MIN))
            editor.removeProxy(i);
        ImGui::EndDisabled();
        ImGui::PopID();
    }
}

void drawEstimatePanel(Editor& editor) {
    drawEstimateButton(editor);
    drawEstimateSettings(editor);
}

bool interruptedOfferShown(const Editor& editor) {
    return editor.state.interrupted && !(editor.job() && editor.job()->kind == JobStatus::Kind::solve);
}

void drawInterruptedOffer(Editor& editor) {
    const InterruptedEstimate& offer = *editor.state.interrupted;
    const bool other = !editor.state.document.capture || editor.state.document.captureFolder != offer.captureFolder;
    ImGui::BeginDisabled(editor.job().has_value());
    const float width = ImGui::GetContentRegionAvail().x - ImGui::GetFrameHeight() - ImGui::GetStyle().ItemSpacing.x;
    std::string words = fmt::format("{} of {}, {}.", shown(offer.project.filename()), shown(offer.time),
                                    offer.seconds > 0 ? duration(offer.seconds) + " of work are kept" : "it was kept");
    words += other ? " Opens it and goes on where it stood." : " Goes on where it stood, with the settings it had.";
    const bool goOn = iconTextButton("Go on with the interrupted estimate", Icon::play, words, false, width);
    ImGui::SameLine();
    const bool discard =
        iconButton("##discard interrupted", Icon::trash, "Throws the interrupted estimate away; nothing else changes");
    ImGui::EndDisabled();
    if (goOn) editor.answerInterrupted(true);
    else if (discard) editor.answerInterrupted(false);
}

void drawEstimateButton(Editor& editor) {
    SolveRequest& solve = editor.state.solve;
    const auto& job = editor.job();
    const bool solving = job && job->kind == JobStatus::Kind::solve;
    const bool open = editor.state.document.capture != nullptr;
    if (solving) {
        bar(job->whole.value_or(-1), progressColour,
            (job->whole && !job->stopping ? percent(*job->whole) + ", " : "") + timeLeftWords(*job));
        tooltip(fmt::format("{}: {} so far", job->title, duration(job->seconds)));
        if (!job->stage.empty()) dimText(elided(job->stage, ImGui::GetContentRegionAvail().x, false));
        ImGui::BeginDisabled(job->stopping);
        if (button("Stop", "Stops and keeps the best answer so far", -FLT_MIN)) editor.cancelJob();
        ImGui::EndDisabled();
    } else {
        if (interruptedOfferShown(editor)) drawInterruptedOffer(editor);
        ImGui::BeginDisabled(!open || job);
        ImGui::PushStyleVar(ImGuiStyleVar_FramePadding, {ImGui::GetStyle().FramePadding.x, em(0.45f)});
        const bool again = editor.estimate() != nullptr;
        const char* why = !open ? "Open a capture first"
                          : job ? "Wait until the running job is finished"
                                : "Separates the photographs into light and surfaces, in the background (Ctrl+Enter)";
        if (primaryButton(again ? "Estimate again" : "Estimate", why, -FLT_MIN)) editor.solve(solve);
        ImGui::PopStyleVar();
        ImGui::EndDisabled();
    }
}

void drawEstimateSettings(Editor& editor) {
    SolveRequest& solve = editor.state.solve;
    if (editor.stale()) warningText("The settings have changed since the last estimate.");
    size_t quality = 1;
    for (size_t i = 0; i < 3; ++i)
        if (solve.quality == qualities[i].value) quality = i;
    ImGui::SetNextItemWidth(-FLT_MIN);
    if (ImGui::BeginCombo("##quality", fmt::format("Quality: {}", qualities[quality].label).c_str())) {
        for (const Choice& choice : qualities) {
            if (ImGui::Selectable(choice.label, solve.quality == choice.value)) solve.quality = choice.value;
            tooltip(choice.explanation);
        }
        ImGui::EndCombo();
    }
    tooltip(qualities[quality].explanation);
    gaugeSettings(editor);
    drawLightReferences(editor);
    dimText("Kinds of light");
    if (radio("Lights and distant light", solve.nearField,
              "Finds lights that stand in the scene as well as light from far away. This is what you want."))
        solve.nearField = true;
    if (radio("Distant only, to compare", !solve.nearField,
              "The older way, which knows no lights in the scene: for comparison. Its result is shown beside the other "
              "one (view modes 5 and 9) and replaces nothing."))
        solve.nearField = false;
    if (ImGui::TreeNode("Smoothness")) {
        const Estimate* found = editor.estimate().get();
        strengthSetting("Distant light: automatic", "light", solve.lightSmoothness,
                        found ? &found->lightSmoothness : nullptr,
                        "How alike neighbouring parts of the environment is taken to be. More where photographs are "
                        "noisy or few, less for skies with small bright spots.");
        strengthSetting("Surface colours: automatic", "surfaces", solve.albedoSmoothness,
                        found ? &found->albedoSmoothness : nullptr,
                        "How alike neighbouring points of a surface are taken to be; edges are kept. More where "
                        "photographs are noisy, less for fine texture.");
        ImGui::SetNextItemWidth(-FLT_MIN);
        ImGui::SliderInt("##palette", &solve.palette, 0, 24,
                         solve.palette > 0 ? "palette of %d materials" : "no palette", ImGuiSliderFlags_AlwaysClamp);
        tooltip(
            "Where the scene has few paints and no texture: how many. Every point is then drawn towards one of them. "
            "0: nothing is said.");
        ImGui::TreePop();
    }
    advancedSettings(solve);
    dimText("Time limit");
    float minutes = float(solve.budgetSeconds / 60);
    ImGui::SetNextItemWidth(-FLT_MIN);
    if (ImGui::DragFloat("##budget", &minutes, 0.05f, 0, 24 * 60, minutes > 0 ? "%.1f min" : "none",
                         ImGuiSliderFlags_AlwaysClamp))
        solve.budgetSeconds = double(std::max(0.0f, minutes)) * 60;
    tooltip("Ends after this time with the best answer so far. 0: as long as it takes.");
    dimText("Seed");
    int seed = int(solve.seed);
    ImGui::SetNextItemWidth(-FLT_MIN);
    if (ImGui::DragInt("##seed", &seed, 0.1f, 1, 1000000, "%d", ImGuiSliderFlags_AlwaysClamp))
        solve.seed = uint64_t(std::max(1, seed));
    tooltip(
        "Pattern of the random samples. The same seed gives the same result; another one shows how much of it is "
        "chance.");
}

}  // namespace relamp::ui
