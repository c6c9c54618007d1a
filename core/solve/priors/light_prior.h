// The one place where knowledge about the light enters: what is seen directly, and smoothness relative to its own
// brightness.
#pragma once
#include <Eigen/Core>
#include <array>
#include <optional>
#include <utility>
#include <vector>

#include "solve/priors/anchors.h"
#include "solve/probe/probe_rows.h"
#include "solve/ratio/influence_rows.h"

namespace relamp {

struct LightPriorOptions {
    float smoothness = 60;  ///< weight of relative differences between neighbouring leaves of a side of 16; half of it
                            ///< on edges half as long
    float hue = 8;          ///< weight of differences between channels of those relative differences, times smoothness
    float backgroundWeight =
        30;  ///< observations a directly seen leaf counts for, at its spread of 2 % (whole) to 72 % (hardly covered)
    float darkness =
        0;  ///< radiance below which the mean of the distant light counts as black: relative terms end there
    float emitterWeight =
        1e3f;  ///< times the data's own weight on an emitter: what is seen directly outweighs model error
};

/// Priors on x = [L; P], channel by channel, shared by the albedo-free start and the lighting program; and on its hue,
/// which only the start uses, because the lighting program takes each channel by itself.
class LightPrior {
public:
    /// `rows`, if given, hold what the unknowns give to what is looked at. Brightness is then computed by what
    /// reaches that: a mean over all directions would rise with light that nothing receives, and with it no difference
    /// between the others would count any more.
    LightPrior(const LightLeaves& leaves, const LightAnchors& anchors, const LightPriorOptions& options,
               std::optional<InfluenceRows> rows = {});
    LightPrior(const LightPrior&) = delete;
    /// Sum of the smoothness and background terms (the emitters' near-equalities hold by construction).
    double value(const Eigen::VectorXd& x, int channel) const;
    /// Lower bounds of a channel: what is seen of a leaf, even if the rest of it were black, and clipped emitters.
    Eigen::VectorXd lowest(int channel) const;
    /// Adds the quadratic model of the priors about x: q, moment (minimise x'qx - 2 moment'x), and sets the lower
    /// bounds. The smoothness term is a Gauss-Newton model of r = (L_i - L_j) / d, d^2 = mean^2 + middle^2, with the
    /// derivative of d: a model without it shrinks the light, with it the scale of the light is free.
    void add(const Eigen::VectorXd& x, int channel, Eigen::MatrixXd& q, Eigen::VectorXd& moment,
             Eigen::VectorXd& lower) const;
    /// The hue of neighbouring leaves: sum over pairs of channels of w (r_c - r_d)^2 with the relative differences r of
    /// the smoothness term. Channels below a hundredth of the brightest one's mean have no say. `x`: the three
    /// channels.
    double hueValue(const Eigen::VectorXd* x) const;
    /// Adds its quadratic model about x to that of all three channels, one after the other.
    void addHue(const Eigen::VectorXd* x, Eigen::MatrixXd& q, Eigen::VectorXd& moment) const;
    /// Of what `add` puts on the diagonal, the part that comes from light seen directly: background and unclipped
    /// emitters.
    Eigen::VectorXd seenDirectly(const Eigen::VectorXd& x, int channel, const Eigen::MatrixXd& q) const;

    /// Of what `add` adds, the part that comes from light probes.
    Eigen::MatrixXd fromProbes(const Eigen::VectorXd& x, int channel) const;
    /// The gain of light probe `probe` under the light x, beside what its anchor has.
    double gainOf(size_t probe, const Eigen::VectorXd& x, int channel) const { return probes_[probe].gain(x, channel); }

private:
    const LightAnchors& anchors_;
    LightPriorOptions options_;
    std::vector<std::pair<uint32_t, uint32_t>> neighbours_;
    std::vector<double> edge_;          ///< per pair: length of its edge over that of the leaves of a side of 16
    std::vector<uint8_t> environment_;  ///< per leaf
    /// Per environment, of each leaf in its mean brightness: together 1, and 0 for leaves of others.
    std::vector<Eigen::VectorXd> fraction_;
    std::vector<ProbeRows> probes_;
    /// Relative difference of a pair, and its derivative: along its two leaves, and -beta along the mean.
    struct Difference {
        double value, along[2], beta, atPresent;  ///< atPresent: the derivative times x itself
    };
    Difference difference(const Eigen::VectorXd& x, size_t pair, double unit, bool unitIsFree) const;
    Eigen::Index leaves() const { return Eigen::Index(environment_.size()); }
    /// Per environment.
    std::vector<double> meansOf(const Eigen::VectorXd& x) const;
    size_t environmentOf(size_t pair) const { return environment_[neighbours_[pair].first]; }
    /// Which channels' differences count: symmetric, rows sum to zero.
    using HueCoupling = std::array<std::array<double, 3>, 3>;
    /// Per environment.
    std::vector<HueCoupling> hueCouplings(const std::array<std::vector<double>, 3>& units) const;
    /// Per environment: at the floor its mean is a constant.
    std::vector<uint8_t> areFree(const Eigen::VectorXd& x, const std::vector<double>& units) const;
    double smoothness(size_t pair) const;
    double background(size_t leaf, int channel, double unit) const;
    /// Weight of an unclipped emitter's near-equality beside `data`, the weight that the photographs give it.
    double emitter(size_t index, int channel, double data) const;
};

}  // namespace relamp
