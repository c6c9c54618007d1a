#include "solve/state/emitter_decision.h"

#include <algorithm>

#include "base/log.h"
#include "base/statistics.h"
#include "transport/incident.h"

namespace relamp {
namespace {

std::vector<EmitterSurface> surfacesOf(const Scene& scene, const EmitterClusters& clusters) {
    std::vector<EmitterSurface> surfaces;
    for (const EmitterCluster& e : clusters.emitters) surfaces.push_back(orderedEmitterSurface(scene, e));
    return surfaces;
}

/// Levels that no photograph tells count as full.
EmitterLevels levelsOf(const EmitterClusters& clusters) {
    EmitterLevels levels;
    for (const EmitterCluster& e : clusters.emitters)
        for (size_t s = 0; s < e.inState.size(); ++s) {
            if (levels.size() <= s) levels.resize(s + 1);
            levels[s].push_back(e.inState[s] < 0 ? 1.0f : e.inState[s]);
        }
    return levels;
}

/// At most 64 of the patch's vertices that a photograph shows, spread over it.
std::vector<uint32_t> someOf(const SolveInput& in, const EmitterCluster& cluster) {
    std::vector<uint32_t> some, spread = cluster.vertices;
    std::sort(spread.begin(), spread.end(),
              [&](uint32_t a, uint32_t b) { return in.scene.rank[a] < in.scene.rank[b]; });
    const size_t step = std::max<size_t>(1, spread.size() / 64);
    for (size_t i = 0; i < spread.size(); i += step)
        if (in.samples.countOf(spread[i]) > 0) some.push_back(spread[i]);
    if (some.empty()) some.assign(1, cluster.vertices[0]);
    return some;
}

/// Albedo that emitter e would need to reflect what it shows of everything but itself. The lower quartile over `rows`:
/// normals and shadows of an inexact mesh take light from some vertices of a patch, and what the others can reflect is
/// no emitter.
float demandedAlbedo(const EmitterClusters& clusters, size_t e, const InfluenceMatrix& rows, const Lighting& lighting) {
    const EmitterCluster& cluster = clusters.emitters[e];
    // Asked where it shines most: others may be off there.
    const size_t state =
        size_t(std::max_element(cluster.inState.begin(), cluster.inState.end()) - cluster.inState.begin());
    std::vector<float> demanded;
    for (size_t i = 0; i < rows.rows; ++i) {
        Rgb lit(0);
        for (size_t k = 0; k < lighting.leaves.size(); ++k)
            if (lighting.leaves.shines(k, state)) lit += rows.row(i)[k] * lighting.leafRadiance[k];
        for (size_t o = 0; o < clusters.emitters.size(); ++o)
            if (o != e)
                lit += rows.row(i)[lighting.leaves.size() + o] *
                       (std::max(0.0f, clusters.emitters[o].levelIn(state)) * lighting.emitterRadiance[o]);
        float worst = 0;
        for (int c = 0; c < 3; ++c)
            if (cluster.radiance[c] > 0.2f * maxChannel(cluster.radiance))
                worst = std::max(worst, cluster.radiance[c] / std::max(lit[c], 1e-12f));
        demanded.push_back(worst);
    }
    return std::min(selectQuantile(demanded, 0.25), 1e6f);
}

}  // namespace

EmitterDecision EmitterDecision::of(const Scene& scene, const EmitterClusters& found, bool nearField) {
    EmitterDecision d;
    d.clusters = found;
    if (!nearField) {
        d.clusters.emitters.clear();
        d.clusters.candidates.clear();
    }
    struct Entry {
        EmitterCluster cluster;
        bool suspect;
    };
    std::vector<Entry> all;
    for (EmitterCluster& c : d.clusters.emitters) all.push_back({std::move(c), false});
    for (EmitterCluster& c : d.clusters.candidates) all.push_back({std::move(c), true});
    std::stable_sort(all.begin(), all.end(),
                     [](const Entry& a, const Entry& b) { return emitterPower(a.cluster) > emitterPower(b.cluster); });
    d.clusters.emitters.clear();
    d.clusters.candidates.clear();
    for (Entry& e : all) {
        d.clusters.emitters.push_back(std::move(e.cluster));
        d.suspect.push_back(e.suspect);
    }
    indexEmitters(scene, d.clusters);
    d.surfaces = surfacesOf(scene, d.clusters);
    d.levels = levelsOf(d.clusters);
    return d;
}

EmitterDecision EmitterDecision::of(const Scene& scene, EmitterClusters clusters, std::vector<uint8_t> suspect) {
    for (EmitterCluster& e : clusters.emitters) {
        for (uint32_t v : e.vertices)
            if (v >= scene.mesh.vertexCount()) throw Error("the checkpoint names a vertex that does not exist");
        for (uint32_t t : e.triangles)
            if (t >= scene.mesh.triangles.size()) throw Error("the checkpoint names a triangle that does not exist");
        if (!e.level.empty() && e.level.size() != e.vertices.size())
            throw Error("the checkpoint holds {} levels of an emitter of {} vertices", e.level.size(),
                        e.vertices.size());
        rebuildPattern(scene.mesh, e);
    }
    EmitterDecision d{std::move(clusters), std::move(suspect), {}, {}};
    indexEmitters(scene, d.clusters);
    d.surfaces = surfacesOf(scene, d.clusters);
    d.levels = levelsOf(d.clusters);
    return d;
}

Lighting EmitterDecision::inState(Lighting lighting, size_t state) const {
    for (size_t i = 0; i < lighting.leaves.size(); ++i)
        if (!lighting.leaves.shines(i, state)) lighting.leafRadiance[i] = Rgb(0);
    for (size_t e = 0; !levels.empty() && e < lighting.emitterRadiance.size(); ++e)
        lighting.emitterRadiance[e] *= levels[state][e];
    return lighting;
}

void EmitterDecision::dim(float* row, const LightLeaves& leaves, size_t state) const {
    for (size_t i = 0; i < leaves.size(); ++i)
        if (!leaves.shines(i, state)) row[i] = 0;
    for (size_t e = 0; !levels.empty() && e < levels[state].size(); ++e) row[leaves.size() + e] *= levels[state][e];
}

std::vector<uint8_t> EmitterDecision::skip() const {
    std::vector<uint8_t> skip(clusters.emitterOfVertex.size(), 0);
    for (size_t v = 0; v < skip.size(); ++v) skip[v] = clusters.emitterOfVertex[v] >= 0;
    return skip;
}

bool EmitterDecision::judge(const SolveInput& in, const Lighting& lighting,
                            const std::function<InfluenceMatrix(const std::vector<uint32_t>&)>& rowsOf) {
    std::vector<EmitterCluster> kept;
    for (size_t e = 0; e < clusters.emitters.size(); ++e) {
        EmitterCluster& cluster = clusters.emitters[e];
        cluster.evidence.demandedAlbedo = demandedAlbedo(clusters, e, rowsOf(someOf(in, cluster)), lighting);
        logInfo("patch of radiance {:.3g} {:.3g} {:.3g}: reflection would need an albedo of {:.3g}", cluster.radiance.x,
                cluster.radiance.y, cluster.radiance.z, cluster.evidence.demandedAlbedo);
        // What is hardly brighter than other surfaces are is a light only if far from what reflects.
        constexpr float asBright = 2, brighter = 4, reflects = 1.5f, mayReflect = 2.5f;
        const float above = (cluster.evidence.sceneContrast - asBright) / (brighter - asBright);
        const float most = glm::mix(mayReflect, reflects, std::clamp(above, 0.0f, 1.0f));
        if (suspect[e] && cluster.evidence.demandedAlbedo < most)
            clusters.rejected.push_back({cluster.centroid, cluster.radiance, cluster.evidence,
                                         "the other lights explain it as a reflecting surface"});
        else kept.push_back(cluster);
    }
    const bool changed = kept.size() != clusters.emitters.size();
    clusters.emitters = std::move(kept);
    suspect.assign(clusters.emitters.size(), 0);
    indexEmitters(in.scene, clusters);
    if (changed) {
        surfaces = surfacesOf(in.scene, clusters);
        levels = levelsOf(clusters);
    }
    return changed;
}

}  // namespace relamp
