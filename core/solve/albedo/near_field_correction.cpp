#include "solve/albedo/near_field_correction.h"

#include <Eigen/SparseCholesky>

#include "base/log.h"
#include "base/parallel.h"

namespace relamp {
namespace {

/// A correction matters where it may change the light by this fraction; that of a screen, which is smooth and far, too.
constexpr float matters = 0.1f, mattersFromScreen = 0.05f;
/// Farther than so many times what the mesh is off by, its errors are those of a direction, which are small unless the
/// light grazes the surface, as a screen's does its wall.
constexpr float nearby = 15, nearScreen = 40;
constexpr float grazing = 0.35f;  ///< cosine of the light's middle to the surface's normal
constexpr float wide = 5;         ///< times as wide as it is high above a surface is a screen
/// Standard deviation of a difference of log albedo across an edge; smaller ones count as this small.
constexpr double albedoStep = 0.1, smallest = 0.02;
/// Standard deviation of a difference, between neighbours, of the correction over its own standard deviation.
constexpr double smoothness = 0.1;
/// Neighbours err alike: a vertex says no more of the correction's size than this fraction of a value of its own. One
/// height of a screen is behind all that is wrong beside it.
constexpr double independent = 0.05, independentAtScreen = 0.005;
/// The variation must fall below this fraction of what it was: a papered wall is less even by itself.
constexpr double clearly = 0.8, clearlyAtScreen = 0.96;
constexpr size_t leastVertices = 10;  ///< that an emitter is wrong for
constexpr double mostChange = 3;  ///< of the light (root mean square): beyond it vertices are in a shadow, not beside

/// One vertex whose light may be wrong.
struct Doubtful {
    uint32_t observation = 0;
    int emitter = -1;
    float sigma = 0;       ///< of the form factor
    float formFactor = 0;  ///< as the mesh has it
    bool screen = false;   ///< of an emitter that is low above the vertex's surface beside its width
};

/// The corner of an emitter that is nearest to a point, or none within `reach`; and how far the emitter rises above the
/// point's surface.
struct Nearest {
    float squared = 0;
    uint32_t vertex = ~0u;
    float height = 0;
};
Nearest nearestOf(const Vec3& point, const Vec3& normal, const Mesh& mesh, const EmitterCluster& emitter, float reach) {
    Nearest best{reach * reach};
    for (uint32_t t : emitter.triangles)
        for (uint32_t v : mesh.triangles[t]) {
            const Vec3 d = mesh.positions[v] - point;
            best.height = std::max(best.height, glm::dot(d, normal));
            if (glm::dot(d, d) < best.squared) {
                best.squared = glm::dot(d, d);
                best.vertex = v;
            }
        }
    return best;
}

/// Whether light from there may reach the vertex, both of them lifted by what the mesh may be off by. What stands with
/// its back to the emitter, or in its shadow, stays dark.
bool mayReach(const Scene& scene, uint32_t vertex, uint32_t from, float meshError) {
    const Vec3& normal = scene.mesh.normals[vertex];
    const Vec3 lift = meshError * normal, origin = scene.mesh.positions[vertex] + lift;
    const Vec3 to = scene.mesh.positions[from] + lift - origin;
    const float distance = glm::length(to);
    if (!(distance > meshError)) return true;
    if (glm::dot(to, normal) < -0.3f * distance) return false;
    return !scene.tracer->occluded({origin, to / distance, 0, distance - meshError});
}

std::vector<Doubtful> doubtfulOf(const NearFieldCorrectionInput& in, Progress& progress) {
    const std::vector<EmitterCluster>& emitters = in.emitters.emitters;
    std::vector<Doubtful> all(in.matte.vertices.size());
    progress.begin("Light close to emitters", all.size());
    parallelFor(
        all.size(), 256,
        [&](size_t i) {
            const uint32_t v = in.matte.vertices[i];
            const Vec3& point = in.scene.mesh.positions[v];
            const float light = maxChannel(in.irradiance.value[i]);
            float most = 0;
            for (size_t e = 0; e < emitters.size(); ++e) {
                const float power = maxChannel(in.radiance[e]);
                if (!(power > 0) || !(light > 0)) continue;
                const float reach = std::min(nearScreen, power / (mattersFromScreen * light)) * in.meshError;
                const Vec3 to = emitters[e].centroid - point;
                const float side = std::sqrt(emitters[e].area);
                if (glm::length(to) > reach + side * 2) continue;
                const Vec3& normal = in.scene.mesh.normals[v];
                const Nearest nearest = nearestOf(point, normal, in.scene.mesh, emitters[e], reach);
                if (nearest.vertex == ~0u || !mayReach(in.scene, v, nearest.vertex, in.meshError)) continue;
                const float d2 = nearest.squared, distance = std::max(std::sqrt(d2), in.meshError),
                            height = std::max(nearest.height, in.meshError);
                const bool screen = side > wide * height && glm::dot(to, normal) < grazing * glm::length(to);
                if (!screen && d2 > nearby * nearby * in.meshError * in.meshError) continue;
                // The emitter covers no more than half of what the vertex sees, and little of it from afar.
                const float covers = std::min(0.5f, emitters[e].area / (pi * std::max(d2, 1e-20f)));
                float sigma = 2 * in.meshError * covers / distance;
                // A strip that stands on the surface, off by the mesh's error in its height.
                if (screen)
                    sigma = std::min(sigma, in.meshError / height * (1 - distance / std::hypot(distance, height)));
                const float change = sigma * power / light;
                if (change <= (screen ? mattersFromScreen : matters) || change <= most) continue;
                most = change;
                all[i] = {uint32_t(i), int(e), sigma, in.nearField.at(v, e), screen};
            }
        },
        &progress);
    std::erase_if(all, [](const Doubtful& d) { return d.emitter < 0; });
    return all;
}

struct Edge {
    int a = -1, b = -1;     ///< doubtful vertices; -1: the light is known there
    uint32_t i = 0, k = 0;  ///< observations
};

class Fit {
public:
    Fit(const NearFieldCorrectionInput& in, const std::vector<Doubtful>& doubtful)
        : in_(in), doubtful_(doubtful), t_(Eigen::VectorXd::Zero(Eigen::Index(doubtful.size()))) {
        std::vector<int> observationOf(in.scene.mesh.vertexCount(), -1), doubtOf(in.matte.vertices.size(), -1);
        for (size_t i = 0; i < in.matte.vertices.size(); ++i) observationOf[in.matte.vertices[i]] = int(i);
        for (size_t d = 0; d < doubtful.size(); ++d) doubtOf[doubtful[d].observation] = int(d);
        const VertexGraph& graph = in.scene.graph;
        for (size_t d = 0; d < doubtful.size(); ++d) {
            const uint32_t v = in.matte.vertices[doubtful[d].observation];
            for (uint32_t e = graph.start[v]; e < graph.start[v + 1]; ++e) {
                const int k = observationOf[graph.to[e]];
                if (k < 0 || (doubtOf[size_t(k)] >= 0 && graph.to[e] < v)) continue;
                if (glm::dot(in.scene.mesh.normals[v], in.scene.mesh.normals[graph.to[e]]) < 0.8f) continue;
                edges_.push_back({int(d), doubtOf[size_t(k)], doubtful[d].observation, uint32_t(k)});
            }
        }
    }

