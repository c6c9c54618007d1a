#include "scene/smooth_normals.h"

namespace relamp {

std::vector<Vec3> smoothedNormals(const Mesh& mesh, int rounds) {
    std::vector<Vec3> normals = mesh.normals, sum;
    for (int round = 0; round < rounds; ++round) {
        sum = normals;
        for (const Triangle& t : mesh.triangles)
            for (size_t k = 0; k < 3; ++k) {
                const uint32_t a = t[k], b = t[(k + 1) % 3];
                const Vec3 d = normals[a] - normals[b];
                const float weight = 0.5f * std::exp(-glm::dot(d, d) / 0.36f);  // an edge lies in two triangles
                sum[a] += weight * normals[b];
                sum[b] += weight * normals[a];
            }
        for (size_t v = 0; v < normals.size(); ++v) normals[v] = glm::normalize(sum[v]);
    }
    return normals;
}

}  // namespace relamp
