#include "solve/registration/registration.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>

namespace relamp {
namespace {

constexpr float sharpest = 0.8f;
constexpr float blurs[] = {3.0f, 1.5f, sharpest};            ///< pixels
constexpr float wideBlurs[] = {6.0f, 3.0f, 1.5f, sharpest};  ///< for another shape
constexpr int mostSteps = 10;                                ///< at each
constexpr double farOff = 1e-3;  ///< misfit, squared log luminance, above which much may be wrong
// Of the photographs' width, for cameras that are far off.
constexpr float widestBlur = 0.019f;  ///< 12 of 640 pixels
constexpr float farPoses = 0.0125f;   ///< standard deviation of what they move the mesh by in the photographs
constexpr float afterFar = farPoses / 3;
constexpr double worthIt = 0.8;  ///< of the misfit, that is left at most

/// Room for hulls and coarse meshes, with poses as they are.
RegistrationPriors widePriors() {
    RegistrationPriors priors;
    priors.posePixels = 0.05;
    priors.displacement = 0.01;
    priors.bend = 0.003;
    priors.repeated = 3;
    return priors;
}

class Registration {
public:
    Registration(const Capture& capture, const Scene& scene, const RadianceSamples& samples,
                 const RegistrationTask& task, Progress& progress)
        : fit_(capture, scene, samples, task.mirrors),
          capture_(capture),
          scene_(scene),
          vertices_(task.vertices),
          progress_(progress) {}

    bool enough() const { return fit_.enough(); }

    /// Poses and a little of shape, for what is off by pixels.
    void refine(const RegistrationTask& task, RegistrationEstimate& found) {
        RegistrationPriors priors;
        priors.shape = task.shape;
        if (task.afterFar) priors.posePixels = std::max(priors.posePixels, double(afterFar * fit_.width()));
        const RegistrationFit::Unknowns given = fit_.unknowns();
        fit_.blur(sharpest);
        const double scale = fit_.usualScale();
        fit_.setScale(scale);
        found.before = fit_.misfitOfRegions();
        descend(blurs, priors, false);
        fit_.setScale(scale);
        found.after = fit_.misfitOfRegions();
        report(found);
        if (found.moved()) {
            fit_.setScale(fit_.usualScale());
            step(priors, true);
            report(found);
        } else {
            fit_.set(given);
        }
    }

    /// Poses alone, from photographs that are hardly more than patches of light and dark.
    void bringFarCameras(RegistrationEstimate& found) {
        const RegistrationFit::Unknowns given = fit_.unknowns();
        const RegistrationFix before = fix();
        fit_.blur(sharpest);
        const double scale = fit_.usualScale();
        fit_.setScale(scale);
        found.farBefore = fit_.misfitOfRegions();
        RegistrationPriors priors;
        priors.shape = false;
        priors.posePixels = double(farPoses * fit_.width());
        fit_.set({given.poses, std::vector<double>(given.moved.size(), 0)});
        const float widest = std::max(blurs[0], widestBlur * fit_.width());
        std::vector<float> halves;
        for (float sigma = widest; sigma > 2 * sharpest; sigma /= 2) halves.push_back(sigma);
        descend(halves, priors, false, widest / 3);
        fit_.blur(sharpest);
        fit_.setScale(scale);
        found.farAfter = fit_.misfitOfRegions();
        if (found.farAfter < worthIt * found.farBefore && keepsOutlines(before)) {
            found.farPoses = fit_.unknowns().poses;
            found.farPixels = fit_.pixels();
        } else {
            fit_.set(given);
        }
    }

    /// Shape at large, for visual hulls and the like: kept where views that are left out agree better with it.
    void reshape(RegistrationEstimate& found) {
        const RegistrationFit::Unknowns given = fit_.unknowns();
        const RegistrationFix before = fix();
        fit_.leaveOutViews(true);
        const double scale = fit_.usualScale();
        fit_.setScale(scale);
        found.viewsBefore = fit_.misfitOfViews();
        descend(wideBlurs, widePriors(), true);
        fit_.setScale(scale);
        found.viewsAfter = fit_.misfitOfViews();
        fit_.leaveOutViews(false);
        found.outlinesLost = found.reshaped() && !keepsOutlines(before);
        if (!found.reshaped()) return fit_.set(given);
        fit_.setScale(fit_.usualScale());
        step(widePriors(), true);
        report(found);
    }

