#include "clusters/thin_emitters.h"

#include <map>
#include <numeric>

#include "base/parallel.h"
#include "base/statistics.h"

namespace relamp {
namespace {

constexpr float clean = 0.1f;  ///< weight of an observation that vertices are judged by
constexpr size_t fewestPixels = 16, fewestPixelsInView = 4;
constexpr size_t mostParts = 4;  ///< that views are counted in at once

/// Per triangle: in how many views more of its pixels are bright than not, and in how many they are not.
struct VertexVotes {
    std::vector<uint16_t> bright, dark;
};

/// Of the views from `first` up to `last`.
VertexVotes votesOf(const Scene& scene, const Capture& capture, const RadianceSamples& samples, float floor,
                    size_t first, size_t last) {
    const size_t n = scene.mesh.triangles.size();
    VertexVotes votes{std::vector<uint16_t>(n, 0), std::vector<uint16_t>(n, 0)};
    std::vector<int> balance(n, 0);
    std::vector<uint32_t> touched;
    for (size_t i = first; i < last; ++i) {
        const Image& image = capture.views[i].image;
        const ViewGeometry& g = samples.geometry[i];
        touched.clear();
        for (int y = 0; y < g.height; ++y)
            for (int x = 0; x < g.width; ++x) {
                const uint32_t t = g.triangle[size_t(y) * size_t(g.width) + size_t(x)];
                if (t == Hit::none || !image.usableAt(x, y)) continue;
                touched.push_back(t);
                balance[t] += maxChannel(image.at(x, y)) > floor ? 1 : -1;
            }
        for (const uint32_t t : touched) {
            if (balance[t] > 0) ++votes.bright[t];
            if (balance[t] < 0) ++votes.dark[t];
            balance[t] = 0;
        }
    }
    return votes;
}

VertexVotes votesOf(const Scene& scene, const Capture& capture, const RadianceSamples& samples, float floor) {
    const size_t views = std::min(capture.views.size(), samples.geometry.size());
    std::vector<VertexVotes> parts(std::clamp(views, size_t(1), mostParts));
    parallelFor(parts.size(), 1, [&](size_t k) {
        parts[k] = votesOf(scene, capture, samples, floor, views * k / parts.size(), views * (k + 1) / parts.size());
    });
    VertexVotes votes = std::move(parts[0]);
    for (size_t k = 1; k < parts.size(); ++k)
        for (size_t t = 0; t < votes.bright.size(); ++t) {
            votes.bright[t] = uint16_t(votes.bright[t] + parts[k].bright[t]);
            votes.dark[t] = uint16_t(votes.dark[t] + parts[k].dark[t]);
        }
    return votes;
}

/// Triangles that share vertices, by their lowest member.
std::vector<std::vector<uint32_t>> connected(const Mesh& mesh, const std::vector<uint32_t>& triangles) {
    std::map<uint32_t, std::vector<uint32_t>> byVertex;
    for (uint32_t i = 0; i < triangles.size(); ++i)
        for (const uint32_t v : mesh.triangles[triangles[i]]) byVertex[v].push_back(i);
    std::vector<uint8_t> taken(triangles.size(), 0);
    std::vector<std::vector<uint32_t>> groups;
    for (uint32_t first = 0; first < triangles.size(); ++first) {
        if (taken[first]) continue;
        std::vector<uint32_t> stack{first}, group;
        taken[first] = 1;
        while (!stack.empty()) {
            const uint32_t at = stack.back();
            stack.pop_back();
            group.push_back(triangles[at]);
            for (const uint32_t v : mesh.triangles[triangles[at]])
                for (const uint32_t next : byVertex[v])
                    if (!taken[next]) taken[next] = 1, stack.push_back(next);
        }
        std::sort(group.begin(), group.end());
        groups.push_back(std::move(group));
    }
    return groups;
}

/// Radiance and evidence from the pixels of the triangles that `group` marks.
bool measure(const Capture& capture, const RadianceSamples& samples, const std::vector<uint8_t>& group,
             ThinEmitter& emitter) {
    std::vector<float> brightness, flatness, channel[3];
    for (size_t i = 0; i < std::min(capture.views.size(), samples.geometry.size()); ++i) {
        const View& view = capture.views[i];
        const ViewGeometry& g = samples.geometry[i];
        std::vector<std::pair<float, Rgb>> pixels;
        for (int y = 0; y < g.height; ++y)
            for (int x = 0; x < g.width; ++x) {
                const uint32_t t = g.triangle[size_t(y) * size_t(g.width) + size_t(x)];
                if (t == Hit::none || !group[t] || !view.image.usableAt(x, y)) continue;
                const Rgb value = view.image.at(x, y);
                pixels.emplace_back(maxChannel(value), value);
                emitter.evidence.clippedFraction += view.saturation > 0 && maxChannel(value) >= view.saturation;
            }
        emitter.evidence.samples += pixels.size();
        if (pixels.size() < fewestPixelsInView) continue;
        std::sort(pixels.begin(), pixels.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
        const auto at = [&](double rank) { return pixels[size_t(rank * double(pixels.size() - 1))]; };
        brightness.push_back(at(0.8).first);
        flatness.push_back((at(0.95).first - at(0.65).first) / std::max(at(0.8).first, 1e-20f));
        for (int c = 0; c < 3; ++c) channel[c].push_back(at(0.8).second[c]);
    }
    if (brightness.size() < 2 || emitter.evidence.samples < fewestPixels) return false;
    emitter.evidence.clippedFraction /= float(emitter.evidence.samples);
    const float middle = medianOf(brightness);
    std::vector<float> off;
    off.reserve(brightness.size());
    for (float b : brightness) off.push_back(std::abs(b / std::max(middle, 1e-20f) - 1));
    emitter.evidence.viewSpread = medianOf(off);
    emitter.evidence.viewsAgree = true;
    emitter.evidence.viewsSeen = int(brightness.size());
    for (int c = 0; c < 3; ++c) emitter.radiance[c] = medianOf(channel[c]);
    // Pixels that are covered whole are all alike.
    emitter.evidence.uniformity = medianOf(flatness);
    emitter.radianceSigma = std::max(0.01f, 0.5f * emitter.evidence.uniformity);
    return true;
}

}  // namespace

std::vector<ThinEmitter> thinEmitters(const Scene& scene, const Capture& capture, const RadianceSamples& samples,
                                      const std::vector<VertexRadiance>& seen, float floor,
                                      const std::vector<uint8_t>& except) {
    const VertexVotes votes = votesOf(scene, capture, samples, floor);
    const std::vector<Triangle>& triangles = scene.mesh.triangles;
    std::vector<uint32_t> bright;
    std::vector<float> brightOf(scene.components, 0), darkOf(scene.components, 0);
    for (uint32_t t = 0; t < triangles.size(); ++t) {
        const uint32_t component = scene.component[triangles[t][0]];
        if (votes.bright[t] > votes.dark[t]) brightOf[component] += scene.mesh.triangleArea(t);
        if (votes.bright[t] < votes.dark[t]) darkOf[component] += scene.mesh.triangleArea(t);
        const bool thin = std::all_of(triangles[t].begin(), triangles[t].end(),
                                      [&](uint32_t v) { return !(seen[v].weight > clean) && !except[v]; });
        if (thin && votes.bright[t] >= 2 && votes.bright[t] > votes.dark[t]) bright.push_back(t);
    }
    // A component that mostly shines is one emitter, hidden sides and all.
    std::vector<uint8_t> shines(scene.components, 0);
    for (const uint32_t t : bright) {
        const uint32_t component = scene.component[triangles[t][0]];
        shines[component] = brightOf[component] > 3 * darkOf[component];
    }
    std::vector<uint32_t> some;
    std::map<uint32_t, std::vector<uint32_t>> whole;
    for (const uint32_t t : bright)
        if (!shines[scene.component[triangles[t][0]]]) some.push_back(t);
    for (uint32_t t = 0; t < triangles.size(); ++t)
        if (const uint32_t component = scene.component[triangles[t][0]]; shines[component])
            whole[component].push_back(t);
    std::vector<std::vector<uint32_t>> groups = connected(scene.mesh, some);
    for (auto& [component, all] : whole) {
        const bool taken = std::any_of(all.begin(), all.end(), [&](uint32_t t) {
            return std::any_of(triangles[t].begin(), triangles[t].end(), [&](uint32_t v) { return except[v] != 0; });
        });
        if (!taken) groups.push_back(std::move(all));
    }
    std::vector<ThinEmitter> found;
    std::vector<uint8_t> member(triangles.size(), 0);
    for (std::vector<uint32_t>& group : groups) {
        for (const uint32_t t : group) member[t] = 1;
        ThinEmitter emitter;
        if (measure(capture, samples, member, emitter)) {
            emitter.triangles = group;
            found.push_back(std::move(emitter));
        }
        for (const uint32_t t : group) member[t] = 0;
    }
    return found;
}

}  // namespace relamp
