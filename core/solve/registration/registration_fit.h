// Poses of the cameras and a smooth displacement of the mesh under which the photographs agree.
#pragma once
#include "capture/registration_fix.h"
#include "solve/registration/log_image.h"
#include "solve/registration/normal_equations.h"

namespace relamp {

struct RegistrationPriors {
    double posePixels = 0.6;       ///< root mean square of what poses move the mesh by in the photographs
    double displacement = 0.0015;  ///< of the diagonal: standard deviation of the displacement
    double bend = 0.0004;          ///< of the diagonal: of a node from the mean of its neighbours
    double repeated = 60;          ///< so many differences tell as much as an independent one
    bool shape = true;             ///< false: poses alone
};

/// Gauss-Newton on differences of log luminance between two near places, whose mean over the views is taken out:
/// albedo, exposure and what changes slowly over the surface with the view cancel. Cauchy weights.
class RegistrationFit {
public:
    /// Keeps references to `capture` and `scene`.
    /// `mirrors`: see choosePlaces.
    RegistrationFit(const Capture& capture, const Scene& scene, const RadianceSamples& samples,
                    const std::vector<uint8_t>& mirrors = {});

    float dark() const { return places_.dark; }  ///< radiance below which little is told
    bool enough() const { return places_.pairs.size() >= 400; }
    /// Photographs blurred by so many pixels from here on, and places taken that far from edges; at most `clear`
    /// pixels, where cameras may be off by more. O(pixels).
    void blur(float sigma, float clear = 1e30f);
    /// Of the widest photograph, in the pixels that `blur` counts.
    float width() const;
    /// Scale of the Cauchy loss, log luminance: three times the median difference as it is now, or a given one.
    double usualScale() const;
    void setScale(double scale) { scale_ = scale; }
    /// `all`: pairs of regions that are left out take part as well. Some 0.1 s for 20000 places in ten views.
    void step(const RegistrationPriors& priors, bool all);
    /// Whether every fourth view takes no part in the steps and only measures.
    void leaveOutViews(bool leaveOut) { viewsLeftOut_ = leaveOut; }
    /// Mean Cauchy loss, squared log luminance: of the pairs in regions that are left out, or of the views that are
    /// left out against the mean of the others.
    double misfitOfRegions() const { return misfit(true, false).value; }
    double misfitOfViews() const { return misfit(false, true).value; }

    struct Unknowns {
        std::vector<PoseFix> poses;
        std::vector<double> moved;  ///< of each node, metres along the normal
    };
    const Unknowns& unknowns() const { return unknowns_; }
    void set(const Unknowns& unknowns);

    /// Root mean square of what the mesh moves by in the photographs, pixels.
    double pixels() const;
    /// Root mean square of the nodes' displacement, metres.
    double displacement() const;
    /// Displacements of the first `vertices` vertices.
    RegistrationFix fix(size_t vertices) const;

private:
    struct Loss {
        double value = 0, count = 0;
    };
    Loss misfit(bool leftOutRegions, bool leftOutViews) const;
    void project(size_t place);
    void observe(size_t place);
    void observeEverywhere();
    Eigen::Matrix<double, 2, 6> pixelsByPose(size_t place, const PlaceObservation& o) const;
    bool isLeftOut(size_t view) const { return viewsLeftOut_ && view % 4 == 3; }
    std::vector<PairResidual> residualsOf(const PlacePair& pair, bool ofLeftOutViews = false) const;
    /// The same of the views of one lighting state, added to `all`.
    void addResiduals(const PlacePair& pair, uint32_t state, bool ofLeftOutViews, std::vector<PairResidual>& all) const;
    void takeMotions();
    void addPriors(const RegistrationPriors& priors, NormalEquations& equations) const;
    DVec3 pointOf(size_t place) const;

    const Capture& capture_;
    const Scene& scene_;
    DisplacementGraph graph_;
    Places places_;
    std::vector<uint32_t> stateOfView_;  ///< lighting state; surfaces differ between them
    uint32_t states_ = 1;
    std::vector<std::vector<uint8_t>> edges_;  ///< of each view: edgeDistance
    int factor_ = 1;                           ///< that photographs are made smaller by before any blur
    float clear_ = 0;                          ///< pixels that a place must be from edges
    std::vector<LogImage> images_;
    Unknowns unknowns_;
    bool viewsLeftOut_ = false;
    std::vector<Camera> cameras_;
    std::vector<PoseMatrix> motions_;  ///< of each view: mean square of pixels by its pose, the metric of the prior
    double scale_ = 0.05;              ///< of the Cauchy loss, log luminance
};

}  // namespace relamp
