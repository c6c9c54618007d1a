#include "pipeline/lean_normals.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "base/log.h"
#include "pipeline/plan_pilot.h"
#include "solve/registration/hue_normals.h"

namespace relamp {
namespace {

constexpr int leanSide = 16;         ///< of the directions' grid
constexpr float leanTried = 0.05f;   ///< radians: for derivatives
constexpr float leastLean = 0.003f;  ///< radians: less is not kept
constexpr double usualStep = 0.05;   ///< of log albedo between neighbours
constexpr double leastEvener = 0.02, sureOfEvener = 6;
constexpr int gateRings = 6;  ///< about a vertex, that judge its lean
constexpr size_t fewSamples = 1000;

/// Light of some vertices under a light that is known, for any normals.
class LitVertices {
public:
    LitVertices(const Scene& scene, const EmitterClusters& emitters, const Lighting& lighting,
                const std::vector<uint32_t>& vertices, uint64_t seed, Progress& progress)
        : scene_(scene),
          emitters_(emitters),
          lighting_(lighting),
          vertices_(vertices),
          seed_(seed),
          progress_(progress),
          wanted_(scene.mesh.vertexCount(), 0) {
        for (const uint32_t v : vertices) wanted_[v] = 1;
        visibility_ = computeVisibility(scene, {.gridSide = leanSide, .only = &wanted_, .axes = scene.axes}, progress);
    }

    /// `lean`: per vertex, what joins its normal.
    std::vector<Rgb> light(const std::vector<Vec3>& lean) const {
        Scene leant = scene_;
        for (size_t i = 0; i < lean.size(); ++i) {
            Vec3& normal = leant.mesh.normals[vertices_[i]];
            normal = glm::normalize(normal + lean[i]);
        }
        NearFieldOptions near;
        near.seed = seed_;
        near.only = &wanted_;
        const NearField nearField = computeNearField(leant, emitters_, near, progress_);
        return litBy(lambertInfluence(leant, visibility_, nearField, lighting_.leaves, vertices_, progress_),
                     lighting_);
    }

private:
    const Scene& scene_;
    const EmitterClusters& emitters_;
    const Lighting& lighting_;
    const std::vector<uint32_t>& vertices_;
    uint64_t seed_;
    Progress& progress_;
    std::vector<uint8_t> wanted_;
    Visibility visibility_;
};

/// In all channels.
bool isLit(const Rgb& light) { return light[0] > 0 && light[1] > 0 && light[2] > 0; }

/// Places in the observations that may lean: matte ones, or matte under a coating.
std::vector<size_t> mayLean(const Scene& scene, const MatteObservations& matte, const std::vector<uint8_t>& still) {
    std::vector<size_t> found;
    for (size_t i = 0; i < matte.vertices.size(); ++i) {
        const uint32_t v = matte.vertices[i];
        if (!still[v] && matte.componentGlossy[scene.material[v]] < 2 && isLit(matte.radiance[i])) found.push_back(i);
    }
    return found;
}

std::vector<HueSample> hueSamples(const Scene& scene, const MatteObservations& matte, const std::vector<size_t>& places,
                                  const EmitterClusters& emitters, const Lighting& lighting, uint64_t seed,
                                  Progress& progress) {
    std::vector<uint32_t> vertices;
    std::vector<Vec3> tangents[2];
    for (const size_t i : places) {
        const Vec3& n = scene.mesh.normals[matte.vertices[i]];
        const Vec3 other = std::abs(n.x) < 0.6f ? Vec3(1, 0, 0) : Vec3(0, 1, 0);
        vertices.push_back(matte.vertices[i]);
        tangents[0].push_back(glm::normalize(glm::cross(n, other)));
        tangents[1].push_back(glm::cross(n, tangents[0].back()));
    }
    const LitVertices lit(scene, emitters, lighting, vertices, seed, progress);
    const auto leant = [&](std::vector<Vec3> directions) {
        for (Vec3& d : directions) d *= leanTried;
        return lit.light(directions);
    };
    const std::vector<Rgb> light = lit.light({}), towards[2] = {leant(tangents[0]), leant(tangents[1])};
    std::vector<HueSample> samples;
    for (size_t k = 0; k < places.size(); ++k) {
        if (!isLit(light[k])) continue;
        HueSample s;
        s.vertex = vertices[k];
        s.albedo = matte.radiance[places[k]] / light[k];
        s.sigma = maxChannel(matte.sigma[places[k]] / matte.radiance[places[k]]);
        for (int t = 0; t < 2; ++t) {
            s.tangents[t] = tangents[t][k];
            s.change[t] = (towards[t][k] - light[k]) / (leanTried * light[k]);
        }
        samples.push_back(s);
    }
    return samples;
}

/// Of green albedo, which hues alone do not tell: how much it differs between neighbours.
class Unevenness {
public:
    Unevenness(const Scene& scene, const std::vector<HueSample>& samples) : samples_(samples) {
        std::vector<int> place(scene.mesh.vertexCount(), -1);
        for (size_t i = 0; i < samples.size(); ++i) place[samples[i].vertex] = int(i);
        for (size_t i = 0; i < samples.size(); ++i) {
            const uint32_t v = samples[i].vertex;
            for (uint32_t e = scene.graph.start[v]; e < scene.graph.start[v + 1]; ++e)
                if (const uint32_t w = scene.graph.to[e]; w > v && place[w] >= 0)
                    edges_.push_back({uint32_t(i), uint32_t(place[w])});
        }
    }

