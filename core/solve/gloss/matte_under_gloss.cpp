#include "solve/gloss/matte_under_gloss.h"

#include "base/parallel.h"
#include "transport/shared_directions.h"

namespace relamp {

void matteUnderGloss(const Capture& capture, const Scene& scene, const RadianceSamples& samples,
                     const std::vector<EmitterSurface>& emitters, const std::vector<int>& emitterOfTriangle,
                     const Lighting& lighting, const ComponentGloss& gloss, const MatteUnderGlossOptions& options,
                     MatteObservations& matte, Progress& progress) {
    std::vector<size_t> here;
    for (size_t i = 0; i < matte.vertices.size(); ++i)
        if (scene.material[matte.vertices[i]] == gloss.component) here.push_back(i);
    const DirectionScene in{scene, emitters, emitterOfTriangle, lighting.leaves};
    progress.begin("Matte under gloss", here.size());
    parallelFor(
        here.size(), 16,
        [&](size_t k) {
            const uint32_t v = matte.vertices[here[k]];
            std::vector<float> row(lighting.leaves.size() + emitters.size());
            std::vector<Rgb> coating;
            std::vector<uint32_t> usable;
            float best = 0;
            LobeRowOptions rows = options.rows;
            rows.state = uint32_t(matte.stateOf(here[k]));
            const auto counts = [&](const RadianceSample& r) {
                return !r.clipped && samples.stateOf(r.view) == rows.state;
            };
            for (uint32_t s = samples.start[v]; s < samples.start[v + 1]; ++s)
                if (counts(samples.samples[s])) best = std::max(best, samples.samples[s].weight);
            thread_local SharedDirections shared;
            drawSharedDirections(in, v, rows, shared);
            for (uint32_t s = samples.start[v]; s < samples.start[v + 1]; ++s) {
                const RadianceSample& r = samples.samples[s];
                if (!counts(r) || r.weight < 0.2f * best) continue;
                const Vec3 towardEye =
                    glm::normalize(Vec3(capture.views[r.view].camera.position()) - scene.mesh.positions[v]);
                Rgb reflected(0);
                glossyInfluence(in, shared, *gloss.lobe, towardEye, rows, row.data(), &reflected);
                coating.push_back(gloss.weight * (lightOfRow(row.data(), lighting) + reflected));
                usable.push_back(s);
            }
            Rgb value(0), sigma(0);
            std::vector<MatteObservation> observations(usable.size());
            for (int c = 0; c < 3; ++c) {
                float mean = 0, total = 0;
                for (size_t i = 0; i < usable.size(); ++i) {
                    const RadianceSample& r = samples.samples[usable[i]];
                    const float y = r.radiance[c], noise = samples.sigma(y) + 1e-20f,
                                doubt = options.doubt * coating[i][c] / noise;
                    observations[i] = {y - coating[i][c], r.weight / (1 + doubt * doubt), noise};
                    mean += observations[i].weight * coating[i][c];
                    total += observations[i].weight;
                }
                const MatteValue matteValue = robustMatteValue(observations, 0.5f);
                if (!(matteValue.radiance > 0.05f * matte.radiance[here[k]][c])) return;
                value[c] = matteValue.radiance;
                sigma[c] = std::hypot(matteValue.sigma, 0.03f * value[c], options.doubt * mean / total);
            }
            matte.radiance[here[k]] = value;
            matte.sigma[here[k]] = sigma;
        },
        &progress);
}

}  // namespace relamp
