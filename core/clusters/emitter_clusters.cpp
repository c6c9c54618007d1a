#include "clusters/emitter_clusters.h"

#include <algorithm>
#include <numeric>
#include <queue>
#include <set>

#include "base/box.h"
#include "base/log.h"
#include "base/statistics.h"
#include "clusters/false_emitters.h"
#include "scene/rim.h"

namespace relamp {
namespace {

/// What the views agree on about a vertex.
struct VertexRadiance {
    Rgb radiance{0};
    float spread = 0;  ///< relative difference between views; -1 with one view
    float weight = 0;  ///< best observation weight; 0: unobserved
};

std::vector<VertexRadiance> summarise(const Scene& scene, const RadianceSamples& samples) {
    std::vector<VertexRadiance> result(scene.mesh.vertexCount());
    for (uint32_t v = 0; v < result.size(); ++v) {
        VertexRadiance& r = result[v];
        // Clipped observations are lower bounds: they count only where there is nothing else.
        float best = 0, bestOpen = 0;
        for (uint32_t s = samples.start[v]; s < samples.start[v + 1]; ++s) {
            best = std::max(best, samples.samples[s].weight);
            if (!samples.samples[s].clipped) bestOpen = std::max(bestOpen, samples.samples[s].weight);
        }
        const bool openOnly = bestOpen >= 0.05f;
        if (openOnly) best = bestOpen;
        if (best < 0.05f) continue;
        std::vector<float> channel[3];
        for (uint32_t s = samples.start[v]; s < samples.start[v + 1]; ++s) {
            if (samples.samples[s].weight < 0.4f * best || (openOnly && samples.samples[s].clipped)) continue;
            for (int c = 0; c < 3; ++c) channel[c].push_back(samples.samples[s].radiance[c]);
        }
        for (int c = 0; c < 3; ++c) r.radiance[c] = lowerMedianOf(channel[c]);
        r.weight = best;
        r.spread = -1;
        if (channel[0].size() > 1) {
            const float scale = std::max(maxChannel(r.radiance), 1e-20f);
            r.spread = 0;
            for (int c = 0; c < 3; ++c) {
                const auto [low, high] = std::minmax_element(channel[c].begin(), channel[c].end());
                r.spread = std::max(r.spread, (*high - *low) / scale);
            }
        }
    }
    return result;
}

struct Patch {
    std::vector<uint32_t> vertices;
    Rgb radiance{0};
    EmitterEvidence evidence;
    float commonSpread = 0;  ///< relative difference between views of the patch as a whole: an exposure that is off, a
                             ///< emitter that shines more one way
    float ownSpread = 0;     ///< what is left of viewSpread without that: a reflection that wanders over the patch
    std::string reject;
};

constexpr size_t minPatch = 4;

bool alike(const Rgb& a, const Rgb& b, float tolerance) {
    return glm::length(a - b) <= tolerance * std::max(glm::length(a), glm::length(b));
}

/// Grows patches of like radiance from the brightest vertices down.
std::vector<Patch> growPatches(const Scene& scene, const std::vector<VertexRadiance>& seen, float floor,
                               float tolerance) {
    std::vector<uint32_t> order;
    for (uint32_t v = 0; v < seen.size(); ++v)
        if (seen[v].weight > 0.1f && maxChannel(seen[v].radiance) > floor) order.push_back(v);
    std::sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) {
        const float x = maxChannel(seen[a].radiance), y = maxChannel(seen[b].radiance);
        return x != y ? x > y : scene.rank[a] < scene.rank[b];
    });
    std::vector<uint8_t> taken(seen.size(), 0);
    std::vector<Patch> patches;
    std::vector<uint32_t> stack, around;
    for (uint32_t seed : order) {
        if (taken[seed]) continue;
        Patch patch;
        Rgb sum(0);
        stack.assign(1, seed);
        taken[seed] = 1;
        while (!stack.empty()) {
            const uint32_t v = stack.back();
            stack.pop_back();
            patch.vertices.push_back(v);
            sum += seen[v].radiance;
            const Rgb mean = sum / float(patch.vertices.size());
            // What joins rests on the mean so far, so the way is one that does not know the file's order.
            around.assign(scene.graph.to.begin() + scene.graph.start[v],
                          scene.graph.to.begin() + scene.graph.start[v + 1]);
            std::sort(around.begin(), around.end(),
                      [&](uint32_t a, uint32_t b) { return scene.rank[a] < scene.rank[b]; });
            for (const uint32_t u : around) {
                if (taken[u] || seen[u].weight <= 0 || !alike(seen[u].radiance, mean, tolerance)) continue;
                taken[u] = 1;
                stack.push_back(u);
            }
        }
        if (patch.vertices.size() < minPatch) continue;
        std::sort(patch.vertices.begin(), patch.vertices.end());
        patches.push_back(std::move(patch));
    }
    return patches;
}