    /// Per edge, bent.
    std::vector<double> misfits(const std::vector<Vec2>& leans) const {
        std::vector<double> log;
        for (size_t i = 0; i < samples_.size(); ++i)
            log.push_back(double(std::log(samples_[i].albedo[1]) + samples_[i].after(leans[i])[1]));
        std::vector<double> found;
        for (const auto& [i, k] : edges_) {
            const double step = (log[i] - log[k]) / usualStep;
            found.push_back(std::log1p(step * step));
        }
        return found;
    }

    /// Leans stay where they make the surface about them evener.
    void keepGood(const std::vector<double>& before, std::vector<Vec2>& leans) const {
        const std::vector<double> after = misfits(leans);
        std::vector<double> gain(samples_.size(), 0);
        for (size_t e = 0; e < edges_.size(); ++e)
            for (const uint32_t i : edges_[e]) gain[i] += before[e] - after[e];
        for (int ring = 0; ring < gateRings; ++ring) {
            const std::vector<double> last = gain;
            for (const auto& [i, k] : edges_) {
                gain[i] += last[k];
                gain[k] += last[i];
            }
        }
        for (size_t i = 0; i < leans.size(); ++i)
            if (!(gain[i] > 0)) leans[i] = Vec2(0);
    }

private:
    const std::vector<HueSample>& samples_;
    std::vector<std::array<uint32_t, 2>> edges_;
};

/// Of a normal's parts: what a shot's file holds.
Vec3 rounded(const Vec3& normal) { return glm::round(normal * 1e4f) / 1e4f; }

}  // namespace

std::vector<uint8_t> knownNormals(const Scene& scene, size_t own, const RegistrationFix& fix, const MeshMend& mend) {
    std::vector<uint8_t> known(scene.mesh.vertexCount(), 1);
    std::fill_n(known.begin(), own, uint8_t(0));
    for (const MeshMend::TurnedVertex& t : mend.turned) known[t.vertex] = 1;
    for (size_t v = 0; v < std::min(own, fix.flatSteps.size()); ++v)
        if (fix.flatSteps[v] != 0) known[v] = 1;
    return known;
}

LeantNormals leanNormals(const Scene& scene, const RadianceSamples& samples, const EmitterClusters& clusters,
                         const std::vector<uint8_t>& still, const SolveOptions& options, Progress& progress) {
    const EmitterClusters emitters = allEmitters(scene, clusters, options.nearField);
    std::vector<uint8_t> skip(scene.mesh.vertexCount(), 0);
    for (size_t v = 0; v < skip.size(); ++v) skip[v] = emitters.emitterOfVertex[v] >= 0;
    const RatioObservations observed = ratioObservations(scene, samples, std::move(skip), options.seed);
    const std::vector<size_t> places = mayLean(scene, observed.matte, still);
    if (places.size() < fewSamples) return {};
    const PilotFindings pilot = runPilot(scene, samples, emitters, observed.matte, observed.pairs, options, progress);
    if (!pilot.ran) return {};
    const std::vector<HueSample> hues =
        hueSamples(scene, observed.matte, places, emitters, pilot.lighting, options.seed, progress);
    std::vector<Vec2> leans = hueLeans(scene, hues);
    const Unevenness green(scene, hues);
    const std::vector<double> before = green.misfits(std::vector<Vec2>(hues.size(), Vec2(0)));
    const MisfitFall fall = misfitFall(before, green.misfits(leans));
    green.keepGood(before, leans);
    LeantNormals found;
    double squares = 0;
    for (size_t i = 0; i < leans.size(); ++i) {
        const HueSample& s = hues[i];
        squares += double(glm::dot(leans[i], leans[i]));
        if (glm::length(leans[i]) < leastLean) continue;
        const Vec3 lean = leans[i].x * s.tangents[0] + leans[i].y * s.tangents[1];
        found.turned.push_back({s.vertex, rounded(glm::normalize(scene.mesh.normals[s.vertex] + lean))});
    }
    const double degrees = std::sqrt(squares / double(std::max<size_t>(1, leans.size()))) * 180 / piD;
    const bool taken = fall.exceeds(leastEvener, sureOfEvener);
    logInfo("normals of {} vertices would lean by {:.2f} degrees as hues show; brightness of neighbours: {}{}",
            found.turned.size(), degrees, fall.words(), taken ? "; they do" : "; left as they are");
    if (!taken) return {};
    found.words = fmt::format(
        "normals lean by {:.1f} degrees, as the hues of the light show it; brightness of neighbours differs {:.0f} % "
        "less",
        degrees, 100 * fall.part);
    return found;
}

}  // namespace relamp