    /// Per emitter: mean absolute difference of log albedo across the edges at vertices that it may be wrong for.
    std::vector<double> variation() const {
        std::vector<double> sum(in_.emitters.emitters.size(), 0), count = sum;
        for (const Edge& e : edges_) {
            const Rgb d = logAlbedo(e.i, e.a) - logAlbedo(e.k, e.b);
            const auto emitter = size_t(doubtful_[size_t(e.a)].emitter);
            sum[emitter] += double(std::sqrt(glm::dot(d, d) / 3));
            count[emitter] += 1;
        }
        for (size_t k = 0; k < sum.size(); ++k) sum[k] /= std::max(1.0, count[k]);
        return sum;
    }

    void step() {
        const Eigen::Index n = t_.size();
        std::vector<Eigen::Triplet<double>> triplets;
        std::vector<double> diagonal;  // t has the standard deviation 1
        for (const Doubtful& d : doubtful_) diagonal.push_back(d.screen ? independentAtScreen : independent);
        Eigen::VectorXd gradient = Eigen::Map<const Eigen::VectorXd>(diagonal.data(), n).cwiseProduct(t_);
        for (const Edge& e : edges_) {
            const Rgb d = logAlbedo(e.i, e.a) - logAlbedo(e.k, e.b);
            const double size = std::sqrt(double(glm::dot(d, d)) / 3);
            const double weight = 1 / (3 * albedoStep * std::max(size, smallest));
            const Rgb ga = slope(e.i, e.a), gb = e.b >= 0 ? slope(e.k, e.b) : Rgb(0);
            diagonal[size_t(e.a)] += weight * double(glm::dot(ga, ga));
            gradient(e.a) += weight * double(glm::dot(d, ga));
            if (e.b < 0) continue;
            diagonal[size_t(e.b)] += weight * double(glm::dot(gb, gb));
            gradient(e.b) -= weight * double(glm::dot(d, gb));
            double across = -weight * double(glm::dot(ga, gb));
            if (doubtful_[size_t(e.a)].emitter == doubtful_[size_t(e.b)].emitter) {
                const double same = 1 / (smoothness * smoothness);
                diagonal[size_t(e.a)] += same;
                diagonal[size_t(e.b)] += same;
                across -= same;
                gradient(e.a) += same * (t_(e.a) - t_(e.b));
                gradient(e.b) -= same * (t_(e.a) - t_(e.b));
            }
            triplets.emplace_back(e.a, e.b, across);
            triplets.emplace_back(e.b, e.a, across);
        }
        for (Eigen::Index i = 0; i < n; ++i) triplets.emplace_back(int(i), int(i), diagonal[size_t(i)]);
        Eigen::SparseMatrix<double> matrix(n, n);
        matrix.setFromTriplets(triplets.begin(), triplets.end());
        if (!analysed_) factor_.analyzePattern(matrix);
        analysed_ = true;
        factor_.factorize(matrix);
        if (factor_.info() != Eigen::Success) return;
        const Eigen::VectorXd change = factor_.solve(gradient);
        if (!change.allFinite()) return;
        for (Eigen::Index i = 0; i < n; ++i)
            t_(i) = std::clamp(t_(i) - std::clamp(change(i), -0.5, 0.5), lowest(size_t(i)), 4.0);
    }

