#include "radiance/state_parts.h"

namespace relamp {
namespace {

/// `number`: per view what it is called in the result.
RadianceSamples observationsOf(const RadianceSamples& all, uint32_t state, const std::vector<uint32_t>* number) {
    RadianceSamples part;
    part.backgroundGrid = all.backgroundGrid;
    const int environment = all.environmentOf(state);
    const auto cells = [&](const auto& list, auto& ofState) {
        const ptrdiff_t count = ptrdiff_t(all.backgroundGrid.cells());
        if (environment < 0) ofState.assign(size_t(count), {});
        else ofState.assign(list.begin() + environment * count, list.begin() + (environment + 1) * count);
    };
    cells(all.background, part.background);
    cells(all.backgroundPixels, part.backgroundPixels);
    cells(all.backgroundClipped, part.backgroundClipped);
    part.relativeNoise = all.relativeNoise;
    part.pixelNoise = all.pixelNoise;
    part.noiseFloor = all.noiseFloor;
    part.start.reserve(all.start.size());
    part.start.push_back(0);
    for (size_t v = 0; v + 1 < all.start.size(); ++v) {
        for (uint32_t k = all.start[v]; k < all.start[v + 1]; ++k) {
            if (all.stateOf(all.samples[k].view) != state) continue;
            part.samples.push_back(all.samples[k]);
            if (number) part.samples.back().view = (*number)[all.samples[k].view];
        }
        part.start.push_back(uint32_t(part.samples.size()));
    }
    return part;
}

}  // namespace

RadianceSamples samplesOfState(const RadianceSamples& all, uint32_t state) {
    return observationsOf(all, state, nullptr);
}

Capture captureOfState(const Capture& capture, uint32_t state) {
    Capture part;
    part.folder = capture.folder;
    part.origin = capture.origin;
    for (const View& view : capture.views)
        if (view.state == state) {
            part.views.push_back(view);
            part.views.back().state = 0;
        }
    part.mesh = capture.mesh;
    part.meshReport = capture.meshReport;
    part.texcoords = capture.texcoords;
    part.up = capture.up;
    part.worldFromFile = capture.worldFromFile;
    part.metresPerUnit = capture.metresPerUnit;
    part.proxies = capture.proxies;
    return part;
}

RadianceSamples samplesOfPart(const RadianceSamples& all, uint32_t state) {
    std::vector<uint32_t> number(all.geometry.size(), 0);
    uint32_t count = 0;
    for (uint32_t view = 0; view < number.size(); ++view)
        if (all.stateOf(view) == state) number[view] = count++;
    RadianceSamples part = observationsOf(all, state, &number);
    for (uint32_t view = 0; view < number.size(); ++view)
        if (all.stateOf(view) == state) part.geometry.push_back(all.geometry[view]);
    return part;
}

std::vector<uint32_t> viewsTakenFrom(const Capture& capture, uint32_t view) {
    constexpr double apart = 1e-3;  // of the distance to the mesh's first vertex, and in radians
    const View& from = capture.views[view];
    const DVec3 place = from.camera.position();
    const double reach =
        apart * (capture.mesh.positions.empty() ? 1.0 : glm::distance(place, DVec3(capture.mesh.positions[0])));
    std::vector<uint32_t> views;
    for (uint32_t i = 0; i < capture.views.size(); ++i) {
        const Camera& camera = capture.views[i].camera;
        const bool same = capture.views[i].state != from.state && glm::distance(camera.position(), place) < reach &&
                          glm::distance(camera.forward(), from.camera.forward()) < apart;
        if (i == view || same) views.push_back(i);
    }
    return views;
}

}  // namespace relamp
