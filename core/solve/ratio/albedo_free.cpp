#include "solve/ratio/albedo_free.h"

#include "base/parallel.h"
#include "solve/light/folded_gram.h"
#include "solve/light/weighted_gram.h"
#include "solve/ratio/hue_errors.h"
#include "solve/ratio/pair_adjacency.h"

namespace relamp {
namespace {

using Eigen::Index;
using RowMajor = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using RowMap = Eigen::Map<const RowMajor>;
using Channels = std::array<Eigen::VectorXd, 3>;     // of the unknowns
using Irradiances = std::array<Eigen::VectorXf, 3>;  // of the observations

/// B't in double, in a fixed order.
Eigen::VectorXd transposedProduct(const InfluenceRows& b, const std::vector<double>& t) {
    constexpr size_t lanes = 8;
    const Index n = Index(b.columns);
    std::vector<Eigen::VectorXd> partial(lanes);
    parallelFor(lanes, 1, [&](size_t lane) {
        partial[lane] = Eigen::VectorXd::Zero(n);
        for (size_t r = lane * b.rows / lanes; r < (lane + 1) * b.rows / lanes; ++r)
            partial[lane] += t[r] * Eigen::Map<const Eigen::VectorXf>(b.row(r), n).cast<double>();
    });
    for (size_t lane = 1; lane < lanes; ++lane) partial[0] += partial[lane];
    return partial[0];
}

/// Gauss-Newton on the ratio residuals of all pairs: the light x, what it makes of the observations, the weights of the
/// pairs, and the quadratic model about x.
class RatioFit {
public:
    RatioFit(const InfluenceRows& influence, const MatteObservations& matte, const std::vector<AlbedoPair>& pairs,
             const LightAnchors& anchors, const ViewRows* viewRows, const AlbedoFreeOptions& options,
             Lighting& lighting, Progress& progress);
    AlbedoFreeReport run(const std::function<void(int, double, double)>& each);

private:
    /// B x + bounce.
    Irradiances irradianceOf(const Channels& light) const;
    /// The variance of the residuals: noise, mismatch, shadow edges. It rests on the light, but stays as it is while a
    /// step is sought: an objective that can be lowered by making shadow edges harder (which raises their variance)
    /// leads away from the light.
    void takeVariance(const Irradiances& at);
    /// The robust objective; fills `robust_` and `viewWeight_`. `rmse`, if not null: relative difference of the pairs.
    double evaluate(const Channels& light, const Irradiances& at, double scale, double* rmse);
    /// W at the present light: each row's partners and then the row itself.
    void weighPairs();
    /// B'WB of the pairs, computed anew or as it was.
    void formProducts(bool anew);
    /// The slope of the pairs in channel c, per observation.
    std::vector<double> slopeOf(int c) const;
    /// The quadratic model at x in `report_.information` and `moments_`, with the bounds `lowest_`.
    void formModel(bool anew);
    /// Where the model has its minimum; sets the report's KKT residual. `fromPresent`: x is a good start.
    Channels modelMinimum(bool fromPresent);
    /// Towards `target`: a step that makes things worse is halved, so that the objective never rises. The robust loss
    /// is flatter than the parabola that its weights make of it, so twice a good step is often a better one.
    struct Step {
        bool accepted = false;
        double change = 0, gain = 0;  ///< of the irradiance, relative; of the objective
    };
    Step stepTowards(const Channels& target, double objective, double scale, bool farther);
    /// How much the irradiance changes, relative at each observation: a few that stand in an emitter must not speak for
    /// the rest.
    double relativeChange(const Irradiances& to) const;
    void iterate(const std::function<void(int, double, double)>& each);
    /// Information and objective of the light found, with the weights that belong to it: what fits of other models can
    /// be held against.
    void close();
    void writeBack();

