#include "clusters/emitter_clusters.h"

#include <set>

#include "base/box.h"
#include "base/log.h"
#include "base/statistics.h"
#include "clusters/emitter_pixels.h"
#include "clusters/false_emitters.h"
#include "clusters/patch_extent.h"
#include "clusters/patches.h"
#include "clusters/thin_emitters.h"
#include "scene/rim.h"

namespace relamp {
namespace {

std::vector<uint8_t> withinOneRing(const Scene& scene, const std::vector<uint8_t>& of) {
    std::vector<uint8_t> result = of;
    for (uint32_t v = 0; v < of.size(); ++v)
        for (uint32_t e = scene.graph.start[v]; of[v] && e < scene.graph.start[v + 1]; ++e)
            result[scene.graph.to[e]] = 1;
    return result;
}

/// measureTriangles; its triangles are those of its vertices.
void measure(const Scene& scene, EmitterCluster& cluster) {
    std::vector<uint8_t> mine(scene.mesh.vertexCount(), 0);
    for (uint32_t v : cluster.vertices) mine[v] = 1;
    cluster.triangles.clear();
    for (uint32_t t = 0; t < scene.mesh.triangles.size(); ++t) {
        const Triangle& i = scene.mesh.triangles[t];
        if (mine[i[0]] && mine[i[1]] && mine[i[2]]) cluster.triangles.push_back(t);
    }
    measureTriangles(scene, cluster);
}

Vec3 middleOf(const Scene& scene, size_t vertices) {
    Box box;
    for (size_t v = 0; v < vertices; ++v)
        if (scene.referenced[v]) box.grow(scene.mesh.positions[v] * scene.axes);
    return scene.axes * box.centre();
}

/// The spheres that stand for emitters without geometry: they are emitters because somebody said so, and how bright
/// they are is solved for.
void addProxyEmitters(const Scene& scene, const Capture& capture, const RadianceSamples& samples, float brightness,
                      EmitterClusters& result) {
    for (size_t i = 0; i < capture.proxies.size(); ++i) {
        const ProxyLight& proxy = capture.proxies[i];
        const size_t before = capture.proxies.size() - i,
                     firstVertex = scene.mesh.vertexCount() - before * proxyVertices;
        EmitterCluster cluster;
        for (size_t v = 0; v < proxyVertices; ++v) cluster.vertices.push_back(uint32_t(firstVertex + v));
        measure(scene, cluster);
        cluster.positionSigma = proxy.sigma;
        if (proxy.observed()) {
            cluster.radiance = proxy.radiance;
            cluster.radianceSigma = 0.005f;
            cluster.fitted = true;
            std::set<uint32_t> views;
            for (const uint32_t v : cluster.vertices)
                for (uint32_t s = samples.start[v]; s < samples.start[v + 1]; ++s)
                    views.insert(samples.samples[s].view);
            cluster.evidence.viewsSeen = int(views.size());
            result.emitters.push_back(std::move(cluster));
            continue;
        }
        cluster.unobserved = true;
        cluster.lobe = proxy.lobe;
        // A guess: half of what lights the middle of the scene, on an albedo of 0.3.
        const float distance = glm::length(Vec3(proxy.centre) - middleOf(scene, firstVertex));
        cluster.radiance = Rgb(std::max(brightness, 1e-9f) / 0.6f *
                               std::max(1.0f, distance * distance / (proxy.radius * proxy.radius)));
        cluster.radianceSigma = 1;
        result.emitters.push_back(std::move(cluster));
    }
}

/// What a part of uneven radiance sends on the whole: the mean over its surface.
Rgb meanRadiance(const Scene& scene, const std::vector<VertexRadiance>& seen, const EmitterCluster& cluster) {
    DVec3 sum(0);
    double area = 0;
    for (const uint32_t t : cluster.triangles)
        for (const uint32_t v : scene.mesh.triangles[t])
            if (seen[v].weight > 0.1f) {
                const double a = scene.mesh.triangleArea(t);
                sum += a * DVec3(seen[v].radiance);
                area += a;
            }
    return area > 0 ? Rgb(sum / area) : cluster.radiance;
}

/// The search for emitters: what it knows of the scene, and what it has found so far.
class ClusterSearch {
public:
    ClusterSearch(const Scene& scene, const Capture& capture, const RadianceSamples& samples,
                  const ClusterOptions& options)
        : scene_(scene), capture_(capture), samples_(samples), options_(options) {
        seen_ = vertexRadiance(scene, samples);
        glimpses_ = glimpsesOf(scene, capture, samples, seen_);
        const size_t proxies = std::min(seen_.size(), capture.proxies.size() * proxyVertices);
        for (size_t v = seen_.size() - proxies; v < seen_.size(); ++v) seen_[v] = {};
        std::vector<float> values;
        for (const VertexRadiance& r : seen_)
            if (r.weight > 0.1f) values.push_back(maxChannel(r.radiance));
        nothingSeen = values.empty();
        median_ = lowerMedianOf(std::move(values));
        result.emitterOfVertex.assign(scene.mesh.vertexCount(), -1);
        result.emitterOfTriangle.assign(scene.mesh.triangles.size(), -1);
        addProxyEmitters(scene, capture, samples, median_, result);
    }

