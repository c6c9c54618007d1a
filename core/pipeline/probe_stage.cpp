#include "pipeline/probe_stage.h"

#include <bit>

#include "base/log.h"
#include "base/random.h"
#include "pipeline/plan_pilot.h"

namespace relamp {
namespace {

constexpr size_t leastProbePairs = 1000;
constexpr double leastMatte = 0.15;                  // of the observations, as SolveObservations::hasMatte
constexpr double worseRise = 0.02, worseErrors = 3;  // of the pilot's misfit; standard errors

/// Asks the shading how far the fitted probe can be trusted. `without`: misfits of the pilot's pairs without it;
/// `bounce`: light from other surfaces on their points.
void askShading(const LightProbe& probe, const Scene& scene, const RadianceSamples& samples,
                const EmitterClusters& emitters, const RatioObservations& observed, const std::vector<double>& without,
                const std::vector<Rgb>& bounce, const SolveOptions& options, ProbeFit& fit, Progress& progress) {
    FittedProbe fitted = fittedProbe(probe, fit, scene.axes);
    // The pilot has few of the solve's pairs, against which a row weighs so much more.
    const float fewer = float(std::sqrt(double(observed.pairs.size()) / double(std::max<size_t>(1, without.size()))));
    for (; fit.noise <= ProbeFit::mostNoise; fit.noise *= 2) {
        fitted.fit.noise = fewer * fit.noise;
        const std::vector<double> with = pilotMisfits(scene, samples, emitters, observed.matte, observed.pairs, options,
                                                      progress, {std::make_shared<const FittedProbe>(fitted)}, bounce);
        const MisfitFall fall = misfitFall(without, with);
        logInfo("{} with a noise of {:.0f} %: {}", fit.name, 100 * fit.noise, fall.words());
        if (-fall.part <= worseRise || -fall.errors <= worseErrors) return;
        fit.contradicted = true;
    }
}

uint64_t fingerprintOfImage(const Image& image, uint64_t state) {
    state = mixBits(state ^ (uint64_t(image.width) << 32 | uint64_t(image.height)));
    for (const Rgb& p : image.pixels)
        for (int c = 0; c < 3; ++c) state = mixBits(state ^ std::bit_cast<uint32_t>(p[c])) + 1;
    for (const uint8_t u : image.usable) state = mixBits(state ^ u) + 1;
    return state;
}

}  // namespace

BallInView findBall(const MirrorBall& ball, const Capture& capture) {
    if (ball.view >= capture.views.size())
        throw Error("mirror ball {}: view {} does not exist, expected 0 to {}", ball.name, ball.view,
                    capture.views.size() - 1);
    const View& view = capture.views[ball.view];
    const Image& photograph = ball.photograph ? *ball.photograph : view.image;
    BallInView found;
    Camera& camera = found.camera = view.camera;
    const double scale = double(photograph.width) / camera.width;
    if (std::abs(photograph.height - scale * camera.height) > 1.5)
        throw Error("mirror ball {}: is {} x {} pixels, expected the shape of view {}, {} x {}", ball.name,
                    photograph.width, photograph.height, ball.view, camera.width, camera.height);
    for (double* v : {&camera.focalX, &camera.focalY, &camera.centreX, &camera.centreY}) *v *= scale;
    camera.width = photograph.width;
    camera.height = photograph.height;
    withContext("mirror ball " + ball.name, [&] { found.rim = findBallRim(photograph, camera, ball.hint); });
    return found;
}

LightProbe probeOf(const MirrorBall& ball, Capture& capture) {
    const auto [camera, rim] = findBall(ball, capture);
    View& view = capture.views[ball.view];
    const Image& photograph = ball.photograph ? *ball.photograph : view.image;
    return withContext("mirror ball " + ball.name, [&, &camera = camera, &rim = rim] {
        LightProbe probe;
        probe.name = "mirror ball " + ball.name;
        probe.aligned = true;
        probe.latLong = unwrapMirrorBall(photograph, camera, rim, ball.photograph ? ball.clip : view.saturation);
        const auto held = std::count(probe.latLong.usable.begin(), probe.latLong.usable.end(), 1);
        logInfo("mirror ball {}: {:.1f} degrees wide, an edge along {:.0f} % of its rim within {:.2f} pixels",
                ball.name, 2 * glm::degrees(rim.halfAngle), 100 * rim.support, rim.offPixels);
        if (held == 0) throw Error("every pixel of it is clipped, masked or too coarse");
        if (!ball.photograph) maskBall(camera, rim, view.image);
        return probe;
    });
}

std::vector<ProbeFit> fitProbes(const std::vector<LightProbe>& probes, const Scene& scene,
                                const RadianceSamples& samples, const EmitterClusters& emitters,
                                const SolveOptions& options, FittedProbes& used, Progress& progress) {
    std::vector<ProbeFit> fits;
    if (probes.empty()) return fits;
    std::vector<uint8_t> skip(scene.mesh.vertexCount(), 0);
    for (size_t v = 0; v < skip.size(); ++v) skip[v] = emitters.emitterOfVertex[v] >= 0;
    const RatioObservations observed = ratioObservations(scene, samples, std::move(skip), options.seed);
    size_t matte = 0;
    for (const uint32_t v : observed.matte.vertices) matte += observed.matte.componentGlossy[scene.material[v]] < 2;
    // The few pairs of a scene of metal say nothing of its light.
    const bool ask =
        observed.pairs.size() >= leastProbePairs && double(matte) > leastMatte * double(observed.matte.vertices.size());
    std::vector<double> without;
    std::vector<Rgb> bounce;
    if (ask) {
        bounce = pilotBounce(scene, samples, emitters, observed.matte, observed.pairs, options, progress);
        without = pilotMisfits(scene, samples, emitters, observed.matte, observed.pairs, options, progress, {}, bounce);
    }
    for (const LightProbe& probe : probes) {
        ProbeFit fit = fitToBackground(probe, samples);
        if (!fit.by.empty() && !without.empty())
            askShading(probe, scene, samples, emitters, observed, without, bounce, options, fit, progress);
        judge(fit);
        if (fit.doubtful()) logWarning("{}", fit.words);
        else logInfo("{}", fit.words);
        if (fit.used) used.push_back(std::make_shared<const FittedProbe>(fittedProbe(probe, fit, scene.axes)));
        fits.push_back(std::move(fit));
    }
    return fits;
}

void takeProbes(const std::vector<ProbeFit>& fits, Estimate& estimate) {
    const std::vector<ProbeFit> found = std::move(estimate.probes);
    estimate.probes = fits;
    size_t next = 0;
    for (ProbeFit& fit : estimate.probes) {
        if (!fit.used || next >= found.size()) continue;
        fit.gain = found[next].gain;
        fit.residual = found[next++].residual;
    }
}

uint64_t fingerprintOf(const LightProbe& probe) { return fingerprintOfImage(probe.latLong, probe.aligned); }

uint64_t fingerprintOf(const MirrorBall& ball) {
    uint64_t state = mixBits(ball.view + 1);
    if (ball.hint)
        for (const float v : {ball.hint->centre.x, ball.hint->centre.y, ball.hint->radius})
            state = mixBits(state ^ std::bit_cast<uint32_t>(v)) + 1;
    return ball.photograph ? fingerprintOfImage(*ball.photograph, state) : state;
}

}  // namespace relamp
