#include "radiance/shown_edge.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "base/parallel.h"

namespace relamp {
namespace {

constexpr double search = 4;   ///< spacings, to either side of a rim
constexpr int perSpacing = 4;  ///< places tried
constexpr int places = 2 * int(search) * perSpacing + 1;
constexpr double compared = 0.6;         ///< spacings on either side of an edge
constexpr float leastContrast = 0.2f;    ///< log ratio: mean over an edge
constexpr float standsOut = 2.4f;        ///< contrast of an edge over that of the places around
constexpr double leastElevation = 0.15;  ///< sine: grazing views tell nothing
constexpr size_t aroundPlace = 6;        ///< places along an edge that are judged with one
constexpr int aroundEdge = 6;            ///< places across an edge in which its middle is sought
constexpr double mostBend = 0.5;         ///< spacings: a piece of a round table's edge
constexpr float partOfMean = 0.3f;       ///< contrast of places that show the edge
constexpr double shortest = 15;          ///< spacings
constexpr double inLine = 2;             ///< spacings that one edge may be off the line of the other

double offsetOf(int place) { return double(place) / perSpacing - search; }

/// Contrast across the places tried, at a part of the way along the rim.
std::array<float, places> contrastsAt(const EdgeViews& views, const StraightRim& rim, double part) {
    std::array<float, places> sum{};
    std::array<int, places> seen{};
    const DVec3 p = rim.from + part * (rim.to - rim.from);
    for (const View& view : views.views()) {
        const DVec3 eye = view.camera.position(), inside = p - search * rim.spacing * rim.out();
        if (glm::dot(glm::normalize(eye - p), rim.up) < leastElevation) continue;
        if (views.hidden(eye, inside, search * rim.spacing)) continue;
        for (int place = 0; place < places; ++place) {
            const DVec3 q = p + offsetOf(place) * rim.spacing * rim.out(), step = compared * rim.spacing * rim.out();
            if (const std::optional<float> contrast = views.contrast(view, q - step, q + step)) {
                sum[size_t(place)] += *contrast;
                ++seen[size_t(place)];
            }
        }
    }
    for (size_t i = 0; i < sum.size(); ++i) sum[i] = seen[i] ? sum[i] / float(seen[i]) : 0;
    return sum;
}

/// Contrast per place along a rim and across it.
using Contrasts = std::vector<std::array<float, places>>;

Contrasts contrastsAlong(const EdgeViews& views, const StraightRim& rim) {
    Contrasts contrasts(std::max<size_t>(2, size_t(rim.length() / rim.spacing)));
    parallelFor(contrasts.size(), 1, [&](size_t k) {
        contrasts[k] = contrastsAt(views, rim, (double(k) + 0.5) / double(contrasts.size()));
    });
    return contrasts;
}

/// Where the edge runs through the highest contrasts, in spacings off the rim.
struct Run {
    double from = 0, to = 0;  ///< at the rim's ends
    double middle = 0;        ///< in the middle, off the straight line
};

/// The parabola through the middles of what shows an edge, because contrast is high over a pixel or two: those near
/// the line between places `first` and `last`, of the part from `begin` to `end`.
std::optional<Run> throughMiddles(const Contrasts& contrasts, int first, int last, size_t begin, size_t end) {
    const double count = double(contrasts.size());
    glm::dmat3 a(0);
    DVec3 b(0);
    for (size_t k = begin; k < end; ++k) {
        const double t = (double(k) + 0.5) / count;
        const int middle = int(std::lround(first + t * (last - first)));
        const int low = std::max(0, middle - aroundEdge), high = std::min(places - 1, middle + aroundEdge);
        const auto row = contrasts[k].begin();
        const float most = *std::max_element(row + low, row + high + 1);
        double sum = 0, place = 0;
        for (int i = low; i <= high; ++i) {
            const double w = std::max(0.0f, contrasts[k][size_t(i)] - most / 2);
            sum += w;
            place += w * offsetOf(i);
        }
        if (!(sum > 0)) continue;
        const DVec3 powers(1, t, t * t);
        a += double(most) * glm::outerProduct(powers, powers);
        b += double(most) * place / sum * powers;
    }
    const DVec3 c = glm::inverse(a) * b;
    if (!isFinite(Vec3(c))) return {};
    const double t0 = double(begin) / count, t1 = double(end) / count, height = -c.z * (t1 - t0) * (t1 - t0) / 4;
    // The straight line of least squares: a parabola's mean lies a third of its height above its chord.
    const double slope = c.y + c.z * (t0 + t1), at0 = c.x + c.y * t0 + c.z * t0 * t0 + 2.0 / 3 * height;
    return Run{at0 - slope * t0, at0 + slope * (1 - t0), height};
}

/// The part of the places along an edge from where it is first shown to where it is last.
std::pair<size_t, size_t> shownPart(size_t count, float mean, const std::function<float(size_t)>& contrast) {
    const auto shows = [&](size_t k) {
        float sum = 0;
        size_t judged = 0;
        for (size_t i = k - std::min(k, aroundPlace); i < std::min(count, k + aroundPlace + 1); ++i, ++judged)
            sum += contrast(i);
        return sum > partOfMean * mean * float(judged);
    };
    size_t first = 0, last = count;
    while (first < last && !shows(first)) ++first;
    while (last > first && !shows(last - 1)) --last;
    return {first, last};
}

/// The rim through the places where single views show it, to a fraction of a pixel.
void refine(const EdgeViews& views, StraightRim& rim) {
    const DVec3 out = rim.out();
    const glm::dvec2 line = lineThrough(views.crossings(rim.from, rim.to, rim.spacing, out, rim.up), true);
    if (std::max(std::abs(line.x), std::abs(line.x + line.y)) > rim.spacing) return;
    rim.from += line.x * out;
    rim.to += (line.x + line.y) * out;
}

/// Mean contrast across a rim as it lies.
float meanContrast(const EdgeViews& views, const StraightRim& rim) {
    float sum = 0;
    const Contrasts contrasts = contrastsAlong(views, rim);
    for (const auto& row : contrasts) sum += row[places / 2];
    return sum / float(contrasts.size());
}

/// One edge in place of two in one line, `b` beyond the end of `a`; none where photographs do not show it in the gap.
std::optional<StraightRim> joined(const EdgeViews& views, const StraightRim& a, const StraightRim& b) {
    const double gap = glm::dot(b.from - a.to, a.along());
    if (a.surface != b.surface || gap < 0 || gap > std::min(a.length(), b.length())) return {};
    const StraightRim &longer = a.length() < b.length() ? b : a, &shorter = a.length() < b.length() ? a : b;
    for (const DVec3& end : {shorter.from, shorter.to})
        if (std::abs(longer.beyond(end)) > inLine * a.spacing) return {};
    StraightRim whole = a, between = a;
    whole.to = b.to;
    whole.creased |= b.creased;
    if (!(glm::dot(whole.along(), b.along()) > 0)) return {};
    between.from = a.to;
    between.to = b.from;
    if (gap > a.spacing && meanContrast(views, between) < partOfMean * meanContrast(views, whole)) return {};
    return shownEdge(views, whole);
}

}  // namespace

std::optional<StraightRim> shownEdge(const EdgeViews& views, StraightRim rim) {
    for (int round = 0; round < 2; ++round) {
        const Contrasts contrasts = contrastsAlong(views, rim);
        const double count = double(contrasts.size());
        const auto across = [&](size_t k, int first, int last) {
            const double at = first + (double(k) + 0.5) / count * (last - first);
            return contrasts[k][size_t(std::lround(at))];
        };
        float best = -1, mean = 0;
        int bestFirst = 0, bestLast = 0;
        for (int first = 0; first < places; ++first)
            for (int last = std::max(0, first - places / 2); last <= std::min(places - 1, first + places / 2); ++last) {
                float sum = 0;
                for (size_t k = 0; k < contrasts.size(); ++k) sum += across(k, first, last);
                if (sum <= best) continue;
                best = sum;
                bestFirst = first;
                bestLast = last;
            }
        for (const auto& row : contrasts)
            for (const float c : row) mean += c / float(places);
        if (best < leastContrast * float(count) || best < standsOut * mean) return {};
        const auto [first, last] =
            shownPart(contrasts.size(), best / float(count), [&](size_t k) { return across(k, bestFirst, bestLast); });
        const std::optional<Run> run = throughMiddles(contrasts, bestFirst, bestLast, first, last);
        if (!run || std::abs(run->middle) > mostBend) return {};
        const DVec3 out = rim.spacing * rim.out(), from = rim.from + run->from * out, to = rim.to + run->to * out;
        rim.from = from + double(first) / count * (to - from);
        rim.to = from + double(last) / count * (to - from);
        if (rim.length() < shortest * rim.spacing) return {};
    }
    refine(views, rim);
    return rim;
}

std::vector<StraightRim> shownEdges(const EdgeViews& views, const std::vector<StraightRim>& rims) {
    std::vector<StraightRim> edges;
    for (const StraightRim& rim : rims)
        if (const std::optional<StraightRim> edge = shownEdge(views, rim)) edges.push_back(*edge);
    for (size_t i = 0; i < edges.size(); ++i)
        for (size_t k = 0; k < edges.size(); ++k) {
            if (i == k) continue;
            const std::optional<StraightRim> whole = joined(views, edges[i], edges[k]);
            if (!whole) continue;
            edges[i] = *whole;
            edges.erase(edges.begin() + std::ptrdiff_t(k));
            i = k < i ? i - 1 : i;
            k = size_t(-1);
        }
    return edges;
}

}  // namespace relamp