    EmitterClusters result;
    bool nothingSeen = false;

    void findPatches() {
        patches_ = growPatches(scene_, seen_, options_.minContrast * median_, options_.tolerance);
        mergeLikePatches(scene_, patches_, seen_);
    }

    /// Each patch becomes an emitter, a candidate or a rejected patch.
    void judgePatches() {
        std::vector<int> patchOf(seen_.size(), -1);
        for (size_t i = 0; i < patches_.size(); ++i)
            for (uint32_t v : patches_[i].vertices) patchOf[v] = int(i);
        measureEnvirons(patchOf);
        for (size_t i = 0; i < patches_.size(); ++i) {
            judgePatch(scene_, samples_, seen_, patchOf, int(i), reference_, patches_[i]);
            if (splitPatch(i, patchOf)) judgePatch(scene_, samples_, seen_, patchOf, int(i), reference_, patches_[i]);
            takePatch(i);
        }
    }

    /// Bright parts none of whose patches is an emitter by itself, but which are one as a whole.
    void findUnevenEmitters() {
        for (EmitterPatch& part : brightPatches(scene_, seen_, 0.75f * options_.unevenContrast * reference_,
                                                withoutSteps(scene_, patches_, accepted_))) {
            std::vector<int> inPatch(seen_.size(), -1);
            for (uint32_t v : part.vertices) inPatch[v] = 0;
            judgePatch(scene_, samples_, seen_, inPatch, 0, reference_, part);
            const EmitterEvidence& e = part.evidence;
            if (e.sceneContrast < options_.unevenContrast || changesWithView(part, options_) || !e.viewsAgree ||
                e.edgeDrop > 0.5f || tooFewPixels(scene_, capture_, samples_, part) ||
                onlyRim(scene_, nearRim_, seenOfComponent_, part) ||
                litByEmitters(scene_, seen_, result.emitters, part))
                continue;
            dropInside(inPatch);
            EmitterCluster cluster;
            cluster.vertices = part.vertices;
            cluster.radiance = part.radiance;
            cluster.evidence = e;
            complete(scene_, seen_, glimpses_, taken_, cluster);
            measure(scene_, cluster);
            if (cluster.triangles.empty()) continue;
            for (uint32_t v : cluster.vertices) taken_[v] = 1;
            cluster.radiance = meanRadiance(scene_, seen_, cluster);
            cluster.radianceSigma =
                std::max(0.02f, 0.1f * e.uniformity);  // what it sends one way is not what it sends another
            size_t kept = 0;
            for (size_t r = 0; r < result.rejected.size(); ++r) {
                if (inPatch[patches_[rejectedPatch_[r]].vertices[0]] == 0) continue;  // a part of this one
                if (kept != r) {
                    result.rejected[kept] = result.rejected[r];
                    rejectedPatch_[kept] = rejectedPatch_[r];
                }
                ++kept;
            }
            result.rejected.resize(kept);
            rejectedPatch_.resize(kept);
            result.candidates.push_back(std::move(cluster));
        }
    }

