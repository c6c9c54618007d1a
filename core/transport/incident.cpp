#include "transport/incident.h"

#include "base/parallel.h"
#include "transport/shared_directions.h"

namespace relamp {

InfluenceMatrix lambertInfluence(const Scene& scene, const Visibility& visibility, const NearField& nearField,
                                 const LightLeaves& leaves, const std::vector<uint32_t>& vertices, Progress& progress) {
    InfluenceMatrix matrix;
    matrix.rows = vertices.size();
    matrix.columns = leaves.size() + nearField.emitters;
    matrix.values.assign(matrix.rows * matrix.columns, 0.0f);
    std::vector<uint32_t> all(leaves.size());
    for (size_t i = 0; i < all.size(); ++i) all[i] = uint32_t(i);
    lambertInfluenceOfLeaves(scene, visibility, leaves, vertices, all, matrix, progress);
    for (size_t r = 0; r < vertices.size(); ++r)
        for (size_t e = 0; e < nearField.emitters; ++e) matrix.row(r)[leaves.size() + e] = nearField.at(vertices[r], e);
    return matrix;
}

void lambertInfluenceOfLeaves(const Scene& scene, const Visibility& visibility, const LightLeaves& leaves,
                              const std::vector<uint32_t>& vertices, const std::vector<uint32_t>& leafIndices,
                              InfluenceMatrix& matrix, Progress& progress) {
    const DirectionGrid& grid = visibility.grid;
    std::vector<uint8_t> wanted(leaves.size(), 0);
    std::vector<uint32_t> fine;
    int gridLevel = 0;
    while ((1 << gridLevel) < grid.side) ++gridLevel;
    for (uint32_t i : leafIndices) {
        if (leaves[i].level <= gridLevel) wanted[i] = 1;
        else fine.push_back(i);
    }
    std::vector<uint32_t> cells, columns;  // only those whose leaf is wanted
    std::vector<Vec3> directions;
    for (size_t environment = 0; environment < leaves.environments(); ++environment) {
        const std::vector<uint32_t> leafOfCell = leaves.leafOfCells(grid, environment);
        for (int c = 0; c < grid.cells(); ++c)
            if (wanted[leafOfCell[size_t(c)]]) {
                cells.push_back(uint32_t(c));
                columns.push_back(leafOfCell[size_t(c)]);
                directions.push_back(grid.direction(c));
            }
    }
    const float scale = grid.cellSolidAngle() / pi;
    constexpr int raysPerSide = 2;
    progress.begin("Distant influence", vertices.size());
    parallelFor(
        vertices.size(), 32,
        [&](size_t r) {
            const uint32_t v = vertices[r];
            const Vec3 normal = scene.mesh.normals[v];
            float* row = matrix.row(r);
            for (uint32_t i : leafIndices) row[i] = 0;
            for (size_t k = 0; k < cells.size(); ++k)
                if (visibility.sees(v, int(cells[k])))
                    row[columns[k]] += scale * std::max(0.0f, glm::dot(normal, directions[k]));
            if (fine.empty() || !scene.referenced[v]) return;
            const Vec3 origin = rayOrigin(scene, scene.mesh.positions[v], normal);
            Ray rays[8];
            for (uint32_t i : fine) {
                const Leaf& leaf = leaves[i];
                int count = 0;
                float cosines[8];
                for (int s = 0; s < raysPerSide * raysPerSide; ++s) {
                    const Vec3 d =
                        leaves.direction(i, Vec2(s % raysPerSide + 0.5f, s / raysPerSide + 0.5f) / float(raysPerSide));
                    const float cosine = glm::dot(d, normal);
                    if (cosine <= 0) continue;
                    cosines[count] = cosine;
                    rays[count++] = {origin, d, 0, 1e30f};
                }
                if (!count) continue;
                const uint32_t blocked = scene.tracer->occluded8({rays, size_t(count)});
                float sum = 0;
                for (int k = 0; k < count; ++k)
                    if (!(blocked >> k & 1)) sum += cosines[k];
                row[i] = sum * leaf.solidAngle() / (pi * raysPerSide * raysPerSide);
            }
        },
        &progress);
}

Rgb outgoingAt(const Scene& scene, const Hit& hit, const std::vector<Rgb>& outgoing, size_t from) {
    const Triangle& t = scene.mesh.triangles[hit.triangle];
    const Vec2 b = hit.barycentric;
    return (1 - b.x - b.y) * outgoing[from + t[0]] + b.x * outgoing[from + t[1]] + b.y * outgoing[from + t[2]];
}

Rgb lightOfRow(const float* row, const Lighting& lighting) {
    const size_t leaves = lighting.leafRadiance.size();
    Rgb sum(0);
    for (size_t k = 0; k < leaves; ++k) sum += row[k] * lighting.leafRadiance[k];
    for (size_t e = 0; e < lighting.emitterRadiance.size(); ++e) sum += row[leaves + e] * lighting.emitterRadiance[e];
    return sum;
}

void glossyInfluence(const DirectionScene& in, const SharedDirections& shared, const Lobe& lobe, const Vec3& towardEye,
                     const LobeRowOptions& options, float* row, Rgb* mirrored) {
    const size_t leaves = in.leaves.size(), columns = leaves + in.emitters.size();
    std::fill(row, row + columns, 0.0f);
    if (mirrored) *mirrored = Rgb(0);
    if (glm::dot(in.scene.mesh.normals[shared.vertex], towardEye) <= 1e-3f) return;
    const Vec3 eye = glm::transpose(shared.frame) * towardEye;
    // Directions are drawn from the lobe, from the cosine, which reaches far from the lobe's peak where a bright sky
    // still counts, and from emitters.
    const auto densityOf = [&](const Vec3& light) {
        return ggxSampleDensity(light, eye, lobe.alpha) * float(options.lobeSamples) +
               light.z / pi * float(options.cosineSamples);
    };
    for (const MetLight& m : shared.emitters)
        row[m.column] += m.level * evaluateLobe(lobe, m.local, eye) * m.local.z / (m.areaDensity + densityOf(m.local));
    const auto take = [&](const MetLight& m) {
        const float density = densityOf(m.local);
        if (!(density > 0)) return;
        const float value = evaluateLobe(lobe, m.local, eye) * m.local.z;
        if (m.column != MetLight::none) row[m.column] += m.level * value / (m.areaDensity + density);
        else if (mirrored) *mirrored += value / density * m.outgoing;
    };
    thread_local std::vector<MetLight> met;
    met.clear();
    drawFromLobes(in, shared, eye, {&lobe.alpha, 1}, options.lobeSamples, 7, options, met);
    for (const MetLight& m : met) take(m);
    for (const MetLight& m : shared.cosine) take(m);
    for (size_t e = 0; options.levels && e < in.emitters.size(); ++e) row[leaves + e] *= options.levelOf(e);
}

void glossyInfluence(const Scene& scene, const std::vector<EmitterSurface>& emitters,
                     const std::vector<int>& emitterOfTriangle, const LightLeaves& leaves, const Lobe& lobe,
                     uint32_t vertex, const Vec3& towardEye, const LobeRowOptions& options, float* row, Rgb* mirrored) {
    const DirectionScene in{scene, emitters, emitterOfTriangle, leaves};
    SharedDirections shared;
    drawSharedDirections(in, vertex, options, shared);
    glossyInfluence(in, shared, lobe, towardEye, options, row, mirrored);
}

}  // namespace relamp
