#include "solve/unobserved/unobserved_light.h"

#include <numeric>

#include "base/log.h"
#include "base/parallel.h"
#include "base/random.h"
#include "base/statistics.h"
#include "solve/unobserved/unobserved_light_fit.h"

namespace relamp {
namespace {

constexpr int coarseLevel = 2, finalLevel = 3;
constexpr size_t refined = 6;
constexpr float farAway = 6;  ///< times the reach of the points: beyond, fall-off and parallax are lost in texture

/// The middle of the points and how far they reach.
struct Extent {
    Vec3 middle{0};
    float radius = 0;
};

Extent extentOf(const UnobservedLightData& data) {
    Extent e;
    for (const Vec3& p : data.positions) e.middle += p / float(data.positions.size());
    std::vector<float> away;
    for (const Vec3& p : data.positions) away.push_back(glm::length(p - e.middle));
    e.radius = selectRank(away, away.size() * 9 / 10);
    return e;
}

/// A photograph shows that nothing shines there: the place is in view, in front of what is seen, and nothing about it
/// is strikingly bright.
bool seenEmpty(const Capture& capture, const RadianceSamples& samples, const Vec3& place, float bright) {
    for (size_t i = 0; i < capture.views.size(); ++i) {
        const View& view = capture.views[i];
        const std::optional<Vec2> pixel = view.camera.project(place);
        if (!pixel || samples.geometry.size() <= i) continue;
        const ViewGeometry& geometry = samples.geometry[i];
        const int x = int(std::floor(pixel->x)), y = int(std::floor(pixel->y));
        if (x < 0 || y < 0 || x >= geometry.width || y >= geometry.height) continue;
        const size_t at = size_t(y) * size_t(geometry.width) + size_t(x);
        const float distance = glm::length(place - Vec3(view.camera.position()));
        if (geometry.triangle[at] != Hit::none && geometry.depth[at] < distance) continue;
        // An emitter has a size, and the place an error: something bright or masked nearby in the image may be it.
        bool told = true;
        const int step = std::max(1, geometry.width / 50);
        for (int k = 0; k < 49 && told; ++k) {
            const int nx = std::clamp(x + (k % 7 - 3) * step, 0, geometry.width - 1),
                      ny = std::clamp(y + (k / 7 - 3) * step, 0, geometry.height - 1);
            told = view.image.usableAt(nx, ny) && maxChannel(view.image.at(nx, ny)) <= bright;
        }
        if (told) return true;
    }
    return false;
}

std::vector<Vec3> placesAround(const Extent& extent) {
    std::vector<Vec3> places;
    const DirectionGrid directions{14};
    for (const float reach : {0.4f, 0.65f, 1.0f, 1.5f, 2.2f, 3.3f, 5.0f, 8.0f})
        for (int c = 0; c < directions.cells(); ++c)
            places.push_back(extent.middle + reach * extent.radius * directions.direction(c));
    return places;
}

/// The best places, none near a better one.
std::vector<size_t> bestPlaces(const std::vector<Vec3>& places, const std::vector<double>& misfit, const Vec3& middle) {
    std::vector<size_t> order(places.size()), best;
    std::iota(order.begin(), order.end(), size_t(0));
    std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) { return misfit[a] < misfit[b]; });
    for (size_t i : order) {
        if (!(misfit[i] < 1e300) || best.size() >= refined) break;
        const Vec3 a = places[i] - middle;
        const bool near = std::any_of(best.begin(), best.end(), [&](size_t j) {
            const Vec3 b = places[j] - middle;
            const float ratio = glm::length(a) / glm::length(b);
            return glm::dot(a, b) > 0.93f * glm::length(a) * glm::length(b) && ratio < 1.6f && ratio > 0.6f;
        });
        if (!near) best.push_back(i);
    }
    return best;
}

/// The best light without an unobserved light; the pairs' variances are taken from what it leaves.
UnobservedLightFit fitted(UnobservedLightData& data) {
    const UnobservedLightFit first = fitUnobservedLight(data, nullptr, {}, 20);
    assessPairs(data, first);
    return fitUnobservedLight(data, nullptr, first.light, 20);
}

std::string placeInWords(const Vec3& p) { return fmt::format("{:.4g} {:.4g} {:.4g}", p.x, p.y, p.z); }
/// In the capture's own coordinates.
std::string placeInWords(const Vec3& p, const DVec3& origin) {
    if (origin == DVec3(0)) return placeInWords(p);
    const DVec3 far = origin + DVec3(p);
    return fmt::format("{:.3f} {:.3f} {:.3f}", far.x, far.y, far.z);
}

}  // namespace