    /// Patches that were refused as a glow become candidates where they are bright and even, as what shading fades out
    /// from is not: a small ball whose mesh lies within it shows its rim beside its vertices.
    void findEvenEmitters() {
        constexpr float even = 0.01f;
        for (size_t r = result.rejected.size(); r-- > 0;) {
            const EmitterEvidence& e = result.rejected[r].evidence;
            const EmitterPatch& patch = patches_[rejectedPatch_[r]];
            const auto taken = [&](uint32_t v) { return taken_[v] != 0; };
            if (result.rejected[r].reason != fadesOutReason || e.sceneContrast < options_.certainContrast ||
                e.uniformity >= even || e.viewSpread >= even || e.clippedFraction > 0 ||
                tooFewPixels(scene_, capture_, samples_, patch) ||
                std::any_of(patch.vertices.begin(), patch.vertices.end(), taken))
                continue;
            EmitterCluster cluster = clusterOf(patch);
            complete(scene_, seen_, glimpses_, taken_, cluster);
            measure(scene_, cluster);
            if (cluster.triangles.empty()) continue;
            for (const uint32_t v : patch.vertices) accepted_[v] = 1;
            for (const uint32_t v : cluster.vertices) taken_[v] = 1;
            result.candidates.push_back(std::move(cluster));
            result.rejected.erase(result.rejected.begin() + ptrdiff_t(r));
            rejectedPatch_.erase(rejectedPatch_.begin() + ptrdiff_t(r));
        }
    }

    /// Strips of light of a pixel or two, which hold no clean observation.
    void findThinEmitters() {
        for (ThinEmitter& thin :
             thinEmitters(scene_, capture_, samples_, seen_, 0.5f * options_.unevenContrast * reference_, taken_)) {
            EmitterEvidence& e = thin.evidence;
            e.sceneContrast = maxChannel(thin.radiance) / std::max(reference_, 1e-20f);
            // Pixels that are covered whole must be there, and alike.
            if (e.sceneContrast < options_.unevenContrast || e.viewSpread > 0.12f || e.uniformity > 0.06f) continue;
            EmitterCluster cluster;
            cluster.triangles = std::move(thin.triangles);
            std::set<uint32_t> vertices;
            for (const uint32_t t : cluster.triangles)
                vertices.insert(scene_.mesh.triangles[t].begin(), scene_.mesh.triangles[t].end());
            cluster.vertices.assign(vertices.begin(), vertices.end());
            cluster.radiance = thin.radiance;
            cluster.radianceSigma = thin.radianceSigma;
            cluster.evidence = e;
            measureTriangles(scene_, cluster);
            if (showsNeighbour(cluster)) continue;
            for (const uint32_t v : cluster.vertices) taken_[v] = 1;
            (e.sceneContrast >= options_.certainContrast ? result.emitters : result.candidates)
                .push_back(std::move(cluster));
        }
    }

    /// Emitters take in what only pixels show of them, strongest first.
    void growEmitters() {
        std::stable_sort(
            result.emitters.begin(), result.emitters.end(),
            [](const EmitterCluster& a, const EmitterCluster& b) { return emitterPower(a) > emitterPower(b); });
        std::vector<uint8_t> taken(scene_.mesh.vertexCount(), 0);
        for (const std::vector<EmitterCluster>* list : {&result.emitters, &result.candidates})
            for (const EmitterCluster& e : *list)
                for (uint32_t v : e.vertices) taken[v] = 1;
        for (EmitterCluster& e : result.emitters) {
            if (e.unobserved || e.fitted || growByPixels(scene_, capture_, samples_, taken, e) == 0) continue;
            const float before = e.area;
            for (uint32_t v : e.vertices) taken[v] = 1;
            measureTriangles(scene_, e);
            logInfo("a light grows by {:.1f} %, as pixels show it", 100 * (e.area / before - 1));
        }
    }

