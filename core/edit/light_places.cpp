#include "edit/light_places.h"

#include <algorithm>
#include <glm/gtc/matrix_transform.hpp>

#include "base/error.h"
#include "edit/emitter_edits.h"

namespace relamp {
namespace {

constexpr size_t stillPoints = 4096;

std::vector<uint8_t> emittingIn(const LiveFrame& frame) {
    std::vector<uint8_t> emitting(frame.radiance.size(), 0);
    if (frame.emitterOfTriangle)
        for (size_t t = 0; t < frame.mesh->triangles.size(); ++t)
            if ((*frame.emitterOfTriangle)[t] >= 0)
                for (const uint32_t v : frame.mesh->triangles[t]) emitting[v] = 1;
    return emitting;
}

/// Of the vertices of a light's triangles; `otherwise` of one that has none.
Vec3 middleOfLight(const LiveFrame& frame, const std::string& id, const Vec3& otherwise) {
    const auto at = std::find(frame.emitterIds.begin(), frame.emitterIds.end(), id);
    const int e = int(at - frame.emitterIds.begin());
    Vec3 sum(0);
    size_t count = 0;
    for (size_t t = 0; frame.emitterOfTriangle && t < frame.mesh->triangles.size(); ++t)
        if ((*frame.emitterOfTriangle)[t] == e)
            for (const uint32_t v : frame.mesh->triangles[t]) sum += frame.mesh->positions[v], ++count;
    return count ? sum / float(count) : otherwise;
}

/// The goal as a linear one for the lights where they stand, and what stands between.
class Model {
public:
    Model(LiveScene& live, const Estimate& estimate, const Look& look, const LiveGoal& goal, Progress& progress)
        : live_(live), estimate_(estimate), look_(look), wanted_(goal), progress_(progress) {
        const auto frame = shown(look);
        for (const GoalVertex& p : goal.points) {
            if (p.vertex >= frame->radiance.size()) throw Error("vertex {} does not exist", p.vertex);
            const uint32_t origin = frame->origin ? (*frame->origin)[p.vertex] : p.vertex;
            Rgb albedo = origin == ~0u ? Rgb(0) : estimate.reflectance.at(origin).albedo();
            if (look.neutralMaterials) albedo = Rgb(luminance(albedo));
            albedo_.push_back(albedo);
        }
        for (const std::string& id : goal.ids) {
            const auto at = std::find(frame->emitterIds.begin(), frame->emitterIds.end(), id);
            if (at == frame->emitterIds.end()) throw Error("light {} does not exist", id);
            emitters_.push_back(size_t(at - frame->emitterIds.begin()));
        }
        if (goal.sides) takeSides();
        else if (goal.environment) environment_.push_back(distantAt(*frame));
    }

    Look moved(const std::vector<Vec3>& moves) const {
        Look out = look_;
        for (size_t e = 0; e < moves.size(); ++e)
            if (moves[e] != Vec3(0)) moveEmitter(out, wanted_.ids[e], glm::translate(Mat4(1), moves[e]));
        return out;
    }

    /// With the lights moved by so much.
    LightGoal at(const std::vector<Vec3>& moves) {
        const auto frame = shown(moved(moves));
        LightGoal goal;
        goal.response.resize(emitters_.size() + environment_.size());
        goal.present.assign(goal.response.size(), Rgb(1));
        for (size_t i = 0; i < wanted_.points.size(); ++i) {
            const GoalVertex& p = wanted_.points[i];
            Rgb rest = frame->radiance[p.vertex];
            for (size_t k = 0; k < goal.response.size(); ++k) {
                const size_t e = k < emitters_.size() ? emitters_[k] : 0;
                const Rgb light = k < emitters_.size()
                                      ? albedo_[i] * frame->formFactor[e][p.vertex] * frame->emitterRadiance[e]
                                      : environment_[k - emitters_.size()][i];
                goal.response[k].push_back(light);
                rest -= light;
            }
            goal.weight.push_back(p.weight);
            goal.target.push_back(p.target);
            goal.rest.push_back(glm::max(rest, Rgb(0)));
        }
        return goal;
    }

