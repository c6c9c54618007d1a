#include <fmt/format.h>

#include "display/html.h"
#include "display/log_plot.h"
#include "report/comparison.h"
#include "report/estimate_tables.h"

namespace relamp {
namespace {

using Modes = std::array<ComparedMode, 2>;

std::string heading(const std::string& title, const std::string& explanation) {
    return "<h2>" + htmlText(title) + "</h2>\n<p>" + htmlText(explanation) + "</p>\n";
}

std::string grid(const char* columns, const std::string& figures) {
    return fmt::format("<div class=\"grid {}\">\n{}</div>\n", columns, figures);
}

std::string stops(float value) { return fmt::format("{:+.1f} stops", value); }

std::string figureRow(const char* what, const char* about, const std::string& near, const std::string& distant) {
    return fmt::format(
        "<tr><td>{}<small>{}</small></td><td class=\"number\">{}</td><td class=\"number\">{}</td></tr>\n", what, about,
        htmlText(near), htmlText(distant));
}

std::string figuresTable(const Comparison& c) {
    std::string rows;
    const auto row = [&](const char* what, const char* about, auto&& value) {
        rows += figureRow(what, about, value(c.modes[0]), value(c.modes[1]));
    };
    const auto estimate = [](const ComparedMode& m) -> const Estimate& { return m.shot.estimate; };
    row("Likeness to the photographs",
        "PSNR of the model on the surfaces, as they appear on screen. A good likeness alone proves little: a wrong "
        "light can be painted into the surfaces.",
        [](const ComparedMode& m) { return fmt::format("{:.1f} dB", m.psnr); });
    row("Worst photograph", "The view that is reproduced least well.",
        [](const ComparedMode& m) { return fmt::format("{:.1f} dB, {}", m.worstPsnr, m.worstView); });
    for (size_t s = 0; s < c.states.size(); ++s)
        row("Likeness in a lighting state", htmlText(c.states[s]).c_str(),
            [&](const ComparedMode& m) { return fmt::format("{:.1f} dB", m.psnrOfState[s]); });
    row("Colour in the surfaces",
        "Mean angle between the surfaces' own colour and grey. Less is better only where it was the light's colour.",
        [](const ComparedMode& m) { return fmt::format("{:.1f}\u00b0", m.tintDegrees); });
    row("Lights found", "Patches of the mesh that send light of their own.",
        [&](const ComparedMode& m) { return fmt::format("{}", estimate(m).emitters.emitters.size()); });
    row("Distant light", "Number of patches of sky or room whose light was told apart.",
        [&](const ComparedMode& m) { return fmt::format("{}", estimate(m).lighting.leaves.size()); });
    row("Time", "Seconds from the photographs to the answer.",
        [](const ComparedMode& m) { return fmt::format("{:.1f} s", m.shot.resources.seconds); });
    row("Memory", "The most this run had used by then.",
        [](const ComparedMode& m) { return fmt::format("{:.0f} MiB", m.shot.resources.peakMib); });
    row("KKT residual", "How exactly the lighting equations were solved; 1e-6 and less is exact for all purposes.",
        [&](const ComparedMode& m) { return fmt::format("{:.1e}", estimate(m).stability.kktResidual); });
    row("Condition number",
        "How much the lighting equations magnify errors, and how many of the unknowns the photographs pin down.",
        [&](const ComparedMode& m) {
            const StabilityReport& s = estimate(m).stability;
            return fmt::format("{:.1e}, {} of {}", s.conditionNumber, s.effectiveRank, s.unknowns);
        });
    row("Brightness scale", "What decides between a bright light on dark surfaces and a dim light on bright ones.",
        [&](const ComparedMode& m) { return estimate(m).gauge.kind; });
    return "<div class=\"wide\"><table><tr><th></th><th>Lights in the scene</th><th>Distant light only</th></tr>\n" +
           rows + "</table></div>\n";
}

std::string viewSection(const ComparedView& view) {
    const char* names[] = {"lights in the scene", "distant light only"};
    std::string figures = htmlImage(view.photograph, "Photograph", "");
    for (size_t m = 0; m < 2; ++m) {
        if (m == 1) figures += "<div></div>\n";
        figures += htmlImage(view.model[m], fmt::format("Model, {}", names[m]), fmt::format("{:.1f} dB", view.psnr[m]));
        figures += htmlImage(view.difference[m], "Difference", "");
        figures += htmlImage(view.albedo[m], "Surfaces without light", "");
    }
    const std::string title = view.name + (view.state.empty() ? "" : ", " + view.state);
    return "<h3>" + htmlText(title) + "</h3>\n" + grid("four", figures);
}

std::string leftOutTable(const Modes& modes) {
    std::string rows;
    for (const ComparedMode& mode : modes)
        for (const LeftOut& l : mode.shot.estimate.leftOut)
            rows += fmt::format("<tr><td>{}</td><td>{}</td><td>{}</td></tr>\n", htmlText(mode.name),
                                htmlText(nameOf(l.what)), htmlText(l.why));
    for (const ComparedMode& mode : modes) {
        const Estimate& e = mode.shot.estimate;
        if (!e.stability.reason.empty())
            rows += fmt::format("<tr><td>{}</td><td>full convergence</td><td>{}</td></tr>\n", htmlText(mode.name),
                                htmlText(e.stability.reason));
        if (e.cancelled)
            rows += fmt::format(
                "<tr><td>{}</td><td>the rest of the solve</td><td>stopped early: the best answer until "
                "then</td></tr>\n",
                htmlText(mode.name));
    }
    if (rows.empty()) return "";
    return "<div class=\"wide\"><table><tr><th>Mode</th><th>Left out</th><th>Why</th></tr>\n" + rows +
           "</table></div>\n";
}

std::string plotOf(const Modes& modes) {
    std::vector<PlotCurve> curves;
    for (size_t m = 0; m < 2; ++m) {
        PlotCurve curve{
            m == 0 ? "lights in the scene" : "distant light only", m == 0 ? "#e8a24a" : "#6fa8dc", m == 1, {}};
        for (const TimelineEntry& t : modes[m].shot.estimate.timeline)
            curve.points.push_back(
                {t.seconds, t.rmse,
                 fmt::format("{}, step {}: {:.2f} s, error {:.3g}", t.stage, t.iteration, t.seconds, t.rmse)});
        curves.push_back(std::move(curve));
    }
    return logPlotSvg(curves, "seconds since the photographs were opened",
                      "relative difference of points with equal colour");
}

}  // namespace

std::string comparisonPage(const Comparison& c) {
    const Modes& modes = c.modes;
    const auto pair = [&](auto&& image, const char* near, const char* distant) {
        return htmlImage(image(modes[0]), near, "") + htmlImage(image(modes[1]), distant, "");
    };
    const char *near = "Lights in the scene", *distant = "Distant light only";
    std::string content = "<h1>" + htmlText(c.capture) + ": two ways to explain the light</h1>\n";
    content += fmt::format(
        "<p>{} photographs, a mesh of {} vertices and {} triangles. The same photographs were explained twice: once "
        "with lights that stand in the "
        "scene and light it from near (near-field), once as if all light came from far away (distant-only). What a "
        "light does and the second way "
        "cannot say ends up painted on the surfaces.</p>\n",
        c.views, c.vertices, c.triangles);
    if (!c.states.empty())
        content += fmt::format(
            "<p>The photographs are of {} lighting states. With lights in the scene, these are brighter or dimmer from "
            "state to state. With distant light only, each state has a distant light of its own, whose power differs "
            "as the photographs say. Lights off, white sky and environment below are those of <i>{}</i>.</p>\n",
            c.states.size(), htmlText(c.stateShown));
    content += heading("Figures", fmt::format("Measured over {} of {} photographs.", c.measuredViews, c.views)) +
               figuresTable(c);
    for (const ComparedMode& m : modes)
        if (!m.shot.estimate.gauge.evidence.empty())
            content += fmt::format("<p>Brightness scale, {}: {}</p>\n", htmlText(m.name),
                                   htmlText(m.shot.estimate.gauge.evidence));

    content += heading("Correction colours",
                       "The tint of the surfaces with their brightness taken away. Neutral grey needs no correction; a "
                       "stain that follows the light is light that was taken for paint.");
    std::string tints;
    for (size_t m = 0; m < 2; ++m)
        for (const ComparedView& view : c.shown) tints += htmlImage(view.tint[m], m == 0 ? near : distant, view.name);
    content += grid(c.shown.size() == 3 ? "three" : c.shown.size() == 1 ? "one" : "two", tints);

    content +=
        heading("View by view",
                "The photograph, what each model makes of it, and where they content: grey is equal, brighter means "
                "the model is too bright there, darker too dark. "
                "Surfaces without light show each surface's own colour, on an absolute scale.");
    for (const ComparedView& view : c.shown) content += viewSection(view);

    content += heading("Lights off", fmt::format("What the distant light alone does. Exposed {} against the first "
                                                 "photograph, both alike. Distant-only has no light to switch off, "
                                                 "so all light stays.",
                                                 stops(c.offStops)));
    content += grid("two", pair([](const ComparedMode& m) -> const Image& { return m.emittersOff; }, near, distant));
    content += heading(
        "Under a white sky",
        "Lights off, the same light from everywhere. Shadows of the old light that still show were taken for paint.");
    content += grid("two", pair([](const ComparedMode& m) -> const Image& { return m.white; }, near, distant));
    content += heading("Environment", fmt::format("The recovered distant light in all directions, straight up at the "
                                                  "top. Exposed {} against the first photograph, both alike. "
                                                  "A bright spot that is not in the room is a light in disguise.",
                                                  stops(c.environmentStops)));
    content += grid("two", pair([](const ComparedMode& m) -> const Image& { return m.environment; }, near, distant));

    content += heading("Lights", "What shines in the scene, and why it is believed to.") +
               emittersTable(modes[0].shot.estimate) +
               rejectedTable(modes[0].shot.estimate, modes[0].shot.capture.origin);
    content += heading("Error against run time",
                       "How fast each way closes in on the photographs, from the first guess on. Both axes are "
                       "logarithmic; rest on a point for its stage.") +
               plotOf(modes);
    content +=
        heading("Left out", "What this scene did not need, and what this version does not do.") + leftOutTable(modes);
    return htmlPage("relamp: " + c.capture, content);
}

}  // namespace relamp