    /// Which emitters shine unevenly, and how.
    void takePatterns() {
        for (std::vector<EmitterCluster>* list : {&result.emitters, &result.candidates})
            for (EmitterCluster& e : *list) takeEmissionPattern(scene_, seen_, e);
    }

    /// What a mesh that is not exact makes of an emitter.
    void dropFalseEmitters() {
        joinSplitEmitters(scene_, result.emitters);
        joinBlurredParts(scene_, result.emitters, result.candidates);
        const std::vector<EmitterCluster> emitters = result.emitters;
        // What shows a brighter candidate is as little an emitter as what shows a certain one.
        std::vector<EmitterCluster> shining = emitters;
        shining.insert(shining.end(), result.candidates.begin(), result.candidates.end());
        const auto dropFalse = [&](std::vector<EmitterCluster>& clusters) {
            std::erase_if(clusters, [&](EmitterCluster& e) {
                if (e.unobserved || e.fitted) return false;
                const char* reason = nullptr;
                for (const EmitterCluster& emitter : shining)
                    if (emitterPower(emitter) > emitterPower(e) &&
                        showsEmitterPastEdge(scene_, capture_, samples_, emitter, e))
                        reason = "shows a light past the edge of the mesh";
                constexpr float plausible = 0.9f;
                if (const float albedo = albedoBesideEmitters(scene_, emitters, e); !reason && albedo < plausible) {
                    e.evidence.demandedAlbedo = albedo;
                    reason = "a light beside it lights it as brightly";
                }
                if (!reason) return false;
                result.rejected.push_back({e.centroid, e.radiance, e.evidence, reason});
                // A reconstruction may have closed what is open there.
                if (std::any_of(emitters.begin(), emitters.end(),
                                [](const EmitterCluster& other) { return other.fitted; }))
                    result.rejected.back().besideBall = e.vertices;
                return true;
            });
        };
        dropFalse(result.emitters);
        dropFalse(result.candidates);
    }

private:
    /// Thin parts close to an emitter of that radiance show it past an edge.
    bool showsNeighbour(const EmitterCluster& thin) const {
        return std::any_of(result.emitters.begin(), result.emitters.end(), [&](const EmitterCluster& e) {
            const float ratio = maxChannel(thin.radiance) / std::max(maxChannel(e.radiance), 1e-20f);
            return ratio > 0.8f && ratio < 1.25f && glm::distance(thin.centroid, e.centroid) < 4 * std::sqrt(e.area);
        });
    }

    void measureEnvirons(const std::vector<int>& patchOf) {
        // The scene's ordinary brightness: view-independent surfaces outside every strikingly bright patch.
        std::vector<float> ordinary;
        for (uint32_t v = 0; v < seen_.size(); ++v)
            if (seen_[v].weight > 0.1f && seen_[v].spread < 0.15f &&
                (patchOf[v] < 0 || maxChannel(seen_[v].radiance) < 6 * median_))
                ordinary.push_back(maxChannel(seen_[v].radiance));
        reference_ = ordinary.size() > 20 ? quantileOf(std::move(ordinary), 0.95) : median_;

        nearRim_ = withinOneRing(scene_, rimVertices(scene_.mesh));
        seenOfComponent_.assign(scene_.components, 0);
        for (uint32_t v = 0; v < seen_.size(); ++v) seenOfComponent_[scene_.component[v]] += seen_[v].weight > 0.1f;
        taken_.assign(seen_.size(), 0);
        accepted_.assign(seen_.size(), 0);
        for (const EmitterCluster& e : result.emitters)
            for (uint32_t v : e.vertices) taken_[v] = 1;
    }

    /// Takes back what was accepted inside a part (`inPart` 0) that is an emitter as a whole.
    void dropInside(const std::vector<int>& inPart) {
        const auto inside = [&](const EmitterCluster& e) {
            if (e.unobserved || e.fitted ||
                std::none_of(e.vertices.begin(), e.vertices.end(), [&](uint32_t v) { return inPart[v] == 0; }))
                return false;
            for (const uint32_t v : e.vertices) taken_[v] = accepted_[v] = 0;
            return true;
        };
        std::erase_if(result.emitters, inside);
        std::erase_if(result.candidates, inside);
    }