    /// Middle of the points by weight.
    Vec3 middle() const {
        const auto frame = live_.frame();
        Vec3 sum(0);
        float weight = 0;
        for (const GoalVertex& p : wanted_.points) {
            sum += p.weight * frame->mesh->positions[p.vertex];
            weight += p.weight;
        }
        return weight > 0 ? sum / weight : sum;
    }

private:
    LiveScene& live_;
    const Estimate& estimate_;
    const Look& look_;
    const LiveGoal& wanted_;
    Progress& progress_;
    std::vector<Rgb> albedo_;
    std::vector<size_t> emitters_;
    std::vector<std::vector<Rgb>> environment_;  ///< per part of it that may change: light of each point

    std::shared_ptr<const LiveFrame> shown(const Look& look) {
        live_.setLook(look);
        live_.refine(0, progress_);
        return live_.frame();
    }
    std::vector<Rgb> distantAt(const LiveFrame& frame) const {
        std::vector<Rgb> light;
        for (size_t i = 0; i < wanted_.points.size(); ++i)
            light.push_back(albedo_[i] * frame.distantMatte[wanted_.points[i].vertex]);
        return light;
    }
    void takeSides() {
        for (size_t side = 0; side < look_.environment.sides.size(); ++side) {
            Look one = look_;
            for (size_t other = 0; other < one.environment.sides.size(); ++other)
                if (other != side) one.environment.sides[other] = Rgb(0);
            // What is black already can be brought back.
            if (!(maxChannel(one.environment.sides[side]) > 0)) one.environment.sides[side] = Rgb(1);
            environment_.push_back(distantAt(*shown(one)));
        }
    }
};

/// Solves the normal equations of a few unknowns with Levenberg's damping (Gauss, pivots by size).
std::vector<double> dampedStep(std::vector<std::vector<double>> a, std::vector<double> b, double damping) {
    const size_t n = b.size();
    for (size_t i = 0; i < n; ++i) a[i][i] *= 1 + damping;
    for (size_t i = 0; i < n; ++i) {
        size_t pivot = i;
        for (size_t r = i + 1; r < n; ++r)
            if (std::abs(a[r][i]) > std::abs(a[pivot][i])) pivot = r;
        std::swap(a[i], a[pivot]);
        std::swap(b[i], b[pivot]);
        if (!(std::abs(a[i][i]) > 0)) continue;
        for (size_t r = i + 1; r < n; ++r) {
            const double f = a[r][i] / a[i][i];
            for (size_t c = i; c < n; ++c) a[r][c] -= f * a[i][c];
            b[r] -= f * b[i];
        }
    }
    std::vector<double> x(n, 0);
    for (size_t i = n; i-- > 0;) {
        double sum = b[i];
        for (size_t c = i + 1; c < n; ++c) sum -= a[i][c] * x[c];
        x[i] = std::abs(a[i][i]) > 0 ? sum / a[i][i] : 0;
    }
    return x;
}

/// Gauss-Newton on what the best scales leave.
class PlaceSearch {
public:
    PlaceSearch(Model& model, const LightGoalOptions& options, std::vector<float> reach)
        : model_(model), options_(options), reach_(std::move(reach)), moves_(reach_.size(), Vec3(0)) {
        take(moves_);
    }
    const std::vector<Vec3>& moves() const { return moves_; }
    const LightGoalAnswer& answer() const { return answer_; }

    /// False: no step is better.
    bool step() {
        const size_t n = 3 * moves_.size();
        std::vector<std::vector<double>> slope(n);
        for (size_t u = 0; u < n; ++u) {
            std::vector<Vec3> there = moves_;
            const float h = 0.02f * reach_[u / 3];
            there[u / 3][int(u % 3)] += h;
            slope[u] = errorsAt(there).second;
            for (size_t i = 0; i < slope[u].size(); ++i) slope[u][i] = (slope[u][i] - errors_[i]) / double(h);
        }
        std::vector<std::vector<double>> normal(n, std::vector<double>(n, 0));
        std::vector<double> right(n, 0);
        for (size_t a = 0; a < n; ++a) {
            for (size_t i = 0; i < errors_.size(); ++i) right[a] -= slope[a][i] * errors_[i];
            for (size_t b = 0; b <= a; ++b) {
                double sum = 0;
                for (size_t i = 0; i < errors_.size(); ++i) sum += slope[a][i] * slope[b][i];
                normal[a][b] = normal[b][a] = sum;
            }
        }
        const float before = answer_.after;
        for (int attempt = 0; attempt < 4; ++attempt) {
            const std::vector<double> by = dampedStep(normal, right, damping_);
            std::vector<Vec3> there = moves_;
            for (size_t e = 0; e < there.size(); ++e) {
                Vec3 d(float(by[3 * e]), float(by[3 * e + 1]), float(by[3 * e + 2]));
                const float length = glm::length(d), most = 0.5f * reach_[e];
                there[e] += length > most ? d * (most / length) : d;
            }
            if (take(there)) {
                damping_ *= 0.2;
                return answer_.after < 0.99f * before;
            }
            damping_ = std::max(damping_, 1e-3) * 10;
        }
        return false;
    }

private:
    Model& model_;
    const LightGoalOptions& options_;
    std::vector<float> reach_;  ///< per light: its distance from what is painted
    std::vector<Vec3> moves_;
    LightGoalAnswer answer_;
    std::vector<double> errors_;
    double damping_ = 1e-3;