    RegistrationFix fix() const { return fit_.fix(vertices_); }
    float dark() const { return fit_.dark(); }

private:
    /// `clear`: see RegistrationFit::blur.
    void descend(std::span<const float> blursDown, const RegistrationPriors& priors, bool all, float clear = 1e30f) {
        for (const float sigma : blursDown) {
            fit_.blur(sigma, clear);
            fit_.setScale(fit_.usualScale());
            step(priors, all);
        }
    }
    void step(RegistrationPriors priors, bool all) {
        const double room = priors.posePixels;
        for (int k = 0; k < mostSteps && !progress_.outOfTime(); ++k) {
            const double before = fit_.pixels();
            // Cameras that turn out to be off by more are given more room.
            if (room > 0.1) priors.posePixels = std::max(room, 0.8 * before);
            fit_.step(priors, all);
            progress_.advance();
            const double after = fit_.pixels();
            if (k > 1 && std::abs(after - before) < 0.02 * std::max(0.1, after)) break;
        }
    }
    void report(RegistrationEstimate& found) const {
        found.pixels = fit_.pixels();
        found.displacement = fit_.displacement() / double(scene_.diagonal);
    }
    /// Whether outlines lie in place as often as with `before`. Reflections move with the eye: cameras and shapes that
    /// let them agree are wrong, and outlines tell.
    bool keepsOutlines(const RegistrationFix& before) const {
        const size_t had = outlinesInPlace(capture_, scene_, before, fit_.dark(), progress_);
        return had < leastPoints || outlinesInPlace(capture_, scene_, fix(), fit_.dark(), progress_) >= had;
    }

    RegistrationFit fit_;
    const Capture& capture_;
    const Scene& scene_;
    size_t vertices_;
    Progress& progress_;
};

}  // namespace

std::string toText(const RegistrationEstimate& e) {
    if (!(e.before > 0)) return "cameras and mesh: too few places are seen by three photographs";
    std::string text = fmt::format(
        "photographs agree {:.0f} % better with cameras and mesh moved by {:.2f} pixels in them (the surface by {:.3f} "
        "% "
        "of the diagonal)",
        100 * (1 - e.after / e.before), e.pixels, 100 * e.displacement);
    if (e.contours.points >= leastPoints && e.contours.before > closeEnough) text += "; " + toText(e.contours);
    if (e.viewsBefore > 0)
        text += fmt::format("; with another shape photographs that were left out agree {:.0f} % better",
                            100 * (1 - e.viewsAfter / e.viewsBefore));
    if (e.outlinesLost) text += ", but outlines leave their place";
    return text;
}

std::string farText(const RegistrationEstimate& e) {
    return fmt::format("cameras stand {:.1f} pixels from where photographs agree {:.0f} % better: moved there",
                       e.farPixels, 100 * (1 - e.farAfter / e.farBefore));
}

RegistrationEstimate estimateRegistration(const Capture& capture, const Scene& scene, const RadianceSamples& samples,
                                          const RegistrationTask& task, Progress& progress) {
    RegistrationEstimate found;
    Registration registration(capture, scene, samples, task, progress);
    if (!registration.enough()) return found;
    progress.begin("Bringing cameras and mesh together", (std::size(blurs) + 1) * mostSteps);
    registration.refine(task, found);
    const bool far = (found.moved() ? found.after : found.before) > farOff;
    if (far && task.farCameras && !progress.outOfTime()) {
        progress.begin("Cameras that are far off", 4 * mostSteps);
        registration.bringFarCameras(found);
        if (!found.farPoses.empty()) return found;
    }
    if (far && task.shape && !progress.outOfTime()) {
        progress.begin("Shape from the photographs", (std::size(wideBlurs) + 1) * mostSteps);
        registration.reshape(found);
    }
    if (found.needed()) found.fix = registration.fix();
    if (task.shape && !progress.outOfTime()) {
        found.contours = alignContours(capture, scene, found.fix, task.vertices, task.emits, registration.dark(),
                                       progress, found.needed() ? outlinesBesides : outlinesAlone);
        if (found.contours.needed()) found.fix = std::move(found.contours.fix);
    }
    return found;
}

}  // namespace relamp