    /// Lamps that are alike on one connected surface become patches of their own, the later ones at the list's end.
    bool splitPatch(size_t i, std::vector<int>& patchOf) {
        const std::vector<uint32_t>& whole = patches_[i].vertices;
        if (2 * whole.size() > seenOfComponent_[scene_.component[whole[0]]]) return false;
        if (!reasonAgainst(patches_[i]).empty()) return false;
        std::vector<std::vector<uint32_t>> parts = partsApart(scene_, whole);
        std::erase_if(parts, [](const std::vector<uint32_t>& part) { return part.size() < smallestPatch; });
        if (parts.size() < 2) return false;
        patches_[i].vertices = std::move(parts[0]);
        for (size_t k = 1; k < parts.size(); ++k) {
            for (const uint32_t v : parts[k]) patchOf[v] = int(patches_.size());
            patches_.emplace_back().vertices = std::move(parts[k]);
        }
        return true;
    }

    /// Why the patch is no emitter; empty when it may be one.
    std::string reasonAgainst(const EmitterPatch& patch) const {
        const EmitterEvidence& e = patch.evidence;
        if (e.sceneContrast < options_.minContrast && e.localContrast < options_.minContrast)
            return "no brighter than the surfaces around it";
        if (changesWithView(patch, options_)) return "changes with the view, as a reflection does";
        if (!e.viewsAgree && e.uniformity > 0.03f)
            return "hardly seen from two sides and not uniform: could be a reflection";
        // A highlight is seldom far brighter than bright surfaces; the less so, the more uniform a light must be.
        if (e.uniformity > 0.06f * std::max(1.0f, e.sceneContrast / options_.minContrast) && e.uniformity <= 0.12f)
            return "hardly brighter than other surfaces and not uniform";
        if (e.uniformity > 0.12f) return "its radiance varies as shading does";
        if (e.edgeDrop > 0.8f) return fadesOutReason;
        if (tooFewPixels(scene_, capture_, samples_, patch)) return tooFewPixelsReason;
        if (onlyRim(scene_, nearRim_, seenOfComponent_, patch))
            return "lies at the rim of a hole, where a pixel may show what is behind";
        return "";
    }

    static EmitterCluster clusterOf(const EmitterPatch& patch) {
        EmitterCluster cluster;
        cluster.vertices = patch.vertices;
        cluster.radiance = patch.radiance;
        cluster.radianceSigma =
            std::max(0.002f, patch.evidence.uniformity / std::sqrt(float(std::max<size_t>(1, patch.vertices.size()))));
        cluster.evidence = patch.evidence;
        return cluster;
    }

    void takePatch(size_t i) {
        EmitterPatch& patch = patches_[i];
        const EmitterEvidence& e = patch.evidence;
        patch.reject = reasonAgainst(patch);
        EmitterCluster cluster = clusterOf(patch);
        if (patch.reject.empty()) {
            complete(scene_, seen_, glimpses_, taken_, cluster);
            for (uint32_t v : cluster.vertices) taken_[v] = 1;
        }
        measure(scene_, cluster);
        if (patch.reject.empty() && cluster.triangles.empty()) patch.reject = "covers no whole triangle";
        if (!patch.reject.empty()) {
            if (e.sceneContrast > 1 || e.localContrast > 2) {
                result.rejected.push_back({cluster.centroid, patch.radiance, e, patch.reject});
                rejectedPatch_.push_back(i);
            }
            return;
        }
        for (uint32_t v : patch.vertices) accepted_[v] = 1;
        (e.sceneContrast >= options_.certainContrast && e.uniformity < 0.06f && e.viewSpread <= 0.12f
             ? result.emitters
             : result.candidates)
            .push_back(std::move(cluster));
    }

