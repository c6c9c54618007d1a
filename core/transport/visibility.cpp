#include "transport/visibility.h"

#include <numeric>

#include "base/parallel.h"
#include "wavelet/haar.h"

namespace relamp {

Vec3 rayOrigin(const Scene& scene, const Vec3& position, const Vec3& normal) {
    return position + normal * (4 * scene.tracer->surfaceOffset());
}

namespace {

/// The blocks of step x step cells of the square of directions, as one vertex sees them. One cell speaks for each: of a
/// lattice that lies the same way in every block, and where that cell is below the horizon the one farthest above it.
/// All vertices send the same directions: what a lattice gets wrong is then much the same for neighbours, and ratios
/// between them hardly feel it (shifts that differ cost 6 dB of the coarse answer).
class BlockLattice {
public:
    enum Answer : uint8_t { blocked, open, below };
    static constexpr int none = -1;

    BlockLattice(const DirectionGrid& grid, int step, const std::vector<float>& cosines)
        : side(grid.side / step), step_(step), fine_(grid.side), shift_(step > 1 ? 1 : 0), cosines_(cosines) {}
    const int side;
    int cell(int x, int y) const {
        const int at = (y * step_ + shift_) * fine_ + x * step_ + shift_;
        if (cosines_[size_t(at)] > 0) return at;
        if (step_ == 1) return none;
        int best = none;
        for (int dy = 0; dy < step_; ++dy)
            for (int dx = 0; dx < step_; ++dx) {
                const int c = (y * step_ + dy) * fine_ + x * step_ + dx;
                if (cosines_[size_t(c)] > (best == none ? 0.0f : cosines_[size_t(best)])) best = c;
            }
        return best;
    }

private:
    int step_, fine_, shift_;
    const std::vector<float>& cosines_;
};

/// Per block: do it and its eight neighbours that are above the horizon say the same? The square's edges fold onto
/// themselves about their middles.
bool agrees(const std::vector<uint8_t>& answers, int side, int x, int y) {
    const uint8_t own = answers[size_t(y) * size_t(side) + size_t(x)];
    if (x > 0 && y > 0 && x + 1 < side && y + 1 < side) {
        const uint8_t* row = &answers[size_t(y - 1) * size_t(side) + size_t(x - 1)];
        bool alike = true;
        for (int k = 0; k < 3; ++k, row += side)
            for (int i = 0; i < 3; ++i) alike &= row[i] == own || row[i] == BlockLattice::below;
        return alike;
    }
    for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx) {
            int nx = x + dx, ny = y + dy;
            if (nx < 0 || nx >= side) nx = std::clamp(nx, 0, side - 1), ny = side - 1 - ny;
            if (ny < 0 || ny >= side) ny = std::clamp(ny, 0, side - 1), nx = side - 1 - nx;
            const uint8_t other = answers[size_t(ny) * size_t(side) + size_t(nx)];
            if (other != own && other != BlockLattice::below) return false;
        }
    return true;
}

/// Sends rays from one vertex eight at a time and keeps the answers.
class VertexRays {
public:
    VertexRays(const Scene& scene, uint32_t v)
        : scene_(scene), origin_(rayOrigin(scene, scene.mesh.positions[v], scene.mesh.normals[v])) {}
    void send(const Vec3& direction, uint8_t* answer) {
        rays_[count_] = {origin_, direction, 0, 1e30f};
        answers_[count_++] = answer;
        if (count_ == 8) flush();
    }
    void flush() {
        if (!count_) return;
        const uint32_t blocked = scene_.tracer->occluded8({rays_, size_t(count_)});
        for (int i = 0; i < count_; ++i) *answers_[i] = blocked >> i & 1 ? BlockLattice::blocked : BlockLattice::open;
        outgoing += size_t(count_);
        count_ = 0;
    }
    size_t outgoing = 0;

private:
    const Scene& scene_;
    Vec3 origin_;
    Ray rays_[8];
    uint8_t* answers_[8];
    int count_ = 0;
};

/// Brings the bits of the vertices from the step `known` (0: nothing is known) to `step`.
size_t traceTo(const Scene& scene, const std::vector<uint8_t>& only, int known, int step, bool agreeing,
               Visibility& visibility, Progress& progress) {
    const DirectionGrid& grid = visibility.grid;
    const size_t n = scene.mesh.vertexCount();
    std::vector<Vec3> directions(size_t(grid.cells()), Vec3(0));
    std::vector<float> dx(directions.size()), dy(dx.size()), dz(dx.size());  // the same, for many at a time
    for (size_t c = 0; c < directions.size(); ++c) {
        directions[c] = grid.direction(int(c));
        dx[c] = directions[c].x;
        dy[c] = directions[c].y;
        dz[c] = directions[c].z;
    }
    // What is left out beside agreeing neighbours is only left out at the last step: coarser ones are traced whole.
    const bool adaptive = step == 1 && !agreeing && grid.side >= 4;
    std::vector<int> steps;
    if (adaptive && known != 2) steps.push_back(2);
    steps.push_back(step);
    progress.begin("Visibility", n);
    const size_t block = 64;
    std::vector<size_t> outgoing((n + block - 1) / block, 0);
    parallelBlocks(
        n, block,
        [&](size_t begin, size_t end) {
            std::vector<float> cosines(size_t(grid.cells()));
            std::vector<uint8_t> coarse, settled, answers;
            std::vector<int> askedCell;
            for (size_t v = begin; v < end; ++v) {
                if (!only[v] || !scene.referenced[v]) continue;
                uint64_t* words = &visibility.bits[v * visibility.wordsPerVertex];
                const auto bit = [&](int c) { return uint8_t(words[c >> 6] >> (c & 63) & 1); };
                const Vec3 normal = scene.mesh.normals[v];
                for (size_t c = 0; c < cosines.size(); ++c)
                    cosines[c] = dx[c] * normal.x + dy[c] * normal.y + dz[c] * normal.z;
                int before = known;
                for (const int now : steps) {
                    const BlockLattice lattice(grid, now, cosines), wider(grid, std::max(1, before), cosines);
                    int shrink = 0;
                    while (before > now << shrink) ++shrink;
                    if (before) {
                        coarse.resize(size_t(wider.side) * size_t(wider.side));
                        askedCell.resize(coarse.size());
                        settled.assign(coarse.size(), 0);
                        for (int y = 0, i = 0; y < wider.side; ++y)
                            for (int x = 0; x < wider.side; ++x, ++i) {
                                const int c = askedCell[size_t(i)] = wider.cell(x, y);
                                coarse[size_t(i)] = c == BlockLattice::none ? uint8_t(BlockLattice::below) : bit(c);
                            }
                        if (adaptive && now == 1)
                            for (int y = 0, i = 0; y < wider.side; ++y)
                                for (int x = 0; x < wider.side; ++x, ++i)
                                    settled[size_t(i)] =
                                        coarse[size_t(i)] != BlockLattice::below && agrees(coarse, wider.side, x, y);
                    }
                    answers.assign(size_t(lattice.side) * size_t(lattice.side), BlockLattice::below);
                    VertexRays rays(scene, uint32_t(v));
                    // Blocks of 8 neighbours (4 x 2), so that a packet's rays stay together.
                    for (int y0 = 0; y0 < lattice.side; y0 += 2)
                        for (int x0 = 0; x0 < lattice.side; x0 += 4)
                            for (int k = 0; k < 8; ++k) {
                                const int x = x0 + k % 4, y = y0 + k / 4;
                                if (x >= lattice.side || y >= lattice.side) continue;
                                const int c = lattice.cell(x, y);
                                if (c == BlockLattice::none) continue;
                                uint8_t& answer = answers[size_t(y) * size_t(lattice.side) + size_t(x)];
                                if (before) {
                                    const size_t parent =
                                        size_t(y >> shrink) * size_t(wider.side) + size_t(x >> shrink);
                                    if (askedCell[parent] == c || settled[parent]) {
                                        answer = coarse[parent];
                                        continue;
                                    }
                                }
                                rays.send(directions[size_t(c)], &answer);
                            }
                    rays.flush();
                    outgoing[begin / block] += rays.outgoing;
                    std::fill(words, words + visibility.wordsPerVertex, 0);
                    for (int by = 0, c = 0; by < lattice.side; ++by)
                        for (int k = 0; k < now; ++k) {
                            const uint8_t* row = answers.data() + size_t(by) * size_t(lattice.side);
                            for (int bx = 0; bx < lattice.side; ++bx) {
                                const bool open = row[bx] == BlockLattice::open;
                                for (int i = 0; i < now; ++i, ++c)
                                    words[c >> 6] |= uint64_t(open && cosines[size_t(c)] > 0) << (c & 63);
                            }
                        }
                    before = now;
                }
            }
        },
        &progress);
    return std::accumulate(outgoing.begin(), outgoing.end(), size_t(0));
}

}  // namespace

