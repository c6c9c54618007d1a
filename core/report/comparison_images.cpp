#include <algorithm>
#include <memory>
#include <set>

#include "display/display_image.h"
#include "image/environment_map.h"
#include "relight/frame.h"
#include "relight/look_track.h"
#include "report/comparison.h"
#include "shot/relit_looks.h"

namespace relamp {
namespace {

constexpr int longestImageSide = 400;
constexpr size_t measuredAtMost = 12;
const Rgb pageGround(0.022f);  // linear; a little lighter than the page, so that a cut-out ends visibly

/// `wanted` numbers of 0 ... count - 1, spread evenly, the first included.
std::vector<size_t> spread(size_t count, size_t wanted) {
    wanted = std::min(count, wanted);
    std::vector<size_t> numbers;
    for (size_t i = 0; i < wanted; ++i) numbers.push_back(i * count / wanted);
    return numbers;
}

FrameOptions fewSamples(bool background) {
    FrameOptions options;
    options.samplesPerPixel = 4;
    options.denoise = true;
    options.background = background;
    return options;
}

Image beautyOf(const Frame& frame) {
    Image image(frame.width, frame.height);
    image.pixels = frame.beauty;
    return image;
}

Image offOf(RelitScene relit, const Camera& camera, Progress& progress) {
    for (RelitEmitter& emitter : relit.emitters) emitter.emission = {};
    return beautyOf(renderFrame(relit, camera, fewSamples(true), progress));
}

/// Surfaces alone under light of radiance 1 from everywhere.
Image whiteOf(RelitScene relit, const Camera& camera, Progress& progress) {
    for (RelitEmitter& emitter : relit.emitters) emitter.emission = {};
    const DirectionGrid grid{16};
    relit.distant = std::make_shared<const DistantLight>(grid, std::vector<Rgb>(size_t(grid.cells()), Rgb(1)));
    const Frame frame = renderFrame(relit, camera, fewSamples(false), progress);
    return over(frame.beauty, frame.alpha, frame.width, frame.height, pageGround);
}

/// Sums over views of one mode.
struct Measures {
    DisplayError error;
    std::vector<DisplayError> ofState;
    double worst = 1e9, tint = 0;
    std::string worstView;
};

/// `count` views that are spread evenly, and one of each lighting state at least.
std::set<size_t> viewsOfEachState(const Capture& capture, size_t count) {
    const std::vector<size_t> evenly = spread(capture.views.size(), count);
    std::set<size_t> views(evenly.begin(), evenly.end()), states;
    for (const size_t v : views) states.insert(capture.views[v].state);
    for (size_t v = 0; v < capture.views.size(); ++v)
        if (states.insert(capture.views[v].state).second) views.insert(v);
    return views;
}

/// The lights as photographed, of both modes.
using LitModes = std::array<RelitLooks, 2>;

void measureViews(const Capture& capture, LitModes& lit, int maxViews, Comparison& comparison, Progress& progress) {
    const std::vector<size_t> shown = spread(capture.views.size(), size_t(std::max(0, maxViews)));
    std::set<size_t> measured = viewsOfEachState(capture, measuredAtMost);
    measured.insert(shown.begin(), shown.end());
    comparison.measuredViews = measured.size();
    std::array<Measures, 2> sums;
    for (Measures& sum : sums) sum.ofState.resize(capture.states.size());
    for (size_t v : measured) {
        const View& view = capture.views[v];
        const Camera camera = smallerCamera(view.camera, longestImageSide);
        const Image photograph = shrunk(view.image, camera.width, camera.height);
        const float exposure = exposureFor(photograph);
        const bool show = std::find(shown.begin(), shown.end(), v) != shown.end();
        ComparedView images;
        images.name = view.name;
        if (!capture.states.empty()) images.state = capture.states[view.state];
        images.photograph = scaledBy(photograph, exposure);
        for (size_t m = 0; m < 2; ++m) {
            const Frame frame = renderFrame(lit[m].captured(progress, view.state), camera, fewSamples(true), progress);
            const Image model = beautyOf(frame);
            std::vector<uint8_t> mask(frame.alpha.size());
            for (size_t i = 0; i < mask.size(); ++i) mask[i] = frame.alpha[i] > 0.999f && photograph.usable[i];
            const DisplayError error = displayError(model, photograph, mask, exposure);
            images.psnr[m] = error.psnr();
            sums[m].error.squares += error.squares;
            sums[m].error.pixels += error.pixels;
            if (!capture.states.empty()) {
                sums[m].ofState[view.state].squares += error.squares;
                sums[m].ofState[view.state].pixels += error.pixels;
            }
            sums[m].tint += meanTintDegrees(frame.albedo, mask);
            if (error.pixels && error.psnr() < sums[m].worst) {
                sums[m].worst = error.psnr();
                sums[m].worstView = view.name;
            }
            if (!show) continue;
            images.model[m] = scaledBy(model, exposure);
            images.difference[m] = differenceOf(model, photograph, exposure);
            images.albedo[m] = over(frame.albedo, frame.alpha, frame.width, frame.height, pageGround);
            images.tint[m] =
                over(tintsOf(frame.albedo, frame.alpha), frame.alpha, frame.width, frame.height, pageGround);
        }
        if (show) comparison.shown.push_back(std::move(images));
    }
    for (size_t m = 0; m < 2; ++m) {
        comparison.modes[m].psnr = sums[m].error.psnr();
        comparison.modes[m].worstPsnr = sums[m].error.pixels ? sums[m].worst : 0;
        comparison.modes[m].worstView = sums[m].worstView;
        for (const DisplayError& error : sums[m].ofState) comparison.modes[m].psnrOfState.push_back(error.psnr());
        comparison.modes[m].tintDegrees = sums[m].tint / double(std::max<size_t>(1, measured.size()));
    }
}

}  // namespace

void drawComparison(const Capture& capture, const Scene& scene, int maxViews, Comparison& comparison,
                    Progress& progress) {
    if (capture.views.empty()) return;
    const LookTrack asFound(Look{});
    LitModes lit{RelitLooks(comparison.modes[0].shot.estimate, scene, asFound),
                 RelitLooks(comparison.modes[1].shot.estimate, scene, asFound)};
    comparison.states = capture.states;
    measureViews(capture, lit, maxViews, comparison, progress);

    // Both modes share one exposure in every pair, the near-field one's: a mode that is too dark or too bright must
    // look so.
    const View& first = capture.views.front();
    if (!capture.states.empty()) comparison.stateShown = capture.states[first.state];
    const Camera camera = smallerCamera(first.camera, longestImageSide);
    const float photographExposure = exposureFor(shrunk(first.image, camera.width, camera.height));
    std::array<Image, 2> environment, off;
    for (size_t m = 0; m < 2; ++m) {
        const Estimate& estimate = comparison.modes[m].shot.estimate;
        const DirectionGrid grid{estimate.environmentSide};
        std::vector<Rgb> cells =
            estimate.states.empty() ? estimate.environment : environmentOf(estimate, estimate.states[first.state]);
        cells.resize(size_t(grid.cells()), Rgb(0));
        environment[m] = latLongFromCells(cells, grid, 512);
        const RelitScene& relit = lit[m].captured(progress, first.state);
        off[m] = offOf(relit, camera, progress);
        comparison.modes[m].white = whiteOf(relit, camera, progress);
    }
    const float environmentExposure = exposureFor(environment[0]), offExposure = exposureFor(off[0]);
    comparison.environmentStops = std::log2(environmentExposure / photographExposure);
    comparison.offStops = std::log2(offExposure / photographExposure);
    for (size_t m = 0; m < 2; ++m) {
        comparison.modes[m].environment = scaledBy(std::move(environment[m]), environmentExposure);
        comparison.modes[m].emittersOff = scaledBy(std::move(off[m]), offExposure);
    }
}

}  // namespace relamp
