#include "pipeline/plan.h"

#include <nlohmann/json.hpp>

#include "base/log.h"
#include "base/significant.h"
#include "pipeline/plan_costs.h"

namespace relamp {
namespace {

double total(const std::vector<StageEstimate>& stages) {
    double sum = 0;
    for (const StageEstimate& s : stages) sum += s.seconds;
    return sum;
}

double most(const std::vector<StageEstimate>& stages) {
    double most = 0;
    for (const StageEstimate& s : stages) most = std::max(most, s.mib);
    return most;
}

/// Looks that a lobe fit of the components would use, by whether they change with the view; and what one row costs,
/// from a few of them.
void countObservations(const Capture& capture, const Scene& scene, const RadianceSamples& samples,
                       const EmitterClusters& emitters, const MatteObservations& matte, const SolveOptions& options,
                       WorkCounts& counts, Progress& progress) {
    const std::vector<size_t> sizes = observationsOfComponents(scene, matte);
    GlossOptions gloss;
    gloss.seed = options.seed;
    std::vector<EmitterSurface> surfaces;
    for (const EmitterCluster& e : emitters.emitters) surfaces.push_back(orderedEmitterSurface(scene, e));
    const BrdfBasis basis = builtInBasis();
    counts.lobes = double(basis.lobes.size()) - 1;
    for (uint32_t p = 0; p < scene.materials; ++p) {
        if (sizes[p] < 30) continue;
        std::vector<GlossyObservation> observations = glossyObservations(capture, scene, samples, p, gloss);
        if (observations.size() < 40) continue;
        counts.metals |= matte.componentGlossy[p] == 2;
        (matte.componentGlossy[p] ? counts.glossyObservations : counts.matteObservations) +=
            double(observations.size());
        if (counts.observationSeconds > 0 && !matte.componentGlossy[p]) continue;
        // Every so many of them, through a sharp and a wide lobe.
        std::vector<GlossyObservation> some;
        for (size_t i = 0; i < observations.size(); i += std::max<size_t>(1, observations.size() / 160))
            some.push_back(observations[i]);
        const double start = progress.seconds();
        for (const size_t lobe : {size_t(2), size_t(5)})
            glossyRows(scene, surfaces, emitters.emitterOfTriangle,
                       LightLeaves::uniform(options.startLevel, scene.axes), basis.lobes[lobe], some, gloss.rows,
                       progress);
        counts.observationSeconds = std::max(progress.seconds() - start, 1e-7) / double(2 * some.size());
    }
}

/// Fits all lobes to a few dozen vertices of each component that changes with the view: is there one that explains the
/// change?
bool lobeLikely(const Capture& capture, const Scene& scene, const RadianceSamples& samples,
                const EmitterClusters& emitters, const MatteObservations& matte, const Lighting& lighting,
                const SolveOptions& options, Progress& progress) {
    GlossOptions gloss;
    gloss.seed = options.seed;
    gloss.maxVertices = 60;
    gloss.rows.lobeSamples = 64;
    std::vector<EmitterSurface> surfaces;
    for (const EmitterCluster& e : emitters.emitters) surfaces.push_back(orderedEmitterSurface(scene, e));
    for (uint32_t p = 0; p < scene.materials; ++p)
        if (matte.componentGlossy[p]) {
            // The light is coarse here: what the solve will explain better is hinted at only.
            const ComponentGloss g = fitGloss(capture, scene, samples, surfaces, emitters.emitterOfTriangle, lighting,
                                              builtInBasis(), p, gloss, progress);
            if (g.residual < 0.92f * g.residualMatte) return true;
        }
    return false;
}

/// What of a full solve this scene does not need, with what that saves.
class OmissionPlanner {
public:
    OmissionPlanner(const WorkCounts& counts, const PilotFindings& pilot, const EmitterClusters& emitters,
                    const RadianceSamples& samples, const SolveOptions& options, bool everything, Progress& progress)
        : counts_(counts),
          pilot_(pilot),
          emitters_(emitters),
          samples_(samples),
          options_(options),
          everything_(everything),
          judged_(pilot.ran && options.nearField && counts.matte),
          speed_(measureMachine(progress)),
          stages(cost()) {
        environment();
        bouncedLight();
        details();
    }
    PlanChoices choices() const { return everything_ ? PlanChoices::everything() : kept_; }

private:
    std::vector<StageEstimate> cost() const { return predictStages(counts_, speed_, pilot_, options_, kept_); }
    void leaveOut(Omission what, const std::string& reason, bool PlanChoices::*part) {
        if (everything_) return;
        kept_.*part = false;
        std::vector<StageEstimate> fewer = cost();
        leftOut.push_back(
            {what, reason, std::max(0.0, total(stages) - total(fewer)), std::max(0.0, most(stages) - most(fewer))});
        stages = std::move(fewer);
    }