/// Patches of one radiance on one connected component are one emitter seen in parts.
void mergeLikePatches(const Scene& scene, std::vector<Patch>& patches, const std::vector<VertexRadiance>& seen) {
    for (size_t i = 0; i < patches.size(); ++i)
        for (size_t j = i + 1; j < patches.size();) {
            Rgb a(0), b(0);
            for (uint32_t v : patches[i].vertices) a += seen[v].radiance / float(patches[i].vertices.size());
            for (uint32_t v : patches[j].vertices) b += seen[v].radiance / float(patches[j].vertices.size());
            if (scene.component[patches[i].vertices[0]] == scene.component[patches[j].vertices[0]] &&
                alike(a, b, 0.1f)) {
                patches[i].vertices.insert(patches[i].vertices.end(), patches[j].vertices.begin(),
                                           patches[j].vertices.end());
                std::sort(patches[i].vertices.begin(), patches[i].vertices.end());
                patches.erase(patches.begin() + ptrdiff_t(j));
            } else {
                ++j;
            }
        }
}

/// Takes apart how a patch differs between views: as a whole, and vertex by vertex.
void splitSpread(const RadianceSamples& samples, const std::vector<VertexRadiance>& seen, Patch& patch) {
    const auto ratios = [&](uint32_t v, const auto& each) {
        const float own = maxChannel(seen[v].radiance);
        for (uint32_t s = samples.start[v]; own > 0 && s < samples.start[v + 1]; ++s)
            if (const RadianceSample& observation = samples.samples[s];
                observation.weight >= 0.4f * seen[v].weight && !observation.clipped)
                each(observation.view, maxChannel(observation.radiance) / own);
    };
    std::vector<std::vector<float>> ofView;
    for (const uint32_t v : patch.vertices)
        ratios(v, [&](uint32_t view, float ratio) {
            if (ofView.size() <= view) ofView.resize(view + 1);
            ofView[view].push_back(ratio);
        });
    std::vector<float> common(ofView.size(), 0);
    float low = 1e30f, high = 0;
    for (size_t view = 0; view < ofView.size(); ++view) {
        if (ofView[view].size() < minPatch) continue;
        common[view] = lowerMedianOf(ofView[view]);
        low = std::min(low, common[view]);
        high = std::max(high, common[view]);
    }
    patch.commonSpread = high > 0 ? (high - low) / high : 0;
    std::vector<float> own;
    for (const uint32_t v : patch.vertices) {
        float least = 1e30f, most = 0;
        ratios(v, [&](uint32_t view, float ratio) {
            if (!(common[view] > 0)) return;
            least = std::min(least, ratio / common[view]);
            most = std::max(most, ratio / common[view]);
        });
        if (most > least) own.push_back((most - least) / most);
    }
    patch.ownSpread = lowerMedianOf(own);
}

/// A reflection moves with the view. What is very bright and changes as a whole, and not much, is an emitter all the
/// same.
bool changesWithView(const Patch& patch, const ClusterOptions& options) {
    const EmitterEvidence& e = patch.evidence;
    return e.viewSpread > 0.12f &&
           !(e.viewsAgree && e.sceneContrast >= options.certainContrast && patch.commonSpread < 0.5f &&
             e.viewSpread < 2 * patch.commonSpread && patch.ownSpread < 0.06f);
}

