#include "transport/visibility.h"

#include "base/parallel.h"
#include "wavelet/haar.h"

namespace relamp {

Vec3 rayOrigin(const Scene& scene, const Vec3& position, const Vec3& normal) { return position + normal * (4 * scene.tracer->surfaceOffset()); }

Visibility computeVisibility(const Scene& scene, const VisibilityOptions& options, Progress& progress) {
    Visibility result;
    result.grid.side = options.gridSide;
    result.wordsPerVertex = size_t(result.grid.cells() + 63) / 64;
    result.bits.assign(scene.mesh.vertexCount() * result.wordsPerVertex, 0);
    addVisibility(scene, options.only ? *options.only : scene.referenced, result, progress);
    return result;
}

void addVisibility(const Scene& scene, const std::vector<uint8_t>& only, Visibility& visibility, Progress& progress) {
    const DirectionGrid& grid = visibility.grid;
    const int cells = grid.cells();
    const size_t n = scene.mesh.vertexCount();
    // Cells in blocks of 8 neighbours (4 x 2), so that a packet's rays stay together.
    std::vector<int> order;
    order.reserve(size_t(cells));
    const int side = grid.side;
    for (int y = 0; y < side; y += 2)
        for (int x = 0; x < side; x += 4)
            for (int k = 0; k < 8; ++k)
                if (y + k / 4 < side && x + k % 4 < side) order.push_back((y + k / 4) * side + x + k % 4);
    std::vector<Vec3> directions(size_t(cells), Vec3(0));
    for (int c = 0; c < cells; ++c) directions[size_t(c)] = grid.direction(c);
    progress.begin("Visibility", n);
    parallelFor(n, 64, [&](size_t v) {
        if (!only[v] || !scene.referenced[v]) return;
        const Vec3 normal = scene.mesh.normals[v];
        const Vec3 origin = rayOrigin(scene, scene.mesh.positions[v], normal);
        uint64_t* words = &visibility.bits[v * visibility.wordsPerVertex];
        Ray rays[8];
        int cellOf[8], count = 0;
        const auto flush = [&] {
            if (!count) return;
            const uint32_t blocked = scene.tracer->occluded8({rays, size_t(count)});
            for (int i = 0; i < count; ++i)
                if (!(blocked >> i & 1)) words[cellOf[i] / 64] |= uint64_t(1) << (cellOf[i] % 64);
            count = 0;
        };
        for (int c : order) {
            if (glm::dot(directions[size_t(c)], normal) <= 0) continue;
            rays[count] = {origin, directions[size_t(c)], 0, 1e30f};
            cellOf[count++] = c;
            if (count == 8) flush();
        }
        flush();
    }, &progress);
}

namespace {
SparseCoefs transformCells(std::vector<float>& cells, const DirectionGrid& grid, float energyShare) {
    const float scale = std::sqrt(grid.cellSolidAngle());
    for (float& value : cells) value *= scale;
    haarForward(cells, grid.side);
    return sparsify(cells, energyShare);
}
}  // namespace

SparseCoefs visibilityCosineCoefs(const Scene& scene, const Visibility& visibility, uint32_t vertex, float energyShare) {
    std::vector<float> cells(size_t(visibility.grid.cells()), 0.0f);
    for (int c = 0; c < visibility.grid.cells(); ++c)
        if (visibility.sees(vertex, c)) cells[size_t(c)] = std::max(0.0f, glm::dot(scene.mesh.normals[vertex], visibility.grid.direction(c)));
    return transformCells(cells, visibility.grid, energyShare);
}

SparseCoefs visibilityCoefs(const Visibility& visibility, uint32_t vertex, float energyShare) {
    std::vector<float> cells(size_t(visibility.grid.cells()), 0.0f);
    for (int c = 0; c < visibility.grid.cells(); ++c) cells[size_t(c)] = visibility.sees(vertex, c);
    return transformCells(cells, visibility.grid, energyShare);
}

}  // namespace relamp
