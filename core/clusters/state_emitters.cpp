#include "clusters/state_emitters.h"

#include "base/log.h"
#include "base/statistics.h"
#include "radiance/agreement.h"
#include "radiance/state_parts.h"

namespace relamp {
namespace {

constexpr float overlapOfOne = 0.3f;  // of the smaller patch's vertices: two patches are one emitter
constexpr float visiblyOn = 1.6f;     // times ordinary surfaces of the same state, as ClusterOptions::minContrast
constexpr float leastLevel = 1e-3f;
constexpr float asShading = 0.2f;  // spread of a level over an emitter
constexpr float oneHue = 0.05f;    // relative, of the ratio in a channel
constexpr size_t leastVertices = 3;

/// One state's patches.
struct Found {
    EmitterCluster cluster;
    bool certain = false;
};

/// How many of `cluster`'s vertices are marked, over those of the smaller of the two patches.
float overlapOf(const EmitterCluster& a, const EmitterCluster& b) {
    size_t both = 0, i = 0, k = 0;
    while (i < a.vertices.size() && k < b.vertices.size()) {
        both += a.vertices[i] == b.vertices[k];
        const bool first = a.vertices[i] <= b.vertices[k], second = b.vertices[k] <= a.vertices[i];
        i += first;
        k += second;
    }
    return float(both) / float(std::max<size_t>(1, std::min(a.vertices.size(), b.vertices.size())));
}

/// The patches of all states, each once: the brightest stays, and takes what others know of it.
std::vector<Found> joined(std::vector<Found> all) {
    std::stable_sort(all.begin(), all.end(), [](const Found& a, const Found& b) {
        return luminance(a.cluster.radiance) > luminance(b.cluster.radiance);
    });
    std::vector<Found> kept;
    for (Found& f : all) {
        const auto same = std::find_if(kept.begin(), kept.end(),
                                       [&](const Found& k) { return overlapOf(k.cluster, f.cluster) > overlapOfOne; });
        if (same == kept.end()) kept.push_back(std::move(f));
        else same->certain |= f.certain;
    }
    return kept;
}

/// Radiance that ordinary surfaces of a state have at most: the 95th percentile outside all emitters.
float ordinaryRadiance(const RadianceSamples& samples, const std::vector<uint8_t>& emits) {
    std::vector<float> values;
    for (uint32_t v = 0; v < emits.size(); ++v)
        if (!emits[v])
            if (const auto seen = medianObservation(samples, v)) values.push_back(maxChannel(*seen));
    return values.empty() ? 0.0f : quantileOf(std::move(values), 0.95);
}

/// What a vertex of an emitter shows in a state.
struct ShownVertex {
    uint32_t vertex = 0;
    Rgb radiance{0};
    bool clipped = false;  ///< in half of its observations or more: a lower bound
};

/// Of all vertices that the state shows; empty where they are too few.
std::vector<ShownVertex> shownIn(const RadianceSamples& samples, const EmitterCluster& cluster) {
    std::vector<ShownVertex> all;
    for (const uint32_t v : cluster.vertices) {
        std::vector<float> channel[3];
        size_t clipped = 0;
        for (uint32_t k = samples.start[v]; k < samples.start[v + 1]; ++k) {
            for (int c = 0; c < 3; ++c) channel[c].push_back(samples.samples[k].radiance[c]);
            clipped += samples.samples[k].clipped;
        }
        if (channel[0].empty()) continue;
        const bool bound = 2 * clipped >= channel[0].size();
        all.push_back(
            {v, Rgb(medianOf(std::move(channel[0])), medianOf(std::move(channel[1])), medianOf(std::move(channel[2]))),
             bound});
    }
    if (all.size() < std::min(leastVertices, cluster.vertices.size())) all.clear();
    return all;
}

bool mostlyClipped(const std::vector<ShownVertex>& shown) {
    return 2 * std::count_if(shown.begin(), shown.end(), [](const ShownVertex& s) { return s.clipped; }) >=
           std::ptrdiff_t(shown.size());
}

/// Calls act(here, there) for each vertex that both states show.
template <class Act>
void forShared(const std::vector<ShownVertex>& here, const std::vector<ShownVertex>& there, Act&& act) {
    for (size_t i = 0, k = 0; i < here.size(); ++i) {
        while (k < there.size() && there[k].vertex < here[i].vertex) ++k;
        if (k < there.size() && there[k].vertex == here[i].vertex) act(here[i].radiance, there[k].radiance);
    }
}

/// Median over the vertices that both states show, per channel; where they are too few, of the medians.
Rgb ratioOf(const std::vector<ShownVertex>& here, const std::vector<ShownVertex>& fullest) {
    Rgb result(0);
    for (int c = 0; c < 3; ++c) {
        std::vector<float> ratio, above, below;
        forShared(here, fullest, [&](const Rgb& a, const Rgb& b) {
            if (b[c] > 0) ratio.push_back(a[c] / b[c]);
        });
        if (ratio.size() >= leastVertices) {
            result[c] = medianOf(std::move(ratio));
            continue;
        }
        for (const ShownVertex& s : here) above.push_back(s.radiance[c]);
        for (const ShownVertex& s : fullest) below.push_back(s.radiance[c]);
        const float under = below.empty() ? 0.0f : medianOf(std::move(below));
        result[c] = under > 0 && !above.empty() ? medianOf(std::move(above)) / under : 0.0f;
    }
    return result;
}

/// Robust relative spread of that ratio over the vertices: an emitter dims as a whole, while what it reflects varies as
/// shading does.
float spreadOfRatio(const std::vector<ShownVertex>& here, const std::vector<ShownVertex>& fullest) {
    std::vector<float> ratio;
    forShared(here, fullest,
              [&](const Rgb& a, const Rgb& b) { ratio.push_back(luminance(a) / std::max(luminance(b), 1e-20f)); });
    if (ratio.size() < 2 * leastVertices) return 0;
    const float middle = std::max(medianOf(ratio), 1e-20f);
    for (float& r : ratio) r = std::abs(r / middle - 1);
    return 1.4826f * medianOf(std::move(ratio));
}

/// The state in which an emitter that no photograph shows gives most: where what it would light by its place is
/// brightest beside the rest. Vertices that all states show, each with the light of a point at its centre.
uint32_t stateLitBy(const Scene& scene, const std::vector<RadianceSamples>& ofState, const EmitterCluster& cluster) {
    std::vector<float> light;
    std::vector<std::vector<float>> radiance(ofState.size());
    for (uint32_t v = 0; v < scene.mesh.vertexCount(); ++v) {
        std::vector<float> shown;
        for (const RadianceSamples& samples : ofState)
            if (const auto seen = medianObservation(samples, v)) shown.push_back(luminance(*seen));
        if (shown.size() != ofState.size()) continue;
        const Vec3& normal = scene.mesh.normals[v];
        const Vec3 origin = scene.mesh.positions[v] + 4 * scene.tracer->surfaceOffset() * normal,
                   to = cluster.centroid - origin;
        const float distance = glm::length(to), cosine = glm::dot(to, normal) / distance;
        // The proxy itself hides its centre.
        const float clear = distance - std::sqrt(cluster.area / (4 * pi)) * 1.1f;
        const bool lit = cosine > 0 && clear > 0 && !scene.tracer->occluded({origin, to / distance, 0, clear});
        light.push_back(lit ? cosine / (distance * distance) : 0.0f);
        for (size_t s = 0; s < ofState.size(); ++s) radiance[s].push_back(shown[s]);
    }
    if (light.empty()) return 0;
    // A few vertices beside it are not to decide.
    const float most = quantileOf(light, 0.95);
    uint32_t best = 0;
    double bestScore = 0;
    for (uint32_t s = 0; s < ofState.size(); ++s) {
        double byLight = 0, all = 0;
        for (size_t i = 0; i < light.size(); ++i) {
            byLight += double(std::min(light[i], most)) * double(radiance[s][i]);
            all += double(radiance[s][i]);
        }
        if (all > 0 && byLight / all > bestScore) bestScore = byLight / all, best = s;
    }
    return best;
}

/// Fills inState. `ordinary`: per state, of its surfaces.
void measureLevels(const std::vector<RadianceSamples>& ofState, const std::vector<float>& ordinary,
                   const Capture& capture, EmitterCluster& cluster) {
    std::vector<std::vector<ShownVertex>> shown;
    std::vector<float> brightness;
    for (const RadianceSamples& samples : ofState) {
        shown.push_back(shownIn(samples, cluster));
        std::vector<float> values;
        for (const ShownVertex& s : shown.back()) values.push_back(luminance(s.radiance));
        brightness.push_back(values.empty() ? -1.0f : medianOf(std::move(values)));
    }
    const size_t fullest = size_t(std::max_element(brightness.begin(), brightness.end()) - brightness.begin());
    cluster.inState.assign(ofState.size(), 1.0f);
    for (size_t s = 0; s < ofState.size(); ++s) {
        if (s == fullest) continue;
        float& level = cluster.inState[s];
        level = -1;
        if (shown[s].empty() || shown[fullest].empty()) continue;
        const Rgb ratio = ratioOf(shown[s], shown[fullest]);
        level = luminance(ratio * cluster.radiance) / std::max(luminance(cluster.radiance), 1e-20f);
        const bool on = level > leastLevel && level * maxChannel(cluster.radiance) > visiblyOn * ordinary[s] &&
                        spreadOfRatio(shown[s], shown[fullest]) < asShading;
        // What an emitter that is off shows of the others is no light of its own.
        if (!on) level = 0;
        // A clipped one is brighter by nobody knows how much.
        if (on && (mostlyClipped(shown[fullest]) || mostlyClipped(shown[s]))) {
            level = -1;
            continue;
        }
        float off = 0;
        for (int c = 0; c < 3; ++c)
            if (cluster.radiance[c] > 0.2f * maxChannel(cluster.radiance))
                off = std::max(off, std::abs(ratio[c] / std::max(level, 1e-20f) - 1));
        if (on && off > oneHue)
            logWarning("a light at {:.2f} {:.2f} {:.2f} changes its hue by {:.0f} % in state {}: its mean is taken",
                       cluster.centroid.x + capture.origin.x, cluster.centroid.y + capture.origin.y,
                       cluster.centroid.z + capture.origin.z, 100 * off, capture.states[s]);
    }
}

}  // namespace

EmitterClusters clusterEmittersOfStates(const Scene& scene, const Capture& capture, const RadianceSamples& samples,
                                        const ClusterOptions& options, Progress& progress) {
    if (samples.states == 1) return clusterEmitters(scene, capture, samples, options, progress);
    std::vector<Found> all;
    EmitterClusters result;
    std::vector<RadianceSamples> ofState;
    for (uint32_t s = 0; s < samples.states; ++s) {
        logInfo("lights in state {}:", capture.states[s]);
        EmitterClusters found =
            clusterEmitters(scene, captureOfState(capture, s), samplesOfPart(samples, s), options, progress);
        for (EmitterCluster& e : found.emitters) all.push_back({std::move(e), true});
        for (EmitterCluster& e : found.candidates) all.push_back({std::move(e), false});
        for (RejectedPatch& r : found.rejected) result.rejected.push_back(std::move(r));
        ofState.push_back(samplesOfState(samples, s));
    }
    all = joined(std::move(all));
    std::vector<uint8_t> emits(scene.mesh.vertexCount(), 0);
    for (const Found& f : all)
        for (const uint32_t v : f.cluster.vertices) emits[v] = 1;
    std::vector<float> ordinary;
    for (const RadianceSamples& part : ofState) ordinary.push_back(ordinaryRadiance(part, emits));
    for (Found& f : all) {
        if (f.cluster.unobserved) {
            f.cluster.inState.assign(samples.states, -1.0f);
            f.cluster.inState[stateLitBy(scene, ofState, f.cluster)] = 1;
        } else measureLevels(ofState, ordinary, capture, f.cluster);
        (f.certain ? result.emitters : result.candidates).push_back(std::move(f.cluster));
    }
    indexEmitters(scene, result);
    for (const EmitterCluster& e : result.emitters) {
        std::string words;
        for (size_t s = 0; s < e.inState.size(); ++s)
            words += e.inState[s] < 0 ? fmt::format("{}{}: not seen", s ? ", " : "", capture.states[s])
                                      : fmt::format("{}{}: {:.3g}", s ? ", " : "", capture.states[s], e.inState[s]);
        logInfo("{} in the lighting states: {}", e.id, words);
    }
    return result;
}

EmitterClusters clustersInState(const Scene& scene, const EmitterClusters& all, uint32_t state) {
    EmitterClusters result = all;
    const auto dim = [&](std::vector<EmitterCluster>& list) {
        std::erase_if(list, [&](const EmitterCluster& e) { return !(e.levelIn(state) > 0); });
        for (EmitterCluster& e : list) {
            e.radiance *= e.levelIn(state);
            e.inState.clear();
        }
    };
    dim(result.emitters);
    dim(result.candidates);
    indexEmitters(scene, result);
    return result;
}

uint32_t brightestState(const EmitterClusters& clusters, const RadianceSamples& samples) {
    std::vector<size_t> observations(samples.states, 0);
    for (const RadianceSample& s : samples.samples) ++observations[samples.stateOf(s.view)];
    uint32_t best = 0;
    double most = -1;
    // What it is for needs distant light where there is some.
    const bool anyEnvironment = std::any_of(samples.environmentOfState.begin(), samples.environmentOfState.end(),
                                            [](int environment) { return environment >= 0; });
    for (uint32_t s = 0; s < samples.states; ++s) {
        if (anyEnvironment && samples.environmentOf(s) < 0) continue;
        double power = 0;
        for (const EmitterCluster& e : clusters.emitters)
            power += double(emitterPower(e)) * double(std::max(0.0f, e.levelIn(s)));
        if (!(power > most * (1 + 1e-3)) && !(power > most * (1 - 1e-3) && observations[s] > observations[best]))
            continue;
        if (observations[s] == 0) continue;
        most = power;
        best = s;
    }
    return best;
}

}  // namespace relamp
