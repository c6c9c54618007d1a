#include <fmt/format.h>

#include "display/html.h"
#include "display/log_plot.h"
#include "report/estimate_tables.h"
#include "report/solve_report.h"

namespace relamp {
namespace {

std::string section(const std::string& title, const std::string& explanation) {
    return "<h2>" + htmlText(title) + "</h2>\n<p>" + htmlText(explanation) + "</p>\n";
}

std::string row(const std::string& what, const std::string& about, const std::string& value) {
    return fmt::format("<tr><td>{}<small>{}</small></td><td class=\"number\">{}</td></tr>\n", htmlText(what),
                       htmlText(about), htmlText(value));
}

std::string figuresTable(const SolveReport& r) {
    const StabilityReport& s = r.estimate.stability;
    std::string rows;
    double sum = 0;
    for (const ReportedView& v : r.views) sum += v.psnr;
    const Reproduction& own = r.estimate.reproduction;
    if (own.measured()) {
        rows += row(
            "Photographs reproduced",
            "Median PSNR over the views, of full-size pixels on the surfaces, the photographs' own noise taken off.",
            htmlText(fmt::format("{:.1f} dB (worst {:.1f} dB, {})", own.median, own.views[own.worst()].psnr,
                                 own.views[own.worst()].name)));
        if (own.heldOut > 0)
            rows += row("Views left out are predicted at",
                        "Two views in turn, surfaces from the other views alone: how good new views will be.",
                        fmt::format("{:.1f} dB", own.heldOut));
        if (own.poor())
            rows += row("Quality gate missed",
                        fmt::format("Below {:.0f} dB an estimate is not to be trusted.", Reproduction::gateDb),
                        htmlText(own.advice));
    }
    if (!r.views.empty())
        rows += row("Likeness to the photographs",
                    "Mean PSNR over the photographs, as they appear on screen. It alone proves little: a wrong light "
                    "can be painted into the surfaces.",
                    fmt::format("{:.1f} dB", sum / double(r.views.size())));
    rows += row("Lights", "Patches of the mesh that send light of their own.",
                fmt::format("{}", r.estimate.emitters.emitters.size()));
    rows += row("Unknowns", "Patches of sky or room whose light was told apart, and lights, for each colour channel.",
                fmt::format("{}", s.unknowns));
    rows += row("KKT residual",
                "How exactly the last lighting program was solved, relative; 1e-6 and less is exact for all purposes.",
                fmt::format("{:.1e}", s.kktResidual));
    if (!s.weakest.empty())
        rows += row("Least certain",
                    "The change of light that the photographs tell least about: what it moves on the surfaces, one "
                    "standard deviation.",
                    htmlText(fmt::format("{} ({:.1f} %)", s.weakest, 100 * s.weakestSigma)));
    rows += row("Condition number", "How much the lighting equations magnify errors.",
                fmt::format("{:.1e}", s.conditionNumber));
    rows += row("Effective rank", "Unknowns that the photographs pin down; the others rest on the priors.",
                fmt::format("{} of {}", s.effectiveRank, s.unknowns));
    for (const auto& [name, strength] : {std::pair{"Smoothness of the light", &r.estimate.lightSmoothness},
                                         std::pair{"Smoothness of the surfaces", &r.estimate.albedoSmoothness}}) {
        std::string tried;
        for (const PriorStrength::Trial& t : strength->trials)
            if (t.factor != 1)
                tried += fmt::format("; {:.3g} times: {:+.1f} +- {:.1f} % misfit of what was left out", t.factor,
                                     100 * (t.misfit - 1), 100 * t.error);
        rows += row(name,
                    "Strength of the prior over the usual one, and how much worse other strengths predict looks and "
                    "pairs that were left out.",
                    htmlText(fmt::format(
                        "{:.3g} (by the {}){}", strength->factor,
                        strength->chosenBy == "usual" && !tried.empty() ? "photographs" : strength->chosenBy, tried)));
    }
    rows += row(
        "Time",
        fmt::format("From the photographs to the answer, {} quality, {} thread(s).", r.quality, r.resources.threads),
        fmt::format("{:.1f} s", r.resources.seconds));
    rows += row("Memory", "The most the solve used.", fmt::format("{:.0f} MiB", r.resources.peakMib));
    if (r.estimate.interreflection)
        rows += row("Bounced light", "Fraction of the light on the surfaces that comes from other surfaces.",
                    fmt::format("{:.0f} %", 100 * r.estimate.bouncedFraction));
    return "<table>\n" + rows + "</table>\n";
}

std::string bar(double psnr, double longest, const char* colour) {
    return fmt::format("<div style=\"height:9px;margin:3px 0;border-radius:2px;width:{:.1f}%;background:{}\"></div>",
                       100 * std::clamp(psnr / longest, 0.0, 1.0), colour);
}

std::string viewsTable(const SolveReport& r) {
    double longest = 1;
    for (const ReportedView& v : r.views) longest = std::max(longest, std::max(v.psnr, v.distantPsnr));
    std::string rows;
    for (const ReportedView& v : r.views)
        rows += fmt::format(
            "<tr><td>{}</td><td class=\"number\">{:.1f} dB</td>{}<td style=\"width:420px\">{}{}</td></tr>\n",
            htmlText(v.name), v.psnr,
            r.distant ? fmt::format("<td class=\"number\">{:.1f} dB</td>", v.distantPsnr) : "",
            bar(v.psnr, longest, "#e8a24a"), r.distant ? bar(v.distantPsnr, longest, "#6fa8dc") : "");
    return fmt::format("<table><tr><th>Photograph</th><th>This shot</th>{}<th>Longer is better</th></tr>\n{}</table>\n",
                       r.distant ? "<th>Distant light only</th>" : "", rows);
}

/// Seconds of each stage, in the order of the timeline.
std::string stagesTable(const SolveReport& r) {
    struct Stage {
        std::string name;
        double from, to, error, best;
        int steps;
    };
    std::vector<Stage> stages;
    double before = 0;
    for (const TimelineEntry& t : r.estimate.timeline) {
        const std::string name = t.stage == "done" ? "brightness scale, how sure" : t.stage;
        if (stages.empty() || stages.back().name != name)
            stages.push_back({name, before, t.seconds, t.rmse, t.rmse, 0});
        Stage& s = stages.back();
        s.to = before = t.seconds;
        if (t.rmse > 0) s.error = t.rmse;
        ++s.steps;
    }
    std::string rows;
    for (const Stage& s : stages)
        rows += fmt::format(
            "<tr><td>{}</td><td class=\"number\">{}</td><td class=\"number\">{:.2f} s</td><td class=\"number\">{:.2f} "
            "s</td><td class=\"number\">{:.4f}</td></tr>\n",
            htmlText(s.name), s.steps, s.to - s.from, s.to, s.error);
    return "<table><tr><th>Stage</th><th>Steps</th><th>Took</th><th>Ended at</th><th>Error then</th></tr>\n" + rows +
           "</table>\n<p>The first stage's time holds what comes before it: photographs, mesh, visibility.</p>\n";
}

/// What each stage was expected to take, what it took, and what was left out.
std::string planSection(const SolvePlan& plan) {
    const auto known = [](double value, const char* unit) {
        return value >= 0 ? fmt::format("{:.{}f} {}", value, value < 10 ? 2 : 0, unit) : std::string();
    };
    std::string rows;
    for (const PlannedStage& s : plan.stages)
        rows += fmt::format(
            "<tr><td>{}</td><td class=\"number\">{}</td><td class=\"number\">{}</td><td class=\"number\">{}</td><td "
            "class=\"number\">{}</td></tr>\n",
            htmlText(nameOf(s.stage)), known(s.predictedSeconds, "s"), known(s.measuredSeconds, "s"),
            known(s.predictedMib, "MiB"), known(s.measuredMib, "MiB"));
    std::string text =
        "<table><tr><th>Stage</th><th>Expected</th><th>Took</th><th>Memory expected</th><th>Memory needed</th></tr>\n" +
        rows + "</table>\n";
    if (plan.suspectedLight)
        text += "<p>" + htmlText(inWords(*plan.suspectedLight)) + " --find-light looks for it.</p>\n";
    rows.clear();
    for (const PlannedOmission& o : plan.leftOut)
        rows += fmt::format("<tr><td>{}</td><td>{}</td><td class=\"number\">{}</td><td class=\"number\">{}</td></tr>\n",
                            htmlText(nameOf(o.what)), htmlText(o.reason), known(o.savedSeconds, "s"),
                            known(o.savedMib, "MiB"));
    if (!rows.empty())
        text +=
            "<h3>Left out beforehand</h3>\n<div class=\"wide\"><table><tr><th>What</th><th>Why</th><th>Saves "
            "about</th><th>Saves about</th></tr>\n" +
            rows + "</table></div>\n";
    return text;
}

std::string leftOutTable(const Estimate& e) {
    std::string rows;
    for (const LeftOut& l : e.leftOut)
        rows += fmt::format("<tr><td>{}</td><td>{}</td></tr>\n", htmlText(nameOf(l.what)), htmlText(l.why));
    if (!e.stability.reason.empty())
        rows += fmt::format("<tr><td>full convergence</td><td>{}</td></tr>\n", htmlText(e.stability.reason));
    if (e.cancelled)
        rows += "<tr><td>the rest of the solve</td><td>stopped early: the best answer until then</td></tr>\n";
    if (rows.empty()) return "<p>Nothing.</p>\n";
    return "<div class=\"wide\"><table><tr><th>What</th><th>Why</th></tr>\n" + rows + "</table></div>\n";
}

std::string truthSection(const TruthFigures& t) {
    std::string content, rows;
    for (const TruthFigure& f : t.figures) rows += row(f.what, f.about, f.value);
    if (!rows.empty()) content += "<table>\n" + rows + "</table>\n";
    rows.clear();
    for (const TruthEdit& e : t.edits)
        rows += fmt::format("<tr><td>{}<small>{}</small></td><td class=\"number\">{:.1f} dB</td></tr>\n",
                            htmlText(e.name), htmlText(e.about), e.psnr);
    if (rows.empty()) return content;
    return content + "<h3>Relit images against the true ones</h3>\n<table><tr><th>Edit</th><th>PSNR</th></tr>\n" +
           rows +
           fmt::format(
               "</table>\n<p>Mean over the images in which something changes: {:.1f} dB. Nothing is divided "
               "out.</p>\n",
               t.meanPsnr);
}

std::string csvText(const std::string& text) {
    if (text.find_first_of(",\"\n") == std::string::npos) return text;
    std::string quoted = "\"";
    for (char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
    return quoted + "\"";
}

}  // namespace

std::string errorPlot(const SolveReport& r) {
    static const char* const colours[] = {"#e8a24a", "#8fbf6a", "#d97b9a", "#b39ddb", "#e6d36a", "#7fc8c0"};
    std::vector<PlotCurve> curves;
    std::vector<std::string> stages;
    const TimelineEntry* last = nullptr;
    for (const TimelineEntry& t : r.estimate.timeline) {
        if (!(t.rmse > 0) || t.stage == "done") continue;
        const size_t at = size_t(std::find(stages.begin(), stages.end(), t.stage) - stages.begin());
        if (at == stages.size()) stages.push_back(t.stage);
        const PlotPoint point{
            t.seconds, t.rmse,
            fmt::format("{}, step {}: {:.2f} s, error {:.3g}", t.stage, t.iteration, t.seconds, t.rmse)};
        if (!last || last->stage != t.stage) {
            // Each run of a stage is a curve of its own that starts where the last one ended; named the first time.
            bool named = false;
            for (const PlotCurve& c : curves) named = named || c.name == t.stage;
            PlotCurve curve{named ? "" : t.stage, colours[at % 6], false, {}};
            if (last) curve.points.push_back({last->seconds, last->rmse, ""});
            curves.push_back(std::move(curve));
        }
        curves.back().points.push_back(point);
        last = &t;
    }
    if (r.distant) {
        PlotCurve curve{"distant light only", "#6fa8dc", true, {}};
        for (const TimelineEntry& t : r.distant->estimate.timeline)
            curve.points.push_back(
                {t.seconds, t.rmse,
                 fmt::format("distant light only, {}: {:.2f} s, error {:.3g}", t.stage, t.seconds, t.rmse)});
        curves.push_back(std::move(curve));
    }
    return logPlotSvg(curves, "seconds since the photographs were opened",
                      "relative difference of points with equal colour");
}

std::string spectrumPlot(const SolveReport& r) {
    const auto curveOf = [](const StabilityReport& s, const char* name, const char* colour, bool dashed) {
        PlotCurve curve{name, colour, dashed, {}};
        const double step = s.spectrum.empty() ? 1 : std::max(1.0, double(s.unknowns) / double(s.spectrum.size()));
        for (size_t i = 0; i < s.spectrum.size(); ++i)
            if (s.spectrum[i] > 1e-12f)
                curve.points.push_back({1 + double(i) * step, s.spectrum[i],
                                        fmt::format("number {:.0f}: {:.2g}", 1 + double(i) * step, s.spectrum[i])});
        return curve;
    };
    std::vector<PlotCurve> curves{curveOf(r.estimate.stability, "this shot", "#e8a24a", false)};
    if (r.distant) curves.push_back(curveOf(r.distant->estimate.stability, "distant light only", "#6fa8dc", true));
    return logPlotSvg(curves, "number of the eigenvalue", "eigenvalue over the largest");
}

std::string truthPlot(const SolveReport& r) {
    PlotCurve curve{"relit images", "#8fbf6a", false, {}};
    for (const TruthMoment& m : r.truthOverTime)
        if (m.psnr > 0)
            curve.points.push_back(
                {m.seconds, std::pow(10, -m.psnr / 20), fmt::format("{:.2f} s: {:.1f} dB", m.seconds, m.psnr)});
    return curve.points.empty() ? ""
                                : logPlotSvg({curve}, "seconds since the photographs were opened",
                                             "root mean square error of relit images, display values");
}

std::string truthCsv(const SolveReport& r) {
    std::string text = "seconds,psnr_db\n";
    for (const TruthMoment& m : r.truthOverTime) text += fmt::format("{:.4f},{:.3f}\n", m.seconds, m.psnr);
    return r.truthOverTime.empty() ? "" : text;
}

std::string timelineCsv(const SolveReport& r) {
    std::string text = "mode,seconds,stage,iteration,objective,error\n";
    const auto add = [&](const Estimate& e) {
        for (const TimelineEntry& t : e.timeline)
            text += fmt::format("{},{:.4f},{},{},{:.9g},{:.6g}\n", csvText(e.mode), t.seconds, csvText(t.stage),
                                t.iteration, t.objective, t.rmse);
    };
    add(r.estimate);
    if (r.distant) add(r.distant->estimate);
    return text;
}

std::string viewsCsv(const SolveReport& r) {
    std::string text = "view,psnr_db,distant_only_psnr_db\n";
    for (const ReportedView& v : r.views)
        text += fmt::format("{},{:.3f},{}\n", csvText(v.name), v.psnr,
                            r.distant ? fmt::format("{:.3f}", v.distantPsnr) : "");
    return r.views.empty() ? "" : text;
}

std::string reportPage(const SolveReport& r) {
    std::string content =
        fmt::format("<h1>{}: how it was solved</h1>\n<p>Capture {}, {}. Brightness scale: {}</p>\n", htmlText(r.shot),
                    htmlText(r.capture), htmlText(r.estimate.mode),
                    htmlText(r.estimate.gauge.evidence.empty() ? "not said" : r.estimate.gauge.evidence));
    for (const ProbeFit& probe : r.estimate.probes)
        content += fmt::format("<p>Light probe {}. The light found differs from it by {:.0f} %.</p>\n",
                               htmlText(probe.words), 100 * probe.residual);
    for (const PatchFit& patch : r.estimate.patches)
        content += fmt::format("<p>Known albedo: {}.</p>\n", htmlText(patch.words));
    content += section("Figures", "What the solve came to.") + figuresTable(r);
    if (r.truth)
        content += section("Against the truth",
                           "The capture's light and surfaces are known: how far the answer is from them.") +
                   truthSection(*r.truth);
    if (!r.truthOverTime.empty())
        content += section("Truth against run time",
                           "A solve of the same capture, stopped in thought after each large step: how far its relit "
                           "images were from the true ones then.") +
                   truthPlot(r);
    content +=
        section("Error against run time",
                "How much surfaces of one colour still differ under the light found: surface colour cancels in it, "
                "so it cannot hide what the light gets wrong. The same measure in every "
                "stage and mode. Both axes are logarithmic; rest on a point for its stage.") +
        errorPlot(r);
    if (!r.noDistantBecause.empty())
        content += "<p>Not held against distant light only: " + htmlText(r.noDistantBecause) + ".</p>\n";
    else if (r.distant)
        content += fmt::format("<p>Distant light only took {:.1f} s, this shot {:.1f} s.</p>\n", r.distant->seconds,
                               r.resources.seconds);
    content += stagesTable(r);
    content += section("Photograph by photograph",
                       "PSNR of what the model makes of each photograph, on the surfaces, as they appear on screen.");
    content +=
        r.views.empty()
            ? "<p>Not measured: " + htmlText(r.noViewsBecause.empty() ? "there are none" : r.noViewsBecause) + ".</p>\n"
            : viewsTable(r);
    if (r.worst)
        content +=
            "<h3>Explained least well: " + htmlText(r.worst->name) + "</h3>\n<div class=\"grid three\">\n" +
            htmlImage(r.worst->photograph, "Photograph", "") + htmlImage(r.worst->model, "Model", "") +
            htmlImage(r.worst->difference, "Difference", "grey is equal, brighter where the model is too bright") +
            "</div>\n";
    const std::string spectrum = spectrumPlot(r);
    if (!spectrum.empty())
        content +=
            section("How well posed the equations were",
                    "Eigenvalues of the column-scaled lighting equations. What lies above 1e-6 of the largest is "
                    "pinned down by the photographs; "
                    "below, the priors decide.") +
            spectrum;
    content += section("Lights", "What shines in the scene, and why it is believed to.") + emittersTable(r.estimate) +
               rejectedTable(r.estimate, r.origin);
    if (!r.estimate.plan.stages.empty())
        content += section("Plan",
                           "What every stage was expected to take on this machine before it ran, and what it took; and "
                           "what was left out because the scene does not need it.") +
                   planSection(r.estimate.plan);
    content += section("Left out", "What this scene did not need.") + leftOutTable(r.estimate);
    return htmlPage("relamp: " + r.shot, content);
}

}  // namespace relamp