    void environment() {
        if (judged_ && !emitters_.emitters.empty() && pilot_.distantFraction < 0.003 && pilot_.background < 0.05)
            leaveOut(Omission::distantLight,
                     fmt::format(
                         "of the light on {} points {} % comes from afar, and the background is black where it is seen",
                         pilot_.points, significant(100 * pilot_.distantFraction, 2)),
                     &PlanChoices::distantLight);
    }

    void bouncedLight() {
        if (judged_ && options_.bounce == SolveOptions::Bounce::automatic) {
            if (pilot_.enclosure < 0.01)
                leaveOut(
                    Omission::interreflection,
                    fmt::format("other surfaces fill only {:.1f} % of what a surface sees", 100 * pilot_.enclosure),
                    &PlanChoices::bounce);
            else if (pilot_.bouncedFraction < 0.5 * double(samples_.relativeNoise))
                leaveOut(Omission::interreflection,
                         fmt::format(
                             "it would be {:.1f} % of the light, less than half of the photographs' noise of {:.1f} %",
                             100 * pilot_.bouncedFraction, 100 * samples_.relativeNoise),
                         &PlanChoices::bounce);
            else if (pilot_.bounceWorse > 4)
                leaveOut(
                    Omission::interreflection,
                    fmt::format(
                        "with it the ratios between {} pairs of points are explained worse, by {:.0f} standard errors",
                        pilot_.pairs, pilot_.bounceWorse),
                    &PlanChoices::bounce);
            else if (pilot_.bounceWorse > 1)
                leaveOut(Omission::fullInterreflection,
                         "it is tried on coarse light first and again only if that cannot rule it out",
                         &PlanChoices::lateBounce);
            kept_.bounceLikely = !everything_ && pilot_.bounceWorse < likelyBounce;
        }
    }

    void details() {
        if (counts_.seen < counts_.vertices)
            leaveOut(Omission::unobservedVertices,
                     fmt::format("{:.0f} of {:.0f}: their light is computed when something needs it",
                                 counts_.vertices - counts_.seen, counts_.vertices),
                     &PlanChoices::unobservedVertices);
        if (kept_.distantLight && options_.visibilitySide >= 4)
            leaveOut(Omission::agreeingRays, "visibility is traced finer only where an edge is near",
                     &PlanChoices::agreeingRays);
        if (counts_.matteObservations > 0)
            leaveOut(counts_.glossyObservations > 0 ? Omission::lobesOnMatte : Omission::glossyLobes,
                     counts_.glossyObservations > 0 ? "those components do not change with the view beyond noise"
                                                    : "no surface changes with the view beyond noise",
                     &PlanChoices::matteComponents);
        if (counts_.glossyObservations > 0 && options_.glossRounds > 0)
            leaveOut(
                Omission::lostLobes,
                "all are tried on directions they share, and on their own only where they come within a twelfth of "
                "the best",
                &PlanChoices::lostLobes);
        if (judged_ && counts_.metals && options_.glossRounds > 0)
            leaveOut(Omission::mattePointsInDetail,
                     "directions are divided for what metals reflect; the curvature that matte points give them is "
                     "computed undivided",
                     &PlanChoices::mattePointsInDetail);
        if (judged_ && kept_.distantLight)
            leaveOut(Omission::emptyColumns,
                     "what no point that a photograph shows can see takes no part in the equations' products",
                     &PlanChoices::emptyColumns);
        if (judged_)
            leaveOut(Omission::lastDigits,
                     "a fit that finer ones follow ends when an iteration explains less than 0.03 % more",
                     &PlanChoices::lastDigits);
        if (counts_.matte)
            leaveOut(Omission::flatLevels,
                     "splitting ends after a round that explains less than a fifth of a percent more",
                     &PlanChoices::flatLevels);
        if (options_.nearField && emitters_.emitters.empty())
            leftOut.push_back({Omission::nearFieldEmitters, "no patch of the scene shines on its own",
                               16 * counts_.seen * pilot_.visibilitySecondsPerRay, counts_.vertices * 8 / (1 << 20)});
    }

