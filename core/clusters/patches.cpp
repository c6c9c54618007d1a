#include "clusters/patches.h"

#include <numeric>
#include <set>

#include "base/statistics.h"

namespace relamp {
namespace {

bool alike(const Rgb& a, const Rgb& b, float tolerance) {
    return glm::length(a - b) <= tolerance * std::max(glm::length(a), glm::length(b));
}

/// Takes apart how a patch differs between views: as a whole, and vertex by vertex. True where something stands before
/// it in some views that the mesh lacks: it is dark there as a whole, and alike in all others, thrice as many at least.
/// Those views are left out then. A reflection is not alike in so many.
bool splitSpread(const RadianceSamples& samples, const std::vector<VertexRadiance>& seen, EmitterPatch& patch) {
    constexpr float hiddenBelow = 0.25f, alikeWithin = 0.06f;
    constexpr size_t shownForHidden = 3;
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
    constexpr float unasked = -1;
    std::vector<float> common(ofView.size(), unasked);
    for (size_t view = 0; view < ofView.size(); ++view)
        if (ofView[view].size() >= smallestPatch) common[view] = lowerMedianOf(ofView[view]);
    const auto split = [&] {
        float low = 1e30f, high = 0;
        for (const float ratio : common)
            if (ratio != unasked) low = std::min(low, ratio), high = std::max(high, ratio);
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
    };
    split();
    const auto countIf = [&](const auto& which) { return size_t(std::count_if(common.begin(), common.end(), which)); };
    const size_t hidden = countIf([&](float ratio) { return ratio != unasked && ratio < hiddenBelow; }),
                 shown = countIf([&](float ratio) { return ratio >= hiddenBelow; });
    if (hidden == 0 || shown < shownForHidden * hidden) return false;
    const float wholeCommon = patch.commonSpread, wholeOwn = patch.ownSpread;
    for (float& ratio : common) ratio = ratio < hiddenBelow ? unasked : ratio;
    split();
    if (patch.commonSpread < alikeWithin && patch.ownSpread < alikeWithin) return true;
    patch.commonSpread = wholeCommon;
    patch.ownSpread = wholeOwn;
    return false;
}

}  // namespace

std::vector<VertexRadiance> vertexRadiance(const Scene& scene, const RadianceSamples& samples) {
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

std::vector<EmitterPatch> growPatches(const Scene& scene, const std::vector<VertexRadiance>& seen, float floor,
                                      float tolerance) {
    std::vector<uint32_t> order;
    for (uint32_t v = 0; v < seen.size(); ++v)
        if (seen[v].weight > 0.1f && maxChannel(seen[v].radiance) > floor) order.push_back(v);
    std::sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) {
        const float x = maxChannel(seen[a].radiance), y = maxChannel(seen[b].radiance);
        return x != y ? x > y : scene.rank[a] < scene.rank[b];
    });
    std::vector<uint8_t> taken(seen.size(), 0);
    std::vector<EmitterPatch> patches;
    std::vector<uint32_t> stack, around;
    for (uint32_t seed : order) {
        if (taken[seed]) continue;
        EmitterPatch patch;
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
        if (patch.vertices.size() < smallestPatch) continue;
        std::sort(patch.vertices.begin(), patch.vertices.end());
        patches.push_back(std::move(patch));
    }
    return patches;
}

void mergeLikePatches(const Scene& scene, std::vector<EmitterPatch>& patches, const std::vector<VertexRadiance>& seen) {
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

std::vector<uint8_t> withoutSteps(const Scene& scene, const std::vector<EmitterPatch>& patches,
                                  std::vector<uint8_t> accepted) {
    constexpr float brighter = 1.2f;
    std::vector<int> patchOf(accepted.size(), -1);
    for (size_t i = 0; i < patches.size(); ++i)
        for (const uint32_t v : patches[i].vertices) patchOf[v] = int(i);
    const auto besideBrighter = [&](uint32_t v, const EmitterPatch& patch) {
        for (uint32_t e = scene.graph.start[v]; e < scene.graph.start[v + 1]; ++e) {
            const int other = patchOf[scene.graph.to[e]];
            if (other >= 0 && patches[size_t(other)].reject == fadesOutReason &&
                maxChannel(patches[size_t(other)].radiance) > brighter * maxChannel(patch.radiance))
                return true;
        }
        return false;
    };
    for (const EmitterPatch& patch : patches)
        if (patch.reject.empty() && std::any_of(patch.vertices.begin(), patch.vertices.end(),
                                                [&](uint32_t v) { return besideBrighter(v, patch); }))
            for (const uint32_t v : patch.vertices) accepted[v] = 0;
    return accepted;
}

std::vector<EmitterPatch> brightPatches(const Scene& scene, const std::vector<VertexRadiance>& seen, float floor,
                                        const std::vector<uint8_t>& except) {
    std::vector<EmitterPatch> parts;
    std::vector<uint8_t> taken(seen.size(), 0);
    std::vector<uint32_t> order(seen.size()), stack;
    std::iota(order.begin(), order.end(), 0u);
    std::sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) { return scene.rank[a] < scene.rank[b]; });
    const auto bright = [&](uint32_t v) {
        return !taken[v] && seen[v].weight > 0.1f && maxChannel(seen[v].radiance) > floor;
    };
    for (const uint32_t seed : order) {
        if (!bright(seed)) continue;
        EmitterPatch part;
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
        if (!whole || part.vertices.size() < smallestPatch) continue;
        std::sort(part.vertices.begin(), part.vertices.end());
        parts.push_back(std::move(part));
    }
    return parts;
}

void judgePatch(const Scene& scene, const RadianceSamples& samples, const std::vector<VertexRadiance>& seen,
                const std::vector<int>& patchOf, int self, float reference, EmitterPatch& patch) {
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
    if (splitSpread(samples, seen, patch)) e.viewSpread = std::max(patch.commonSpread, patch.ownSpread);
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

bool changesWithView(const EmitterPatch& patch, const ClusterOptions& options) {
    const EmitterEvidence& e = patch.evidence;
    return e.viewSpread > 0.12f &&
           !(e.viewsAgree && e.sceneContrast >= options.certainContrast && patch.commonSpread < 0.5f &&
             e.viewSpread < 2 * patch.commonSpread && patch.ownSpread < 0.06f);
}

bool onlyRim(const Scene& scene, const std::vector<uint8_t>& nearRim, const std::vector<uint32_t>& seenOfComponent,
             const EmitterPatch& patch) {
    if (2 * patch.vertices.size() > seenOfComponent[scene.component[patch.vertices[0]]]) return false;
    return std::count_if(patch.vertices.begin(), patch.vertices.end(), [&](uint32_t v) { return !nearRim[v]; }) <
           ptrdiff_t(smallestPatch);
}

bool tooFewPixels(const Scene& scene, const Capture& capture, const RadianceSamples& samples,
                  const EmitterPatch& patch) {
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

}  // namespace relamp