void judge(const Scene& scene, const RadianceSamples& samples, const std::vector<VertexRadiance>& seen,
           const std::vector<int>& patchOf, int self, float reference, Patch& patch) {
    EmitterEvidence& e = patch.evidence;
    std::vector<float> channel[3], spreads, inside, outside;
    std::vector<uint8_t> views;
    Vec3 centre(0);
    size_t clipped = 0;
    for (uint32_t v : patch.vertices) {
        for (int c = 0; c < 3; ++c) channel[c].push_back(seen[v].radiance[c]);
        if (seen[v].spread >= 0) spreads.push_back(seen[v].spread);
        centre += scene.mesh.positions[v] / float(patch.vertices.size());
        for (uint32_t s = samples.start[v]; s < samples.start[v + 1]; ++s) {
            const RadianceSample& sample = samples.samples[s];
            if (views.size() <= sample.view) views.resize(sample.view + 1, 0);
            views[sample.view] = 1;
            ++e.samples;
            clipped += sample.clipped;
        }
    }
    for (int c = 0; c < 3; ++c) patch.radiance[c] = lowerMedianOf(channel[c]);
    e.viewsSeen = int(std::accumulate(views.begin(), views.end(), 0));
    e.clippedFraction = e.samples ? float(clipped) / float(e.samples) : 0;
    e.viewSpread = lowerMedianOf(spreads);
    e.viewsAgree = spreads.size() * 4 >= patch.vertices.size();
    std::vector<float> off;
    float radius = 0, spacing = 0;
    for (uint32_t v : patch.vertices) {
        spacing += scene.vertexSpacing[v] / float(patch.vertices.size());
        off.push_back(glm::length(seen[v].radiance - patch.radiance) / std::max(glm::length(patch.radiance), 1e-20f));
        radius = std::max(radius, glm::length(scene.mesh.positions[v] - centre));
    }
    e.uniformity = 1.4826f * lowerMedianOf(off);
    splitSpread(samples, seen, patch);
    e.sceneContrast = maxChannel(patch.radiance) / std::max(reference, 1e-20f);
    // The edge on the mesh, and the surfaces around in space.
    std::vector<float> drop, around;
    for (uint32_t v : patch.vertices)
        for (uint32_t k = scene.graph.start[v]; k < scene.graph.start[v + 1]; ++k) {
            const uint32_t u = scene.graph.to[k];
            if (patchOf[u] != self && seen[u].weight > 0.1f)
                drop.push_back(maxChannel(seen[u].radiance) / std::max(maxChannel(seen[v].radiance), 1e-20f));
        }
    e.edgeDrop = drop.size() * 4 > patch.vertices.size() / 4 ? lowerMedianOf(drop) : 0;
    const float reach = 2.5f * radius + 2 * spacing;
    for (uint32_t v = 0; v < seen.size(); ++v)
        if (seen[v].weight > 0.1f && patchOf[v] != self && glm::length(scene.mesh.positions[v] - centre) < reach)
            around.push_back(maxChannel(seen[v].radiance));
    e.localContrast =
        around.size() < 8 ? e.sceneContrast : maxChannel(patch.radiance) / std::max(lowerMedianOf(around), 1e-20f);
}

std::vector<uint8_t> withinOneRing(const Scene& scene, const std::vector<uint8_t>& of) {
    std::vector<uint8_t> result = of;
    for (uint32_t v = 0; v < of.size(); ++v)
        for (uint32_t e = scene.graph.start[v]; of[v] && e < scene.graph.start[v + 1]; ++e)
            result[scene.graph.to[e]] = 1;
    return result;
}

/// Where a reconstruction ends, its rim is off by a pixel or more, and observations there mix in what lies behind: a
/// window, a bright wall. A patch needs vertices away from rims, as many as the smallest patch has; one that is most of
/// its component is a sheet of its own, and its rim is its outline.
bool onlyRim(const Scene& scene, const std::vector<uint8_t>& nearRim, const std::vector<uint32_t>& seenOfComponent,
             const Patch& patch) {
    if (2 * patch.vertices.size() > seenOfComponent[scene.component[patch.vertices[0]]]) return false;
    return std::count_if(patch.vertices.begin(), patch.vertices.end(), [&](uint32_t v) { return !nearRim[v]; }) <
           ptrdiff_t(minPatch);
}