Visibility computeVisibility(const Scene& scene, const VisibilityOptions& options, Progress& progress) {
    Visibility result;
    result.grid = {options.gridSide, options.axes};
    result.step = options.step;
    result.agreeing = options.agreeing || options.step > 1;
    result.wordsPerVertex = size_t(result.grid.cells() + 63) / 64;
    result.bits.assign(scene.mesh.vertexCount() * result.wordsPerVertex, 0);
    addVisibility(scene, options.only ? *options.only : scene.referenced, result, progress);
    return result;
}

size_t addVisibility(const Scene& scene, const std::vector<uint8_t>& only, Visibility& visibility, Progress& progress) {
    return traceTo(scene, only, 0, visibility.step, visibility.agreeing, visibility, progress);
}

size_t refineVisibility(const Scene& scene, const std::vector<uint8_t>& only, int step, bool agreeing,
                        Visibility& visibility, Progress& progress) {
    if (step >= visibility.step) return 0;
    // In place: where the work is given up in the middle, the bits of every vertex are good at one step or the other.
    const size_t outgoing = traceTo(scene, only, visibility.step, step, agreeing, visibility, progress);
    visibility.step = step;
    visibility.agreeing = agreeing || step > 1;
    return outgoing;
}

size_t traceFiner(const Scene& scene, const std::vector<uint8_t>& only, const std::vector<FinerDirections>& blocks,
                  Visibility& visibility, Progress& progress) {
    const DirectionGrid& grid = visibility.grid;
    std::vector<int> cells;
    size_t asked = 0;
    for (const FinerDirections& b : blocks) {
        for (int y = b.y; y < b.y + b.side; ++y)
            for (int x = b.x; x < b.x + b.side; ++x) cells.push_back(y * grid.side + x);
        asked += size_t(b.side / b.step) * size_t(b.side / b.step);
    }
    std::vector<Vec3> directions(size_t(grid.cells()));
    for (const int c : cells) directions[size_t(c)] = grid.direction(c);
    const size_t n = scene.mesh.vertexCount();
    constexpr size_t run = 64;
    progress.begin("Visibility of strong light", n);
    return parallelSum(
        n, run, size_t(0),
        [&](size_t begin, size_t end) {
            std::vector<float> cosines(size_t(grid.cells()), 0.0f);
            std::vector<uint8_t> answers(asked);
            size_t outgoing = 0;
            for (size_t v = begin; v < end; ++v) {
                if (!only[v] || !scene.referenced[v]) continue;
                const Vec3 normal = scene.mesh.normals[v];
                for (const int c : cells) cosines[size_t(c)] = glm::dot(directions[size_t(c)], normal);
                std::fill(answers.begin(), answers.end(), uint8_t(BlockLattice::below));
                VertexRays rays(scene, uint32_t(v));
                const auto each = [&](auto&& told) {
                    uint8_t* answer = answers.data();
                    for (const FinerDirections& b : blocks)
                        for (int y = b.y; y < b.y + b.side; y += b.step)
                            for (int x = b.x; x < b.x + b.side; x += b.step) told(b, x, y, answer++);
                };
                each([&](const FinerDirections& b, int x, int y, uint8_t* answer) {
                    if (const int c = BlockLattice(grid, b.step, cosines).cell(x / b.step, y / b.step);
                        c != BlockLattice::none)
                        rays.send(directions[size_t(c)], answer);
                });
                rays.flush();
                outgoing += rays.outgoing;
                uint64_t* words = &visibility.bits[v * visibility.wordsPerVertex];
                each([&](const FinerDirections& b, int x0, int y0, const uint8_t* answer) {
                    for (int y = y0; y < y0 + b.step; ++y)
                        for (int x = x0; x < x0 + b.step; ++x) {
                            const int c = y * grid.side + x;
                            const uint64_t bit = uint64_t(1) << (c & 63);
                            if (*answer == BlockLattice::open && cosines[size_t(c)] > 0) words[c >> 6] |= bit;
                            else words[c >> 6] &= ~bit;
                        }
                });
            }
            return outgoing;
        },
        &progress);
}