    /// Per emitter: vertices it may be wrong for, and the root mean square relative change of their light.
    std::vector<std::pair<size_t, double>> changes() const {
        std::vector<std::pair<size_t, double>> result(in_.emitters.emitters.size(), {0, 0});
        for (size_t d = 0; d < doubtful_.size(); ++d) {
            const uint32_t i = doubtful_[d].observation;
            const double before = double(luminance(in_.irradiance.value[i]));
            auto& [count, sum] = result[size_t(doubtful_[d].emitter)];
            ++count;
            sum += std::pow(double(luminance(lightAt(i, int(d)))) / std::max(before, 1e-20) - 1, 2);
        }
        for (auto& [count, sum] : result) sum = std::sqrt(sum / std::max<double>(1, double(count)));
        return result;
    }

    float added(size_t d) const { return float(t_(Eigen::Index(d))) * doubtful_[d].sigma; }

private:
    const NearFieldCorrectionInput& in_;
    const std::vector<Doubtful>& doubtful_;
    std::vector<Edge> edges_;
    Eigen::VectorXd t_;  // corrections over their standard deviations
    Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor_;
    bool analysed_ = false;

    /// No less than a tenth of the emitter's light is left.
    double lowest(size_t d) const { return -0.9 * double(doubtful_[d].formFactor / doubtful_[d].sigma); }

