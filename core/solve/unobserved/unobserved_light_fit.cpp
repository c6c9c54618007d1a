#include "solve/unobserved/unobserved_light_fit.h"

#include <map>

#include "base/parallel.h"
#include "base/random.h"
#include "base/statistics.h"
#include "base/dense.h"
#include "solve/light/qp.h"

namespace relamp {
namespace {

constexpr double robust = 2.5;  // Cauchy, in standard deviations
struct PairStep {
    double residual, a, b;  // and its derivatives by the light on a and on b
};

PairStep stepOf(double ya, double yb, double la, double lb) {
    const double p = ya * lb, q = yb * la, sum = std::max(p + q, 1e-100);
    return {2 * (p - q) / sum, -4 * p * yb / (sum * sum), 4 * q * ya / (sum * sum)};
}

double bent(double squared) { return robust * robust * std::log1p(squared / (robust * robust)); }

/// Misfit of every pair at the light on the points.
std::vector<double> misfits(const UnobservedLightData& data, const Eigen::VectorXd& lit) {
    std::vector<double> result(data.pairs.size());
    for (size_t k = 0; k < result.size(); ++k) {
        const AlbedoPair& p = data.pairs[k];
        const PairStep s = stepOf(data.radiance[p.a], data.radiance[p.b], lit(p.a), lit(p.b));
        result[k] = double(p.weight) * bent(s.residual * s.residual / data.variance[k]);
    }
    return result;
}

double sumOf(const std::vector<double>& values) {
    double sum = 0;
    for (double v : values) sum += v;
    return sum;
}

std::vector<double> partsOf(const UnobservedLightData& data, const std::vector<double>& values) {
    std::vector<double> parts(size_t(data.parts), 0.0);
    for (size_t k = 0; k < values.size(); ++k) parts[size_t(data.part[k])] += values[k];
    return parts;
}

double weightOf(const UnobservedLightData& data) {
    double sum = 0;
    for (const AlbedoPair& p : data.pairs) sum += double(p.weight);
    return std::max(sum, 1e-300);
}

/// What a place does to the light it gives, by X, Y and Z; shadows stay where they are.
Eigen::MatrixXd placeDerivatives(const UnobservedLightData& data, const Vec3& place, const Eigen::VectorXd& column) {
    Eigen::MatrixXd d = Eigen::MatrixXd::Zero(Eigen::Index(data.positions.size()), 3);
    for (size_t i = 0; i < data.positions.size(); ++i) {
        const DVec3 to(place - data.positions[i]), n(data.normals[i]);
        const double d2 = glm::dot(to, to), cosine = glm::dot(n, to);
        if (!(column(Eigen::Index(i)) > 0) || !(cosine > 0)) continue;
        const DVec3 slope = column(Eigen::Index(i)) * (n / cosine - 3.0 / d2 * to);
        for (int c = 0; c < 3; ++c) d(Eigen::Index(i), c) = slope[c];
    }
    return d;
}

/// One row a pair: the derivative of its relative difference by the light's unknowns (and by what `more` holds), times
/// the root of its weight.
struct Linear {
    Eigen::MatrixXd rows;
    Eigen::VectorXd residual;
};

Linear linearise(const UnobservedLightData& data, const Eigen::MatrixXd& columns, const Eigen::VectorXd& lit) {
    Linear l;
    l.rows.resize(Eigen::Index(data.pairs.size()), columns.cols());
    l.residual.resize(Eigen::Index(data.pairs.size()));
    for (size_t k = 0; k < data.pairs.size(); ++k) {
        const AlbedoPair& p = data.pairs[k];
        const PairStep s = stepOf(data.radiance[p.a], data.radiance[p.b], lit(p.a), lit(p.b));
        const double w =
            std::sqrt(double(p.weight) /
                      (data.variance[k] * (1 + s.residual * s.residual / data.variance[k] / (robust * robust))));
        l.rows.row(Eigen::Index(k)) = w * (s.a * columns.row(p.a) + s.b * columns.row(p.b));
        l.residual(Eigen::Index(k)) = w * s.residual;
    }
    return l;
}

/// Data and priors as a quadratic program about x. Unknowns of the place, where there are any, follow the light's own.
struct UnobservedLightProgram {
    Eigen::MatrixXd q;
    Eigen::VectorXd moment, lower;
};

UnobservedLightProgram programOf(const UnobservedLightData& data, const LightPrior& prior, const Linear& l,
                                 const Eigen::MatrixXd& columns, const Eigen::VectorXd& x) {
    UnobservedLightProgram p;
    const Eigen::Index lightCount = x.size();
    p.q = transposedProduct(l.rows, l.rows);
    p.moment =
        -(l.rows.transpose() * l.residual);  // along the light itself the derivative is 0, so this is about x = 0
    p.lower = Eigen::VectorXd::Zero(p.q.rows());
    prior.add(x, 0, p.q, p.moment, p.lower);
    if (!data.anchored) {
        // Nothing ties the scale down: the mean of the light on the points stays where it is.
        Eigen::VectorXd mean = Eigen::VectorXd::Zero(p.q.rows());
        mean.head(lightCount) = columns.leftCols(lightCount).colwise().mean().transpose();
        const double hold =
            p.q.topLeftCorner(lightCount, lightCount).diagonal().maxCoeff() / std::max(mean.squaredNorm(), 1e-300);
        p.moment += hold * mean.head(lightCount).dot(x) * mean;
        p.q += hold * mean * mean.transpose();
    }
    return p;
}

Eigen::MatrixXd withColumn(const UnobservedLightData& data, const Eigen::VectorXd* column) {
    Eigen::MatrixXd columns(data.rows.rows(), data.rows.cols() + (column ? 1 : 0));
    columns.leftCols(data.rows.cols()) = data.rows;
    if (column) columns.rightCols(1) = *column;
    return columns;
}

/// What the light of a fit gives the points.
Eigen::VectorXd litBy(const UnobservedLightData& data, const UnobservedLightFit& fit) {
    return withColumn(data, fit.column.size() ? &fit.column : nullptr) * fit.light;
}

/// The light a fit with an emitter more starts from: three tenths of what lights the points on average come from the
/// emitter.
Eigen::VectorXd startWith(const UnobservedLightData& data, const Eigen::VectorXd& column,
                          const Eigen::VectorXd& light) {
    Eigen::VectorXd x(data.rows.cols() + 1);
    x.head(data.rows.cols()) = light;
    x(data.rows.cols()) = 0.3 * (data.rows * light).mean() / std::max(column.mean(), 1e-300);
    return x;
}

/// Improves x; its last `signedOnes` unknowns may be negative.
void descend(const UnobservedLightData& data, const LightPrior& prior, const Eigen::MatrixXd& columns,
             Eigen::Index signedOnes, int iterations, Eigen::VectorXd& x) {
    const auto objective = [&](const Eigen::VectorXd& light) {
        return sumOf(misfits(data, columns * light)) + prior.value(light, 0);
    };
    double value = objective(x);
    for (int i = 0; i < iterations; ++i) {
        const Linear l = linearise(data, columns, columns * x);
        UnobservedLightProgram p = programOf(data, prior, l, columns, x);
        p.lower.tail(signedOnes).setConstant(-1e3 * x.cwiseAbs().maxCoeff());
        const QpResult solution = solveBoundedQp(p.q, p.moment, p.lower, &x);
        if (!solution.usable) break;
        bool better = false;
        const double before = value;
        for (double step = 1; step > 0.05 && !better; step *= 0.5) {
            const Eigen::VectorXd trial = x + step * (solution.x - x);
            const double there = objective(trial);
            if (!(there < value)) continue;
            better = true;
            value = there;
            x = trial;
        }
        if (!better || value > before * (1 - 1e-4)) break;
    }
}

/// Unit directions from `place` to the points.
std::vector<Vec3> directionsFrom(const UnobservedLightData& data, const Vec3& place) {
    std::vector<Vec3> away;
    away.reserve(data.positions.size());
    for (const Vec3& p : data.positions) {
        const float length = glm::length(p - place);
        away.push_back(length > 0 ? (p - place) / length : Vec3(0, 0, -1));
    }
    return away;
}

/// The axis of a light of power 1, from a fit with a vector for its intensity: what leaves into a direction is its
/// product with that.
Vec3 linearAxis(const UnobservedLightData& data, const Eigen::VectorXd& even, const std::vector<Vec3>& away,
                const UnobservedLightFit& from) {
    const Eigen::Index known = data.rows.cols(), points = data.rows.rows();
    Eigen::MatrixXd columns(points, known + 3);
    columns.leftCols(known) = data.rows;
    DVec3 mean(0);
    for (Eigen::Index i = 0; i < points; ++i) {
        const DVec3 to(away[size_t(i)]);
        for (int c = 0; c < 3; ++c) columns(i, known + c) = even(i) * to[c];
        mean += even(i) * to;
    }
    const double length = glm::length(mean);
    if (!(length > 0)) return Vec3(0, 0, -1);
    Eigen::VectorXd x(known + 3);
    x.head(known) = from.light.head(known);
    for (int c = 0; c < 3; ++c) x(known + c) = from.light(known) * mean[c] / length;
    descend(data, LightPrior(data.leaves, data.anchors, data.prior), columns, 3, 8, x);
    const DVec3 axis(x(known), x(known + 1), x(known + 2));
    return Vec3(glm::length(axis) > 0 ? glm::normalize(axis) : mean / length);
}

}  // namespace

void addKnownPlace(const Scene& scene, const Vec3& place, const LightShape& shape, UnobservedLightData& data) {
    const Eigen::VectorXd column = pointLightColumn(scene, data, place, 8, shape);
    const Eigen::VectorXd start = startWith(data, column, data.start);
    data.rows = withColumn(data, &column);
    data.start = start;
    data.anchors.emitterRadiance.push_back(Rgb(0));
    data.anchors.emitterSigma.push_back(1);
    data.anchors.emitterClipped.push_back(1);
}

void assessPairs(UnobservedLightData& data, const UnobservedLightFit& fit) {
    const Eigen::VectorXd lit = litBy(data, fit);
    constexpr uint32_t everywhere = ~0u;
    std::map<uint32_t, std::vector<double>> over;
    for (size_t k = 0; k < data.pairs.size(); ++k) {
        if (data.far[k]) continue;
        const AlbedoPair& p = data.pairs[k];
        const double r = stepOf(data.radiance[p.a], data.radiance[p.b], lit(p.a), lit(p.b)).residual;
        for (const uint32_t component : {data.component[k], everywhere})
            over[component].push_back(r * r / data.variance[k]);
    }
    std::map<uint32_t, double> factor;
    for (auto& [component, values] : over) {
        if (values.size() < 30) continue;
        // The median of a squared standard normal is 0.455.
        factor[component] = std::max(1.0, medianOf(std::move(values)) / 0.455);
    }
    for (size_t k = 0; k < data.pairs.size(); ++k) {
        auto at = factor.find(data.component[k]);
        if (at == factor.end()) at = factor.find(everywhere);
        if (at != factor.end()) data.variance[k] *= at->second;
    }
}

UnobservedLightFit fitUnobservedLight(const UnobservedLightData& data, const Eigen::VectorXd* column,
                                      const Eigen::VectorXd& start, int iterations) {
    UnobservedLightFit fit;
    const LightPrior prior(data.leaves, data.anchors, data.prior);
    const Eigen::MatrixXd columns = withColumn(data, column);
    Eigen::VectorXd x = start.size() == 0 ? data.start : start;
    if (column && x.size() == data.rows.cols()) x = startWith(data, *column, x);
    const double weight = weightOf(data);
    descend(data, prior, columns, 0, iterations, x);
    const Eigen::VectorXd lit = columns * x;
    fit.misfit = sumOf(misfits(data, lit)) / weight;
    if (column) {
        fit.column = *column;
        const double total = lit.sum();
        fit.fraction = total > 0 ? x(x.size() - 1) * column->sum() / total : 0;
    }
    fit.light = std::move(x);
    return fit;
}

UnobservedLightFit searchAround(const Scene& scene, const UnobservedLightData& data, const Vec3& first,
                                const Vec3& middle, const Eigen::VectorXd& start, float reach, float least,
                                bool sideways, Progress& progress, const LightShape& shape) {
    const auto fitAt = [&](const Vec3& place, const Eigen::VectorXd& from) {
        const Eigen::VectorXd column = pointLightColumn(scene, data, place, 8, shape);
        UnobservedLightFit fit;
        fit.misfit = 1e300;
        if (column.sum() > 0) fit = fitUnobservedLight(data, &column, from, 4);
        fit.place = place;
        fit.shape = shape;
        return fit;
    };
    UnobservedLightFit best = fitAt(first, start);
    for (float step = reach; step >= least;) {
        progress.check();
        const Vec3 away = best.place - middle;
        const float distance = glm::length(away);
        const Mat3 frame = frameAround(away / distance);
        std::vector<UnobservedLightFit> tries(sideways ? 8 : 14);
        parallelFor(tries.size(), 1, [&](size_t i) {
            // Eight ways about the line from the middle, or the six faces and the eight corners of a cube.
            const float turn = float(i) * pi / 4;
            Vec3 d = sideways ? Vec3(std::cos(turn), std::sin(turn), 0)
                     : i < 6  ? Vec3(0)
                              : Vec3(i & 1 ? 0.577f : -0.577f, i & 2 ? 0.577f : -0.577f, i & 4 ? 0.577f : -0.577f);
            if (i < 6 && !sideways) d[int(i / 2)] = i % 2 ? 1.0f : -1.0f;
            const Vec3 aside = away + step * distance * (frame * Vec3(d.x, d.y, 0));
            tries[i] = fitAt(middle + std::exp(step * d.z) * distance / glm::length(aside) * aside,
                             best.light.size() ? best.light : start);
        });
        const auto bestTry = std::min_element(
            tries.begin(), tries.end(),
            [](const UnobservedLightFit& a, const UnobservedLightFit& b) { return a.misfit < b.misfit; });
        if (bestTry->misfit < best.misfit * (1 - 1e-4)) best = std::move(*bestTry);
        else step *= 0.5f;
    }
    return best;
}

UnobservedLightFit aimedLight(const Scene& scene, const UnobservedLightData& data, const Vec3& place, float power,
                              float radius, const Eigen::VectorXd& start) {
    const Eigen::VectorXd even = pointLightColumn(scene, data, place, 8, {{}, radius});
    const std::vector<Vec3> away = directionsFrom(data, place);
    const auto fitFor = [&](const Vec3& axis, const Eigen::VectorXd& from) {
        const EmissionLobe lobe{axis, power};
        Eigen::VectorXd column = even;
        for (Eigen::Index i = 0; i < column.size(); ++i) column(i) *= double(lobe.at(away[size_t(i)]));
        UnobservedLightFit fit;
        fit.misfit = 1e300;
        if (column.sum() > 0) fit = fitUnobservedLight(data, &column, from, 4);
        fit.place = place;
        fit.shape = {lobe, radius};
        return fit;
    };
    const UnobservedLightFit first = fitUnobservedLight(data, &even, start, 4);
    UnobservedLightFit best = fitFor(linearAxis(data, even, away, first), first.light.head(data.rows.cols()));
    for (float step = 0.4f; step > 0.04f && best.misfit < 1e300;) {
        const Mat3 frame = frameAround(best.shape.lobe.axis);
        std::vector<UnobservedLightFit> tries(6);
        parallelFor(tries.size(), 1, [&](size_t i) {
            const float turn = float(i) * pi / 3;
            const Vec3 aside = frame * Vec3(std::cos(turn), std::sin(turn), 0);
            tries[i] = fitFor(glm::normalize(best.shape.lobe.axis + step * aside), best.light);
        });
        const auto bestTry = std::min_element(
            tries.begin(), tries.end(),
            [](const UnobservedLightFit& a, const UnobservedLightFit& b) { return a.misfit < b.misfit; });
        if (bestTry->misfit < best.misfit * (1 - 1e-4)) best = std::move(*bestTry);
        else step *= 0.5f;
    }
    return best;
}

UnobservedLightFit refineUnobservedLight(const Scene& scene, const UnobservedLightData& data, const Vec3& first,
                                         const Eigen::VectorXd& start, int iterations, Progress& progress) {
    const LightPrior prior(data.leaves, data.anchors, data.prior);
    Vec3 place = first;
    Eigen::VectorXd column = pointLightColumn(scene, data, place, 8);
    UnobservedLightFit fit = fitUnobservedLight(data, &column, start, 6);
    Eigen::VectorXd x = fit.light;
    const Eigen::Index n = x.size();
    double damping = 1e-3;
    const auto objective = [&](const Eigen::MatrixXd& columns, const Eigen::VectorXd& light) {
        return sumOf(misfits(data, columns * light)) + prior.value(light, 0);
    };
    double value = objective(withColumn(data, &column), x);
    for (int i = 0; i < iterations; ++i) {
        progress.check();
        Eigen::MatrixXd columns(data.rows.rows(), n + 3);
        columns.leftCols(n) = withColumn(data, &column);
        columns.rightCols(3) = x(n - 1) * placeDerivatives(data, place, column);
        const Linear l = linearise(data, columns, columns.leftCols(n) * x);
        UnobservedLightProgram p = programOf(data, prior, l, columns, x);
        for (Eigen::Index c = n; c < n + 3; ++c) p.q(c, c) *= 1 + damping;
        float nearest = 1e30f;
        for (size_t k = 0; k < data.positions.size(); ++k)
            if (column(Eigen::Index(k)) > 0) nearest = std::min(nearest, glm::length(place - data.positions[k]));
        const double reach = 0.5 * double(std::min(nearest, scene.diagonal * 4));
        p.lower.tail(3).setConstant(-10 * double(scene.diagonal));
        const QpResult solution = solveBoundedQp(p.q, p.moment, p.lower);
        if (!solution.usable) break;
        Vec3 move(float(solution.x(n)), float(solution.x(n + 1)), float(solution.x(n + 2)));
        const float length = glm::length(move);
        const float cut = length > float(reach) ? float(reach) / length : 1.0f;
        bool better = false;
        const double before = value;
        for (float step = 1; step > 0.1f && !better; step *= 0.4f) {
            const Vec3 there = place + step * cut * move;
            Eigen::VectorXd trialColumn = pointLightColumn(scene, data, there, 8);
            if (!(trialColumn.sum() > 0)) continue;
            const Eigen::VectorXd trial = x + double(step * cut) * (solution.x.head(n) - x);
            const double reached = objective(withColumn(data, &trialColumn), trial);
            if (!(reached < value)) continue;
            better = true;
            value = reached;
            place = there;
            column = std::move(trialColumn);
            x = trial;
        }
        damping = better ? damping * 0.3 : damping * 30;
        if ((!better && damping > 1e3) || (better && value > before * (1 - 1e-6))) break;
    }
    fit = fitUnobservedLight(data, &column, x, 6);
    fit.place = place;
    return fit;
}

glm::dmat3 positionCovariance(const Scene& scene, const UnobservedLightData& data, const Vec3& middle,
                              const std::vector<Vec3>& more, uint64_t seed, UnobservedLightFit& best,
                              Progress& progress) {
    constexpr size_t around = 128, replicates = 200;
    const size_t places = around + more.size();
    const Vec3 away = best.place - middle;
    const float distance = glm::length(away);
    const Mat3 frame = frameAround(away / distance);
    const auto normal = [&](uint64_t k) {  // Box and Muller
        const float u = unitFloat(mixBits(seed + 2 * k)), v = unitFloat(mixBits(seed + 2 * k + 1));
        return std::sqrt(-2 * std::log(1 - u)) * std::cos(2 * pi * v);
    };
    // From half a hundredth of the distance to a fifth of it.
    std::vector<UnobservedLightFit> tries(places);
    std::vector<std::vector<double>> lost(places);
    parallelFor(
        places, 4,
        [&](size_t i) {
            const float reach = i == 0 ? 0 : 0.005f * std::pow(40.0f, float(i) / float(around - 1));
            const Vec3 d = reach * Vec3(normal(3 * i), normal(3 * i + 1), normal(3 * i + 2));
            const Vec3 place = i < around ? middle + std::exp(d.z) * (away + distance * (frame * Vec3(d.x, d.y, 0)))
                                          : more[i - around];
            const Eigen::VectorXd column = pointLightColumn(scene, data, place, 8, best.shape);
            if (!(column.sum() > 0)) return;
            tries[i] = fitUnobservedLight(data, &column, best.light, 4);
            tries[i].place = place;
            tries[i].shape = best.shape;
            lost[i] = partsOf(data, misfits(data, withColumn(data, &column) * tries[i].light));
        },
        &progress);
    std::vector<size_t> usable;
    for (size_t i = 0; i < places; ++i)
        if (!lost[i].empty()) usable.push_back(i);
    if (usable.empty()) return glm::dmat3(1e30);
    const size_t found = *std::min_element(usable.begin(), usable.end(),
                                           [&](size_t x, size_t y) { return tries[x].misfit < tries[y].misfit; });
    glm::dmat3 covariance(0);
    for (size_t r = 0; r < replicates; ++r) {
        std::vector<double> times(size_t(data.parts), 0.0);
        for (int k = 0; k < data.parts; ++k)
            ++times[mixBits(mixBits(seed ^ 0xb00757) + r * 1000003 + size_t(k)) % times.size()];
        double least = 1e300;
        size_t chosen = found;
        for (size_t i : usable) {
            double sum = 0;
            for (size_t k = 0; k < times.size(); ++k) sum += times[k] * lost[i][k];
            if (sum < least) least = sum, chosen = i;
        }
        const DVec3 off(tries[chosen].place - tries[found].place);
        covariance += glm::outerProduct(off, off) / double(replicates);
    }
    best = std::move(tries[found]);
    // What lies between the places tried is not known.
    for (int c = 0; c < 3; ++c) covariance[c][c] += std::pow(0.005 * double(distance), 2);
    return covariance;
}

double gainCertainty(const UnobservedLightData& data, const UnobservedLightFit& without,
                     const UnobservedLightFit& with) {
    const std::vector<double> before = misfits(data, litBy(data, without)), after = misfits(data, litBy(data, with));
    std::vector<double> difference(before.size());
    for (size_t k = 0; k < before.size(); ++k) difference[k] = before[k] - after[k];
    const std::vector<double> gain = partsOf(data, difference);
    const double sum = sumOf(gain), mean = sum / double(gain.size());
    double squares = 0;
    for (double g : gain) squares += (g - mean) * (g - mean);
    const double error = std::sqrt(squares * double(gain.size()) / std::max(1.0, double(gain.size()) - 1));
    return error > 0 ? sum / error : 0;
}

}  // namespace relamp