namespace {
SparseCoefs transformCells(std::vector<float>& cells, const DirectionGrid& grid, float energyFraction) {
    const float scale = std::sqrt(grid.cellSolidAngle());
    for (float& value : cells) value *= scale;
    haarForward(cells, grid.side);
    return sparsify(cells, energyFraction);
}
}  // namespace

SparseCoefs visibilityCosineCoefs(const Scene& scene, const Visibility& visibility, uint32_t vertex,
                                  float energyFraction) {
    std::vector<float> cells(size_t(visibility.grid.cells()), 0.0f);
    for (int c = 0; c < visibility.grid.cells(); ++c)
        if (visibility.sees(vertex, c))
            cells[size_t(c)] = std::max(0.0f, glm::dot(scene.mesh.normals[vertex], visibility.grid.direction(c)));
    return transformCells(cells, visibility.grid, energyFraction);
}

SparseCoefs visibilityCoefs(const Visibility& visibility, uint32_t vertex, float energyFraction) {
    std::vector<float> cells(size_t(visibility.grid.cells()), 0.0f);
    for (int c = 0; c < visibility.grid.cells(); ++c) cells[size_t(c)] = visibility.sees(vertex, c);
    return transformCells(cells, visibility.grid, energyFraction);
}

}  // namespace relamp
