#include "pipeline/complete_lights.h"

#include <algorithm>
#include <numeric>

#include "base/log.h"
#include "base/sort_unique.h"
#include "pipeline/mend_mesh.h"
#include "pipeline/plan_pilot.h"

namespace relamp {
namespace {

constexpr double leastChange = 0.01, leastSure = 3;  // of the misfit; standard errors
constexpr int halvings = 3;                          // of the first step, which is half of an end's reach
constexpr size_t leastPairs = 1000;

/// The scene with a body in a light's place, whose ends can be moved.
class BodyTrial {
public:
    BodyTrial(const Scene& scene, const RadianceSamples& samples, const EmitterClusters& clusters,
              const PartialLight& partial, const EmitterReplacement& replacement, const SolveOptions& options,
              Progress& progress)
        : partial_(partial), options_(options), progress_(progress), samples_(samples), clusters_(clusters) {
        Mesh mesh = scene.mesh;
        first_ = uint32_t(mesh.vertexCount());
        withBody_ = mesh.shadowless;
        withBody_.insert(withBody_.end(), replacement.place.removed.begin(), replacement.place.removed.end());
        sortUnique(withBody_);
        withMesh_ = mesh.shadowless;
        std::vector<Vec3> positions;
        std::vector<Triangle> triangles;
        partial.body.surface(positions, triangles);
        EmitterCluster light = partial.mesh;
        light.vertices.resize(positions.size());
        std::iota(light.vertices.begin(), light.vertices.end(), first_);
        light.triangles.resize(triangles.size());
        std::iota(light.triangles.begin(), light.triangles.end(), uint32_t(mesh.triangles.size()));
        withMesh_.insert(withMesh_.end(), light.triangles.begin(), light.triangles.end());
        light.level.clear();
        light.pattern = {};
        light.twoSided = false;
        addSurface(positions, triangles, mesh);
        scene_ = buildScene(std::move(mesh), progress, scene.axes);
        samples_.start.resize(scene_.mesh.vertexCount() + 1, samples.start.back());

        const auto isIt = [&](const EmitterCluster& e) { return e.vertices == partial.mesh.vertices; };
        std::erase_if(clusters_.emitters, isIt);
        std::erase_if(clusters_.candidates, isIt);
        body_ = std::move(light);
        std::vector<uint8_t> skip = verticesOf(scene_, {&clusters_.emitters, &clusters_.candidates});
        for (const EmitterCluster* e : {static_cast<const EmitterCluster*>(&body_), &partial.mesh})
            for (const uint32_t v : e->vertices) skip[v] = 1;
        for (const uint32_t t : replacement.place.removed)
            for (const uint32_t v : scene_.mesh.triangles[t]) skip[v] = 1;
        observed_ = ratioObservations(scene_, samples_, std::move(skip), options.seed);
    }
    bool enough() const { return observed_.pairs.size() >= leastPairs; }

    /// Misfits of the pilot's pairs with what the mesh has there, as a light or as a surface.
    std::vector<double> misfitsOfMesh(bool shining) {
        return misfitsWith(withMesh_, shining ? &partial_.mesh : nullptr);
    }
    /// With the body, its ends so many metres farther out.
    std::vector<double> misfits(const std::vector<double>& lengths) {
        const EmitterBody body = withEnds(partial_.body, partial_.ends, lengths);
        // The base's vertices, drawn out: their number stays.
        for (size_t k = 0; k < base_.size(); ++k) {
            const DVec3 at =
                (DVec3(base_[k]) - partial_.body.centre) * partial_.body.axes * body.half / partial_.body.half;
            scene_.mesh.positions[first_ + k] = Vec3(body.centre + body.axes * at);
        }
        measureTriangles(scene_, body_);
        return misfitsWith(withBody_, &body_);
    }

private:
    const PartialLight& partial_;
    const SolveOptions& options_;
    Progress& progress_;
    RadianceSamples samples_;
    EmitterClusters clusters_;
    Scene scene_;
    RatioObservations observed_;
    EmitterCluster body_;
    std::vector<Vec3> base_;                     ///< its vertices, without longer ends
    std::vector<uint32_t> withBody_, withMesh_;  ///< triangles that light passes
    uint32_t first_ = 0;

    std::vector<double> misfitsWith(const std::vector<uint32_t>& shadowless, const EmitterCluster* light) {
        scene_.mesh.shadowless = shadowless;
        scene_.tracer = std::make_shared<const RayTracer>(scene_.mesh, scene_.diagonal);
        EmitterClusters now = clusters_;
        if (light) now.emitters.push_back(*light);
        indexEmitters(scene_, now);
        return pilotMisfits(scene_, samples_, now, observed_.matte, observed_.pairs, options_, progress_);
    }

