#include "solve/state/observations.h"

namespace relamp {

SolveObservations SolveObservations::of(const SolveInput& in, std::vector<uint8_t> skip, bool noMetals,
                                        const RatioObservations* planned) {
    RatioObservations anew;
    if (!planned || planned->skip != skip || planned->seed != in.options.seed || planned->noMetals != noMetals ||
        planned->matte.states() != in.samples.states) {
        anew = ratioObservations(in.scene, in.samples, std::move(skip), in.options.seed, noMetals);
        planned = &anew;
    }
    SolveObservations result;
    result.matte = planned->matte;
    result.pairs = planned->pairs;
    const MatteObservations& matte = result.matte;
    std::vector<float> brightness;
    for (const Rgb& y : matte.radiance) brightness.push_back(maxChannel(y));
    std::sort(brightness.begin(), brightness.end());
    result.darkness = brightness.empty() ? 0.0f : 1e-3f * brightness[brightness.size() * 9 / 10];
    size_t usable = 0;
    for (uint32_t v : matte.vertices) usable += matte.componentGlossy[in.scene.material[v]] < 2;
    result.matteFraction = matte.vertices.empty() ? 0 : double(usable) / double(matte.vertices.size());
    return result;
}

void SolveObservations::keepAsPhotographed() {
    if (withCoatings.vertices.empty()) withCoatings = matte;
}

void SolveObservations::backToPhotographed() {
    if (!withCoatings.vertices.empty()) matte = withCoatings;
}

void SolveObservations::readAsMatte(const SolveInput& in, const std::vector<uint8_t>& components) {
    std::vector<uint8_t> glossy = matte.componentGlossy, skip(in.scene.mesh.vertexCount(), 1);
    bool any = false;
    for (size_t p = 0; p < glossy.size(); ++p)
        if (components[p] && glossy[p]) glossy[p] = 0, any = true;
    if (!any) return;
    keepAsPhotographed();
    for (uint32_t v : matte.vertices) skip[v] = !components[in.scene.material[v]];
    const MatteObservations median = matteObservations(in.scene, in.samples, skip, &glossy);
    for (size_t state = 0; state < matte.states(); ++state) {
        size_t i = matte.beginOf(state);
        for (size_t k = median.beginOf(state); k < median.endOf(state); ++k) {
            while (matte.vertices[i] != median.vertices[k]) ++i;
            matte.radiance[i] = median.radiance[k];
            matte.sigma[i] = median.sigma[k];
        }
    }
}

}  // namespace relamp
