#include "clusters/partial_lights.h"

#include <algorithm>

#include "base/log.h"
#include "clusters/emitter_pixels.h"

namespace relamp {
namespace {

constexpr size_t leastViews = 3, mostWhole = 2;
constexpr float almostCovered = 0.02f;    ///< overlap by which the body may be worse than the mesh
constexpr double mostRefuted = 1.0 / 30;  ///< of a body's surface
constexpr double inset = 0.94;            ///< what a pixel's error at an edge shows is no witness
constexpr double stepsOfHalf = 8;         ///< steps in which an end goes on
constexpr double mostTimes = 3;           ///< its own length by which an end may go on
constexpr double leastReach = 0.2;        ///< of its length: less is no open end
constexpr double thinnest = 1.0 / 8;      ///< of the longest axis: a strip's width has no open end

/// Points over the surface; of a box, whose longest axis is the first, on its two largest sides.
std::vector<DVec3> pointsOn(const EmitterBody& body) {
    constexpr int along = 24, across = 12;
    std::vector<DVec3> points;
    for (int i = 0; i < along; ++i)
        for (int j = 0; j < across; ++j) {
            const double s = inset * (2 * (i + 0.5) / along - 1);
            if (body.round) {
                const double angle = 2 * piD * j / across, r = inset * body.radiusAt(s * body.half.x);
                points.push_back({s * body.half.x, r * std::cos(angle), r * std::sin(angle)});
                continue;
            }
            for (const double face : {-1.0, 1.0}) {
                const double t = inset * (2 * (j + 0.5) / across - 1);
                points.push_back(DVec3(s, t, face) * body.half);
            }
        }
    for (DVec3& p : points) p = body.centre + body.axes * p;
    return points;
}

/// Axes along which a body may go on; a cone does not.
std::vector<int> longAxes(const EmitterBody& body) {
    if (body.taper != 0) return {};
    if (body.round) return {0};
    if (body.half.y < thinnest * body.half.x) return {0};
    return {0, 1};
}

/// A box's axes in the order of their lengths.
EmitterBody longestFirst(const EmitterBody& body) {
    if (body.round) return body;
    int order[3] = {0, 1, 2};
    std::sort(order, order + 3, [&](int i, int j) { return body.half[i] > body.half[j]; });
    EmitterBody sorted = body;
    for (int k = 0; k < 3; ++k) {
        sorted.axes[k] = body.axes[order[k]];
        sorted.half[k] = body.half[order[k]];
    }
    if (glm::determinant(sorted.axes) < 0) sorted.axes[2] = -sorted.axes[2];
    return sorted;
}

std::vector<OpenEnd> openEnds(const EmitterBody& body, const BodyWitness& witness) {
    std::vector<OpenEnd> ends;
    for (const int axis : longAxes(body))
        for (const double side : {-1.0, 1.0}) {
            const double length = 2 * body.half[axis], step = length / (2 * stepsOfHalf);
            double reach = 0;
            while (reach + step <= mostTimes * length &&
                   witness.allow(withEnds(body, {{axis, side, 0}}, {reach + step})))
                reach += step;
            if (reach > leastReach * length) ends.push_back({axis, side, reach});
        }
    return ends;
}

}  // namespace

EmitterBody withEnds(EmitterBody body, const std::vector<OpenEnd>& ends, const std::vector<double>& lengths) {
    for (size_t i = 0; i < ends.size(); ++i) {
        const int axis = ends[i].axis;
        body.half[axis] += 0.5 * lengths[i];
        body.centre += 0.5 * lengths[i] * ends[i].side * body.axes[axis];
    }
    return body;
}

BodyWitness::BodyWitness(const Scene& scene, const Capture& capture, const RadianceSamples& samples,
                         const EmitterCluster& light)
    : scene_(scene), capture_(capture), samples_(samples), light_(light) {
    for (const View& view : capture.views)
        shows_.push_back(emittingPixels(view, light.radiance, pixelTolerance(light)));
}

bool BodyWitness::allow(const EmitterBody& body) const {
    const std::vector<DVec3> points = pointsOn(body);
    const double slack = 0.005 * double(scene_.diagonal);
    for (size_t i = 0; i < capture_.views.size(); ++i) {
        const View& view = capture_.views[i];
        const ViewGeometry& g = samples_.geometry[i];
        if (light_.levelIn(samples_.stateOf(uint32_t(i))) <= 0) continue;  // it is off there
        size_t refuted = 0;
        for (const DVec3& p : points) {
            const auto at = view.camera.project(p);
            if (!at || at->x < 1 || at->y < 1 || at->x >= float(g.width - 1) || at->y >= float(g.height - 1)) continue;
            const size_t pixel = size_t(at->y) * size_t(g.width) + size_t(at->x);
            if (shows_[i][pixel] || !view.image.usableAt(int(at->x), int(at->y))) continue;
            const uint32_t t = g.triangle[pixel];
            const bool hidden = t != Hit::none &&
                                double(g.depth[pixel]) < glm::length(p - view.camera.position()) - slack &&
                                !std::binary_search(light_.triangles.begin(), light_.triangles.end(), t);
            refuted += !hidden;
        }
        if (double(refuted) > mostRefuted * double(points.size())) return false;
    }
    return true;
}

std::vector<PartialLight> partialLights(const Scene& scene, const Capture& capture, const RadianceSamples& samples,
                                        const EmitterClusters& clusters) {
    std::vector<PartialLight> found;
    for (const std::vector<EmitterCluster>* list : {&clusters.emitters, &clusters.candidates})
        for (const EmitterCluster& e : *list) {
            if (e.unobserved || e.fitted || e.triangles.empty()) continue;
            PartialLight partial;
            partial.outlines = emitterOutlines(scene, capture, samples, clusters, e, true);
            const auto whole = size_t(std::count_if(partial.outlines.begin(), partial.outlines.end(),
                                                    [](const EmitterOutline& o) { return !o.cut; }));
            partial.certain = list == &clusters.emitters;
            if (partial.outlines.size() < leastViews || (partial.certain && whole > mostWhole)) continue;
            const std::optional<EmitterBody> body = fitUnhidden(scene, capture, samples, e, partial.outlines);
            if (!body) continue;
            partial.covered = meshOverlap(samples, e, partial.outlines);
            logInfo(
                "{} covers {:.0f} % of what {} photographs show of a light of {:.0f} cm2, {} of them whole; the mesh "
                "covers {:.0f} %",
                wordsOf(*body), 100 * body->overlap, partial.outlines.size(), 1e4f * e.area, whole,
                100 * partial.covered);
            if (!explainsOutlines(*body, partial.outlines) || body->overlap < partial.covered - almostCovered) continue;
            partial.mesh = e;
            partial.body = longestFirst(*body);
            partial.ends = openEnds(partial.body, BodyWitness(scene, capture, samples, e));
            for (const OpenEnd& end : partial.ends) logInfo("it may go on by up to {:.0f} mm", 1000 * end.reach);
            if (partial.showsMore() || !partial.ends.empty()) found.push_back(std::move(partial));
        }
    return found;
}

}  // namespace relamp