    void addSurface(const std::vector<Vec3>& positions, const std::vector<Triangle>& triangles, Mesh& mesh) {
        base_ = positions;
        mesh.positions.insert(mesh.positions.end(), positions.begin(), positions.end());
        std::vector<Vec3> normals(positions.size(), Vec3(0));
        for (const auto& [a, b, c] : triangles) {
            const Vec3 across = glm::cross(positions[b] - positions[a], positions[c] - positions[a]);
            for (const uint32_t v : {a, b, c}) normals[v] += across;
            mesh.triangles.push_back({first_ + a, first_ + b, first_ + c});
        }
        for (const Vec3& n : normals) mesh.normals.push_back(glm::length(n) > 0 ? glm::normalize(n) : Vec3(0, 0, 1));
    }
};

double sumOf(const std::vector<double>& misfits) { return std::accumulate(misfits.begin(), misfits.end(), 0.0); }

/// Lengths with the least misfit: steps of each end, halved where none helps. `misfits`: of none, then of these.
std::vector<double> bestLengths(const PartialLight& partial, const BodyWitness& witness, BodyTrial& trial,
                                std::vector<double>& misfits) {
    std::vector<double> best(partial.ends.size(), 0);
    for (int halving = 0; halving <= halvings; ++halving) {
        for (size_t end = 0; end < best.size(); ++end)
            for (const double sign : {1.0, -1.0}) {
                std::vector<double> tried = best;
                tried[end] += sign * partial.ends[end].reach / double(2 << halving);
                if (tried[end] < 0 || tried[end] > partial.ends[end].reach) continue;
                if (!witness.allow(withEnds(partial.body, partial.ends, tried))) continue;
                std::vector<double> now = trial.misfits(tried);
                if (!(sumOf(now) < sumOf(misfits))) continue;
                misfits = std::move(now);
                best = tried;
                break;
            }
    }
    return best;
}

}  // namespace

std::vector<EmitterReplacement> completedLights(const Scene& scene, const Capture& capture,
                                                const RadianceSamples& samples, const EmitterClusters& clusters,
                                                const SolveOptions& options, Progress& progress) {
    std::vector<EmitterReplacement> result;
    for (const PartialLight& partial : partialLights(scene, capture, samples, clusters)) {
        const auto replacement = [&](const EmitterBody& body, std::string words) {
            return replacedBy(body, scene, capture, samples, clusters, partial.mesh, partial.outlines, partial.covered,
                              std::move(words));
        };
        EmitterReplacement accepted = replacement(partial.body, "");
        BodyTrial trial(scene, samples, clusters, partial, accepted, options, progress);
        if (!trial.enough()) continue;
        const std::vector<double> shown = trial.misfits(std::vector<double>(partial.ends.size(), 0));
        std::vector<double> lengths(partial.ends.size(), 0), misfits = shown;
        if (!partial.ends.empty()) {
            std::vector<double> longer = shown;
            lengths = bestLengths(partial, BodyWitness(scene, capture, samples, partial.mesh), trial, longer);
            const MisfitFall fall = misfitFall(shown, longer);
            logInfo("if it goes on to {}: {}", wordsOf(withEnds(partial.body, partial.ends, lengths)), fall.words());
            if (fall.exceeds(leastChange, leastSure)) misfits = longer;
            else std::fill(lengths.begin(), lengths.end(), 0.0);
        }
        const MisfitFall fall = misfitFall(trial.misfitsOfMesh(true), misfits);
        const EmitterBody body = withEnds(partial.body, partial.ends, lengths);
        logInfo("a light as {} in place of the mesh's: {}", wordsOf(body), fall.words());
        bool better = fall.exceeds(leastChange, leastSure) || partial.showsMore();
        if (better && !partial.certain)
            better = misfitFall(trial.misfitsOfMesh(false), misfits).exceeds(leastChange, leastSure);
        if (!better) continue;
        if (body.half != partial.body.half) accepted = replacement(body, "");
        accepted.was.words = fmt::format(
            "the mesh covers {:.0f} % of what photographs show of a light at {:.2f} {:.2f} {:.2f}, {} covers {:.0f} %: "
            "it takes its place",
            100 * partial.covered, body.centre.x + capture.origin.x, body.centre.y + capture.origin.y,
            body.centre.z + capture.origin.z, wordsOf(body), 100 * partial.body.overlap);
        result.push_back(std::move(accepted));
    }
    return result;
}

}  // namespace relamp
