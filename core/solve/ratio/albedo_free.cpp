#include "solve/ratio/albedo_free.h"

#include "base/parallel.h"
#include "solve/light/folded_gram.h"

namespace relamp {

using RowMajor = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using RowMap = Eigen::Map<const RowMajor>;

Eigen::MatrixXd weightedGram(const InfluenceMatrix& influence, const std::function<void(size_t, float*)>& weighted,
                             Progress& progress, bool symmetric) {
    const size_t n = influence.columns;
    constexpr size_t block = 512;
    constexpr Eigen::Index panel = 64;
    const size_t blocks = (influence.rows + block - 1) / block;
    if (influence.rows == 0) return Eigen::MatrixXd::Zero(Eigen::Index(n), Eigen::Index(n));
    // A fixed number of partial sums, each over its own run of blocks: the same bits whatever the thread count.
    constexpr size_t lanes = 8;
    std::vector<Eigen::MatrixXd> partial(lanes);
    parallelFor(lanes, 1, [&](size_t lane) {
        partial[lane] = Eigen::MatrixXd::Zero(Eigen::Index(n), Eigen::Index(n));
        RowMajor t{Eigen::Index(block), Eigen::Index(n)}, product{Eigen::Index(n), panel};
        for (size_t b = lane; b < blocks; b += lanes) {
            progress.check();
            const size_t begin = b * block, count = std::min(block, influence.rows - begin);
            for (size_t i = 0; i < count; ++i) weighted(begin + i, t.row(Eigen::Index(i)).data());
            const RowMap rows(influence.row(begin), Eigen::Index(count), Eigen::Index(n));
            // By panels of columns, each from its diagonal down where the rest is its mirror.
            for (Eigen::Index j = 0; j < Eigen::Index(n); j += panel) {
                const Eigen::Index w = std::min(panel, Eigen::Index(n) - j), from = symmetric ? j : 0,
                                   down = Eigen::Index(n) - from;
                product.topRows(down).leftCols(w).noalias() =
                    rows.rightCols(down).transpose() * t.topRows(Eigen::Index(count)).middleCols(j, w);
                partial[lane].block(from, j, down, w) += product.topRows(down).leftCols(w).cast<double>();
            }
        }
    });
    Eigen::MatrixXd gram = partial[0];
    for (size_t lane = 1; lane < lanes; ++lane) gram += partial[lane];
    if (!symmetric) return gram;
    return gram.selfadjointView<Eigen::Lower>();
}

namespace {

/// B't in double, in a fixed order.
Eigen::VectorXd transposedProduct(const InfluenceMatrix& b, const std::vector<double>& t) {
    constexpr size_t lanes = 8;
    const Eigen::Index n = Eigen::Index(b.columns);
    std::vector<Eigen::VectorXd> partial(lanes);
    parallelFor(lanes, 1, [&](size_t lane) {
        partial[lane] = Eigen::VectorXd::Zero(n);
        for (size_t r = lane * b.rows / lanes; r < (lane + 1) * b.rows / lanes; ++r)
            partial[lane] += t[r] * Eigen::Map<const Eigen::VectorXf>(b.row(r), n).cast<double>();
    });
    for (size_t lane = 1; lane < lanes; ++lane) partial[0] += partial[lane];
    return partial[0];
}

/// For each observation its partners: (pair, other end).
struct Adjacency {
    std::vector<uint32_t> start, pair, other;
};

Adjacency adjacencyOf(size_t n, const std::vector<AlbedoPair>& pairs) {
    Adjacency a;
    a.start.assign(n + 1, 0);
    for (const AlbedoPair& p : pairs) {
        ++a.start[p.a + 1];
        ++a.start[p.b + 1];
    }
    for (size_t i = 0; i < n; ++i) a.start[i + 1] += a.start[i];
    a.pair.resize(2 * pairs.size());
    a.other.resize(2 * pairs.size());
    std::vector<uint32_t> fill(a.start.begin(), a.start.end() - 1);
    for (uint32_t k = 0; k < pairs.size(); ++k) {
        const AlbedoPair& p = pairs[k];
        a.pair[fill[p.a]] = k;
        a.other[fill[p.a]++] = p.b;
        a.pair[fill[p.b]] = k;
        a.other[fill[p.b]++] = p.a;
    }
    return a;
}

}  // namespace

AlbedoFreeReport solveAlbedoFree(const InfluenceMatrix& influence, const MatteObservations& matte,
                                 const std::vector<AlbedoPair>& pairs, const LightAnchors& anchors,
                                 const ViewRows* viewRows, const AlbedoFreeOptions& options, Lighting& lighting,
                                 Progress& progress, const std::function<void(int, double, double)>& each) {
    AlbedoFreeReport report;
    const size_t rows = influence.rows, leafCount = lighting.leaves.size(),
                 emitterCount = anchors.emitterRadiance.size();
    const Eigen::Index n = Eigen::Index(influence.columns);
    const Adjacency adjacency = adjacencyOf(rows, pairs);
    const RowMap b(influence.values.data(), Eigen::Index(rows), n);
    const LightPrior prior(lighting.leaves, anchors, options.light, &influence);

    Eigen::VectorXd x[3];
    Eigen::VectorXf lit[3];  // B x
    for (int c = 0; c < 3; ++c) {
        x[c].resize(n);
        for (size_t i = 0; i < leafCount; ++i) x[c](Eigen::Index(i)) = lighting.leafRadiance[i][c];
        for (size_t e = 0; e < emitterCount; ++e) x[c](Eigen::Index(leafCount + e)) = lighting.emitterRadiance[e][c];
    }
    const bool anchored = options.bounce != nullptr || tiesScale(anchors, options.light.darkness);
    std::vector<float> robust(pairs.size(), 1);
    std::vector<Rgb> mixing(rows);
    std::vector<PairPrecision> precision(pairs.size());
    struct Term {
        double residual, a, b;  // residual and its derivative: b B_b - a B_a
    };
    std::vector<std::array<Term, 3>> terms(pairs.size());

    // One pair in one channel at the irradiances la, lb: r = 2 (p - q) / (p + q) with p = y_a lit_b, q = y_b lit_a,
    // which is the difference of log albedo where that is small and stays finite in the dark.
    const auto pairResidual = [&](const AlbedoPair& p, int c, float la, float lb) {
        const double pp = double(matte.radiance[p.a][c]) * lb, qq = double(matte.radiance[p.b][c]) * la;
        return 2 * (pp - qq) / std::max(pp + qq, 1e-30);
    };
    // Its variance: noise, mismatch, shadow edges. It rests on the light, but stays as it is while a step is sought: an
    // objective that can be lowered by making shadow edges harder (which raises their variance) leads away from the
    // light.
    std::vector<PairVariance> variance(pairs.size());
    const auto takeVariance = [&](const Eigen::VectorXf* at) {
        parallelFor(rows, 1024, [&](size_t i) {
            mixing[i] = Rgb(0);
            for (uint32_t k = adjacency.start[i]; k < adjacency.start[i + 1]; ++k)
                for (int c = 0; c < 3 && pairs[adjacency.pair[k]].weight == 1; ++c)
                    mixing[i][c] = std::max(mixing[i][c], std::abs(at[c](Eigen::Index(i)) - at[c](adjacency.other[k])));
        });
        std::vector<Rgb> residual(pairs.size());
        parallelFor(pairs.size(), 4096, [&](size_t k) {
            const AlbedoPair& p = pairs[k];
            for (int c = 0; c < 3; ++c) {
                const double la = at[c](p.a), lb = at[c](p.b), ya = matte.radiance[p.a][c], yb = matte.radiance[p.b][c],
                             sum = std::max(ya * lb + yb * la, 1e-30);
                const double sa = matte.sigma[p.a][c] * lb, sb = matte.sigma[p.b][c] * la;
                const double ma = options.mixing * mixing[p.a][c] * yb, mb = options.mixing * mixing[p.b][c] * ya;
                variance[k].noise[c] = float(std::min(1e6, 4 * (sa * sa + sb * sb) / (sum * sum)) + 1e-12);
                variance[k].model[c] = float(std::min(1e6, 4 * (ma * ma + mb * mb) / (sum * sum)) +
                                             2 * double(options.mismatch) * options.mismatch);
                residual[k][c] = float(pairResidual(p, c, float(la), float(lb)));
            }
        });
        report.chroma = options.chroma ? *options.chroma : chromaFraction(residual, variance);
        parallelFor(pairs.size(), 4096, [&](size_t k) { precision[k] = pairPrecision(variance[k], report.chroma); });
    };
    const auto litBy = [&](const Eigen::VectorXd* light, Eigen::VectorXf* out) {
        for (int c = 0; c < 3; ++c) {
            out[c].resize(Eigen::Index(rows));
            const Eigen::VectorXf xf = light[c].cast<float>();
            parallelBlocks(rows, 1024, [&](size_t begin, size_t end) {
                out[c].segment(Eigen::Index(begin), Eigen::Index(end - begin)).noalias() =
                    b.middleRows(Eigen::Index(begin), Eigen::Index(end - begin)) * xf;
                if (options.bounce)
                    for (size_t i = begin; i < end; ++i) out[c](Eigen::Index(i)) += (*options.bounce)[i][c];
            });
        }
    };
    // The robust objective; fills `robust`, and the relative difference of the pairs.
    std::vector<float> viewWeight(viewRows ? viewRows->radiance.size() : 0);
    const auto evaluate = [&](const Eigen::VectorXd* light, const Eigen::VectorXf* at, double scale, double* rmse) {
        constexpr size_t block = 4096;
        struct Sums {
            double objective = 0, squares = 0, counted = 0;
            Sums& operator+=(const Sums& o) {
                objective += o.objective;
                squares += o.squares;
                counted += o.counted;
                return *this;
            }
        };
        Sums sums = parallelSum(pairs.size(), block, Sums{}, [&](size_t begin, size_t end) {
            Sums s;
            for (size_t k = begin; k < end; ++k) {
                const AlbedoPair& p = pairs[k];
                double residual[3];
                for (int c = 0; c < 3; ++c) {
                    const double r = residual[c] = pairResidual(p, c, at[c](p.a), at[c](p.b));
                    s.squares += robustStep(r);
                    ++s.counted;
                }
                const double mean = precision[k].square(residual) / 3;
                robust[k] = float(1 / (1 + mean / (scale * scale)));
                s.objective += p.weight * scale * scale * std::log1p(mean / (scale * scale));
            }
            return s;
        });
        for (size_t i = 0; i < viewWeight.size(); ++i) {
            double mean = 0;
            for (int c = 0; c < 3; ++c) {
                const Eigen::Map<const Eigen::VectorXf> row(viewRows->influence[c].row(i), n);
                const double r = double(row.dot(light[c].cast<float>())) - viewRows->radiance[i][c];
                mean += r * r / 3;
            }
            const double s2 = double(viewRows->sigma[i]) * viewRows->sigma[i];
            viewWeight[i] = float(1 / (s2 * (1 + mean / s2 / (scale * scale))));
            sums.objective += scale * scale * std::log1p(mean / s2 / (scale * scale));
        }
        for (int c = 0; c < 3; ++c)
            sums.objective += prior.value(light[c], c) / 3;  // the data term is a mean over channels
        sums.objective += prior.hueValue(light) / 3;
        if (rmse) *rmse = std::sqrt(sums.squares / std::max(1.0, sums.counted));
        return sums.objective;
    };

    // Directions that light no observation have columns of zeros, and some that light all alike are not worth being
    // told apart.
    std::optional<FoldedColumns> fold;
    if (!options.fold.empty() || !options.emptyColumns) {
        fold = foldColumns(influence, options.fold.empty() ? rows : options.foldedRows, options.fold);
        if (fold->folded.columns * 10 > influence.columns * 9) fold.reset();
    }
    ChannelWeights weights;
    weights.start.resize(rows + 1);
    for (size_t i = 0; i <= rows; ++i) weights.start[i] = adjacency.start[i] + uint32_t(i);
    weights.other.resize(adjacency.other.size() + rows);
    weights.weight.resize(weights.other.size());
    // W at the present light: each row's partners and then the row itself.
    const auto weighPairs = [&] {
        parallelFor(rows, 512, [&](size_t i) {
            std::array<float, 6> diagonal{};
            uint32_t at = weights.start[i];
            for (uint32_t k = adjacency.start[i]; k < adjacency.start[i + 1]; ++k, ++at) {
                const uint32_t p = adjacency.pair[k];
                const bool first = pairs[p].a == i;
                weights.other[at] = adjacency.other[k];
                for (size_t block = 0; block < 6; ++block) {
                    const auto [c, d] = ChannelWeights::blocks[block];
                    const Term &t = terms[p][size_t(c)], &u = terms[p][size_t(d)];
                    const double mine = double(pairs[p].weight * robust[p] * precision[p](c, d)) * (first ? t.a : t.b);
                    diagonal[block] += float(mine * (first ? u.a : u.b));
                    weights.weight[at][block] = -float(mine * (first ? u.b : u.a));
                }
            }
            weights.other[at] = uint32_t(i);
            weights.weight[at] = diagonal;
        });
    };

    Eigen::VectorXd lowest;  // bounds of the last model
    // Where the quadratic model at x has its minimum, and how exactly that was found. Without a target only the model
    // is formed.
    Eigen::MatrixXf products;  // B'WB of the last model that was computed anew
    const auto modelMinimum = [&](bool fromPresent, bool anew, Eigen::VectorXd* target) {
        parallelFor(pairs.size(), 4096, [&](size_t k) {
            const AlbedoPair& p = pairs[k];
            for (int c = 0; c < 3; ++c) {
                const float la = lit[c](p.a), lb = lit[c](p.b);
                const double ya = matte.radiance[p.a][c], yb = matte.radiance[p.b][c], pp = ya * lb, qq = yb * la,
                             sum = std::max(pp + qq, 1e-30);
                terms[k][size_t(c)] = {pairResidual(p, c, la, lb), 4 * pp * yb / (sum * sum),
                                       4 * qq * ya / (sum * sum)};
            }
        });
        Eigen::MatrixXd& all = report.information.all;
        if (pairs.empty()) {
            all.setZero(3 * n, 3 * n);
        } else if (!anew) {
            all = products.cast<double>();
        } else {
            products.resize(0, 0);
            weighPairs();
            all = fold ? foldedGram(*fold, influence, weights, report.chroma.apart(), progress)
                       : channelGram(influence, weights, report.chroma.apart(), progress);
            products = all.cast<float>();
        }
        Eigen::VectorXd moments = Eigen::VectorXd::Zero(3 * n), lowers = Eigen::VectorXd::Zero(3 * n), present(3 * n);
        for (int c = 0; c < 3; ++c) present.segment(c * n, n) = x[c];
        // The minimum is where the model's slope, Q (x' - x) plus the slope at x, is zero: rounding in Q then slows the
        // way and does not move its end.
        moments.noalias() = all * present;
        for (int c = 0; c < 3; ++c) {
            std::vector<double> slope(rows, 0.0);
            parallelFor(rows, 512, [&](size_t i) {
                for (uint32_t e = adjacency.start[i]; e < adjacency.start[i + 1]; ++e) {
                    const uint32_t k = adjacency.pair[e];
                    double pull = 0;
                    for (int d = 0; d < 3; ++d) pull += double(precision[k](c, d)) * terms[k][size_t(d)].residual;
                    pull *= double(pairs[k].weight) * robust[k];
                    slope[i] += pairs[k].b == i ? pull * terms[k][size_t(c)].b : -pull * terms[k][size_t(c)].a;
                }
            });
            Eigen::MatrixXd q = all.block(c * n, c * n, n, n);
            Eigen::VectorXd moment = moments.segment(c * n, n) - transposedProduct(influence, slope),
                            lower = Eigen::VectorXd::Zero(n);
            if (viewRows) {
                const InfluenceMatrix& rows3 = viewRows->influence[c];
                Eigen::MatrixXd& observations = report.information.observations[size_t(c)];
                observations = weightedGram(
                    rows3,
                    [&](size_t i, float* out) {
                        for (Eigen::Index k = 0; k < n; ++k) out[k] = viewWeight[i] * rows3.row(i)[k];
                    },
                    progress);
                q += observations;
                for (size_t i = 0; i < rows3.rows; ++i) {
                    const Eigen::Map<const Eigen::VectorXf> row(rows3.row(i), n);
                    moment += (viewWeight[i] * viewRows->radiance[i][c]) * row.cast<double>();
                }
            }
            report.information.seen[size_t(c)] = prior.seenDirectly(x[c], c, q);
            prior.add(x[c], c, q, moment, lower);
            all.block(c * n, c * n, n, n) = q;
            moments.segment(c * n, n) = moment;
            lowers.segment(c * n, n) = lower;
        }
        prior.addHue(x, all, moments);
        all.triangularView<Eigen::StrictlyUpper>() = all.transpose();
        if (!target) return report.kktResidual;
        Eigen::MatrixXd held;
        if (!anchored) {
            // Nothing ties the scale down, and black light explains every ratio: the mean stays where it is.
            held = all;
            // Of the light on the surfaces, because directions that light none may hold anything.
            const Eigen::VectorXd mean = transposedProduct(influence, std::vector<double>(rows, 1 / double(rows)));
            for (int c = 0; c < 3; ++c) {
                const double hold = all.diagonal().segment(c * n, n).maxCoeff() / mean.squaredNorm() + 1e-30;
                moments.segment(c * n, n) += hold * mean.dot(x[c]) * mean;
                held.block(c * n, c * n, n, n) += hold * mean * mean.transpose();
            }
        }
        lowest = lowers;
        const QpResult solution =
            solveBoundedQp(anchored ? all : held, moments, lowers, fromPresent ? &present : nullptr, {&progress});
        for (int c = 0; c < 3; ++c) target[c] = solution.usable ? Eigen::VectorXd(solution.x.segment(c * n, n)) : x[c];
        return solution.kktResidual;
    };

    progress.begin("Light from ratios", size_t(options.iterations));
    double scale = options.robustScale, objective = 0;
    // Products are by far the most of an iteration, and the model's end is where its slope is zero, which is computed
    // anew each time: while the light moves little they stay as they are.
    double moved = 0;
    bool stale = false;
    const int settled = options.anneal ? 3 : 0;  // from then on the objective is one and the same
    const auto writeBack = [&] {
        for (int c = 0; c < 3; ++c) {
            for (size_t i = 0; i < leafCount; ++i) lighting.leafRadiance[i][c] = float(x[c](Eigen::Index(i)));
            for (size_t e = 0; e < emitterCount; ++e)
                lighting.emitterRadiance[e][c] = float(x[c](Eigen::Index(leafCount + e)));
        }
    };
    for (int iteration = 0; iteration < options.iterations; ++iteration) {
        const bool annealing = options.anneal && iteration < 3;
        std::optional<Progress::Dispensable> dispensable;
        if (iteration >= options.leastIterations) dispensable.emplace(progress);
        scale = double(options.robustScale) * (annealing ? 4 - iteration : 1);
        litBy(x, lit);
        if (iteration <= settled) takeVariance(lit);
        double rmse = 0;
        objective = evaluate(x, lit, scale, &rmse);
        writeBack();
        if (each) each(iteration, objective, rmse);
        Eigen::VectorXd target[3];
        const bool anew = iteration <= settled || !(moved < double(options.keepProducts));
        if (anew) moved = 0;
        stale = !anew;
        try {
            report.kktResidual = modelMinimum(iteration > 0, anew, target);
        } catch (const OutOfTime&) {
            if (report.information.all.rows() != 3 * n) report.information.all.setZero(3 * n, 3 * n);
            break;
        }
        dispensable.reset();
        // A step that makes things worse is halved: the objective never rises. The robust loss is flatter than the
        // parabola that its weights make of it, so twice a good step is often a better one.
        double change = 0, gain = 0;
        bool accepted = false;
        Eigen::VectorXd trial[3], farther[3];
        Eigen::VectorXf trialLit[3], fartherLit[3];
        for (double step = 1; step > 0.01 && !accepted; step *= 0.5) {
            for (int c = 0; c < 3; ++c) trial[c] = x[c] + step * (target[c] - x[c]);
            litBy(trial, trialLit);
            const double reached = evaluate(trial, trialLit, scale, nullptr);
            if (!(reached <= objective)) continue;
            accepted = true;
            gain = objective - reached;
            if (step == 1 && !annealing) {
                for (int c = 0; c < 3; ++c)
                    farther[c] = (x[c] + 2 * (target[c] - x[c])).cwiseMax(lowest.segment(c * n, n));
                litBy(farther, fartherLit);
                if (const double there = evaluate(farther, fartherLit, scale, nullptr); there < reached) {
                    gain = objective - there;
                    std::swap(trial, farther);
                    std::swap(trialLit, fartherLit);
                }
            }
            for (int c = 0; c < 3; ++c) {
                // Relative at each observation: a few that stand in an emitter must not speak for the rest.
                double squares = 0;
                for (Eigen::Index i = 0; i < trialLit[c].size(); ++i)
                    squares += std::min(
                        1.0, std::pow(double(trialLit[c](i) - lit[c](i)) / std::max(1e-30, double(trialLit[c](i))), 2));
                change = std::max(change, std::sqrt(squares / double(std::max<size_t>(1, rows))));
                x[c] = trial[c];
            }
        }
        moved += accepted ? change : 1;
        report.iterations = iteration + 1;
        progress.advance();
        if (!annealing && (accepted ? change < options.tolerance : anew)) break;
        report.endedEarly = !annealing && accepted && gain < double(options.leastGain) * objective;
        if (report.endedEarly) break;
        if (iteration + 1 >= options.leastIterations && progress.outOfTime()) break;
    }
    writeBack();
    report.objective = objective;
    if (!options.closing) return report;
    // How sure the light is rests on products of the present: those of before know a scale that nothing ties down.
    if (stale) {
        litBy(x, lit);
        evaluate(x, lit, scale, nullptr);
        try {
            modelMinimum(true, true, nullptr);
        } catch (const OutOfTime&) {}
    }
    // Of the light found, with the weights that belong to it: what fits of other models can be held against.
    litBy(x, lit);
    takeVariance(lit);
    report.objective = evaluate(x, lit, options.robustScale, nullptr);
    return report;
}

}  // namespace relamp
