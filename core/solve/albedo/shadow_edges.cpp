#include "solve/albedo/shadow_edges.h"

#include <Eigen/Dense>

#include "base/parallel.h"
#include "base/statistics.h"

namespace relamp {
namespace {

constexpr int shadowReach = 3;         // mesh edges
constexpr float longestStep = 0.006f;  // of the scene's diagonal: coarser meshes tell nothing of so small errors
constexpr float flatCosine = 0.995f;   // cosine between neighbouring normals
constexpr float leftOutLight = 0.01f;  // of the median irradiance
constexpr uint32_t notObserved = ~0u;

/// Observed vertices within reach of one, over flat, short edges. One object a thread: it keeps its memory.
class Neighbourhood {
public:
    Neighbourhood(const Scene& scene, const std::vector<uint32_t>& observation)
        : scene_(scene), observation_(observation), longest_(longestStep * scene.diagonal) {}

    /// Observations about vertex `v`, its own first; valid until the next call.
    const std::vector<uint32_t>& about(uint32_t v) {
        reached_.assign(1, v);
        size_t ring = 0;
        for (int r = 0; r < shadowReach; ++r)
            for (const size_t end = reached_.size(); ring < end; ++ring) spreadFrom(reached_[ring]);
        members_.clear();
        for (const uint32_t u : reached_) members_.push_back(observation_[u]);
        return members_;
    }

private:
    void spreadFrom(uint32_t u) {
        const std::vector<Vec3>&normals = scene_.mesh.normals, &positions = scene_.mesh.positions;
        for (uint32_t e = scene_.graph.start[u]; e < scene_.graph.start[u + 1]; ++e) {
            const uint32_t to = scene_.graph.to[e];
            if (observation_[to] == notObserved || glm::dot(normals[u], normals[to]) < flatCosine ||
                glm::distance(positions[u], positions[to]) > longest_ ||
                std::find(reached_.begin(), reached_.end(), to) != reached_.end())
                continue;
            reached_.push_back(to);
        }
    }

    const Scene& scene_;
    const std::vector<uint32_t>& observation_;
    float longest_;
    std::vector<uint32_t> reached_, members_;
};

constexpr int quadraticTerms = 6;
using Terms = Eigen::Matrix<double, quadraticTerms, 1>;

/// What no smooth course of light over the tangent plane explains: twice the largest residual of a quadratic fitted to
/// the irradiance of `members` (with few of them, of a plane or a constant), and for a jump about its height.
/// `terms` is room to work in.
Rgb jumpAbout(const Scene& scene, const MatteObservations& matte, const std::vector<Rgb>& irradiance,
              const std::vector<uint32_t>& members, std::vector<Terms>& terms) {
    const size_t n = members.size();
    const int used = n >= 12 ? quadraticTerms : n >= 6 ? 3 : 1;
    const uint32_t v = matte.vertices[members[0]];
    const Vec3 origin = scene.mesh.positions[v];
    const Mat3 frame = frameAround(scene.mesh.normals[v]);
    float radius = 1e-30f;
    for (const uint32_t m : members)
        radius = std::max(radius, glm::distance(origin, scene.mesh.positions[matte.vertices[m]]));
    terms.resize(n);
    Eigen::Matrix<double, quadraticTerms, quadraticTerms> normalMatrix = decltype(normalMatrix)::Zero();
    Eigen::Matrix<double, quadraticTerms, 3> right = decltype(right)::Zero();
    for (size_t k = 0; k < n; ++k) {
        const Vec3 d = (scene.mesh.positions[matte.vertices[members[k]]] - origin) / radius;
        const double x = glm::dot(d, frame[0]), y = glm::dot(d, frame[1]);
        terms[k] << 1, x, y, x * x, x * y, y * y;
        terms[k].tail(quadraticTerms - used).setZero();
        const Rgb e = irradiance[members[k]];
        normalMatrix += terms[k] * terms[k].transpose();
        right += terms[k] * Eigen::RowVector3d(e.x, e.y, e.z);
    }
    normalMatrix.diagonal().tail<quadraticTerms - 1>().array() += 1e-3 * double(n);  // members on a line, or a few
    const Eigen::Matrix<double, quadraticTerms, 3> fit = normalMatrix.ldlt().solve(right);
    Rgb most(0);
    for (size_t k = 0; k < n; ++k) {
        const Eigen::RowVector3d smooth = terms[k].transpose() * fit;
        most = glm::max(most, glm::abs(irradiance[members[k]] - Rgb(smooth(0), smooth(1), smooth(2))));
    }
    return 2.0f * most;
}

Irradiance unsureInOneState(const Scene& scene, const MatteObservations& matte, Irradiance irradiance) {
    if (scene.mesh.normals.size() != scene.mesh.vertexCount() || matte.vertices.empty()) return irradiance;
    std::vector<uint32_t> observation(scene.mesh.vertexCount(), notObserved);
    for (size_t i = 0; i < matte.vertices.size(); ++i) observation[matte.vertices[i]] = uint32_t(i);
    std::vector<float> brightness;
    brightness.reserve(irradiance.value.size());
    for (const Rgb& value : irradiance.value) brightness.push_back(luminance(value));
    const float floor = leftOutLight * medianOf(std::move(brightness));
    constexpr size_t block = 256;
    const size_t count = matte.vertices.size();
    parallelFor((count + block - 1) / block, 1, [&](size_t part) {
        Neighbourhood neighbourhood(scene, observation);
        std::vector<Terms> terms;
        for (size_t i = part * block; i < std::min(count, (part + 1) * block); ++i) {
            const Rgb value = irradiance.value[i],
                      jump = jumpAbout(scene, matte, irradiance.value, neighbourhood.about(matte.vertices[i]), terms),
                      edge = 2.0f * jump * jump / (jump + value + Rgb(1e-20f));
            Rgb& sigma = irradiance.sigma[i];
            sigma = glm::sqrt(sigma * sigma + edge * edge + Rgb(floor * floor));
        }
    });
    return irradiance;
}

}  // namespace

Irradiance unsureAtShadows(const Scene& scene, const MatteObservations& matte, Irradiance irradiance) {
    if (matte.states() == 1) return unsureInOneState(scene, matte, std::move(irradiance));
    for (size_t s = 0; s < matte.states(); ++s) {
        const Irradiance part = unsureInOneState(scene, matte.inState(s), irradiance.inState(matte, s));
        std::copy(part.sigma.begin(), part.sigma.end(), irradiance.sigma.begin() + ptrdiff_t(matte.beginOf(s)));
    }
    return irradiance;
}

}  // namespace relamp
