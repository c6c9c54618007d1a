#include "report/stress.h"

#include <glm/gtc/quaternion.hpp>
#include <nlohmann/json.hpp>

#include <functional>
#include <optional>

#include "report/stress_solve.h"
#include "report/stress_variants.h"
#include "report/stress_world.h"

namespace relamp {
namespace {

constexpr double invarianceWanted = 1e-4, kktWanted = 1e-6;

/// Runs and books cases; nothing but Cancelled leaves a case.
class Runner {
public:
    Runner(const StressOptions& options, Progress& progress) : options_(options), progress_(progress) {}

    bool wanted(const std::string& name) const {
        return options_.only.empty() || name.find(options_.only) != std::string::npos;
    }

    /// One case; the estimate, when there is one.
    std::optional<Estimate> run(const std::string& name, const std::function<Estimate(Progress&)>& part) {
        StressCase c;
        c.name = name;
        const double start = progress_.seconds();
        std::optional<Estimate> estimate;
        try {
            Estimate found = part(progress_);
            c.finite = allFinite(found);
            c.kkt = found.stability.kktResidual;
            c.reason = !c.finite           ? "an answer holds numbers that are not finite"
                       : c.kkt > kktWanted ? found.stability.reason
                                           : "";
            c.figures = {{"emitters", double(found.emitters.emitters.size())},
                         {"unknowns", double(found.stability.unknowns)},
                         {"condition", found.stability.conditionNumber}};
            estimate = std::move(found);
        } catch (const Error& error) {
            c.finite = c.refused = true;
            c.reason = error.what();
        } catch (const std::exception& error) { c.reason = std::string("a fault in relamp: ") + error.what(); }
        c.figures.emplace_back("seconds", progress_.seconds() - start);
        report_.cases.push_back(std::move(c));
        return estimate;
    }

