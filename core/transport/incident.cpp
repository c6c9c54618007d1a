#include "transport/incident.h"

#include "base/parallel.h"
#include "base/random.h"

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

void glossyInfluence(const Scene& scene, const std::vector<EmitterSurface>& emitters,
                     const std::vector<int>& emitterOfTriangle, const LightLeaves& leaves, const Lobe& lobe,
                     uint32_t vertex, const Vec3& towardEye, const LobeRowOptions& options, float* row, Rgb* mirrored) {
    const size_t columns = leaves.size() + emitters.size();
    std::fill(row, row + columns, 0.0f);
    if (mirrored) *mirrored = Rgb(0);
    const Vec3 normal = scene.mesh.normals[vertex], position = scene.mesh.positions[vertex];
    if (glm::dot(normal, towardEye) <= 1e-3f) return;
    const Mat3 frame = frameAround(normal, leaves.axes());
    const Vec3 eye = glm::transpose(frame) * towardEye;
    const Vec3 origin = rayOrigin(scene, position, normal);
    const int environment = leaves.environmentOf(options.state);

    // Emitter samples: density per steradian of one emitter's sampler is cos / (pi x unshadowed form factor).
    thread_local std::vector<EmitterSample> samples;
    thread_local std::vector<float> totals;
    totals.assign(emitters.size(), 0);
    // Directions are drawn from the lobe, from the cosine, which reaches far from the lobe's peak where a bright sky
    // still counts, and from emitters.
    const auto directionDensity = [&](const Vec3& light) {
        return ggxSampleDensity(light, eye, lobe.alpha) * float(options.lobeSamples) +
               light.z / pi * float(options.cosineSamples);
    };
    for (size_t e = 0; e < emitters.size(); ++e) {
        totals[e] = sampleEmitter(scene, emitters[e], position, normal, options.emitterSamples,
                                  mixBits(options.seed + scene.rank[vertex]) + e, samples);
        for (const EmitterSample& s : samples) {
            if (s.visible == 0) continue;
            const Vec3 light = glm::transpose(frame) * s.direction;
            if (light.z <= 0) continue;
            const float areaDensity = light.z / (pi * totals[e]) * float(samples.size());
            const float evenness = s.formFactor * float(samples.size()) /
                                   totals[e];  // 1 but for what a sample stands for more or less than its fraction
            row[leaves.size() + e] +=
                s.level * evenness * evaluateLobe(lobe, light, eye) * light.z / (areaDensity + directionDensity(light));
        }
    }
    const Vec2 shift = randomShift(options.seed, scene.rank[vertex], 7);
    Ray rays[8];
    Hit hits[8];
    Vec3 local[8];
    int pending = 0;
    const auto flush = [&] {
        if (!pending) return;
        scene.tracer->closest8({rays, size_t(pending)}, {hits, size_t(pending)});
        for (int i = 0; i < pending; ++i) {
            const float density = directionDensity(local[i]);
            if (!(density > 0)) continue;
            const float value = evaluateLobe(lobe, local[i], eye) * local[i].z;
            if (!hits[i]) {
                if (environment < 0) continue;
                row[leaves.leafOf(rays[i].direction, size_t(environment))] +=
                    options.shapeAt(rays[i].direction, environment) * value / density;
                continue;
            }
            const int e = emitterOfTriangle.empty() ? -1 : emitterOfTriangle[hits[i].triangle];
            if (e < 0 && mirrored && options.outgoing &&
                glm::dot(scene.mesh.faceNormal(hits[i].triangle), rays[i].direction) < 0) {
                *mirrored += value / density * options.outgoingAt(scene, hits[i]);
            }
            if (e < 0 || !(totals[size_t(e)] > 0)) continue;
            if (!emitters[size_t(e)].twoSided &&
                glm::dot(scene.mesh.faceNormal(hits[i].triangle), rays[i].direction) >= 0)
                continue;
            const float areaDensity = local[i].z / (pi * totals[size_t(e)]) * float(options.emitterSamples);
            const float level =
                emitters[size_t(e)].levelAt(origin + hits[i].distance * rays[i].direction, -rays[i].direction);
            row[leaves.size() + size_t(e)] += level * value / (areaDensity + density);
        }
        pending = 0;
    };
    const auto shoot = [&](const Vec3& light) {
        if (light.z <= 0) return;
        local[pending] = light;
        rays[pending++] = {origin, frame * light, 0, 1e30f};
        if (pending == 8) flush();
    };
    for (int i = 0; i < options.lobeSamples; ++i) shoot(sampleGgx(eye, lobe.alpha, r2Point(uint32_t(i), shift)));
    const Vec2 otherShift = randomShift(options.seed, scene.rank[vertex], 8);
    for (int i = 0; i < options.cosineSamples; ++i) {
        const Vec2 u = r2Point(uint32_t(i), otherShift);
        const float radius = std::sqrt(u.x), angle = 2 * pi * u.y;
        shoot({radius * std::cos(angle), radius * std::sin(angle), std::sqrt(std::max(0.0f, 1 - u.x))});
    }
    flush();
    for (size_t e = 0; options.levels && e < emitters.size(); ++e) row[leaves.size() + e] *= options.levelOf(e);
}

}  // namespace relamp
