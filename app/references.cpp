// Light references on the command line: light probes, mirror balls, grey cards, charts.
#include "commands.h"
#include "solve/chart.h"

namespace relamp::cli {
namespace {

/// "VIEW:rest".
size_t viewBefore(const std::string& text, const std::string& option, std::string& rest) {
    const size_t colon = text.find(':');
    if (colon == std::string::npos) throw UsageError(option + ": expected a view's number, a colon and pixels");
    const double view = numbersOf(text.substr(0, colon), option, 1)[0];
    if (!(view >= 0 && view < 1e6) || view != std::floor(view))
        throw UsageError(option + ": expected a view's number, counted from 0");
    rest = text.substr(colon + 1);
    return size_t(view);
}

}  // namespace

MirrorBall mirrorBallOf(const std::string& text) {
    MirrorBall ball;
    const size_t at = text.rfind('@'), begin = at == std::string::npos ? 0 : at + 1, colon = text.find(':', begin);
    const fs::path file = text.substr(0, at == std::string::npos ? 0 : at);
    const std::string view = text.substr(begin, colon == std::string::npos ? colon : colon - begin);
    const double number = numbersOf(view, "--mirror-ball", 1)[0];
    if (!(number >= 0 && number < 1e6) || number != std::floor(number) || at == 0)
        throw UsageError("--mirror-ball: expected [FILE@]VIEW[:X,Y,RADIUS], the view's number counted from 0");
    ball.view = size_t(number);
    if (colon != std::string::npos) {
        const std::vector<double> v = numbersOf(text.substr(colon + 1), "--mirror-ball", 3);
        if (!(v[2] > 0)) throw UsageError("--mirror-ball: expected a radius of more than 0 pixels");
        ball.hint = BallHint{Vec2(v[0], v[1]), float(v[2])};
    }
    ball.name = file.empty() ? "in view " + view : file.filename().string();
    if (file.empty()) return ball;
    ImageReport report;
    ball.photograph = readImage(file, &report);
    ball.clip = report.clipLevel;
    return ball;
}

void addGreyPatch(const std::string& text, std::vector<KnownPatch>& patches) {
    std::string rest;
    KnownPatch patch;
    patch.view = viewBefore(text, "--grey", rest);
    const size_t equals = rest.find('=');
    const std::vector<double> v = numbersOf(rest.substr(0, equals), "--grey", 3);
    if (!(v[2] >= 0)) throw UsageError("--grey: expected a radius of 0 pixels or more");
    patch.centre = {v[0], v[1]};
    patch.radius = float(v[2]);
    if (equals != std::string::npos) {
        const std::string albedo = rest.substr(equals + 1);
        const bool coloured = albedo.find(',') != std::string::npos;
        const std::vector<double> a = numbersOf(albedo, "--grey", coloured ? 3 : 1);
        patch.albedo = coloured ? Rgb(a[0], a[1], a[2]) : Rgb(float(a[0]));
        if (!(std::min({patch.albedo.x, patch.albedo.y, patch.albedo.z}) >= 0.005f && maxChannel(patch.albedo) <= 1))
            throw UsageError("--grey: expected an albedo of 0.005 to 1");
    }
    patch.name = "grey patch " + text;
    patches.push_back(patch);
}

void addChart(const std::string& text, std::vector<KnownPatch>& patches) {
    std::string rest;
    const size_t view = viewBefore(text, "--chart", rest);
    const std::vector<double> v = numbersOf(rest, "--chart", 8);
    try {
        const auto at = [&](size_t k) { return Vec2(v[2 * k], v[2 * k + 1]); };
        for (KnownPatch& patch : chartPatches(view, {at(0), at(1), at(2), at(3)})) patches.push_back(std::move(patch));
    } catch (const Error& error) { throw UsageError(std::string("--chart: ") + error.what()); }
}

void takeReferences(const SolveArguments& a, PipelineOptions& options) {
    for (const std::string& grey : a.grey) addGreyPatch(grey, options.solve.patches);
    for (const std::string& chart : a.charts) addChart(chart, options.solve.patches);
    for (const fs::path& file : a.probes) options.probes.push_back(readLightProbe(file));
    for (const std::string& ball : a.mirrorBalls) options.mirrorBalls.push_back(mirrorBallOf(ball));
}

std::vector<fs::path> referenceFiles(const SolveArguments& a) {
    std::vector<fs::path> files = a.probes;
    for (const std::string& ball : a.mirrorBalls)
        if (const size_t at = ball.rfind('@'); at != std::string::npos) files.push_back(ball.substr(0, at));
    return files;
}

}  // namespace relamp::cli
