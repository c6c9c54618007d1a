#include "texture/seams.h"

#include "scene/equal_vertices.h"
#include "texture/charts.h"

namespace relamp {

std::vector<SeamPoint> seamPoints(const Mesh& captured, const AlbedoTexture& texture) {
    // Writers split vertices where charts of their own end: at the seams.
    Mesh mesh;
    mesh.triangles = captured.triangles;
    if (captured.normals.size() == captured.positions.size()) {
        const std::vector<uint32_t> first = firstEqualVertex(captured.positions, captured.normals);
        for (Triangle& t : mesh.triangles)
            for (uint32_t& v : t) v = first[v];
    }
    const auto beside = trianglesBeside(mesh);
    std::vector<SeamPoint> points;
    for (uint32_t t = 0; t < beside.size(); ++t)
        for (size_t k = 0; k < 3; ++k) {
            const uint32_t n = beside[t][k];
            if (n == noNeighbour || n < t || !texture.has(t) || !texture.has(n)) continue;
            const uint32_t from = mesh.triangles[t][k], to = mesh.triangles[t][(k + 1) % 3];
            SeamPoint first{texture.corners[t][k], {}}, last{texture.corners[t][(k + 1) % 3], {}};
            for (size_t c = 0; c < 3; ++c) {
                if (mesh.triangles[n][c] == from) first.there = texture.corners[n][c];
                if (mesh.triangles[n][c] == to) last.there = texture.corners[n][c];
            }
            if (first.here == first.there && last.here == last.there) continue;  // the same chart
            const int steps = 1 + int(glm::length(last.here - first.here));
            for (int i = 0; i < steps; ++i) {
                const float f = (float(i) + 0.5f) / float(steps);
                points.push_back({glm::mix(first.here, last.here, f), glm::mix(first.there, last.there, f)});
            }
        }
    return points;
}

void levelSeams(const std::vector<SeamPoint>& seams, int rounds, AlbedoTexture& texture) {
    for (int round = 0; round < rounds; ++round)
        for (const SeamPoint& p : seams) {
            const TexelBlend here = texture.blendAt(p.here), there = texture.blendAt(p.there);
            Rgb difference(0);
            float squares = 0;
            for (size_t k = 0; k < 4; ++k) {
                difference +=
                    there.weight[k] * texture.texels[there.texel[k]] - here.weight[k] * texture.texels[here.texel[k]];
                squares += here.weight[k] * here.weight[k] + there.weight[k] * there.weight[k];
            }
            for (size_t k = 0; k < 4; ++k) {
                Rgb &a = texture.texels[here.texel[k]], &b = texture.texels[there.texel[k]];
                a = glm::max(a + here.weight[k] / squares * difference, Rgb(0));
                b = glm::max(b - there.weight[k] / squares * difference, Rgb(0));
            }
        }
}

}  // namespace relamp