    const InfluenceRows& influence_;
    const MatteObservations& matte_;
    const std::vector<AlbedoPair>& pairs_;
    const ViewRows* viewRows_;
    const AlbedoFreeOptions& options_;
    Lighting& lighting_;
    Progress& progress_;
    const size_t rows_, leafCount_, emitterCount_;
    const Index n_;
    const bool anchored_;  ///< something ties the scale down
    const Adjacency adjacency_;
    const LightPrior prior_;
    std::optional<FoldedColumns> fold_;

    Channels x_;
    Irradiances lit_;  ///< at x
    std::vector<PairVariance> variance_;
    std::vector<PairPrecision> precision_;
    std::vector<float> robust_, viewWeight_;
    std::vector<std::array<RatioResidual, 3>> terms_;
    ChannelWeights weights_;
    Eigen::MatrixXf products_;  ///< B'WB of the last model that was computed anew
    Eigen::VectorXd moments_, lowest_;
    double objective_ = 0, scale_ = 1;
    bool stale_ = false;  ///< the model's products are those of an earlier light
    AlbedoFreeReport report_;
};

RatioFit::RatioFit(const InfluenceRows& influence, const MatteObservations& matte, const std::vector<AlbedoPair>& pairs,
                   const LightAnchors& anchors, const ViewRows* viewRows, const AlbedoFreeOptions& options,
                   Lighting& lighting, Progress& progress)
    : influence_(influence),
      matte_(matte),
      pairs_(pairs),
      viewRows_(viewRows),
      options_(options),
      lighting_(lighting),
      progress_(progress),
      rows_(influence.rows),
      leafCount_(lighting.leaves.size()),
      emitterCount_(anchors.emitterRadiance.size()),
      n_(Index(influence.columns)),
      anchored_(options.bounce != nullptr || (viewRows && viewRows->tieScale) ||
                tiesScale(anchors, options.light.darkness)),
      adjacency_(influence.rows, pairs),
      prior_(lighting.leaves, anchors, options.light, influence),
      variance_(pairs.size()),
      precision_(pairs.size()),
      robust_(pairs.size(), 1),
      viewWeight_(viewRows ? viewRows->radiance.size() : 0),
      terms_(pairs.size()) {
    for (int c = 0; c < 3; ++c) {
        Eigen::VectorXd& x = x_[size_t(c)];
        x.resize(n_);
        for (size_t i = 0; i < leafCount_; ++i) x(Index(i)) = lighting.leafRadiance[i][c];
        for (size_t e = 0; e < emitterCount_; ++e) x(Index(leafCount_ + e)) = lighting.emitterRadiance[e][c];
        x = x.cwiseMax(prior_.lowest(c));
    }
    // Directions that light no observation have columns of zeros; some that light all alike need not be told apart.
    if (!options.fold.empty() || !options.emptyColumns) {
        fold_ = foldColumns(influence, options.fold.empty() ? rows_ : options.foldedRows, options.fold);
        if (fold_->folded.columns * 10 > influence.columns * 9) fold_.reset();
    }
    weights_.start.resize(rows_ + 1);
    for (size_t i = 0; i <= rows_; ++i) weights_.start[i] = adjacency_.start[i] + uint32_t(i);
    weights_.other.resize(adjacency_.other.size() + rows_);
    weights_.weight.resize(weights_.other.size());
}

Irradiances RatioFit::irradianceOf(const Channels& light) const {
    Irradiances out;
    for (size_t c = 0; c < 3; ++c) {
        out[c].resize(Index(rows_));
        const Eigen::VectorXf xf = light[c].cast<float>();
        parallelBlocks(rows_, 1024, [&](size_t begin, size_t end) {
            std::vector<float> scratch;
            const Index count = Index(end - begin);
            out[c].segment(Index(begin), count).noalias() =
                RowMap(influence_.block(begin, end - begin, scratch), count, n_) * xf;
            if (options_.bounce)
                for (size_t i = begin; i < end; ++i) out[c](Index(i)) += (*options_.bounce)[i][int(c)];
        });
    }
    return out;
}

void RatioFit::takeVariance(const Irradiances& at) {
    std::vector<Rgb> mixing(rows_);  // largest step of the irradiance to a neighbour
    parallelFor(rows_, 1024, [&](size_t i) {
        mixing[i] = Rgb(0);
        for (uint32_t k = adjacency_.start[i]; k < adjacency_.start[i + 1]; ++k)
            for (int c = 0; c < 3 && pairs_[adjacency_.pair[k]].edge; ++c)
                mixing[i][c] =
                    std::max(mixing[i][c], std::abs(at[size_t(c)](Index(i)) - at[size_t(c)](adjacency_.other[k])));
    });
    std::vector<std::array<float, 6>> hue;
    if (options_.lightError > 0) hue = hueErrors(influence_, leafCount_, x_, at, options_.lightError);
    std::vector<Rgb> residual(pairs_.size());
    parallelFor(pairs_.size(), 4096, [&](size_t k) {
        const AlbedoPair& p = pairs_[k];
        for (size_t b = 0; b < 6 && !hue.empty(); ++b) variance_[k].hue[b] = hue[p.a][b] + hue[p.b][b];
        for (int c = 0; c < 3; ++c) {
            const double la = at[size_t(c)](p.a), lb = at[size_t(c)](p.b), ya = matte_.radiance[p.a][c],
                         yb = matte_.radiance[p.b][c];
            const auto varianceOf = [&](double sigmaP, double sigmaQ) {
                return std::min(1e6, RatioResidual::variance(ya, yb, la, lb, sigmaP, sigmaQ));
            };
            variance_[k].noise[c] = float(varianceOf(matte_.sigma[p.a][c] * lb, matte_.sigma[p.b][c] * la) + 1e-12);
            const float mismatch = p.same ? options_.sameMismatch : options_.mismatch;
            variance_[k].model[c] =
                float(varianceOf(options_.mixing * mixing[p.a][c] * yb, options_.mixing * mixing[p.b][c] * ya) +
                      2 * double(mismatch) * mismatch);
            residual[k][c] = float(RatioResidual::value(ya, yb, la, lb));
        }
    });
    report_.chroma = options_.chroma ? *options_.chroma : chromaFraction(residual, variance_);
    // Between two states of one vertex channels err apart: there is no texture.
    parallelFor(pairs_.size(), 4096, [&](size_t k) {
        precision_[k] = pairPrecision(variance_[k], pairs_[k].same ? ChromaFraction{} : report_.chroma);
    });
}

double RatioFit::evaluate(const Channels& light, const Irradiances& at, double scale, double* rmse) {
    struct Sums {
        double objective = 0, squares = 0, counted = 0;
        Sums& operator+=(const Sums& o) {
            objective += o.objective;
            squares += o.squares;
            counted += o.counted;
            return *this;
        }
    };
    const CauchyLoss cauchy{scale};
    Sums sums = parallelSum(pairs_.size(), 4096, Sums{}, [&](size_t begin, size_t end) {
        Sums s;
        for (size_t k = begin; k < end; ++k) {
            const AlbedoPair& p = pairs_[k];
            double residual[3];
            for (int c = 0; c < 3; ++c) {
                residual[c] = RatioResidual::value(matte_.radiance[p.a][c], matte_.radiance[p.b][c], at[size_t(c)](p.a),
                                                   at[size_t(c)](p.b));
                s.squares += robustStep(residual[c]);
                ++s.counted;
            }
            const double mean = precision_[k].square(residual) / 3;
            robust_[k] = float(cauchy.weight(mean));
            s.objective += cauchy.loss(mean, p.weight);
        }
        return s;
    });
    for (size_t i = 0; i < viewWeight_.size(); ++i) {
        double mean = 0;
        for (size_t c = 0; c < 3; ++c) {
            const Eigen::Map<const Eigen::VectorXf> row(viewRows_->influence[c].row(i), n_);
            const double r = double(row.dot(light[c].cast<float>())) - viewRows_->radiance[i][int(c)];
            mean += r * r / 3;
        }
        const double variance = double(viewRows_->sigma[i]) * viewRows_->sigma[i];
        const double count = viewRows_->count.empty() ? 1 : double(viewRows_->count[i]);
        viewWeight_[i] = float(count / (variance * (1 + mean / variance / (scale * scale))));
        sums.objective += cauchy.loss(mean / variance, count);
    }
    // The data term is a mean over channels.
    for (int c = 0; c < 3; ++c) sums.objective += prior_.value(light[size_t(c)], c) / 3;
    sums.objective += prior_.hueValue(light.data()) / 3;
    if (rmse) *rmse = std::sqrt(sums.squares / std::max(1.0, sums.counted));
    return sums.objective;
}

void RatioFit::weighPairs() {
    parallelFor(rows_, 512, [&](size_t i) {
        std::array<float, 6> diagonal{};
        uint32_t at = weights_.start[i];
        for (uint32_t k = adjacency_.start[i]; k < adjacency_.start[i + 1]; ++k, ++at) {
            const uint32_t p = adjacency_.pair[k];
            const bool first = pairs_[p].a == i;
            weights_.other[at] = adjacency_.other[k];
            for (size_t block = 0; block < 6; ++block) {
                const auto [c, d] = ChannelWeights::blocks[block];
                const RatioResidual &t = terms_[p][size_t(c)], &u = terms_[p][size_t(d)];
                const double mine =
                    double(pairs_[p].weight * robust_[p] * precision_[p](c, d)) * (first ? t.byA : t.byB);
                diagonal[block] += float(mine * (first ? u.byA : u.byB));
                weights_.weight[at][block] = -float(mine * (first ? u.byB : u.byA));
            }
        }
        weights_.other[at] = uint32_t(i);
        weights_.weight[at] = diagonal;
    });
}

void RatioFit::formProducts(bool anew) {
    Eigen::MatrixXd& all = report_.information.all;
    if (pairs_.empty()) {
        all.setZero(3 * n_, 3 * n_);
    } else if (!anew) {
        all = products_.cast<double>();
    } else {
        products_.resize(0, 0);
        weighPairs();
        all = fold_ ? foldedGram(*fold_, influence_, weights_, report_.chroma.apart(), progress_)
                    : channelGram(influence_, weights_, report_.chroma.apart(), progress_);
        products_ = all.cast<float>();
    }
}

std::vector<double> RatioFit::slopeOf(int c) const {
    std::vector<double> slope(rows_, 0.0);
    parallelFor(rows_, 512, [&](size_t i) {
        for (uint32_t e = adjacency_.start[i]; e < adjacency_.start[i + 1]; ++e) {
            const uint32_t k = adjacency_.pair[e];
            double pull = 0;
            for (int d = 0; d < 3; ++d) pull += double(precision_[k](c, d)) * terms_[k][size_t(d)].residual;
            pull *= double(pairs_[k].weight) * robust_[k];
            const RatioResidual& term = terms_[k][size_t(c)];
            slope[i] += pairs_[k].b == i ? pull * term.byB : -pull * term.byA;
        }
    });
    return slope;
}

void RatioFit::formModel(bool anew) {
    parallelFor(pairs_.size(), 4096, [&](size_t k) {
        const AlbedoPair& p = pairs_[k];
        for (int c = 0; c < 3; ++c)
            terms_[k][size_t(c)] = RatioResidual::at(matte_.radiance[p.a][c], matte_.radiance[p.b][c],
                                                     lit_[size_t(c)](p.a), lit_[size_t(c)](p.b));
    });
    formProducts(anew);
    Eigen::MatrixXd& all = report_.information.all;
    moments_.setZero(3 * n_);
    lowest_.setZero(3 * n_);
    Eigen::VectorXd present(3 * n_);
    for (Index c = 0; c < 3; ++c) present.segment(c * n_, n_) = x_[size_t(c)];
    // The minimum is where the model's slope, Q (x' - x) plus the slope at x, is zero: rounding in Q then slows the way
    // and does not move its end.
    moments_.noalias() = all * present;
    for (Index c = 0; c < 3; ++c) {
        Eigen::MatrixXd q = all.block(c * n_, c * n_, n_, n_);
        Eigen::VectorXd moment = moments_.segment(c * n_, n_) - transposedProduct(influence_, slopeOf(int(c))),
                        lower = Eigen::VectorXd::Zero(n_);
        if (viewRows_) {
            const InfluenceMatrix& rows = viewRows_->influence[c];
            Eigen::MatrixXd& observations = report_.information.observations[size_t(c)];
            observations = weightedGram(
                rows,
                [&](size_t i, float* out) {
                    for (Index k = 0; k < n_; ++k) out[k] = viewWeight_[i] * rows.row(i)[k];
                },
                progress_);
            q += observations;
            for (size_t i = 0; i < rows.rows; ++i)
                moment += (viewWeight_[i] * viewRows_->radiance[i][int(c)]) *
                          Eigen::Map<const Eigen::VectorXf>(rows.row(i), n_).cast<double>();
        }
        report_.information.seen[size_t(c)] = prior_.seenDirectly(x_[size_t(c)], int(c), q);
        prior_.add(x_[size_t(c)], int(c), q, moment, lower);
        all.block(c * n_, c * n_, n_, n_) = q;
        moments_.segment(c * n_, n_) = moment;
        lowest_.segment(c * n_, n_) = lower;
    }
    prior_.addHue(x_.data(), all, moments_);
    all.triangularView<Eigen::StrictlyUpper>() = all.transpose();
}

Channels RatioFit::modelMinimum(bool fromPresent) {
    const Eigen::MatrixXd& all = report_.information.all;
    Eigen::VectorXd present(3 * n_);
    for (Index c = 0; c < 3; ++c) present.segment(c * n_, n_) = x_[size_t(c)];
    Eigen::MatrixXd held;
    if (!anchored_) {
        // Nothing ties the scale down, and black light explains every ratio: the mean stays where it is. That of the
        // light on the surfaces, because directions that light none may hold anything.
        held = all;
        const Eigen::VectorXd mean = transposedProduct(influence_, std::vector<double>(rows_, 1 / double(rows_)));
        for (Index c = 0; c < 3; ++c) {
            const double hold = all.diagonal().segment(c * n_, n_).maxCoeff() / mean.squaredNorm() + 1e-30;
            moments_.segment(c * n_, n_) += hold * mean.dot(x_[size_t(c)]) * mean;
            held.block(c * n_, c * n_, n_, n_) += hold * mean * mean.transpose();
        }
    }
    const QpResult solution =
        solveBoundedQp(anchored_ ? all : held, moments_, lowest_, fromPresent ? &present : nullptr, {&progress_});
    report_.kktResidual = solution.kktResidual;
    if (!solution.usable) return x_;
    Channels target;
    for (Index c = 0; c < 3; ++c) target[size_t(c)] = solution.x.segment(c * n_, n_);
    return target;
}

double RatioFit::relativeChange(const Irradiances& to) const {
    double change = 0;
    for (size_t c = 0; c < 3; ++c) {
        double squares = 0;
        for (Index i = 0; i < to[c].size(); ++i)
            squares += std::min(1.0, std::pow(double(to[c](i) - lit_[c](i)) / std::max(1e-30, double(to[c](i))), 2));
        change = std::max(change, std::sqrt(squares / double(std::max<size_t>(1, rows_))));
    }
    return change;
}

RatioFit::Step RatioFit::stepTowards(const Channels& target, double objective, double scale, bool farther) {
    Step done;
    for (double length = 1; length > 0.01; length *= 0.5) {
        Channels trial;
        for (size_t c = 0; c < 3; ++c) trial[c] = x_[c] + length * (target[c] - x_[c]);
        Irradiances at = irradianceOf(trial);
        const double reached = evaluate(trial, at, scale, nullptr);
        if (!(reached <= objective)) continue;
        done = {true, 0, objective - reached};
        if (length == 1 && farther) {
            Channels twice;
            for (Index c = 0; c < 3; ++c)
                twice[size_t(c)] =
                    (x_[size_t(c)] + 2 * (target[size_t(c)] - x_[size_t(c)])).cwiseMax(lowest_.segment(c * n_, n_));
            Irradiances atTwice = irradianceOf(twice);
            if (const double there = evaluate(twice, atTwice, scale, nullptr); there < reached) {
                done.gain = objective - there;
                std::swap(trial, twice);
                std::swap(at, atTwice);
            }
        }
        done.change = relativeChange(at);
        x_ = std::move(trial);
        break;
    }
    return done;
}

void RatioFit::writeBack() {
    for (int c = 0; c < 3; ++c) {
        const Eigen::VectorXd& x = x_[size_t(c)];
        for (size_t i = 0; i < leafCount_; ++i) lighting_.leafRadiance[i][c] = float(x(Index(i)));
        for (size_t e = 0; e < emitterCount_; ++e) lighting_.emitterRadiance[e][c] = float(x(Index(leafCount_ + e)));
    }
}

void RatioFit::iterate(const std::function<void(int, double, double)>& each) {
    const int settled = options_.anneal ? 3 : 0;  // from then on the objective is one and the same
    // Products are by far the most of an iteration, and slopes are exact: they stay while the light moves little.
    double moved = 0;
    scale_ = options_.robustScale;
    for (int iteration = 0; iteration < options_.iterations; ++iteration) {
        const bool annealing = options_.anneal && iteration < 3;
        std::optional<Progress::Dispensable> dispensable;
        if (iteration >= options_.leastIterations) dispensable.emplace(progress_);
        scale_ = double(options_.robustScale) * (annealing ? 4 - iteration : 1);
        lit_ = irradianceOf(x_);
        if (iteration <= settled) takeVariance(lit_);
        double rmse = 0;
        objective_ = evaluate(x_, lit_, scale_, &rmse);
        writeBack();
        if (each) each(iteration, objective_, rmse);
        const bool anew = iteration <= settled || !(moved < double(options_.keepProducts));
        if (anew) moved = 0;
        stale_ = !anew;
        Channels target;
        try {
            formModel(anew);
            target = modelMinimum(iteration > 0);
        } catch (const OutOfTime&) {
            if (report_.information.all.rows() != 3 * n_) report_.information.all.setZero(3 * n_, 3 * n_);
            break;
        }
        dispensable.reset();
        const Step step = stepTowards(target, objective_, scale_, !annealing);
        moved += step.accepted ? step.change : 1;
        report_.iterations = iteration + 1;
        progress_.advance();
        if (!annealing && (step.accepted ? step.change < double(options_.tolerance) : anew)) break;
        report_.endedEarly = !annealing && step.accepted && step.gain < double(options_.leastGain) * objective_;
        if (report_.endedEarly) break;
        if (iteration + 1 >= options_.leastIterations && progress_.outOfTime()) break;
    }
}

void RatioFit::close() {
    // How sure the light is rests on products of the present: those of before know a scale that nothing ties down.
    if (stale_) {
        lit_ = irradianceOf(x_);
        evaluate(x_, lit_, scale_, nullptr);
        try {
            formModel(true);
        } catch (const OutOfTime&) {}
    }
    lit_ = irradianceOf(x_);
    takeVariance(lit_);
    report_.objective = evaluate(x_, lit_, options_.robustScale, nullptr);
}

AlbedoFreeReport RatioFit::run(const std::function<void(int, double, double)>& each) {
    progress_.begin("Light from ratios", size_t(options_.iterations));
    iterate(each);
    writeBack();
    report_.objective = objective_;
    if (options_.closing) close();
    return std::move(report_);
}

}  // namespace

AlbedoFreeReport solveAlbedoFree(const InfluenceRows& influence, const MatteObservations& matte,
                                 const std::vector<AlbedoPair>& pairs, const LightAnchors& anchors,
                                 const ViewRows* viewRows, const AlbedoFreeOptions& options, Lighting& lighting,
                                 Progress& progress, const std::function<void(int, double, double)>& each) {
    return RatioFit(influence, matte, pairs, anchors, viewRows, options, lighting, progress).run(each);
}

}  // namespace relamp