UnobservedLightSearch findUnobservedLight(const Capture& capture, const Scene& scene, const RadianceSamples& samples,
                                          const EmitterClusters& clusters, const UnobservedLightOptions& options,
                                          Progress& progress) {
    UnobservedLightSearch search;
    UnobservedLightData coarse =
        unobservedLightData(scene, samples, clusters, coarseLevel, options.pairs, options.seed, progress);
    if (coarse.pairs.size() < 200) {
        search.words = "no unobserved light: too few matte points to tell";
        return search;
    }
    const Extent extent = extentOf(coarse);
    const float bright = 10 * float(medianOf(coarse.radiance));

    const std::vector<Vec3> places = placesAround(extent);
    std::vector<Vec3> distant;
    std::optional<UnobservedLightFit> best;
    UnobservedLightFit without;
    // What is too far to have a place is a detail of the environment that their leaves are too coarse for: it joins
    // them, and the search begins again.
    for (size_t pass = 0; pass < 6 && !best; ++pass) {
        without = fitted(coarse);
        std::vector<double> misfit(places.size(), 1e301);
        progress.begin("Looking for an unobserved light", places.size());
        parallelFor(
            places.size(), 8,
            [&](size_t i) {
                if (seenEmpty(capture, samples, places[i], bright)) return;
                const Eigen::VectorXd column = pointLightColumn(scene, coarse, places[i], 0);
                if (!(column.sum() > 0)) return;
                misfit[i] = fitUnobservedLight(coarse, &column, without.light, 5).misfit;
            },
            &progress);
        const auto likely = bestPlaces(places, misfit, extent.middle);
        progress.begin("Following the shadows of an unobserved light", likely.size());
        for (size_t i : likely) {
            progress.advance();
            UnobservedLightFit fit =
                searchAround(scene, coarse, places[i], extent.middle, without.light, 0.2f, 0.02f, false, progress);
            if (seenEmpty(capture, samples, fit.place, bright)) continue;
            if (!best || fit.misfit < best->misfit) best = std::move(fit);
        }
        if (!best) break;
        logInfo("unobserved light? at {}: misfit {:.4f}, without {:.4f}", placeInWords(best->place), best->misfit,
                without.misfit);
        if (glm::length(best->place - extent.middle) < farAway * extent.radius) continue;
        if (best->misfit > 0.97 * without.misfit) {
            best.reset();
            break;
        }
        distant.push_back(best->place);
        addKnownPlace(scene, best->place, coarse);
        best.reset();
    }
    if (!best) {
        search.misfitWithout = search.misfitWith = without.misfit;
        search.words = distant.empty() ? "no unobserved light: every place for one is in view and dark"
                                       : "no unobserved light: what the environment leaves unexplained comes from afar";
        return search;
    }
    // How far it is, is known worst: at every distance the best direction, by many more points, because shadows' edges
    // tell it.
    UnobservedLightData dense =
        unobservedLightData(scene, samples, clusters, coarseLevel, options.finalPairs, options.seed + 1, progress);
    for (const Vec3& place : distant) addKnownPlace(scene, place, dense);
    fitted(dense);
    std::vector<Vec3> along;
    UnobservedLightFit nearest;
    nearest.misfit = 1e300;
    progress.begin("How far the unobserved light is", 13);
    for (int k = -6; k <= 6; ++k) {
        progress.advance();
        const Vec3 place = extent.middle + std::exp(0.08f * float(k)) * (best->place - extent.middle);
        UnobservedLightFit fit =
            searchAround(scene, dense, place, extent.middle, best->light, 0.03f, 0.003f, true, progress);
        along.push_back(fit.place);
        if (fit.misfit < nearest.misfit) nearest = std::move(fit);
    }
    *best = searchAround(scene, dense, nearest.place, extent.middle, nearest.light, 0.02f, 0.003f, false, progress);
    const UnobservedLightFit polished = refineUnobservedLight(scene, dense, best->place, best->light, 20, progress);
    if (polished.misfit < best->misfit) *best = polished;
    progress.begin("How sure its place is", 1);
    const glm::dmat3 covariance = positionCovariance(scene, dense, extent.middle, along, options.seed, *best, progress);

    // Would finer environment do as well?
    UnobservedLightData fine =
        unobservedLightData(scene, samples, clusters, finalLevel, options.finalPairs, options.seed + 2, progress);
    for (const Vec3& place : distant) addKnownPlace(scene, place, fine);
    const UnobservedLightFit fineWithout = fitted(fine);
    const Eigen::VectorXd column = pointLightColumn(scene, fine, best->place, 8);
    const UnobservedLightFit fineWith = fitUnobservedLight(fine, &column, fineWithout.light, 20);
    search.misfitWithout = fineWithout.misfit;
    search.misfitWith = fineWith.misfit;
    search.certainty = gainCertainty(fine, fineWithout, fineWith);
    const double gain = 1 - search.misfitWith / std::max(search.misfitWithout, 1e-300);
    UnobservedLight light;
    light.position = best->place;
    light.covariance = covariance;
    light.fraction = float(fineWith.fraction);
    const Vec3 away = light.position - extent.middle;
    light.distance = glm::length(away);
    const DVec3 outward(away / light.distance);
    light.distanceSigma = float(std::sqrt(glm::dot(outward, light.covariance * outward))) / light.distance;
    const std::string what = fmt::format(
        "at {} (+- {}) m, {:.0f} % of the light; it lowers the misfit of shading by {:.0f} % ({:.1f} standard errors)",
        placeInWords(light.position, capture.origin), placeInWords(light.sigma()), 100 * light.fraction, 100 * gain,
        search.certainty);
    if (gain < double(options.leastGain) || search.certainty < 2 || light.fraction < options.leastFraction)
        search.words = "no unobserved light: the likeliest one is " + what + ", which is too little to go by";
    else if (!(light.distanceSigma < 0.5f))
        search.words =
            "no unobserved light: the likeliest one is " + what + ", too far to be told from the environment";
    else {
        search.words = "an unobserved light " + what;
        search.light = light;
    }
    return search;
}

}  // namespace relamp
