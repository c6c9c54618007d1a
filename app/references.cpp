// Light references on the command line: light probes, mirror balls, grey cards, charts.
#include "commands.h"
#include "pipeline/marked_reference.h"

namespace relamp::cli {
namespace {

size_t viewNumber(const std::string& text, const char* option) {
    const double view = numbersOf(text, option, 1)[0];
    if (!(view >= 0 && view < 1e6) || view != std::floor(view))
        throw UsageError(std::string(option) + ": expected a view's number, counted from 0");
    return size_t(view);
}

/// "VIEW:X,Y,...", `count` numbers of pixels, the first two of each point and then what is left.
MarkedReference markOf(MarkedReference::Kind kind, const std::string& text, const char* option, size_t count) {
    const size_t colon = text.find(':');
    if (colon == std::string::npos)
        throw UsageError(std::string(option) + ": expected a view's number, a colon and pixels");
    MarkedReference mark;
    mark.kind = kind;
    mark.view = viewNumber(text.substr(0, colon), option);
    const std::vector<double> v = numbersOf(text.substr(colon + 1), option, count);
    for (size_t k = 0; k + 1 < v.size(); k += 2) mark.points.emplace_back(v[k], v[k + 1]);
    if (count % 2) mark.radius = float(v.back());
    return mark;
}

MarkedReference greyOf(const std::string& text) {
    const size_t equals = text.find('=');
    MarkedReference mark = markOf(MarkedReference::Kind::grey, text.substr(0, equals), "--grey", 3);
    if (!(mark.radius >= 0)) throw UsageError("--grey: expected a radius of 0 pixels or more");
    if (equals == std::string::npos) return mark;
    const std::string albedo = text.substr(equals + 1);
    const bool coloured = albedo.find(',') != std::string::npos;
    const std::vector<double> a = numbersOf(albedo, "--grey", coloured ? 3 : 1);
    mark.albedo = coloured ? Rgb(a[0], a[1], a[2]) : Rgb(float(a[0]));
    if (!(std::min({mark.albedo.x, mark.albedo.y, mark.albedo.z}) >= 0.005f && maxChannel(mark.albedo) <= 1))
        throw UsageError("--grey: expected an albedo of 0.005 to 1");
    return mark;
}

MarkedReference mirrorBallOf(const std::string& text) {
    const size_t at = text.rfind('@'), begin = at == std::string::npos ? 0 : at + 1;
    if (at == 0) throw UsageError("--mirror-ball: expected [FILE@]VIEW[:X,Y,RADIUS], the view's number counted from 0");
    const std::string where = text.substr(begin);
    MarkedReference mark;
    if (where.find(':') == std::string::npos) mark.view = viewNumber(where, "--mirror-ball");
    else mark = markOf(MarkedReference::Kind::mirrorBall, where, "--mirror-ball", 3);
    mark.kind = MarkedReference::Kind::mirrorBall;
    if (!mark.points.empty() && !(mark.radius > 0))
        throw UsageError("--mirror-ball: expected a radius of more than 0 pixels");
    if (at != std::string::npos) mark.photograph = text.substr(0, at);
    return mark;
}

}  // namespace

void takeReferences(const SolveArguments& a, PipelineOptions& options) {
    for (const std::string& grey : a.grey) takeReference(greyOf(grey), options);
    for (const std::string& chart : a.charts) {
        const MarkedReference mark = markOf(MarkedReference::Kind::chart, chart, "--chart", 8);
        try {
            takeReference(mark, options);
        } catch (const Error& error) { throw UsageError(std::string("--chart: ") + error.what()); }
    }
    for (const fs::path& file : a.probes) options.probes.push_back(readLightProbe(file));
    for (const std::string& ball : a.mirrorBalls) takeReference(mirrorBallOf(ball), options);
}

std::vector<fs::path> referenceFiles(const SolveArguments& a) {
    std::vector<fs::path> files = a.probes;
    for (const std::string& ball : a.mirrorBalls)
        if (const size_t at = ball.rfind('@'); at != std::string::npos) files.push_back(ball.substr(0, at));
    return files;
}

}  // namespace relamp::cli