    std::pair<LightGoalAnswer, std::vector<double>> errorsAt(const std::vector<Vec3>& moves) {
        const LightGoal goal = model_.at(moves);
        LightGoalAnswer answer = reachGoal(goal, options_);
        std::vector<double> errors = goalErrors(goal, answer.scale);
        return {std::move(answer), std::move(errors)};
    }
    /// False: it is no better there.
    bool take(const std::vector<Vec3>& moves) {
        auto [answer, errors] = errorsAt(moves);
        if (!errors_.empty() && !(answer.after < answer_.after)) return false;
        answer_ = std::move(answer);
        errors_ = std::move(errors);
        moves_ = moves;
        return true;
    }
};

}  // namespace

std::vector<GoalVertex> brushedPoints(const LiveFrame& frame, std::span<const PaintedVertex> painted,
                                      const LightBrush& brush, size_t vertices) {
    const size_t n = std::min(vertices, frame.radiance.size());
    std::vector<float> amount(n, 0);
    float sum = 0;
    for (const PaintedVertex& p : painted)
        if (p.vertex < n) amount[p.vertex] = std::max(amount[p.vertex], std::clamp(p.amount, 0.0f, 1.0f));
    for (const float a : amount) sum += a;
    const std::vector<uint8_t> emitting = emittingIn(frame);
    const size_t step = std::max<size_t>(1, n / stillPoints);
    const float still = brush.stillness * sum / float(std::max<size_t>(1, n / step));
    std::vector<GoalVertex> points;
    for (uint32_t v = 0; v < n; ++v) {
        if (emitting[v] || !(amount[v] > 0 || v % step == 0) || !(maxChannel(frame.radiance[v]) > 0)) continue;
        const float weight = amount[v] > 0 ? amount[v] : still;
        if (weight > 0) points.push_back({v, weight, wantedUnder(brush, frame.radiance[v], amount[v])});
    }
    return points;
}

LiveGoalAnswer reachLiveGoal(LiveScene& live, const Estimate& estimate, const Look& look, const LiveGoal& goal,
                             const LightGoalOptions& options, Progress& progress, int steps) {
    LiveGoalAnswer out;
    Model model(live, estimate, look, goal, progress);
    if (goal.places && !goal.ids.empty()) {
        std::vector<float> reach;
        const Vec3 middle = model.middle();
        const auto frame = live.frame();
        for (const std::string& id : goal.ids) {
            const Vec3 at = middleOfLight(*frame, id, middle);
            reach.push_back(std::max(1e-3f, glm::distance(at, middle)));
        }
        PlaceSearch search(model, options, std::move(reach));
        out.steps.push_back(search.answer());
        for (int i = 0; i < steps; ++i) {
            progress.check();
            const bool onwards = search.step();
            out.steps.push_back(search.answer());
            if (!onwards) break;
        }
        out.moves = search.moves();
    } else {
        out.moves.assign(goal.ids.size(), Vec3(0));
    }
    const LightGoal linear = model.at(out.moves);
    out.goal = reachGoal(linear, options);
    if (!out.steps.empty()) out.goal.before = out.steps.front().before;
    out.look = model.moved(out.moves);
    const std::vector<Rgb>& scale = out.goal.scale;
    scaleLights(out.look, estimate, goal.ids, goal.environment && !goal.sides, scale);
    for (size_t side = 0; goal.sides && side < out.look.environment.sides.size(); ++side) {
        Rgb& factor = out.look.environment.sides[side];
        factor = (maxChannel(factor) > 0 ? factor : Rgb(1)) * scale[goal.ids.size() + side];
    }
    live.setLook(out.look);
    return out;
}

}  // namespace relamp
