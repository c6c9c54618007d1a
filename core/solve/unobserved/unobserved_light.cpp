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
constexpr float lobePowers[] = {1, 4};  ///< a panel's intensity is a cosine; a spot's falls off faster
constexpr float radii[] = {0.05f, 0.1f, 0.15f, 0.2f, 0.3f};  ///< in parts of the distance
constexpr double leastShapeGain = 0.01;  ///< fraction of the misfit by which each further shape is to be better
constexpr float atInfinity = 50;         ///< times the reach of the points
constexpr double leastCertainty = 4;     ///< standard errors, of a suspected light and of its distance
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

std::vector<Vec3> placesAround(const Extent& extent, int side) {
    std::vector<Vec3> places;
    const DirectionGrid directions{side};
    for (const float reach : {0.4f, 0.65f, 1.0f, 1.5f, 2.2f, 3.3f, 5.0f, 8.0f})
        for (int c = 0; c < directions.cells(); ++c)
            places.push_back(extent.middle + reach * extent.radius * directions.direction(c));
    return places;
}

/// The best places, at most `most`, none near a better one.
std::vector<size_t> bestPlaces(const std::vector<Vec3>& places, const std::vector<double>& misfit, const Vec3& middle,
                               size_t most) {
    std::vector<size_t> order(places.size()), best;
    std::iota(order.begin(), order.end(), size_t(0));
    std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) { return misfit[a] < misfit[b]; });
    for (size_t i : order) {
        if (!(misfit[i] < 1e300) || best.size() >= most) break;
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

/// The best light without another one; the pairs' variances are taken from what it leaves.
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

/// The search's data at three degrees of detail, and what was found so far.
class LightSearch {
public:
    LightSearch(const Capture& capture, const Scene& scene, const RadianceSamples& samples,
                const EmitterClusters& clusters, const UnobservedLightOptions& options, Progress& progress)
        : capture_(capture),
          scene_(scene),
          samples_(samples),
          options_(options),
          progress_(progress),
          coarse_(unobservedLightData(scene, samples, clusters, coarseLevel, options.pairs, options.seed, progress)) {
        if (tooFew()) return;
        extent_ = extentOf(coarse_);
        bright_ = 10 * float(medianOf(coarse_.radiance));
        places_ = placesAround(extent_, options.directionSide);
        if (!options.suspicion)
            dense_ = unobservedLightData(scene, samples, clusters, coarseLevel, options.finalPairs, options.seed + 1,
                                         progress);
        fine_ =
            unobservedLightData(scene, samples, clusters, finalLevel, options.finalPairs, options.seed + 2, progress);
    }
    bool tooFew() const { return coarse_.pairs.size() < 200; }
    UnobservedLightSearch run();
    std::optional<SuspectedLight> suspected();

private:
    /// A light that is taken for real while others are looked for.
    struct Likely {
        Vec3 place{0};
        LightShape shape{};
        std::vector<Vec3> along;  ///< the best places at other distances
        double gain = 0;          ///< fraction of the misfit that it explains, when it was found
    };
    /// How much one of them explains beside the others.
    struct Judged {
        UnobservedLightFit fit;
        double without = 0, gain = 0, certainty = 0;
    };
    const Capture& capture_;
    const Scene& scene_;
    const RadianceSamples& samples_;
    const UnobservedLightOptions& options_;
    Progress& progress_;
    UnobservedLightData coarse_, dense_, fine_;
    Extent extent_;
    float bright_ = 0;
    std::vector<Vec3> places_, distant_;
    double misfitAlone_ = 0;  ///< of the last search for a place

    /// With the likely ones, but for one of them, among what is known.
    UnobservedLightData with(const UnobservedLightData& base, const std::vector<Likely>& likely,
                             size_t without = ~size_t(0)) const;
    std::optional<UnobservedLightFit> bestPlace(const std::vector<Likely>& likely);
    double certaintyOfDistance(const UnobservedLightFit& near);
    std::optional<Likely> next(const std::vector<Likely>& likely);
    UnobservedLightFit atItsDistance(const UnobservedLightData& dense, const UnobservedLightFit& from, Likely& out);
    UnobservedLightFit shapedLight(const UnobservedLightData& dense, const UnobservedLightFit& even);
    Judged judged(const std::vector<Likely>& likely, size_t of) const;
    UnobservedLight lightOf(const std::vector<Likely>& likely, size_t of, const Judged& judgement);
    std::string wordsOf(const UnobservedLight& light, const Judged& judgement) const;
};

UnobservedLightData LightSearch::with(const UnobservedLightData& base, const std::vector<Likely>& likely,
                                      size_t without) const {
    UnobservedLightData data = base;
    for (const Vec3& place : distant_) addKnownPlace(scene_, place, {}, data);
    for (size_t i = 0; i < likely.size(); ++i)
        if (i != without) addKnownPlace(scene_, likely[i].place, likely[i].shape, data);
    return data;
}

/// The best of places all around. What is too far to have a place is a detail of the environment that their leaves are
/// too coarse for: it joins them, and the search begins again.
std::optional<UnobservedLightFit> LightSearch::bestPlace(const std::vector<Likely>& likely) {
    UnobservedLightData data = with(coarse_, likely);
    for (size_t pass = 0; pass < (options_.suspicion ? 2 : 6); ++pass) {
        const UnobservedLightFit without = fitted(data);
        misfitAlone_ = without.misfit;
        std::vector<double> misfit(places_.size(), 1e301);
        progress_.begin("Looking for an unobserved light", places_.size());
        parallelFor(
            places_.size(), 8,
            [&](size_t i) {
                if (seenEmpty(capture_, samples_, places_[i], bright_)) return;
                const Eigen::VectorXd column = pointLightColumn(scene_, data, places_[i], 0);
                if (!(column.sum() > 0)) return;
                misfit[i] = fitUnobservedLight(data, &column, without.light, 5).misfit;
            },
            &progress_);
        const auto candidates = bestPlaces(places_, misfit, extent_.middle, options_.followed);
        progress_.begin("Following the shadows of an unobserved light", candidates.size());
        std::optional<UnobservedLightFit> best;
        for (size_t i : candidates) {
            progress_.advance();
            UnobservedLightFit fit =
                searchAround(scene_, data, places_[i], extent_.middle, without.light, 0.2f, 0.02f, false, progress_);
            if (seenEmpty(capture_, samples_, fit.place, bright_)) continue;
            if (!best || fit.misfit < best->misfit) best = std::move(fit);
        }
        if (!best) return best;
        logInfo("unobserved light? at {}: misfit {:.4f}, without {:.4f}", placeInWords(best->place), best->misfit,
                without.misfit);
        if (glm::length(best->place - extent_.middle) < farAway * extent_.radius) return best;
        if (best->misfit > 0.97 * without.misfit) return std::nullopt;
        distant_.push_back(best->place);
        addKnownPlace(scene_, best->place, {}, data);
    }
    return std::nullopt;
}

/// How far it is, is known worst: at every distance the best direction, by many more points, because shadows' edges
/// tell it.
UnobservedLightFit LightSearch::atItsDistance(const UnobservedLightData& dense, const UnobservedLightFit& from,
                                              Likely& out) {
    UnobservedLightFit nearest;
    nearest.misfit = 1e300;
    progress_.begin("How far the unobserved light is", 13);
    for (int k = -6; k <= 6; ++k) {
        progress_.advance();
        const Vec3 place = extent_.middle + std::exp(0.08f * float(k)) * (from.place - extent_.middle);
        UnobservedLightFit fit =
            searchAround(scene_, dense, place, extent_.middle, from.light, 0.03f, 0.003f, true, progress_);
        out.along.push_back(fit.place);
        if (fit.misfit < nearest.misfit) nearest = std::move(fit);
    }
    UnobservedLightFit best =
        searchAround(scene_, dense, nearest.place, extent_.middle, nearest.light, 0.02f, 0.003f, false, progress_);
    UnobservedLightFit polished = refineUnobservedLight(scene_, dense, best.place, best.light, 20, progress_);
    return polished.misfit < best.misfit ? polished : best;
}

/// The same light larger, or as one whose radiance is a power of the cosine to an axis, where that explains clearly
/// more. It stands elsewhere then: one that faces the scene seems nearer while it is taken to shine alike in all
/// directions, and a small one nearer or farther than a large one with the same soft shadows.
UnobservedLightFit LightSearch::shapedLight(const UnobservedLightData& dense, const UnobservedLightFit& plain) {
    const float distance = glm::length(plain.place - extent_.middle);
    const Eigen::Index known = dense.rows.cols();
    const auto better = [&](const UnobservedLightFit& fit, const UnobservedLightFit& than) {
        logInfo("unobserved light of {:.3f} m, cosine to the power of {:g}: at {}, misfit {:.4f}, plain {:.4f}",
                fit.shape.radius, fit.shape.lobe.power, placeInWords(fit.place), fit.misfit, plain.misfit);
        return fit.misfit < (1 - leastShapeGain) * than.misfit && !seenEmpty(capture_, samples_, fit.place, bright_) &&
               gainCertainty(dense, plain, fit) > 2;
    };
    progress_.begin("What shape the unobserved light has", std::size(lobePowers) + std::size(radii));
    UnobservedLightFit large = plain;
    for (const float part : radii) {
        progress_.advance();
        LightShape shape;
        shape.radius = part * distance;
        UnobservedLightFit fit = searchAround(scene_, dense, large.place, extent_.middle, large.light, 0.06f, 0.005f,
                                              false, progress_, shape);
        if (better(fit, large)) large = std::move(fit);
    }
    UnobservedLightFit best = large;
    for (const float power : lobePowers) {
        progress_.advance();
        UnobservedLightFit fit =
            aimedLight(scene_, dense, large.place, power, large.shape.radius, large.light.head(known));
        if (!(fit.misfit < 1e300)) continue;
        for (const float reach : {0.12f, 0.04f}) {
            fit = searchAround(scene_, dense, fit.place, extent_.middle, fit.light, reach, reach / 8, false, progress_,
                               fit.shape);
            UnobservedLightFit aimed =
                aimedLight(scene_, dense, fit.place, power, fit.shape.radius, fit.light.head(known));
            if (aimed.misfit < fit.misfit) fit = std::move(aimed);
        }
        if (better(fit, large) && fit.misfit < best.misfit) best = std::move(fit);
    }
    return best;
}

std::optional<LightSearch::Likely> LightSearch::next(const std::vector<Likely>& likely) {
    const std::optional<UnobservedLightFit> place = bestPlace(likely);
    if (!place) return std::nullopt;
    UnobservedLightData dense = with(dense_, likely);
    const UnobservedLightFit without = fitted(dense);
    Likely out;
    UnobservedLightFit found = atItsDistance(dense, *place, out);
    // Far from what counts, its shape does not help.
    if (found.misfit < (1 - 0.5 * double(options_.leastOwnGain)) * without.misfit) found = shapedLight(dense, found);
    out.place = found.place;
    out.shape = found.shape;
    out.gain = 1 - found.misfit / std::max(without.misfit, 1e-300);
    return out;
}

/// Would finer environment do as well?
LightSearch::Judged LightSearch::judged(const std::vector<Likely>& likely, size_t of) const {
    UnobservedLightData data = with(fine_, likely, of);
    const UnobservedLightFit without = fitted(data);
    const Eigen::VectorXd column = pointLightColumn(scene_, data, likely[of].place, 8, likely[of].shape);
    Judged out;
    out.fit = fitUnobservedLight(data, &column, without.light, 20);
    out.without = without.misfit;
    out.gain = 1 - out.fit.misfit / std::max(without.misfit, 1e-300);
    out.certainty = gainCertainty(data, without, out.fit);
    return out;
}

UnobservedLight LightSearch::lightOf(const std::vector<Likely>& likely, size_t of, const Judged& judgement) {
    UnobservedLightData dense = with(dense_, likely, of);
    const UnobservedLightFit without = fitted(dense);
    const Eigen::VectorXd column = pointLightColumn(scene_, dense, likely[of].place, 8, likely[of].shape);
    UnobservedLightFit best = fitUnobservedLight(dense, &column, without.light, 6);
    best.place = likely[of].place;
    best.shape = likely[of].shape;
    progress_.begin("How sure its place is", 1);
    UnobservedLight light;
    light.covariance =
        positionCovariance(scene_, dense, extent_.middle, likely[of].along, options_.seed, best, progress_);
    light.position = best.place;
    light.lobe = best.shape.lobe;
    light.radius = best.shape.radius;
    light.fraction = float(judgement.fit.fraction);
    const Vec3 away = light.position - extent_.middle;
    light.distance = glm::length(away);
    const DVec3 outward(away / light.distance);
    light.distanceSigma = float(std::sqrt(glm::dot(outward, light.covariance * outward))) / light.distance;
    light.certainty = judgement.certainty;
    return light;
}

std::string LightSearch::wordsOf(const UnobservedLight& light, const Judged& judgement) const {
    return fmt::format(
        "at {} (+- {}) m, {:.0f} % of the light{}; it lowers the misfit of shading by {:.0f} % ({:.1f} standard "
        "errors)",
        placeInWords(light.position, capture_.origin), placeInWords(light.sigma()), 100 * light.fraction,
        light.lobe.even() ? std::string()
                          : fmt::format(", towards {} (half as bright {:.0f} degrees aside)",
                                        placeInWords(light.lobe.axis), light.lobe.halfDegrees()),
        100 * judgement.gain, judgement.certainty);
}

/// By how many standard errors more a light at a place explains than one in its direction and far away, which would be
/// a detail of the environment.
double LightSearch::certaintyOfDistance(const UnobservedLightFit& near) {
    const Vec3 away = near.place - extent_.middle;
    const Vec3 far = extent_.middle + atInfinity * extent_.radius * glm::normalize(away);
    const Vec3 direction =
        searchAround(scene_, coarse_, far, extent_.middle, near.light, 0.2f, 0.02f, true, progress_).place;
    UnobservedLightData data = fine_;
    const UnobservedLightFit without = fitted(data);
    const auto fitAt = [&](const Vec3& place) {
        const Eigen::VectorXd column = pointLightColumn(scene_, data, place, 8);
        return fitUnobservedLight(data, &column, without.light, 20);
    };
    return gainCertainty(data, fitAt(direction), fitAt(near.place));
}

std::optional<SuspectedLight> LightSearch::suspected() {
    const std::optional<UnobservedLightFit> place = bestPlace({});
    if (!place) return std::nullopt;
    const Judged judgement = judged({{place->place, {}, {}, 0}}, 0);
    logInfo("suspected light at {}: {:.1f} % of the misfit, {:.1f} standard errors, {:.0f} % of the light",
            placeInWords(place->place), 100 * judgement.gain, judgement.certainty, 100 * judgement.fit.fraction);
    if (judgement.gain < double(options_.leastGain) || judgement.certainty < leastCertainty ||
        judgement.fit.fraction < double(options_.leastFraction))
        return std::nullopt;
    const double nearer = certaintyOfDistance(*place);
    logInfo("there in place of far away: {:.1f} standard errors", nearer);
    if (nearer < leastCertainty) return std::nullopt;
    return SuspectedLight{capture_.origin + DVec3(place->place), judgement.gain, judgement.certainty,
                          judgement.fit.fraction};
}

UnobservedLightSearch LightSearch::run() {
    UnobservedLightSearch search;
    std::vector<Likely> likely;
    while (likely.size() < options_.most) {
        const std::optional<Likely> one = next(likely);
        if (likely.empty()) search.misfitWithout = search.misfitWith = misfitAlone_;
        if (!one || (!likely.empty() && one->gain < double(options_.leastOwnGain))) break;
        likely.push_back(*one);
        if (one->gain < double(options_.leastOwnGain)) break;
    }
    if (likely.empty()) {
        search.words = distant_.empty()
                           ? "no unobserved light: every place for one is in view and dark"
                           : "no unobserved light: what the environment leaves unexplained comes from afar";
        return search;
    }
    // With the others known, each stands elsewhere than it seemed while it had to explain their light too.
    for (size_t i = 0; likely.size() > 1 && i < likely.size(); ++i) {
        UnobservedLightData dense = with(dense_, likely, i);
        const UnobservedLightFit without = fitted(dense);
        likely[i].place = searchAround(scene_, dense, likely[i].place, extent_.middle, without.light, 0.08f, 0.004f,
                                       false, progress_, likely[i].shape)
                              .place;
    }
    // Those that the others explain as well go, the least certain first.
    std::vector<Judged> judgements;
    for (;;) {
        judgements.clear();
        for (size_t i = 0; i < likely.size(); ++i) judgements.push_back(judged(likely, i));
        const auto worst = std::min_element(judgements.begin(), judgements.end(),
                                            [](const Judged& a, const Judged& b) { return a.certainty < b.certainty; });
        const bool real = worst->certainty >= 2 && worst->gain >= double(options_.leastOwnGain) &&
                          worst->fit.fraction >= double(options_.leastFraction);
        if (likely.size() == 1 || real) break;
        logInfo("unobserved light at {}: {:.1f} standard errors beside the others, left out",
                placeInWords(likely[size_t(worst - judgements.begin())].place), worst->certainty);
        likely.erase(likely.begin() + (worst - judgements.begin()));
    }
    UnobservedLightData bare = with(fine_, {});
    search.misfitWithout = fitted(bare).misfit;
    search.misfitWith = judgements[0].fit.misfit;
    const double whole = 1 - search.misfitWith / std::max(search.misfitWithout, 1e-300);
    std::string words;
    for (size_t i = 0; i < likely.size(); ++i) {
        const UnobservedLight light = lightOf(likely, i, judgements[i]);
        const std::string what = wordsOf(light, judgements[i]);
        const bool alone = likely.size() == 1;
        search.certainty = std::max(search.certainty, judgements[i].certainty);
        if ((alone && (judgements[i].gain < double(options_.leastGain) || judgements[i].certainty < 2 ||
                       light.fraction < options_.leastFraction)) ||
            whole < double(options_.leastGain))
            search.words = "no unobserved light: the likeliest one is " + what + ", which is too little to go by";
        else if (!(light.distanceSigma < 0.5f))
            search.words =
                "no unobserved light: the likeliest one is " + what + ", too far to be told from the environment";
        else {
            words += (words.empty() ? "" : "; another ") + what;
            search.lights.push_back(light);
        }
    }
    if (search.lights.size() == 1) search.words = "an unobserved light " + words;
    if (search.lights.size() > 1)
        search.words = fmt::format("{} unobserved lights, one {}", search.lights.size(), words);
    return search;
}

}  // namespace

