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

/// What no smooth course of light over the tangent plane explains: twice the largest residual of a quadratic fitted to
/// the irradiance of `members` (with few of them, of a plane or a constant), and for a jump about its height.
Rgb jumpAbout(const Scene& scene, const MatteObservations& matte, const std::vector<Rgb>& irradiance,
              const std::vector<uint32_t>& members) {
    const size_t n = members.size();
    const int terms = n >= 12 ? 6 : n >= 6 ? 3 : 1;
    const uint32_t v = matte.vertices[members[0]];
    const Vec3 normal = scene.mesh.normals[v], origin = scene.mesh.positions[v],
               across = std::abs(normal.x) < 0.6f ? Vec3(1, 0, 0) : Vec3(0, 1, 0),
               t = glm::normalize(glm::cross(normal, across)), b = glm::cross(normal, t);
    float radius = 0;
    for (const uint32_t m : members)
        radius = std::max(radius, glm::distance(origin, scene.mesh.positions[matte.vertices[m]]));
    Eigen::Matrix<double, Eigen::Dynamic, 6> design(n, 6);
    Eigen::Matrix<double, Eigen::Dynamic, 3> value(n, 3);
    for (size_t k = 0; k < n; ++k) {
        const Vec3 d = (scene.mesh.positions[matte.vertices[members[k]]] - origin) / std::max(radius, 1e-30f);
        const double x = glm::dot(d, t), y = glm::dot(d, b);
        design.row(Eigen::Index(k)) << 1, x, y, x * x, x * y, y * y;
        const Rgb e = irradiance[members[k]];
        value.row(Eigen::Index(k)) << e.x, e.y, e.z;
    }
    const auto used = design.leftCols(terms);
    Eigen::MatrixXd normalMatrix = used.transpose() * used;
    normalMatrix.diagonal().tail(terms - 1).array() += 1e-3 * double(n);  // members on a line, or a few
    const Eigen::MatrixXd residual = value - used * normalMatrix.ldlt().solve(used.transpose() * value);
    const Eigen::Vector3d most = residual.cwiseAbs().colwise().maxCoeff();
    return 2.0f * Rgb(float(most(0)), float(most(1)), float(most(2)));
}

}  // namespace

Irradiance unsureAtShadows(const Scene& scene, const MatteObservations& matte, Irradiance irradiance) {
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
        for (size_t i = part * block; i < std::min(count, (part + 1) * block); ++i) {
            const Rgb value = irradiance.value[i],
                      jump = jumpAbout(scene, matte, irradiance.value, neighbourhood.about(matte.vertices[i])),
                      edge = 2.0f * jump * jump / (jump + value + Rgb(1e-20f));
            Rgb& sigma = irradiance.sigma[i];
            sigma = glm::sqrt(sigma * sigma + edge * edge + Rgb(floor * floor));
        }
    });
    return irradiance;
}

}  // namespace relamp
