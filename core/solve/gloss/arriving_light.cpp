#include "solve/gloss/arriving_light.h"

#include <array>

#include "base/parallel.h"
#include "transport/shared_directions.h"

namespace relamp {
namespace {

using Direction = ArrivingLight::Direction;

/// Draws the directions of all observations of one vertex after the other.
struct ArrivingSampler {
    DirectionScene in;
    const Lighting& lighting;
    const LobeRowOptions& options;

    /// `each(i, eye, directions)` hears of the observations first ... last - 1, all of one vertex and state; without
    /// directions where the surface faces away.
    template <class Each>
    void draw(const std::vector<GlossyObservation>& observations, size_t first, size_t last, const Each& each) const {
        constexpr std::array<float, 4> widths{0.006f, 0.03f, 0.12f, 0.45f};
        const int ofWidth = std::max(8, options.lobeSamples / 3);
        LobeRowOptions here = options;
        here.state = observations[first].state;
        const std::vector<Rgb> shines = here.shining(lighting);
        thread_local SharedDirections shared;
        thread_local std::vector<MetLight> met;
        thread_local std::vector<Direction> arriving;
        drawSharedDirections(in, observations[first].vertex, here, shared);
        const size_t leaves = in.leaves.size();
        for (size_t i = first; i < last; ++i) {
            arriving.clear();
            const Vec3 eye = glm::transpose(shared.frame) * observations[i].towardEye;
            const auto take = [&](const MetLight& m) {
                float drawn = m.local.z / pi * float(options.cosineSamples);
                for (const float alpha : widths) drawn += float(ofWidth) * ggxSampleDensity(m.local, eye, alpha);
                if (!(m.areaDensity + drawn > 0)) return;
                const Rgb radiance = m.column == MetLight::none ? m.outgoing
                                     : m.column < leaves        ? lighting.leafRadiance[m.column] * m.level
                                                                : shines[m.column - leaves] * m.level;
                arriving.push_back({m.local, radiance * (m.local.z / (m.areaDensity + drawn))});
            };
            if (glm::dot(in.scene.mesh.normals[shared.vertex], observations[i].towardEye) > 1e-3f) {
                met.clear();
                drawFromLobes(in, shared, eye, widths, ofWidth, 11, here, met);
                for (const MetLight& m : shared.emitters) take(m);
                for (const MetLight& m : met) take(m);
                for (const MetLight& m : shared.cosine) take(m);
            }
            each(i, eye, arriving);
        }
    }
};

Rgb sumThrough(const Lobe& lobe, const std::vector<Direction>& arriving, const Vec3& eye) {
    Rgb sum(0);
    for (const Direction& d : arriving) sum += evaluateLobe(lobe, d.local, eye) * d.radiance;
    return sum;
}

/// `each(i, eye, directions)` for all observations, by all threads.
template <class Each>
void forAll(const ArrivingSampler& sampler, const std::vector<GlossyObservation>& observations, Progress& progress,
            const Each& each) {
    const std::vector<size_t> starts = startsOfVertices(observations);
    progress.begin("Trying lobes", starts.size() - 1);
    parallelFor(
        starts.size() - 1, 4, [&](size_t g) { sampler.draw(observations, starts[g], starts[g + 1], each); }, &progress);
}

}  // namespace

ArrivingLight::ArrivingLight(const Scene& scene, const std::vector<EmitterSurface>& emitters,
                             const std::vector<int>& emitterOfTriangle, const Lighting& lighting,
                             const std::vector<GlossyObservation>& observations, const LobeRowOptions& rows,
                             Progress& progress)
    : directions_(observations.size()), eye_(observations.size()) {
    forAll({{scene, emitters, emitterOfTriangle, lighting.leaves}, lighting, rows}, observations, progress,
           [&](size_t i, const Vec3& eye, const std::vector<Direction>& arriving) {
               eye_[i] = eye;
               directions_[i] = arriving;  // of the size it needs
           });
}

std::vector<Rgb> ArrivingLight::through(const Lobe& lobe) const {
    std::vector<Rgb> response(directions_.size());
    parallelFor(response.size(), 16, [&](size_t i) { response[i] = sumThrough(lobe, directions_[i], eye_[i]); });
    return response;
}

std::vector<std::vector<Rgb>> lobeResponses(const Scene& scene, const std::vector<EmitterSurface>& emitters,
                                            const std::vector<int>& emitterOfTriangle, const Lighting& lighting,
                                            const std::vector<Lobe>& lobes,
                                            const std::vector<GlossyObservation>& observations,
                                            const LobeRowOptions& rows, Progress& progress) {
    std::vector<std::vector<Rgb>> responses(lobes.size(), std::vector<Rgb>(observations.size(), Rgb(0)));
    forAll({{scene, emitters, emitterOfTriangle, lighting.leaves}, lighting, rows}, observations, progress,
           [&](size_t i, const Vec3& eye, const std::vector<Direction>& arriving) {
               for (size_t k = 1; k < lobes.size(); ++k) responses[k][i] = sumThrough(lobes[k], arriving, eye);
           });
    return responses;
}

}  // namespace relamp
