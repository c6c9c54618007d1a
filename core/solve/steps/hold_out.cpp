// Albedo without two views, for the held-out prediction of their photographs.
#include "radiance/state_parts.h"
#include "solve/steps/steps.h"

namespace relamp {

std::vector<HeldOutAlbedo> holdOutViews(const SolveRun& s, const Irradiance& irradiance) {
    std::vector<HeldOutAlbedo> held;
    const uint32_t state = s.mainState();
    std::vector<size_t> ofState;
    for (size_t i = 0; i < s.in.capture.views.size(); ++i)
        if (s.in.samples.stateOf(uint32_t(i)) == state) ofState.push_back(i);
    const size_t views = ofState.size();
    if (views < 4 || !s.hasMatte() || s.stopped()) return held;
    const std::vector<uint8_t> skip = s.emitters.skip();
    const MatteObservations& whole = s.observed.matte;
    std::vector<std::vector<uint32_t>> at(whole.states(), std::vector<uint32_t>(s.in.scene.mesh.vertexCount(), 0));
    for (size_t i = 0; i < whole.vertices.size(); ++i) at[whole.stateOf(i)][whole.vertices[i]] = uint32_t(i);
    AlbedoPrior prior = s.surfaces.prior;
    prior.iterations = 2;
    for (const size_t view : {ofState[views / 3], ofState[2 * views / 3]}) {
        RadianceSamples others;
        others.relativeNoise = s.in.samples.relativeNoise;
        others.noiseFloor = s.in.samples.noiseFloor;
        others.states = s.in.samples.states;
        others.stateOfView = s.in.samples.stateOfView;
        others.environmentOfState.assign(others.states, -1);  // no background is asked for
        std::vector<uint8_t> left(s.in.capture.views.size(), 0);
        for (const uint32_t alike : viewsTakenFrom(s.in.capture, uint32_t(view))) left[alike] = 1;
        others.start.assign(1, 0);
        for (uint32_t v = 0; v < skip.size(); ++v) {
            for (uint32_t i = s.in.samples.start[v]; i < s.in.samples.start[v + 1]; ++i)
                if (!left[s.in.samples.samples[i].view]) others.samples.push_back(s.in.samples.samples[i]);
            others.start.push_back(uint32_t(others.samples.size()));
        }
        MatteObservations matte = matteObservations(s.in.scene, others, skip, &whole.componentGlossy);
        if (matte.vertices.empty()) continue;
        std::vector<Rgb> lit, litSigma;
        for (size_t i = 0; i < matte.vertices.size(); ++i) {
            const uint32_t k = at[matte.stateOf(i)][matte.vertices[i]];
            lit.push_back(irradiance.value[k]);
            litSigma.push_back(irradiance.sigma[k]);
            // What coatings reflect, as it was taken off the whole.
            if (!s.observed.withCoatings.vertices.empty())
                matte.radiance[i] *= whole.radiance[k] / glm::max(s.observed.withCoatings.radiance[k], Rgb(1e-20f));
        }
        AlbedoResult albedo = solveAlbedo(s.in.scene, matte, lit, litSigma, prior, s.in.progress);
        s.gloss.withoutMetals(s.in.scene, albedo.albedo);
        for (size_t v = 0; v < skip.size(); ++v)
            if (skip[v]) albedo.albedo[v] = Rgb(0);
        held.push_back({view, std::move(albedo.albedo)});
    }
    return held;
}

}  // namespace relamp