    const WorkCounts& counts_;
    const PilotFindings& pilot_;
    const EmitterClusters& emitters_;
    const RadianceSamples& samples_;
    const SolveOptions& options_;
    const bool everything_, judged_;
    const MachineSpeed speed_;
    PlanChoices kept_ = PlanChoices::everything();

public:
    std::vector<StageEstimate> stages;  ///< of what is left
    std::vector<PlannedOmission> leftOut;
};

}  // namespace

SolvePlan planSolve(const Capture& capture, const Scene& scene, const RadianceSamples& samples,
                    const EmitterClusters& clusters, const SolveOptions& options, bool everything, Progress& progress) {
    SolvePlan plan;
    const double start = progress.seconds();
    progress.begin("Planning", 1);
    const EmitterClusters emitters = allEmitters(scene, clusters, options.nearField);
    WorkCounts counts;
    counts.vertices = double(std::count(scene.referenced.begin(), scene.referenced.end(), 1));
    counts.emitters = double(emitters.emitters.size());
    std::vector<uint8_t> skip(scene.mesh.vertexCount(), 0);
    for (size_t v = 0; v < skip.size(); ++v) {
        skip[v] = emitters.emitterOfVertex[v] >= 0;
        counts.seen += samples.countOf(uint32_t(v)) > 0 || skip[v];
    }
    const auto observed =
        std::make_shared<const RatioObservations>(ratioObservations(scene, samples, std::move(skip), options.seed));
    const MatteObservations& matte = observed->matte;
    const std::vector<AlbedoPair>& pairs = observed->pairs;
    plan.observed = observed;
    counts.rows = double(matte.vertices.size());
    counts.pairs = double(pairs.size());
    size_t usable = 0;
    for (uint32_t v : matte.vertices) usable += matte.componentGlossy[scene.material[v]] < 2;
    counts.matte = matte.vertices.empty() || double(usable) > 0.15 * double(matte.vertices.size());
    countObservations(capture, scene, samples, emitters, matte, options, counts, progress);
    const PilotFindings pilot = runPilot(scene, samples, emitters, matte, pairs, options, progress);
    // Metals have nothing but lobes: there it need not be tried.
    if (counts.glossyObservations > 0 && pilot.ran && !counts.metals)
        counts.lobeLikely = std::count(scene.shines.begin(), scene.shines.end(), 1) > 0 ||
                            lobeLikely(capture, scene, samples, emitters, matte, pilot.lighting, options, progress);
    if (pilot.ran) plan.light = std::make_shared<const Lighting>(pilot.lighting);
    OmissionPlanner planner(counts, pilot, emitters, samples, options, everything, progress);
    plan.leftOut = std::move(planner.leftOut);
    plan.choices = planner.choices();
    for (const StageEstimate& s : planner.stages) plan.stages.push_back({s.stage, s.seconds, -1, s.mib, -1});
    plan.planningSeconds = progress.seconds() - start;
    progress.advance();
    logInfo(
        "plan: {:.1f} s to come, {:.1f} s left out; distant light {} %, bounced light {:.1f} % (misfit {:+.1f} "
        "standard errors), planned in {:.2f} s",
        plan.predictedSeconds(), plan.savedSeconds(), significant(100 * pilot.distantFraction, 2),
        100 * pilot.bouncedFraction, pilot.bounceWorse, plan.planningSeconds);
    return plan;
}

void countAllStates(const RadianceSamples& all, const RadianceSamples& part, SolvePlan& plan) {
    const double more = double(all.samples.size()) / double(std::max<size_t>(1, part.samples.size()));
    for (PlannedStage& stage : plan.stages) {
        if (stage.stage == Stage::visibility) continue;
        if (stage.predictedSeconds > 0) stage.predictedSeconds *= more;
        if (stage.predictedMib > 0) stage.predictedMib *= more;
    }
}

nlohmann::json planJson(const SolvePlan& plan) {
    const auto known = [](double value) { return value >= 0 ? nlohmann::json(value) : nlohmann::json(); };
    nlohmann::json stages = nlohmann::json::array(), leftOut = nlohmann::json::array();
    for (const PlannedStage& s : plan.stages)
        stages.push_back({{"name", fileNameOf(s.stage)},
                          {"predicted_s", known(s.predictedSeconds)},
                          {"measured_s", known(s.measuredSeconds)},
                          {"predicted_mib", known(s.predictedMib)},
                          {"measured_mib", known(s.measuredMib)}});
    for (const PlannedOmission& o : plan.leftOut)
        leftOut.push_back(
            {{"what", nameOf(o.what)}, {"reason", o.reason}, {"saved_s", o.savedSeconds}, {"saved_mib", o.savedMib}});
    nlohmann::json json{{"stages", stages},
                        {"left_out", leftOut},
                        {"predicted_s", plan.predictedSeconds()},
                        {"saved_s", plan.savedSeconds()},
                        {"planning_s", plan.planningSeconds}};
    if (const auto& light = plan.suspectedLight)
        json["suspected_light"] = {{"position", {light->position.x, light->position.y, light->position.z}},
                                   {"misfit_explained", light->gain},
                                   {"standard_errors", light->certainty},
                                   {"fraction", light->fraction}};
    return json;
}

std::string planText(const SolvePlan& plan) {
    std::string text = fmt::format("{:36} {:>8} {:>8}\n", "kept", "s", "MiB");
    for (const PlannedStage& s : plan.stages)
        text += fmt::format("{:36} {:>8} {:>8}\n", nameOf(s.stage),
                            s.predictedSeconds >= 0 ? fmt::format("{:.2f}", s.predictedSeconds)
                                                    : fmt::format("({:.2f})", std::max(0.0, s.measuredSeconds)),
                            s.predictedMib >= 0 ? fmt::format("{:.0f}", s.predictedMib)
                                                : fmt::format("({:.0f})", std::max(0.0, s.measuredMib)));
    text += fmt::format("{:36} {:>8.2f}\n", "to come", plan.predictedSeconds());
    if (!plan.leftOut.empty()) text += fmt::format("\n{:36} {:>8} {:>8}  {}\n", "left out", "s", "MiB", "because");
    for (const PlannedOmission& o : plan.leftOut)
        text += fmt::format("{:36} {:>8.2f} {:>8.0f}  {}\n", nameOf(o.what), o.savedSeconds, o.savedMib, o.reason);
    if (plan.suspectedLight) text += fmt::format("\n{} --find-light looks for it.\n\n", inWords(*plan.suspectedLight));
    return text + "In brackets: already done and measured, the solve does it once more.\n";
}

}  // namespace relamp