/// Vertices that fall on one pixel agree because they are one measurement. What a patch is told by, that it is uniform,
/// has an edge and looks alike from two sides, needs several pixels in two views, or, where only one shows it, many.
bool tooFewPixels(const Scene& scene, const Capture& capture, const RadianceSamples& samples, const Patch& patch) {
    constexpr size_t inTwoViews = 4, inOneView = 16;
    std::vector<std::set<std::pair<int, int>>> pixels(capture.views.size());
    for (uint32_t v : patch.vertices)
        for (uint32_t s = samples.start[v]; s < samples.start[v + 1]; ++s) {
            const uint32_t view = samples.samples[s].view;
            if (view >= pixels.size()) return false;  // nothing is known of its pixels
            if (const auto at = capture.views[view].camera.project(DVec3(scene.mesh.positions[v])))
                pixels[view].insert({int(at->x), int(at->y)});
        }
    size_t most = 0, second = 0;
    for (const auto& p : pixels) {
        second = std::max(second, std::min(most, p.size()));
        most = std::max(most, p.size());
    }
    return second < inTwoViews && most < inOneView;
}

/// Lets a patch take the unobserved and half-seen rest of its own part.
/// Vertices that belong to another patch stay there.
void complete(const Scene& scene, const std::vector<VertexRadiance>& seen, const std::vector<uint8_t>& ofOthers,
              EmitterCluster& cluster) {
    std::vector<uint8_t> mine(seen.size(), 0);
    for (uint32_t v : cluster.vertices) mine[v] = 1;
    // A connected component whose clearly seen vertices nearly all shine is an emitter as a whole.
    std::vector<float> shining(scene.components, 0), clear(scene.components, 0);
    for (uint32_t v = 0; v < seen.size(); ++v) {
        if (seen[v].weight <= 0) continue;
        clear[scene.component[v]] += seen[v].weight;
        if (mine[v]) shining[scene.component[v]] += seen[v].weight;
    }
    for (uint32_t v = 0; v < seen.size(); ++v) {
        const uint32_t p = scene.component[v];
        if (!mine[v] && !ofOthers[v] && shining[p] > 0.7f * clear[p]) mine[v] = 1;
    }
    // Elsewhere unobserved neighbours of similar orientation join, a few rings far.
    std::vector<uint32_t> ring = cluster.vertices;
    for (int step = 0; step < 3; ++step) {
        std::vector<uint32_t> next;
        for (uint32_t v : ring)
            for (uint32_t e = scene.graph.start[v]; e < scene.graph.start[v + 1]; ++e) {
                const uint32_t u = scene.graph.to[e];
                if (mine[u] || ofOthers[u] || seen[u].weight > 0 ||
                    glm::dot(scene.mesh.normals[u], scene.mesh.normals[v]) < 0.5f)
                    continue;
                mine[u] = 1;
                next.push_back(u);
            }
        ring.swap(next);
    }
    cluster.vertices.clear();
    for (uint32_t v = 0; v < mine.size(); ++v)
        if (mine[v]) cluster.vertices.push_back(v);
}

