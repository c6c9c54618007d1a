#include "pipeline/marked_reference.h"

#include "image/image_io.h"
#include "pipeline/pipeline.h"
#include "solve/chart.h"

namespace relamp {
namespace {

std::string pixels(const MarkedReference& mark) {
    std::string text;
    for (const Vec2& p : mark.points) text += fmt::format("{}{:g},{:g}", text.empty() ? "" : ",", p.x, p.y);
    return text;
}

std::string ballName(const MarkedReference& mark) {
    return mark.photograph.empty() ? fmt::format("in view {}", mark.view) : mark.photograph.filename().string();
}

MirrorBall mirrorBallOf(const MarkedReference& mark) {
    MirrorBall ball;
    ball.view = mark.view;
    if (!mark.points.empty()) ball.hint = BallHint{mark.points[0], mark.radius};
    ball.name = ballName(mark);
    if (mark.photograph.empty()) return ball;
    ImageReport report;
    ball.photograph = readImage(mark.photograph, &report);
    ball.clip = report.clipLevel;
    return ball;
}

KnownPatch greyOf(const MarkedReference& mark) {
    KnownPatch patch;
    patch.name = nameOf(mark);
    patch.view = mark.view;
    patch.centre = mark.points.at(0);
    patch.radius = mark.radius;
    patch.albedo = mark.albedo;
    return patch;
}

}  // namespace

std::string toText(const MarkedReference& mark) {
    using Kind = MarkedReference::Kind;
    std::string text = fmt::format("{}", mark.view);
    if (!mark.points.empty()) text += ":" + pixels(mark);
    if (!mark.points.empty() && mark.kind != Kind::chart) text += fmt::format(",{:g}", mark.radius);
    if (mark.kind == Kind::mirrorBall && !mark.photograph.empty()) text = mark.photograph.string() + "@" + text;
    if (mark.kind == Kind::grey && mark.albedo != KnownPatch().albedo) {
        const Rgb& a = mark.albedo;
        text += a.x == a.y && a.y == a.z ? fmt::format("={:g}", a.x) : fmt::format("={:g},{:g},{:g}", a.x, a.y, a.z);
    }
    return text;
}

std::string nameOf(const MarkedReference& mark) {
    switch (mark.kind) {
        case MarkedReference::Kind::mirrorBall: return "mirror ball " + ballName(mark);
        case MarkedReference::Kind::grey: return "grey patch " + toText(mark);
        case MarkedReference::Kind::chart: return fmt::format("chart in view {}, patch", mark.view);
    }
    return {};
}

void takeReference(const MarkedReference& mark, PipelineOptions& options) {
    using Kind = MarkedReference::Kind;
    if (mark.kind == Kind::mirrorBall) options.mirrorBalls.push_back(mirrorBallOf(mark));
    if (mark.kind == Kind::grey) options.solve.patches.push_back(greyOf(mark));
    if (mark.kind != Kind::chart) return;
    const std::vector<Vec2>& p = mark.points;
    for (KnownPatch& patch : chartPatches(mark.view, {p.at(0), p.at(1), p.at(2), p.at(3)}))
        options.solve.patches.push_back(std::move(patch));
}

}  // namespace relamp