UnobservedLightSearch findUnobservedLights(const Capture& capture, const Scene& scene, const RadianceSamples& samples,
                                           const EmitterClusters& clusters, const UnobservedLightOptions& options,
                                           Progress& progress) {
    LightSearch search(capture, scene, samples, clusters, options, progress);
    if (search.tooFew()) {
        UnobservedLightSearch nothing;
        nothing.words = "no unobserved light: too few matte points to tell";
        return nothing;
    }
    return search.run();
}

std::optional<SuspectedLight> suspectUnobservedLight(const Capture& capture, const Scene& scene,
                                                     const RadianceSamples& samples, const EmitterClusters& clusters,
                                                     uint64_t seed, Progress& progress) {
    UnobservedLightOptions options;
    options.seed = seed;
    options.pairs = 1500;
    options.finalPairs = 6000;
    options.directionSide = 10;
    options.followed = 3;
    options.suspicion = true;
    LightSearch search(capture, scene, samples, clusters, options, progress);
    return search.tooFew() ? std::nullopt : search.suspected();
}

std::string inWords(const SuspectedLight& light) {
    const DVec3& p = light.position;
    return fmt::format(
        "A light that no photograph shows may stand near {:.2f} {:.2f} {:.2f}: it would give {:.0f} % of the light and "
        "lower the misfit of shading by {:.0f} % ({:.1f} standard errors).",
        p.x, p.y, p.z, 100 * light.fraction, 100 * light.gain, light.certainty);
}

UnobservedLightSearch joinedSearches(const std::vector<std::string>& states,
                                     const std::vector<UnobservedLightSearch>& searches) {
    UnobservedLightSearch all;
    for (size_t s = 0; s < searches.size(); ++s) {
        all.words += fmt::format("{}{}: {}", s ? "; " : "", states[s], searches[s].words);
        if (searches[s].certainty > all.certainty) {
            all.certainty = searches[s].certainty;
            all.misfitWithout = searches[s].misfitWithout;
            all.misfitWith = searches[s].misfitWith;
        }
        for (const UnobservedLight& light : searches[s].lights) {
            const auto same = std::find_if(all.lights.begin(), all.lights.end(), [&](const UnobservedLight& other) {
                const glm::dmat3 scatter = light.covariance + other.covariance;
                const double apart = double(glm::distance(light.position, other.position)),
                             spread = std::sqrt(scatter[0][0] + scatter[1][1] + scatter[2][2]);
                return apart < std::max(3 * spread, 0.15 * double(std::min(light.distance, other.distance)));
            });
            if (same == all.lights.end()) all.lights.push_back(light);
            else if (light.certainty > same->certainty) *same = light;
        }
    }
    return all;
}

}  // namespace relamp