void measure(const Scene& scene, EmitterCluster& cluster) {
    std::vector<uint8_t> mine(scene.mesh.vertexCount(), 0);
    for (uint32_t v : cluster.vertices) mine[v] = 1;
    cluster.triangles.clear();
    double area = 0;
    DVec3 centre(0), normal(0);
    for (uint32_t t = 0; t < scene.mesh.triangles.size(); ++t) {
        const Triangle& i = scene.mesh.triangles[t];
        if (!mine[i[0]] || !mine[i[1]] || !mine[i[2]]) continue;
        cluster.triangles.push_back(t);
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

Vec3 middleOf(const Scene& scene, size_t vertices) {
    Box box;
    for (size_t v = 0; v < vertices; ++v)
        if (scene.referenced[v]) box.grow(scene.mesh.positions[v] * scene.axes);
    return scene.axes * box.centre();
}

/// The spheres that stand for emitters without geometry: they are emitters because somebody said so, and how bright
/// they are is solved for.
void addProxyEmitters(const Scene& scene, const Capture& capture, float brightness, EmitterClusters& result) {
    for (size_t i = 0; i < capture.proxies.size(); ++i) {
        const ProxyLight& proxy = capture.proxies[i];
        const size_t before = capture.proxies.size() - i,
                     firstVertex = scene.mesh.vertexCount() - before * proxyVertices;
        EmitterCluster cluster;
        for (size_t v = 0; v < proxyVertices; ++v) cluster.vertices.push_back(uint32_t(firstVertex + v));
        measure(scene, cluster);
        cluster.unobserved = true;
        cluster.positionSigma = proxy.sigma;
        // A guess: half of what lights the middle of the scene, on an albedo of 0.3.
        const float distance = glm::length(Vec3(proxy.centre) - middleOf(scene, firstVertex));
        cluster.radiance = Rgb(std::max(brightness, 1e-9f) / 0.6f *
                               std::max(1.0f, distance * distance / (proxy.radius * proxy.radius)));
        cluster.radianceSigma = 1;
        result.emitters.push_back(std::move(cluster));
    }
}

/// Parts of connected vertices above `floor`, in an order that does not know the file's; none that has a vertex in
/// `except`.
std::vector<Patch> brightPatches(const Scene& scene, const std::vector<VertexRadiance>& seen, float floor,
                                 const std::vector<uint8_t>& except) {
    std::vector<Patch> parts;
    std::vector<uint8_t> taken(seen.size(), 0);
    std::vector<uint32_t> order(seen.size()), stack;
    std::iota(order.begin(), order.end(), 0u);
    std::sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) { return scene.rank[a] < scene.rank[b]; });
    const auto bright = [&](uint32_t v) {
        return !taken[v] && seen[v].weight > 0.1f && maxChannel(seen[v].radiance) > floor;
    };
    for (const uint32_t seed : order) {
        if (!bright(seed)) continue;
        Patch part;
        bool whole = true;
        stack.assign(1, seed);
        taken[seed] = 1;
        while (!stack.empty()) {
            const uint32_t v = stack.back();
            stack.pop_back();
            part.vertices.push_back(v);
            whole &= !except[v];
            for (uint32_t e = scene.graph.start[v]; e < scene.graph.start[v + 1]; ++e)
                if (const uint32_t u = scene.graph.to[e]; bright(u)) {
                    taken[u] = 1;
                    stack.push_back(u);
                }
        }
        if (!whole || part.vertices.size() < minPatch) continue;
        std::sort(part.vertices.begin(), part.vertices.end());
        parts.push_back(std::move(part));
    }
    return parts;
}

