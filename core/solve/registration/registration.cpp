#include "solve/registration/registration.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace relamp {
namespace {

constexpr float sharpest = 0.8f;
constexpr float blurs[] = {3.0f, 1.5f, sharpest};  ///< pixels
constexpr int mostSteps = 10;                      ///< at each

}  // namespace

std::string toText(const RegistrationEstimate& e) {
    if (!(e.before > 0)) return "cameras and mesh: too few places are seen by three photographs";
    return fmt::format(
        "photographs agree {:.0f} % better with the mesh moved by {:.2f} pixels in them (its surface by {:.3f} % of "
        "the "
        "diagonal)",
        100 * (1 - e.after / e.before), e.pixels, 100 * e.displacement);
}

RegistrationEstimate estimateRegistration(const Capture& capture, const Scene& scene, const RadianceSamples& samples,
                                          size_t vertices, bool shape, Progress& progress) {
    RegistrationEstimate found;
    RegistrationPriors priors;
    priors.shape = shape;
    RegistrationFit fit(capture, scene, samples);
    if (!fit.enough()) return found;
    progress.begin("Bringing cameras and mesh together", 1 + (std::size(blurs) + 1) * mostSteps);
    // Cameras that turn out to be off by more are given more room.
    const double room = priors.posePixels;
    const auto steps = [&](bool all) {
        for (int k = 0; k < mostSteps; ++k) {
            const double before = fit.pixels();
            priors.posePixels = std::max(room, 0.8 * before);
            fit.step(priors, all);
            progress.advance();
            const double after = fit.pixels();
            if (k > 1 && std::abs(after - before) < 0.02 * std::max(0.1, after)) break;
        }
    };
    fit.blur(sharpest);
    const double scale = fit.usualScale();
    fit.setScale(scale);
    found.before = fit.leftOutMisfit();
    progress.advance();
    for (const float sigma : blurs) {
        fit.blur(sigma);
        fit.setScale(fit.usualScale());
        steps(false);
    }
    fit.setScale(scale);
    found.after = fit.leftOutMisfit();
    found.pixels = fit.pixels();
    found.displacement = fit.displacement() / double(scene.diagonal);
    if (!found.needed()) return found;
    fit.setScale(fit.usualScale());
    steps(true);
    found.pixels = fit.pixels();
    found.displacement = fit.displacement() / double(scene.diagonal);
    found.fix = fit.fix(vertices);
    return found;
}

}  // namespace relamp
