#include "relight/light_goal.h"

#include "base/error.h"
#include "brdf/projection.h"

namespace relamp {
namespace {

void check(const LightGoal& goal) {
    const size_t n = goal.points();
    bool same = goal.target.size() == n && goal.rest.size() == n && goal.present.size() == goal.lights();
    for (const std::vector<Rgb>& light : goal.response) same = same && light.size() == n;
    if (!same) throw Error("goal: its lists have different lengths");
    double weight = 0;
    for (const float w : goal.weight) weight += double(w);
    if (!(weight > 0)) throw Error("goal: no point counts");
}

/// Mean of the targets' luminance, so that errors in the dark do not count without end.
float meanTarget(const LightGoal& goal) {
    double sum = 0, weight = 0;
    for (size_t i = 0; i < goal.points(); ++i) {
        sum += double(goal.weight[i] * luminance(goal.target[i]));
        weight += double(goal.weight[i]);
    }
    return std::max(float(sum / weight), 1e-20f);
}

/// Solves for channels [from, to) together.
void solveChannels(const LightGoal& goal, const std::vector<float>& certainty, float keep, int from, int to,
                   std::vector<Rgb>& scale) {
    const size_t n = goal.lights();
    std::vector<double> gram(n * n, 0), right(n, 0), x(n, 0);
    std::vector<double> column(n);
    for (size_t i = 0; i < goal.points(); ++i) {
        if (!(certainty[i] > 0)) continue;
        for (int c = from; c < to; ++c) {
            const double w = double(certainty[i]), wanted = double(goal.target[i][c] - goal.rest[i][c]);
            for (size_t a = 0; a < n; ++a) column[a] = double(goal.response[a][i][c]);
            for (size_t a = 0; a < n; ++a) {
                right[a] += w * column[a] * wanted;
                for (size_t b = 0; b <= a; ++b) gram[a * n + b] += w * column[a] * column[b];
            }
        }
    }
    for (size_t a = 0; a < n; ++a) {
        for (int c = from; c < to; ++c) x[a] += double(goal.present[a][c]) / (to - from);
        for (size_t b = 0; b < a; ++b) gram[b * n + a] = gram[a * n + b];
    }
    for (size_t a = 0; a < n; ++a) {
        const double stays = double(keep) * gram[a * n + a];
        gram[a * n + a] += stays;
        right[a] += stays * x[a];
    }
    x = nonNegativeLeastSquares(gram, right);
    for (size_t a = 0; a < n; ++a)
        if (gram[a * n + a] > 0)  // else it sends nothing there
            for (int c = from; c < to; ++c) scale[a][c] = float(x[a]);
}

}  // namespace

LightGoalAnswer reachGoal(const LightGoal& goal, const LightGoalOptions& options) {
    check(goal);
    const float mean = meanTarget(goal);
    // Squared relative errors; a twentieth of the mean is as dark as counts.
    std::vector<float> certainty(goal.points());
    for (size_t i = 0; i < goal.points(); ++i) {
        const float level = luminance(goal.target[i]) + 0.05f * mean;
        certainty[i] = goal.weight[i] / (level * level);
    }
    LightGoalAnswer out;
    out.scale = goal.present;
    if (options.colour)
        for (int c = 0; c < 3; ++c) solveChannels(goal, certainty, options.keep, c, c + 1, out.scale);
    else solveChannels(goal, certainty, options.keep, 0, 3, out.scale);

    double weight = 0, before = 0, after = 0, dark = 0, bright = 0;
    for (size_t i = 0; i < goal.points(); ++i) {
        Rgb was = goal.rest[i], is = goal.rest[i];
        for (size_t a = 0; a < goal.lights(); ++a) {
            was += goal.present[a] * goal.response[a][i];
            is += out.scale[a] * goal.response[a][i];
        }
        const Rgb wrongBefore = was - goal.target[i], wrongAfter = is - goal.target[i];
        before += double(certainty[i] * glm::dot(wrongBefore, wrongBefore) / 3);
        after += double(certainty[i] * glm::dot(wrongAfter, wrongAfter) / 3);
        const float slack = 0.1f * luminance(goal.target[i]) + 0.02f * mean, error = luminance(wrongAfter);
        weight += double(goal.weight[i]);
        if (error < -slack) dark += double(goal.weight[i]);
        if (error > slack) bright += double(goal.weight[i]);
    }
    out.before = float(std::sqrt(before / weight));
    out.after = float(std::sqrt(after / weight));
    out.tooDark = float(dark / weight);
    out.tooBright = float(bright / weight);
    return out;
}

}  // namespace relamp