    const Scene& scene_;
    const Capture& capture_;
    const RadianceSamples& samples_;
    const ClusterOptions& options_;
    std::vector<VertexRadiance> seen_;
    std::vector<float> glimpses_;       ///< of vertices without observation
    float median_ = 0, reference_ = 0;  ///< brightness of all vertices, and of ordinary surfaces (95 %)
    std::vector<EmitterPatch> patches_;
    std::vector<uint8_t> nearRim_;
    std::vector<uint32_t> seenOfComponent_;
    std::vector<uint8_t> taken_, accepted_;  ///< vertices of accepted patches, with what completes them and without
    std::vector<size_t> rejectedPatch_;      ///< of each in result.rejected
};

void logClusters(const EmitterClusters& result) {
    for (const EmitterCluster& e : result.emitters)
        logInfo(
            "{}: radiance {:.4g} {:.4g} {:.4g}, {} vertices, scene contrast {:.1f}, local {:.1f}, uniform {:.3f}, view "
            "spread {:.3f}, edge {:.2f}",
            e.id, e.radiance.x, e.radiance.y, e.radiance.z, e.vertices.size(), e.evidence.sceneContrast,
            e.evidence.localContrast, e.evidence.uniformity, e.evidence.viewSpread, e.evidence.edgeDrop);
    for (const EmitterCluster& e : result.candidates)
        logInfo(
            "candidate: radiance {:.4g} {:.4g} {:.4g}, {} vertices, scene contrast {:.1f}, local {:.1f}, uniform "
            "{:.3f}, view spread {:.3f}, edge {:.2f}",
            e.radiance.x, e.radiance.y, e.radiance.z, e.vertices.size(), e.evidence.sceneContrast,
            e.evidence.localContrast, e.evidence.uniformity, e.evidence.viewSpread, e.evidence.edgeDrop);
}

}  // namespace

void measureTriangles(const Scene& scene, EmitterCluster& cluster) {
    double area = 0;
    DVec3 centre(0), normal(0);
    for (const uint32_t t : cluster.triangles) {
        const Triangle& i = scene.mesh.triangles[t];
        const double a = scene.mesh.triangleArea(t);
        area += a;
        centre += a * DVec3(scene.mesh.positions[i[0]] + scene.mesh.positions[i[1]] + scene.mesh.positions[i[2]]) / 3.0;
        normal += a * DVec3(scene.mesh.faceNormal(t));
    }
    cluster.area = float(area);
    if (area > 0) {
        cluster.centroid = Vec3(centre / area);
        cluster.normal = glm::length(normal) > 0.1 * area ? Vec3(glm::normalize(normal)) : Vec3(0);
    }
}

void indexEmitters(const Scene& scene, EmitterClusters& clusters) {
    std::erase_if(clusters.emitters, [](const EmitterCluster& e) { return e.triangles.empty(); });
    std::stable_sort(
        clusters.emitters.begin(), clusters.emitters.end(),
        [](const EmitterCluster& a, const EmitterCluster& b) { return emitterPower(a) > emitterPower(b); });
    clusters.emitterOfVertex.assign(scene.mesh.vertexCount(), -1);
    clusters.emitterOfTriangle.assign(scene.mesh.triangles.size(), -1);
    for (size_t i = 0; i < clusters.emitters.size(); ++i) {
        EmitterCluster& e = clusters.emitters[i];
        e.id = fmt::format("emitter-{}", i + 1);
        for (uint32_t v : e.vertices) clusters.emitterOfVertex[v] = int(i);
        for (uint32_t t : e.triangles) clusters.emitterOfTriangle[t] = int(i);
    }
}

EmitterClusters clusterEmitters(const Scene& scene, const Capture& capture, const RadianceSamples& samples,
                                const ClusterOptions& options, Progress& progress) {
    progress.begin("Emitter clusters", 4);
    ClusterSearch search(scene, capture, samples, options);
    if (search.nothingSeen) {
        indexEmitters(scene, search.result);
        return std::move(search.result);
    }
    progress.advance();
    search.findPatches();
    progress.advance();
    search.judgePatches();
    search.findUnevenEmitters();
    search.findEvenEmitters();
    search.findThinEmitters();
    search.dropFalseEmitters();
    search.growEmitters();
    search.takePatterns();
    progress.advance();
    indexEmitters(scene, search.result);
    logClusters(search.result);
    progress.advance();
    return std::move(search.result);
}

}  // namespace relamp
