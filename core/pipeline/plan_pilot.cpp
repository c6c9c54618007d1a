#include "pipeline/plan_pilot.h"

#include <numeric>

#include "base/random.h"
#include "base/statistics.h"
#include "solve/light/contributions.h"
#include "solve/ratio/albedo_free.h"
#include "solve/ratio/pair_misfit.h"
#include "transport/bounce.h"

namespace relamp {
namespace {

constexpr size_t pairsWanted = 4000;
constexpr int pilotSide = 16, pilotLevel = 3;
constexpr uint32_t pilotRays = 256;  // with fewer their noise speaks against bounced light where it is

/// A fraction of the pairs, drawn by where their points lie, and those points.
struct PilotPairs {
    std::vector<uint8_t> wanted;  ///< per mesh vertex
    std::vector<AlbedoPair> pairs;
    MatteObservations matte;

    PilotPairs(const Scene& scene, const MatteObservations& all, const std::vector<AlbedoPair>& allPairs, uint64_t seed)
        : wanted(scene.mesh.vertexCount(), 0) {
        const double fraction = std::min(1.0, double(pairsWanted) / double(allPairs.size()));
        for (const AlbedoPair& p : allPairs) {
            const uint64_t a = scene.rank[all.vertices[p.a]], b = scene.rank[all.vertices[p.b]];
            if (double(unitFloat(mixBits(mixBits(seed ^ a) ^ b))) >= fraction) continue;
            pairs.push_back(p);
            wanted[all.vertices[p.a]] = wanted[all.vertices[p.b]] = 1;
        }
        matte.viewSpread = all.viewSpread;
        matte.componentGlossy = all.componentGlossy;
        std::vector<uint32_t> place(all.vertices.size(), 0);
        for (uint32_t i = 0; i < all.vertices.size(); ++i) {
            if (!wanted[all.vertices[i]]) continue;
            place[i] = uint32_t(matte.vertices.size());
            matte.vertices.push_back(all.vertices[i]);
            matte.radiance.push_back(all.radiance[i]);
            matte.sigma.push_back(all.sigma[i]);
        }
        for (AlbedoPair& p : pairs) {
            p.a = place[p.a];
            p.b = place[p.b];
        }
    }
};

/// The fit's options and its start: even light.
AlbedoFreeOptions pilotFit(const MatteObservations& matte, const EmitterClusters& emitters, double& middle,
                           Lighting& lighting) {
    std::vector<float> brightness;
    for (const Rgb& y : matte.radiance) brightness.push_back(maxChannel(y));
    middle = double(medianOf(std::move(brightness)));
    lighting.emitterRadiance = firstRadiance(emitters);
    lighting.leafRadiance.assign(lighting.leaves.size(), Rgb(float(std::max(middle / 0.3, 1e-9))));
    AlbedoFreeOptions fit;
    fit.iterations = 12;
    fit.light.darkness = float(1e-3 * middle);
    fit.chroma = ChromaFraction{};  // each channel by itself: that is enough to judge by
    return fit;
}

/// Divides strong directions down to a side of 64, as the solve does (sharpenStrong of solve/steps), so that it can
/// begin with them.
void sharpenStrong(const Scene& scene, const Visibility& visibility, const NearField& nearField,
                   const RadianceSamples& samples, const EmitterClusters& emitters, const PilotPairs& part,
                   const AlbedoFreeOptions& fit, Lighting& lighting, Progress& progress) {
    const std::vector<uint32_t>& vertices = part.matte.vertices;
    Visibility none;  // of a grid so coarse that divided directions get rays of their own
    none.grid = {1 << pilotLevel, scene.axes};
    std::vector<uint32_t> every(vertices.size());
    std::iota(every.begin(), every.end(), 0u);
    InfluenceMatrix rows = lambertInfluence(scene, visibility, nearField, lighting.leaves, vertices, progress);
    for (int round = 0; round < StrongDirections::rounds; ++round) {
        const std::vector<Rgb> fraction = lightContributions(rows, lighting, litBy(rows, lighting), every);
        bool any = false;
        for (uint32_t k = 0; k < fraction.size(); ++k) {
            if (!(maxChannel(fraction[k]) > StrongDirections::fraction) ||
                lighting.leaves[k].level >= StrongDirections::finest)
                continue;
            lighting.leaves.split(k);
            lighting.leafRadiance.resize(lighting.leaves.size(), lighting.leafRadiance[k]);
            any = true;
        }
        if (!any) return;
        rows = lambertInfluence(scene, visibility, nearField, lighting.leaves, vertices, progress);
        std::vector<uint32_t> fine;
        for (uint32_t k = 0; k < lighting.leaves.size(); ++k)
            if (lighting.leaves[k].level > pilotLevel) fine.push_back(k);
        lambertInfluenceOfLeaves(scene, none, lighting.leaves, vertices, fine, rows, progress);
        solveAlbedoFree(rows, part.matte, part.pairs, lightAnchors(samples, emitters, lighting.leaves), nullptr, fit,
                        lighting, progress, {});
    }
}

/// Middle albedo of the observations, alike in all channels.
float middleAlbedo(const MatteObservations& matte, const std::vector<Rgb>& lit) {
    std::vector<float> albedo;
    for (size_t i = 0; i < lit.size(); ++i)
        if (luminance(lit[i]) > 0) albedo.push_back(float(luminance(matte.radiance[i]) / luminance(lit[i])));
    return albedo.empty() ? 0.0f : std::min(1.0f, medianOf(std::move(albedo)));
}

/// Surfaces that rays met and no photograph shows, such as the inside of a shade, send `albedo` times the light that
/// reaches them.
void sendFromHidden(const Scene& scene, const EmitterClusters& emitters, const MatteObservations& observed,
                    const std::array<const BounceRays*, 2>& met, const SolveOptions& options, const Lighting& lighting,
                    float albedo, std::vector<Rgb>& outgoing, Progress& progress) {
    constexpr double most = 20000;  // where there are more, each is met seldom
    std::vector<uint8_t> hidden(scene.mesh.vertexCount(), 0);
    for (const BounceRays* rays : met)
        for (const uint32_t v : rays->sender) hidden[v] = emitters.emitterOfVertex[v] < 0;
    for (const uint32_t v : observed.vertices) hidden[v] = 0;
    const double fraction = most / std::max(1.0, double(std::count(hidden.begin(), hidden.end(), 1)));
    std::vector<uint32_t> vertices;
    for (uint32_t v = 0; v < hidden.size(); ++v) {
        hidden[v] = hidden[v] && double(unitFloat(mixBits(scene.rank[v]))) < fraction;
        if (hidden[v]) vertices.push_back(v);
    }
    if (vertices.empty()) return;
    const Visibility visibility =
        computeVisibility(scene, {.gridSide = pilotSide, .only = &hidden, .axes = scene.axes}, progress);
    NearFieldOptions near;
    near.seed = options.seed;
    near.only = &hidden;
    const InfluenceMatrix rows = lambertInfluence(scene, visibility, computeNearField(scene, emitters, near, progress),
                                                  lighting.leaves, vertices, progress);
    const std::vector<Rgb> lit = litBy(rows, lighting);
    for (size_t i = 0; i < lit.size(); ++i) outgoing[vertices[i]] = albedo * lit[i];
}

/// What light from other surfaces, as photographs show those, explains beyond a fit of direct light.
struct BounceTrial {
    std::vector<Rgb> light;                         ///< per point of the pilot
    Lighting lighting;                              ///< fitted with it
    double enclosure = 0, fraction = 0, worse = 0;  ///< PilotFindings
    double raySeconds = 0;                          ///< to trace twice
};

/// `lighting`: fitted without. `fit`: the options of that.
BounceTrial tryBounce(const Scene& scene, const EmitterClusters& emitters, const MatteObservations& all,
                      const PilotPairs& part, const InfluenceMatrix& rows, const LightAnchors& anchors,
                      AlbedoFreeOptions fit, const Lighting& lighting, const SolveOptions& options,
                      Progress& progress) {
    BounceTrial trial;
    const MatteObservations& matte = part.matte;
    const std::vector<Rgb> lit = litBy(rows, lighting);
    const double began = progress.seconds();
    // Twice, against the noise of the rays.
    BounceOptions rays;
    rays.rays = pilotRays;
    rays.seed = options.seed;
    rays.only = &part.wanted;
    const BounceRays met = traceBounce(scene, rays, progress);
    rays.seed = mixBits(options.seed);
    const BounceRays metAgain = traceBounce(scene, rays, progress);
    trial.raySeconds = std::max(progress.seconds() - began, 1e-7);
    for (uint32_t v : matte.vertices) trial.enclosure += double(met.enclosure(v)) / double(matte.vertices.size());
    // What surfaces send is in the photographs; those that no photograph shows have the middle albedo of the others.
    std::vector<Rgb> outgoing(scene.mesh.vertexCount(), Rgb(0));
    for (size_t i = 0; i < all.vertices.size(); ++i) outgoing[all.vertices[i]] = all.radiance[i];
    sendFromHidden(scene, emitters, all, {&met, &metAgain}, options, lighting, middleAlbedo(matte, lit), outgoing,
                   progress);
    const std::vector<Rgb> gathered = gatherBounce(met, outgoing), again = gatherBounce(metAgain, outgoing);
    for (uint32_t v : matte.vertices) trial.light.push_back((gathered[v] + again[v]) / 2.0f);
    trial.lighting = lighting;
    fit.anneal = false;
    fit.bounce = &trial.light;
    solveAlbedoFree(rows, matte, part.pairs, anchors, nullptr, fit, trial.lighting, progress, {});
    std::vector<Rgb> bouncedLit = litBy(rows, trial.lighting), bouncedAgain = bouncedLit;
    double fromSurfaces = 0, whole = 0;
    for (size_t i = 0; i < trial.light.size(); ++i) {
        fromSurfaces += luminance(trial.light[i]);
        whole += luminance(bouncedLit[i] + trial.light[i]);
        bouncedLit[i] += gathered[matte.vertices[i]];
        bouncedAgain[i] += again[matte.vertices[i]];
    }
    trial.fraction = whole > 0 ? fromSurfaces / whole : 0;
    double sum = 0, squares = 0;
    for (const AlbedoPair& p : part.pairs) {
        const double rise = pairMisfit(matte, p, bouncedLit, bouncedAgain) - pairMisfit(matte, p, lit, lit);
        sum += rise;
        squares += rise * rise;
    }
    const double n = double(std::max<size_t>(2, part.pairs.size())), mean = sum / n,
                 variance = std::max(0.0, squares / n - mean * mean) / (n - 1);
    trial.worse = variance > 0 ? mean / std::sqrt(variance) : 0;
    return trial;
}

/// Pairs of the pilot and how direct light of coarse directions reaches their points.
struct PilotRows {
    PilotPairs part;
    Lighting lighting;  ///< even light of coarse directions, where a fit begins
    AlbedoFreeOptions fit;
    InfluenceMatrix rows;