/// Whether the part could be what these emitters, of known radiance, light: its median vertex would need an albedo
/// below 1.5 if nothing stood between. O(64 x their triangles).
bool litByEmitters(const Scene& scene, const std::vector<VertexRadiance>& seen,
                   const std::vector<EmitterCluster>& emitters, const Patch& part) {
    constexpr size_t mostVertices = 64;
    std::vector<float> demanded;
    std::vector<uint32_t> vertices = part.vertices;
    std::sort(vertices.begin(), vertices.end(), [&](uint32_t a, uint32_t b) { return scene.rank[a] < scene.rank[b]; });
    const size_t step = std::max<size_t>(1, vertices.size() / mostVertices);
    for (size_t i = 0; i < vertices.size(); i += step) {
        const uint32_t v = vertices[i];
        Rgb lit(0);
        for (const EmitterCluster& emitter : emitters) {
            if (emitter.unobserved) continue;  // its radiance is a guess yet
            float factor = 0;                  // form factor; whichever way the surfaces face
            for (const uint32_t t : emitter.triangles) {
                const Triangle& corners = scene.mesh.triangles[t];
                const Vec3 to = (scene.mesh.positions[corners[0]] + scene.mesh.positions[corners[1]] +
                                 scene.mesh.positions[corners[2]]) /
                                    3.0f -
                                scene.mesh.positions[v];
                const float area = scene.mesh.triangleArea(t), squared = std::max(glm::dot(to, to), area);
                factor += area *
                          std::abs(glm::dot(to, scene.mesh.normals[v]) * glm::dot(to, scene.mesh.faceNormal(t))) /
                          (pi * squared * squared);
            }
            lit += emitter.radiance * std::min(factor, 1.0f);
        }
        demanded.push_back(maxChannel(seen[v].radiance) / std::max(maxChannel(lit), 1e-20f));
    }
    return lowerMedianOf(demanded) < 1.5f;
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

}  // namespace

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
    std::vector<VertexRadiance> seen = summarise(scene, samples);
    for (size_t v = seen.size() - std::min(seen.size(), capture.proxies.size() * proxyVertices); v < seen.size(); ++v)
        seen[v] = {};
    std::vector<float> values;
    for (const VertexRadiance& r : seen)
        if (r.weight > 0.1f) values.push_back(maxChannel(r.radiance));
    EmitterClusters result;
    result.emitterOfVertex.assign(scene.mesh.vertexCount(), -1);
    result.emitterOfTriangle.assign(scene.mesh.triangles.size(), -1);
    addProxyEmitters(scene, capture, lowerMedianOf(values), result);
    if (values.empty()) {
        indexEmitters(scene, result);
        return result;
    }
    progress.advance();

    std::vector<Patch> patches =
        growPatches(scene, seen, options.minContrast * lowerMedianOf(values), options.tolerance);
    mergeLikePatches(scene, patches, seen);
    progress.advance();
    std::vector<int> patchOf(seen.size(), -1);
    for (size_t i = 0; i < patches.size(); ++i)
        for (uint32_t v : patches[i].vertices) patchOf[v] = int(i);
    // The scene's ordinary brightness: view-independent surfaces outside every strikingly bright patch.
    const float median = lowerMedianOf(values);
    std::vector<float> ordinary;
    for (uint32_t v = 0; v < seen.size(); ++v)
        if (seen[v].weight > 0.1f && seen[v].spread < 0.15f &&
            (patchOf[v] < 0 || maxChannel(seen[v].radiance) < 6 * median))
            ordinary.push_back(maxChannel(seen[v].radiance));
    const float reference = ordinary.size() > 20 ? quantileOf(std::move(ordinary), 0.95) : median;

    const std::vector<uint8_t> nearRim = withinOneRing(scene, rimVertices(scene.mesh));
    std::vector<uint32_t> seenOfComponent(scene.components, 0);
    for (uint32_t v = 0; v < seen.size(); ++v) seenOfComponent[scene.component[v]] += seen[v].weight > 0.1f;
    std::vector<uint8_t> taken(seen.size(), 0),
        accepted(seen.size(), 0);       // by accepted patches, with what completes them and without
    std::vector<size_t> rejectedPatch;  // of each in result.rejected
    for (const EmitterCluster& e : result.emitters)
        for (uint32_t v : e.vertices) taken[v] = 1;
    for (size_t i = 0; i < patches.size(); ++i) {
        Patch& patch = patches[i];
        judge(scene, samples, seen, patchOf, int(i), reference, patch);
        const EmitterEvidence& e = patch.evidence;
        if (e.sceneContrast < options.minContrast && e.localContrast < options.minContrast)
            patch.reject = "no brighter than the surfaces around it";
        else if (changesWithView(patch, options)) patch.reject = "changes with the view, as a reflection does";
        else if (!e.viewsAgree && e.uniformity > 0.03f)
            patch.reject = "hardly seen from two sides and not uniform: could be a reflection";
        else if (e.uniformity > 0.12f) patch.reject = "its radiance varies as shading does";
        else if (e.edgeDrop > 0.8f) patch.reject = "fades out without an edge";
        else if (tooFewPixels(scene, capture, samples, patch))
            patch.reject = "is seen by too few pixels to tell a light from a bright speck";
        else if (onlyRim(scene, nearRim, seenOfComponent, patch))
            patch.reject = "lies at the rim of a hole, where a pixel may show what is behind";
        EmitterCluster cluster;
        cluster.vertices = patch.vertices;
        cluster.radiance = patch.radiance;
        cluster.radianceSigma =
            std::max(0.002f, e.uniformity / std::sqrt(float(std::max<size_t>(1, patch.vertices.size()))));
        cluster.evidence = e;
        if (patch.reject.empty()) {
            complete(scene, seen, taken, cluster);
            for (uint32_t v : cluster.vertices) taken[v] = 1;
        }
        measure(scene, cluster);
        if (patch.reject.empty() && cluster.triangles.empty()) patch.reject = "covers no whole triangle";
        if (!patch.reject.empty()) {
            if (e.sceneContrast > 1 || e.localContrast > 2) {
                result.rejected.push_back({cluster.centroid, patch.radiance, e, patch.reject});
                rejectedPatch.push_back(i);
            }
            continue;
        }
        for (uint32_t v : patch.vertices) accepted[v] = 1;
        (e.sceneContrast >= options.certainContrast && e.uniformity < 0.06f && e.viewSpread <= 0.12f
             ? result.emitters
             : result.candidates)
            .push_back(std::move(cluster));
    }
    // Bright parts none of whose patches is an emitter by itself, but which are one as a whole.
    for (Patch& part : brightPatches(scene, seen, 0.75f * options.unevenContrast * reference, accepted)) {
        std::vector<int> inPatch(seen.size(), -1);
        for (uint32_t v : part.vertices) inPatch[v] = 0;
        judge(scene, samples, seen, inPatch, 0, reference, part);
        const EmitterEvidence& e = part.evidence;
        if (e.sceneContrast < options.unevenContrast || changesWithView(part, options) || !e.viewsAgree ||
            e.edgeDrop > 0.5f || tooFewPixels(scene, capture, samples, part) ||
            onlyRim(scene, nearRim, seenOfComponent, part) || litByEmitters(scene, seen, result.emitters, part))
            continue;
        EmitterCluster cluster;
        cluster.vertices = part.vertices;
        cluster.radiance = part.radiance;
        cluster.evidence = e;
        complete(scene, seen, taken, cluster);
        measure(scene, cluster);
        if (cluster.triangles.empty()) continue;
        for (uint32_t v : cluster.vertices) taken[v] = 1;
        cluster.radiance = meanRadiance(scene, seen, cluster);
        cluster.radianceSigma =
            std::max(0.02f, 0.1f * e.uniformity);  // what it sends one way is not what it sends another
        size_t kept = 0;
        for (size_t r = 0; r < result.rejected.size(); ++r) {
            if (inPatch[patches[rejectedPatch[r]].vertices[0]] == 0) continue;  // a part of this one
            if (kept != r) {
                result.rejected[kept] = result.rejected[r];
                rejectedPatch[kept] = rejectedPatch[r];
            }
            ++kept;
        }
        result.rejected.resize(kept);
        rejectedPatch.resize(kept);
        result.candidates.push_back(std::move(cluster));
    }
    // What a mesh that is not exact makes of an emitter.
    joinSplitEmitters(scene, result.emitters);
    const std::vector<EmitterCluster> emitters = result.emitters;
    const auto dropFalse = [&](std::vector<EmitterCluster>& clusters) {
        std::erase_if(clusters, [&](EmitterCluster& e) {
            if (e.unobserved) return false;
            const char* reason = nullptr;
            for (const EmitterCluster& emitter : emitters)
                if (emitterPower(emitter) > emitterPower(e) &&
                    showsEmitterPastEdge(scene, capture, samples, emitter, e))
                    reason = "shows a light past the edge of the mesh";
            constexpr float plausible = 0.9f;
            if (const float albedo = albedoBesideEmitters(scene, emitters, e); !reason && albedo < plausible) {
                e.evidence.demandedAlbedo = albedo;
                reason = "a light beside it lights it as brightly";
            }
            if (reason) result.rejected.push_back({e.centroid, e.radiance, e.evidence, reason});
            return reason != nullptr;
        });
    };
    dropFalse(result.emitters);
    dropFalse(result.candidates);
    progress.advance();
    indexEmitters(scene, result);
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
    progress.advance();
    return result;
}

}  // namespace relamp
