// Light references in the pipeline: mirror balls are unwrapped, probes are fitted to what photographs show before the
// solve, and reported after it.
#pragma once
#include "capture/mirror_ball.h"
#include "solve/solve.h"

namespace relamp {

/// A mirror ball, in a photograph of its own or in one of the capture's.
struct MirrorBall {
    std::string name;
    std::optional<Image> photograph;  ///< taken with the view's camera; none: the view's own photograph
    float clip = 0;                   ///< at and above which that one is clipped; 0: nowhere
    size_t view = 0;
    std::optional<BallHint> hint;
};

/// Where the ball is, and the camera of the photograph that shows it. Throws Error that names the ball: no such view,
/// another shape than the view's, no ball found.
struct BallInView {
    Camera camera;
    BallRim rim;
};
BallInView findBall(const MirrorBall& ball, const Capture& capture);

/// What the ball mirrors. Throws Error as findBall, and for a ball that shows nothing. A ball in the capture's own
/// photograph is masked there: it is no background.
LightProbe probeOf(const MirrorBall& ball, Capture& capture);

/// Fits each probe to the background, and asks the shading of the surfaces: where the pilot's pairs are explained worse
/// with it than without it (2 %, three standard errors), its noise is doubled until they are not. Says so in the log,
/// as a warning for one that does not suit the photographs, and puts those that take part into `used`.
std::vector<ProbeFit> fitProbes(const std::vector<LightProbe>& probes, const Scene& scene,
                                const RadianceSamples& samples, const EmitterClusters& emitters,
                                const SolveOptions& options, FittedProbes& used, Progress& progress);

/// Puts what is to be said of all probes into the estimate, which holds those that took part.
void takeProbes(const std::vector<ProbeFit>& fits, Estimate& estimate);

/// Numbers that rest on all texels.
uint64_t fingerprintOf(const LightProbe& probe);
uint64_t fingerprintOf(const MirrorBall& ball);

}  // namespace relamp