    PilotRows(const Scene& scene, const EmitterClusters& emitters, const MatteObservations& all,
              const std::vector<AlbedoPair>& pairs, const SolveOptions& options, Progress& progress)
        : part(scene, all, pairs, options.seed) {
        const Visibility visibility =
            computeVisibility(scene, {.gridSide = pilotSide, .only = &part.wanted, .axes = scene.axes}, progress);
        NearFieldOptions nearOptions;
        nearOptions.seed = options.seed;
        nearOptions.only = &part.wanted;
        const NearField nearField = computeNearField(scene, emitters, nearOptions, progress);
        lighting.leaves = LightLeaves::uniform(pilotLevel, scene.axes);
        rows = lambertInfluence(scene, visibility, nearField, lighting.leaves, part.matte.vertices, progress);
        double middle = 0;
        fit = pilotFit(part.matte, emitters, middle, lighting);
    }
};

}  // namespace

std::vector<Rgb> litBy(const InfluenceMatrix& rows, const Lighting& lighting) {
    std::vector<Rgb> lit(rows.rows);
    for (size_t i = 0; i < rows.rows; ++i) lit[i] = lightOfRow(rows.row(i), lighting);
    return lit;
}

EmitterClusters allEmitters(const Scene& scene, const EmitterClusters& clusters, bool nearField) {
    EmitterClusters emitters;
    if (nearField) {
        emitters.emitters = clusters.emitters;
        emitters.emitters.insert(emitters.emitters.end(), clusters.candidates.begin(), clusters.candidates.end());
    }
    indexEmitters(scene, emitters);
    return emitters;
}

PilotFindings runPilot(const Scene& scene, const RadianceSamples& samples, const EmitterClusters& emitters,
                       const MatteObservations& all, const std::vector<AlbedoPair>& pairs, const SolveOptions& options,
                       Progress& progress) {
    PilotFindings found;
    if (pairs.size() < 50) return found;
    found.ran = true;
    const PilotPairs part(scene, all, pairs, options.seed);
    const std::vector<uint8_t>& wanted = part.wanted;
    const std::vector<AlbedoPair>& chosen = part.pairs;
    const MatteObservations& matte = part.matte;
    found.pairs = chosen.size();
    found.points = matte.vertices.size();

    double since = progress.seconds();
    const auto took = [&] {
        const double now = progress.seconds(), seconds = now - since;
        since = now;
        return std::max(seconds, 1e-7);
    };
    const Visibility visibility =
        computeVisibility(scene, {.gridSide = pilotSide, .only = &wanted, .axes = scene.axes}, progress);
    took();
    // Whole blocks of neighbours at the real resolution: how fast rays are rests on how they lie together.
    std::vector<uint8_t> blocks(scene.mesh.vertexCount(), 0);
    size_t inBlocks = 0;
    const size_t apart = std::max<size_t>(1, scene.mesh.vertexCount() / 64 / 12);
    for (uint32_t v = 0; v < blocks.size(); ++v)
        if (v / 64 % apart == 0 && samples.countOf(v) > 0 && scene.referenced[v]) blocks[v] = 1, ++inBlocks;
    Visibility sample;
    sample.grid = {options.visibilitySide, scene.axes};
    sample.wordsPerVertex = size_t(sample.grid.cells() + 63) / 64;
    sample.bits.assign(scene.mesh.vertexCount() * sample.wordsPerVertex, 0);
    sample.step = std::max(1, options.visibilitySide >> (options.startLevel + 1));
    took();
    const size_t raysTraced = addVisibility(scene, blocks, sample, progress);
    found.visibilitySecondsPerRay = took() / double(std::max<size_t>(1, raysTraced));
    refineVisibility(scene, blocks, 1, false, sample, progress);
    found.edgeSecondsPerPoint = took() / double(std::max<size_t>(1, inBlocks));
    NearFieldOptions nearOptions;
    nearOptions.seed = options.seed;
    nearOptions.only = &wanted;
    const NearField nearField = computeNearField(scene, emitters, nearOptions, progress);
    found.nearSecondsPerPoint = took() / double(found.points);
    Lighting lighting;
    lighting.leaves = LightLeaves::uniform(pilotLevel, scene.axes);
    const InfluenceMatrix rows =
        lambertInfluence(scene, visibility, nearField, lighting.leaves, matte.vertices, progress);
    found.rowSecondsPerCell = took() / (double(found.points) * pilotSide * pilotSide);
    found.rows = rows.rows;
    found.columns = rows.columns;

    const LightAnchors anchors = lightAnchors(samples, emitters, lighting.leaves);
    double middle = 0;
    AlbedoFreeOptions fit = pilotFit(matte, emitters, middle, lighting);
    found.background = backgroundOverSurfaces(samples, all);
    took();
    const AlbedoFreeReport without =
        solveAlbedoFree(rows, matte, chosen, anchors, nullptr, fit, lighting, progress, {});
    found.iterations = without.iterations;
    found.iterationSeconds = took() / std::max(1, without.iterations);
    const std::vector<Rgb> lit = litBy(rows, lighting);
    double distant = 0, light = 0;
    for (size_t i = 0; i < rows.rows; ++i) {
        light += luminance(lit[i]);
        for (size_t k = 0; k < lighting.leaves.size(); ++k)
            distant += double(rows.row(i)[k]) * luminance(lighting.leafRadiance[k]);
    }
    found.distantFraction = light > 0 ? distant / light : 1;

    took();
    BounceTrial bounce = tryBounce(scene, emitters, all, part, rows, anchors, fit, lighting, options, progress);
    found.bounceSecondsPerRay = bounce.raySeconds / (2 * double(found.points) * pilotRays);
    found.enclosure = bounce.enclosure;
    found.bouncedFraction = bounce.fraction;
    found.bounceWorse = bounce.worse;

    const bool withBounce = found.bounceWorse < likelyBounce;
    found.lighting = withBounce ? std::move(bounce.lighting) : lighting;
    fit.anneal = false;
    if (withBounce) fit.bounce = &bounce.light;
    fit.iterations = 4;
    sharpenStrong(scene, visibility, nearField, samples, emitters, part, fit, found.lighting, progress);
    return found;
}

std::vector<double> pilotMisfits(const Scene& scene, const RadianceSamples& samples, const EmitterClusters& emitters,
                                 const MatteObservations& all, const std::vector<AlbedoPair>& pairs,
                                 const SolveOptions& options, Progress& progress, const FittedProbes& probes,
                                 const std::vector<Rgb>& bounce) {
    PilotRows pilot(scene, emitters, all, pairs, options, progress);
    LightAnchors anchors = lightAnchors(samples, emitters, pilot.lighting.leaves);
    for (const auto& probe : probes) anchors.probes.push_back(probeAnchor(*probe, pilot.lighting.leaves));
    if (!bounce.empty()) pilot.fit.bounce = &bounce;
    solveAlbedoFree(pilot.rows, pilot.part.matte, pilot.part.pairs, anchors, nullptr, pilot.fit, pilot.lighting,
                    progress, {});
    std::vector<Rgb> lit = litBy(pilot.rows, pilot.lighting);
    for (size_t i = 0; i < bounce.size(); ++i) lit[i] += bounce[i];
    std::vector<double> misfits;
    for (const AlbedoPair& p : pilot.part.pairs) misfits.push_back(pairMisfit(pilot.part.matte, p, lit, lit));
    return misfits;
}

std::vector<Rgb> pilotBounce(const Scene& scene, const RadianceSamples& samples, const EmitterClusters& emitters,
                             const MatteObservations& all, const std::vector<AlbedoPair>& pairs,
                             const SolveOptions& options, Progress& progress) {
    PilotRows pilot(scene, emitters, all, pairs, options, progress);
    const LightAnchors anchors = lightAnchors(samples, emitters, pilot.lighting.leaves);
    solveAlbedoFree(pilot.rows, pilot.part.matte, pilot.part.pairs, anchors, nullptr, pilot.fit, pilot.lighting,
                    progress, {});
    BounceTrial trial =
        tryBounce(scene, emitters, all, pilot.part, pilot.rows, anchors, pilot.fit, pilot.lighting, options, progress);
    return trial.worse < likelyBounce ? std::move(trial.light) : std::vector<Rgb>{};
}

MisfitFall misfitFall(const std::vector<double>& before, const std::vector<double>& after) {
    double whole = 0, fall = 0, squares = 0;
    for (size_t i = 0; i < before.size() && i < after.size(); ++i) {
        const double step = before[i] - after[i];
        whole += before[i];
        fall += step;
        squares += step * step;
    }
    return {fall / std::max(whole, 1e-30), fall / std::sqrt(std::max(squares, 1e-30)),
            std::min(before.size(), after.size())};
}

std::string MisfitFall::words() const {
    return fmt::format("misfit of {} pairs {:+.2f} %, {:.1f} standard errors", pairs, -100 * part, errors);
}

}  // namespace relamp
