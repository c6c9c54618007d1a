#include "radiance/edge_views.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "capture/view_pixels.h"
#include "radiance/background_cells.h"

namespace relamp {
namespace {

constexpr float fullContrast = 1;          ///< log ratio
constexpr float leastAcross = 0.2f;        ///< the same, of an edge
constexpr double leastPixelsAcross = 0.7;  ///< between what is compared
constexpr double leastSlant = 0.15;        ///< cosine: grazing views tell nothing
constexpr int halfPixels = 3;              ///< on either side of an edge
constexpr double mostPixel = 3;            ///< spacings: views that show edges more coarsely tell nothing
constexpr double strayPixels = 0.5;        ///< beyond which what a view shows is something else
constexpr double withinEdge = 4;           ///< spacings from an edge: what must be seen

}  // namespace

bool EdgeViews::hidden(const DVec3& eye, const DVec3& p, double slack) const {
    const double distance = glm::length(p - eye);
    return bool(scene_.cameraTracer->closest(
        {Vec3(eye), Vec3((p - eye) / distance), 0, float(std::max(0.0, distance - slack))}));
}

std::optional<Rgb> EdgeViews::shownAt(const View& view, const DVec3& p) const {
    const std::optional<Vec2> at = view.camera.project(p);
    return at ? radianceAt(view, *at, true) : std::nullopt;
}

std::optional<float> EdgeViews::contrast(const View& view, const DVec3& p, const DVec3& q) const {
    const std::optional<Vec2> a = view.camera.project(p), b = view.camera.project(q);
    if (!a || !b || double(glm::length(*a - *b)) < leastPixelsAcross) return {};
    const std::optional<Rgb> first = shownAt(view, p), second = shownAt(view, q);
    if (!first || !second) return {};
    return std::min(fullContrast, logDistance(*first, *second, *second, floor_));
}

/// The middle of the steepest pixels across an edge, near `p` on it and along `across`; none where the view, which
/// must see a surface that faces `facing`, does not show it.
std::optional<EdgeCrossing> EdgeViews::crossing(const View& view, double spacing, const DVec3& p, const DVec3& across,
                                                const DVec3& facing) const {
    const DVec3 eye = view.camera.position(), inside = p - withinEdge * spacing * across;
    if (glm::dot(glm::normalize(eye - p), facing) < leastSlant) return {};
    const std::optional<Vec2> here = view.camera.project(p), there = view.camera.project(p + spacing * across);
    if (!here || !there) return {};
    const double pixel = spacing / double(glm::length(*there - *here));
    if (!(pixel < mostPixel * spacing) || hidden(eye, inside, withinEdge * spacing)) return {};
    constexpr int middle = 4 * halfPixels;
    std::array<float, 2 * middle + 1> contrast{};
    for (int i = 0; i <= 2 * middle; ++i) {
        const DVec3 q = p + 0.25 * (i - middle) * pixel * across;
        const std::optional<float> c = this->contrast(view, q - 0.5 * pixel * across, q + 0.5 * pixel * across);
        if (!c) return {};
        contrast[size_t(i)] = *c;
    }
    const int steepest = int(std::max_element(contrast.begin(), contrast.end()) - contrast.begin());
    const float most = contrast[size_t(steepest)];
    if (most < leastAcross || steepest < 4 || steepest > 2 * middle - 4) return {};
    double sum = 0, place = 0;
    for (int i = steepest - 4; i <= steepest + 4; ++i) {
        const double w = std::max(0.0f, contrast[size_t(i)] - most / 2);
        sum += w;
        place += w * 0.25 * (i - middle);
    }
    return EdgeCrossing{0, place / sum * pixel, pixel, double(most)};
}

std::vector<EdgeCrossing> EdgeViews::crossings(const DVec3& from, const DVec3& to, double spacing, const DVec3& across,
                                               const DVec3& facing) const {
    const size_t points = std::max<size_t>(2, size_t(2 * glm::length(to - from) / spacing));
    std::vector<std::vector<EdgeCrossing>> byPoint(points);
    parallelFor(points, 1, [&](size_t k) {
        const double at = (double(k) + 0.5) / double(points);
        for (const View& view : capture_.views)
            if (std::optional<EdgeCrossing> c = crossing(view, spacing, from + at * (to - from), across, facing)) {
                c->at = at;
                byPoint[k].push_back(*c);
            }
    });
    std::vector<EdgeCrossing> all;
    for (const auto& found : byPoint) all.insert(all.end(), found.begin(), found.end());
    return all;
}

glm::dvec2 lineThrough(const std::vector<EdgeCrossing>& crossings, bool sloped) {
    glm::dvec2 line(0);
    for (int round = 0; round < 6; ++round) {
        glm::dmat2 a(0);
        glm::dvec2 b(0);
        for (const EdgeCrossing& c : crossings) {
            const glm::dvec2 powers(1, sloped ? c.at : 0);
            const double off = (c.off - glm::dot(line, powers)) / (round ? strayPixels * c.pixel : 1e30),
                         w = c.weight / (c.pixel * c.pixel) / (1 + off * off);
            a += w * glm::outerProduct(powers, powers);
            b += w * c.off * powers;
        }
        if (!sloped) a[1][1] = 1;
        line = glm::inverse(a) * b;
        if (!isFinite(Vec3(line.x, line.y, 0))) return glm::dvec2(0);
    }
    return line;
}

}  // namespace relamp