    Rgb lightAt(uint32_t i, int d) const {
        const Rgb& light = in_.irradiance.value[i];
        return d < 0 ? light : light + added(size_t(d)) * in_.radiance[size_t(doubtful_[size_t(d)].emitter)];
    }
    Rgb logAlbedo(uint32_t i, int d) const {
        const Rgb light = glm::max(lightAt(i, d), 1e-3f * in_.irradiance.value[i] + Rgb(1e-20f));
        return glm::log(glm::max(in_.matte.radiance[i], 1e-3f * light) / light);
    }
    /// Derivative of logAlbedo by t.
    Rgb slope(uint32_t i, int d) const {
        const Doubtful& at = doubtful_[size_t(d)];
        return -at.sigma * in_.radiance[size_t(at.emitter)] /
               glm::max(lightAt(i, d), 1e-3f * in_.irradiance.value[i] + Rgb(1e-20f));
    }
};

}  // namespace

NearFieldCorrection correctNearField(const NearFieldCorrectionInput& in, Progress& progress) {
    NearFieldCorrection out;
    if (!(in.meshError > 0) || in.emitters.emitters.empty()) return out;
    const std::vector<Doubtful> doubtful = doubtfulOf(in, progress);
    if (doubtful.size() < 10) return out;
    Fit fit(in, doubtful);
    const std::vector<double> before = fit.variation();
    constexpr int steps = 12;
    for (int i = 0; i < steps; ++i) {
        progress.check();
        fit.step();
    }
    const std::vector<double> after = fit.variation();
    const std::vector<std::pair<size_t, double>> changes = fit.changes();
    std::vector<uint8_t> better(before.size(), 0), screen = better;
    for (const Doubtful& d : doubtful) screen[size_t(d.emitter)] |= d.screen;
    for (size_t e = 0; e < before.size(); ++e) {
        if (changes[e].first == 0) continue;
        better[e] = changes[e].first >= leastVertices && changes[e].second < mostChange &&
                    after[e] < (screen[e] ? clearlyAtScreen : clearly) * before[e];
        logInfo(
            "light close to {}: {} vertices, changed by {:.1f} %; log albedo varies by {:.3f} and then {:.3f} an "
            "edge{}",
            in.emitters.emitters[e].id, changes[e].first, 100 * changes[e].second, before[e], after[e],
            better[e] ? "" : ": left as it is");
    }
    if (std::none_of(better.begin(), better.end(), [](uint8_t b) { return b; })) return out;
    out.emitter.assign(in.scene.mesh.vertexCount(), -1);
    out.formFactor.assign(out.emitter.size(), 0);
    for (size_t d = 0; d < doubtful.size(); ++d) {
        if (!better[size_t(doubtful[d].emitter)]) continue;
        const uint32_t v = in.matte.vertices[doubtful[d].observation];
        out.emitter[v] = doubtful[d].emitter;
        out.formFactor[v] = fit.added(d);
    }
    return out;
}

void addCorrection(const NearFieldCorrection& correction, const MatteObservations& matte,
                   const std::vector<Rgb>& radiance, const EmitterLevels& levels, Irradiance& irradiance) {
    if (correction.empty()) return;
    for (size_t i = 0; i < matte.vertices.size(); ++i)
        if (const int e = correction.emitter[matte.vertices[i]]; e >= 0) {
            const float fraction = correction.formFactor[matte.vertices[i]] *
                                   (levels.empty() ? 1.0f : levels[matte.stateOf(i)][size_t(e)]);
            irradiance.value[i] = glm::max(irradiance.value[i] + fraction * radiance[size_t(e)], Rgb(0));
        }
}

}  // namespace relamp
