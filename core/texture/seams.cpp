#include "texture/seams.h"

#include <utility>

#include "base/parallel.h"
#include "scene/equal_vertices.h"
#include "texture/charts.h"

namespace relamp {

std::vector<SeamPoint> seamPoints(const Mesh& captured, const AlbedoTexture& texture, float perTexel) {
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
            constexpr float flat = 0.866f;
            const bool crease = !(glm::dot(captured.faceNormal(t), captured.faceNormal(n)) > flat);
            SeamPoint first{texture.corners[t][k], {}}, last{texture.corners[t][(k + 1) % 3], {}};
            for (size_t c = 0; c < 3; ++c) {
                if (mesh.triangles[n][c] == from) first.there = texture.corners[n][c];
                if (mesh.triangles[n][c] == to) last.there = texture.corners[n][c];
            }
            if (first.here == first.there && last.here == last.there) continue;  // the same chart
            const int steps = 1 + int(perTexel * glm::length(last.here - first.here));
            for (int i = 0; i < steps; ++i) {
                const float f = (float(i) + 0.5f) / float(steps);
                points.push_back({glm::mix(first.here, last.here, f), glm::mix(first.there, last.there, f), crease});
            }
        }
    return points;
}

namespace {

/// The sum of squared differences between the two sides of seams, x' M x, over the texels that touch seams.
struct SeamMatrix {
    std::vector<std::vector<std::pair<uint32_t, float>>> row;  ///< columns and values

    void add(uint32_t a, uint32_t b, float value) {
        for (auto& [column, sum] : row[a])
            if (column == b) {
                sum += value;
                return;
            }
        row[a].emplace_back(b, value);
    }
    float diagonal(size_t at) const {
        for (const auto& [column, sum] : row[at])
            if (column == at) return sum;
        return 0;
    }
    Rgb times(size_t at, const std::vector<Rgb>& x) const {
        Rgb sum(0);
        for (const auto& [column, value] : row[at]) sum += value * x[column];
        return sum;
    }
};

constexpr size_t texelBlock = 4096;

double dotOf(const std::vector<Rgb>& a, const std::vector<Rgb>& b) {
    return parallelSum(a.size(), texelBlock, 0.0, [&](size_t begin, size_t end) {
        double sum = 0;
        for (size_t i = begin; i < end; ++i) sum += double(glm::dot(a[i], b[i]));
        return sum;
    });
}

/// What to add to `values` so that the differences nearly vanish, by least squares, where `isFree` is 1: conjugate
/// gradients. Small changes alone: sides that texels cannot bring together without large ones stay apart, as prints do
/// that are finer than texels.
std::vector<Rgb> leastChange(const SeamMatrix& matrix, const std::vector<Rgb>& values, const std::vector<Rgb>& isFree) {
    constexpr float size = 0.02f;  // of the squared change, beside the squared differences
    constexpr double enough = 1e-7;
    constexpr int rounds = 60;
    const size_t count = values.size();
    std::vector<Rgb> x(count, Rgb(0)), residual(x), scaled(x), direction(x), image(x);
    std::vector<float> inverse(count, 0);
    parallelFor(count, texelBlock, [&](size_t i) {
        residual[i] = -isFree[i] * matrix.times(i, values);
        inverse[i] = 1 / (size + matrix.diagonal(i));
        direction[i] = scaled[i] = inverse[i] * residual[i];
    });
    double length = dotOf(residual, scaled);
    const double least = enough * length;
    for (int round = 0; round < rounds && length > least; ++round) {
        parallelFor(count, texelBlock,
                    [&](size_t i) { image[i] = size * direction[i] + isFree[i] * matrix.times(i, direction); });
        const float step = float(length / dotOf(direction, image));
        parallelFor(count, texelBlock, [&](size_t i) {
            x[i] += step * direction[i];
            residual[i] -= step * image[i];
            scaled[i] = inverse[i] * residual[i];
        });
        const double before = std::exchange(length, dotOf(residual, scaled));
        const float turn = float(length / before);
        parallelFor(count, texelBlock, [&](size_t i) { direction[i] = scaled[i] + turn * direction[i]; });
    }
    return x;
}

}  // namespace

bool goesOn(const SeamPoint& place, const AlbedoTexture& texture) {
    constexpr float most = 0.2f;
    if (!place.crease) return true;
    const Rgb here = texture.at(place.here), there = texture.at(place.there);
    return glm::length(here - there) < most * 0.5f * glm::length(here + there);
}

void levelSeams(const std::vector<SeamPoint>& given, AlbedoTexture& texture) {
    std::vector<SeamPoint> seams;
    for (const SeamPoint& p : given)
        if (goesOn(p, texture)) seams.push_back(p);
    // The second brings nearer what large changes alone would, and leaves texels at an end of their range there.
    constexpr int solves = 2;
    std::vector<size_t> touched;
    std::vector<std::array<size_t, 8>> texels;
    std::vector<std::array<float, 8>> weights;
    for (const SeamPoint& p : seams) {
        const TexelBlend here = texture.blendAt(p.here), there = texture.blendAt(p.there);
        texels.emplace_back();
        weights.emplace_back();
        for (size_t k = 0; k < 4; ++k) {
            texels.back()[k] = here.texel[k];
            texels.back()[k + 4] = there.texel[k];
            weights.back()[k] = here.weight[k];
            weights.back()[k + 4] = -there.weight[k];
        }
        touched.insert(touched.end(), texels.back().begin(), texels.back().end());
    }
    std::sort(touched.begin(), touched.end());
    touched.erase(std::unique(touched.begin(), touched.end()), touched.end());
    std::vector<std::array<uint32_t, 8>> places(seams.size());
    parallelFor(seams.size(), texelBlock, [&](size_t i) {
        for (size_t k = 0; k < 8; ++k)
            places[i][k] = uint32_t(std::lower_bound(touched.begin(), touched.end(), texels[i][k]) - touched.begin());
    });
    SeamMatrix matrix{std::vector<std::vector<std::pair<uint32_t, float>>>(touched.size())};
    for (size_t i = 0; i < seams.size(); ++i)
        for (size_t k = 0; k < 8; ++k)
            for (size_t l = 0; l < 8; ++l)
                if (weights[i][k] * weights[i][l] != 0)
                    matrix.add(places[i][k], places[i][l], weights[i][k] * weights[i][l]);
    std::vector<Rgb> values, isFree(touched.size(), Rgb(1));
    for (const size_t at : touched) values.push_back(texture.texels[at]);
    for (int solve = 0; solve < solves; ++solve) {
        const std::vector<Rgb> change = leastChange(matrix, values, isFree);
        for (size_t i = 0; i < values.size(); ++i) {
            const Rgb wanted = values[i] + change[i], here = glm::clamp(wanted, Rgb(0), Rgb(2));
            for (int c = 0; c < 3; ++c)
                if (here[c] != wanted[c]) isFree[i][c] = 0;
            values[i] = here;
        }
    }
    for (size_t i = 0; i < values.size(); ++i) texture.texels[touched[i]] = values[i];
}

}  // namespace relamp