    /// A variant whose answer should be that of `base`. `because`: what is known to keep the two apart.
    void hold(const std::string& name, const std::optional<Estimate>& base, const VariantOf& how,
              const std::function<Estimate(Progress&)>& part, const std::string& because = "") {
        if (!wanted(name)) return;
        const std::optional<Estimate> found = run(name, part);
        if (!found || !base || !report_.cases.back().finite) return;
        StressCase& c = report_.cases.back();
        const AnswerDifference d = differenceOf(*base, *found, how);
        c.figures.emplace_back("difference", d.worst());
        c.figures.emplace_back("of_emitters", d.emitters);
        c.figures.emplace_back("of_distant", d.irradiance);
        c.figures.emplace_back("of_albedo", d.albedo);
        if (d.worst() > invarianceWanted && c.reason.empty())
            c.reason = fmt::format("the answer differs by {:.1e}{}", d.worst(), because.empty() ? "" : ": " + because);
    }
    void solve(const std::string& name, const std::function<Estimate(Progress&)>& part) {
        if (wanted(name)) run(name, part);
    }
    StressReport take() {
        report_.seconds = progress_.seconds() - start_;
        return std::move(report_);
    }

private:
    const StressOptions& options_;
    Progress& progress_;
    const double start_ = progress_.seconds();
    StressReport report_;
};

const char* const rounding =
    "positions are rounded otherwise and single rays and decisions flip; see lengths x 2^10, where nothing is rounded";

/// What can be done to any capture.
void variantsOf(const std::string& of, const Capture& capture, const SolveOptions& options, Runner& runner) {
    const auto named = [&](const char* what) { return of + ": " + what; };
    const auto solved = [&options](Capture variant) {
        return [variant = std::move(variant), &options](Progress& progress) {
            return solveForStress(variant, nullptr, false, options, progress);
        };
    };
    // The answer every invariance is held against is needed as soon as one of them is asked for.
    std::optional<Estimate> base;
    bool needed = false;
    for (const char* what : {"as it is", "images x 1e-6", "images x 1e6", "images x 2^-20", "in millimetres",
                             "in kilometres", "lengths x 2^10", "far from the origin", "turned by 90 degrees",
                             "turned by 33 degrees", "turned about a slanting axis", "vertices in another order",
                             "views in another order", "emitters in another order"})
        needed |= runner.wanted(named(what));
    if (needed) base = runner.run(named("as it is"), solved(capture));
    const auto scaled = [&](const char* what, float factor) {
        VariantOf how;
        how.radiance = Rgb(factor);
        runner.hold(named(what), base, how, solved(withRadianceTimes(capture, Rgb(factor))));
    };
    scaled("images x 1e-6", 1e-6f);
    scaled("images x 1e6", 1e6f);
    scaled("images x 2^-20", 0x1p-20f);
    const auto moved = [&](const char* what, double scale, const glm::dmat3& turn, const DVec3& offset,
                           const char* because) {
        VariantOf how;
        how.scale = scale;
        how.turn = turn;
        if (!runner.wanted(named(what))) return;
        Capture variant = movedBy(capture, scale, turn, offset);
        how.offset = offset - variant.origin;
        runner.hold(named(what), base, how, solved(std::move(variant)), because);
    };
    const glm::dmat3 unturned(1.0);
    moved("in millimetres", 1000, unturned, DVec3(0), rounding);
    moved("lengths x 2^10", 1024, unturned, DVec3(0), "");
    moved("in kilometres", 1e-3, unturned, DVec3(0), rounding);
    moved("far from the origin", 1, unturned, 100.0 * extentOf(capture) * DVec3(1, -0.7, 0.2), rounding);
    moved("turned by 90 degrees", 1, glm::dmat3(DVec3(0, 1, 0), DVec3(-1, 0, 0), DVec3(0, 0, 1)), DVec3(0), rounding);
    moved("turned by 33 degrees", 1,
          glm::dmat3(DVec3(0.8386705679, 0.5446390350, 0), DVec3(-0.5446390350, 0.8386705679, 0), DVec3(0, 0, 1)),
          DVec3(0), rounding);
    moved("turned about a slanting axis", 1,
          glm::dmat3(glm::mat3_cast(glm::angleAxis(0.9, glm::normalize(DVec3(1, 2, -1))))), DVec3(0), rounding);
    VariantOf shuffled;
    const Capture renumbered = withVerticesShuffled(capture, 7, shuffled.newIndex);
    runner.hold(named("vertices in another order"), base, shuffled, solved(renumbered));
    runner.hold(named("views in another order"), base, {}, solved(withViewsReversed(capture)));
    runner.hold(named("emitters in another order"), base, {},
                [&](Progress& progress) { return solveForStress(capture, nullptr, true, options, progress); });

    runner.solve(named("one view"), solved(withViews(capture, 1)));
    runner.solve(named("two clipped views"), solved(withClipping(withViews(capture, 2), 70)));
    runner.solve(named("1 % wild outliers"), solved(withOutliers(capture, 0.01f, 1)));
    runner.solve(named("light of one channel"), solved(withRadianceTimes(capture, Rgb(1, 0, 0))));
    runner.solve(named("noise of 5 %"), solved(withNoise(capture, 0.05f, 1)));
    runner.solve(named("noise of 20 %"), solved(withNoise(capture, 0.2f, 1)));
    runner.solve(named("exposures 10 % apart"), solved(withExposures(capture, 0.1f, 1)));
}

StressEmitter emitterAt(const Vec3& centre, float side, const Rgb& radiance) { return {centre, side, radiance}; }

/// What needs another scene. `given`: the emitters are told, because photographs of such emitters do not show them.
void worlds(Runner& runner) {
    const auto add = [&](const std::string& what, const StressScene& world, bool given = false) {
        runner.solve("world: " + what, [world, given](Progress& progress) {
            const PaintedWorld painted = paintStressScene(world, progress);
            return solveForStress(painted.capture, given ? &painted.emitters : nullptr, false, solveOptionsFor("draft"),
                                  progress);
        });
    };
    const Vec3 left(-0.45f, 0.3f, 1.1f), right(0.45f, 0.25f, 1.15f);
    for (const float ratio : {1.0f, 1e2f, 1e4f, 1e6f}) {
        StressScene w;
        w.emitters = {emitterAt(left, 0.25f, Rgb(40)), emitterAt(right, 0.25f, Rgb(40) / ratio)};
        add(fmt::format("two lights of power 1 : {:.0e}", ratio), w);
        add(fmt::format("two lights of power 1 : {:.0e}, both told", ratio), w, true);
    }
    const auto with = [&](const char* what, const std::function<void(StressScene&)>& change, bool given = false) {
        StressScene w;
        change(w);
        add(what, w, given);
    };
    const float small = 2e-3f;
    with("emitter of 1e-3 of the scene", [&](StressScene& w) { w.emitters = {emitterAt(right, small, Rgb(1e6f))}; });
    with(
        "emitter of 1e-3 of the scene, told",
        [&](StressScene& w) { w.emitters = {emitterAt(right, small, Rgb(1e6f))}; }, true);
    with(
        "emitter touching a surface",
        [](StressScene& w) {
            w.emitters = {emitterAt({0, 0.5f, 0}, 0.2f, Rgb(30))};
        },
        true);
    with("emitter inside a shade seen only by its light", [](StressScene& w) {
        w.shade = true;
        w.views = 5;
    });
    with(
        "emitter inside a shade, told", [](StressScene& w) { w.shade = true; }, true);
    with("emitter five times as bright on one side",
         [&](StressScene& w) { w.emitters = {emitterAt(right, 0.4f, Rgb(30))}, w.emitters[0].uneven = 5; });
    with(
        "duplicated emitters",
        [&](StressScene& w) {
            w.emitters = {emitterAt(right, 0.3f, Rgb(30)), emitterAt(right, 0.3f, Rgb(30))};
        },
        true);
    with(
        "coplanar emitters that touch",
        [&](StressScene& w) {
            w.emitters = {emitterAt(right, 0.3f, Rgb(30)), emitterAt(right - Vec3(0.3f, 0, 0), 0.3f, Rgb(20))};
        },
        true);
    with(
        "fully hidden emitter", [](StressScene& w) { w.shade = w.closed = true; }, true);
    with("no emitter", [](StressScene& w) { w.emitters.clear(); });
    with("environment of zero", [](StressScene& w) { w.sky = [](const Vec3&) { return Rgb(0); }; });
    with("environment constant", [](StressScene& w) { w.sky = [](const Vec3&) { return Rgb(0.5f); }; });
    with("environment constant, no emitter", [](StressScene& w) {
        w.sky = [](const Vec3&) { return Rgb(0.5f); };
        w.emitters.clear();
    });
    with("environment with a sun of 1e5", [](StressScene& w) {
        w.sky = [](const Vec3& d) {
            return Rgb(0.4f) + (glm::dot(d, glm::normalize(Vec3(0.5f, 0.3f, 0.8f))) > 0.9996f ? Rgb(1e5f) : Rgb(0));
        };
    });
    with("no light at all", [](StressScene& w) {
        w.sky = [](const Vec3&) { return Rgb(0); };
        w.emitters.clear();
    });
    with("albedo 0", [](StressScene& w) { w.albedo = Rgb(0); });
    with("albedo 1", [](StressScene& w) { w.albedo = Rgb(1); });
    with("near-mirror", [](StressScene& w) { w.specularAlpha = 0.01f; });
    with("needle triangles", [](StressScene& w) { w.needles = true; });
    runner.solve("world: 3 vertices", [](Progress& progress) {
        return solveForStress(oneTriangle(), nullptr, false, solveOptionsFor("draft"), progress);
    });
}

}  // namespace

double StressReport::finiteFraction() const {
    size_t finite = 0;
    for (const StressCase& c : cases) finite += c.finite;
    return cases.empty() ? 1 : double(finite) / double(cases.size());
}

StressReport runStress(const Capture* capture, const StressOptions& options, Progress& progress) {
    Runner runner(options, progress);
    const SolveOptions draft = solveOptionsFor("draft");
    if (capture) {
        // Everything a draft does, but each thing once: the cases are many.
        SolveOptions brief = draft;
        brief.glossRounds = 0;
        brief.refineRounds = 1;
        brief.startIterations = 6;
        brief.bounce = SolveOptions::Bounce::off;
        variantsOf("capture", withSmallImages(*capture, options.longestSide), brief, runner);
    }
    if (options.worlds) {
        variantsOf("world", paintStressScene({}, progress).capture, draft, runner);
        worlds(runner);
    }
    return runner.take();
}

nlohmann::json stressJson(const StressReport& report) {
    nlohmann::json cases = nlohmann::json::array();
    for (const StressCase& c : report.cases) {
        nlohmann::json figures = nlohmann::json::object();
        for (const auto& [name, value] : c.figures) figures[name] = value;
        cases.push_back({{"name", c.name},
                         {"finite", c.finite},
                         {"refused", c.refused},
                         {"kkt", c.kkt},
                         {"reason", c.reason},
                         {"figures", figures}});
    }
    const double finite = report.finiteFraction();
    return {{"cases", cases}, {"finite_fraction", finite}, {"finite_share", finite}, {"seconds", report.seconds}};
}

std::string stressText(const StressReport& report) {
    std::string text =
        fmt::format("{:58} {:>7} {:>8} {:>10} {:>7}  {}\n", "case", "finite", "KKT", "difference", "s", "reason");
    for (const StressCase& c : report.cases) {
        const auto figure = [&](const char* name, const char* format) {
            for (const auto& [key, value] : c.figures)
                if (key == name) return fmt::format(fmt::runtime(format), value);
            return std::string("-");
        };
        text += fmt::format("{:58} {:>7} {:>8} {:>10} {:>7}  {}\n", c.name,
                            c.refused  ? "refused"
                            : c.finite ? "yes"
                                       : "NO",
                            c.refused ? "-" : fmt::format("{:.0e}", c.kkt), figure("difference", "{:.1e}"),
                            figure("seconds", "{:.2f}"), c.reason);
    }
    size_t holding = 0;
    for (const StressCase& c : report.cases) holding += c.holds();
    return text + fmt::format("{:.0f} % finite; {} of {} cases are solved to 1e-6 or say why not; {:.1f} s\n",
                              100 * report.finiteFraction(), holding, report.cases.size(), report.seconds);
}

}  // namespace relamp
