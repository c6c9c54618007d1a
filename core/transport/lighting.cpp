#include "transport/lighting.h"

#include <algorithm>

#include "wavelet/haar.h"

namespace relamp {

namespace {
constexpr int tableSide = 1 << LightLeaves::maxLevel;
constexpr size_t tableCells = size_t(tableSide) * tableSide;
}  // namespace

void LightLeaves::takeStates(const std::vector<int>& environmentOfState) {
    environmentOfState_ = environmentOfState;
    for (const int environment : environmentOfState)
        environments_ = std::max(environments_, size_t(std::max(0, environment)) + 1);
}

LightLeaves LightLeaves::uniform(int level, const Mat3& axes, const std::vector<int>& environmentOfState) {
    LightLeaves result;
    result.axes_ = axes;
    result.takeStates(environmentOfState);
    result.table_.assign(tableCells * result.environments_, 0);
    const int side = 1 << level;
    for (size_t environment = 0; environment < result.environments_; ++environment)
        for (int y = 0; y < side; ++y)
            for (int x = 0; x < side; ++x) {
                result.leaves_.push_back({uint8_t(level), uint16_t(x), uint16_t(y), uint8_t(environment)});
                result.fillTable(uint32_t(result.leaves_.size() - 1));
            }
    return result;
}

LightLeaves LightLeaves::of(const std::vector<Leaf>& leaves, const Mat3& axes,
                            const std::vector<int>& environmentOfState) {
    LightLeaves result;
    result.axes_ = axes;
    result.takeStates(environmentOfState);
    double area = 0;
    for (const Leaf& leaf : leaves) {
        if (leaf.environment >= result.environments_)
            throw Error("a leaf belongs to environment {} of {}", leaf.environment, result.environments_);
        if (leaf.level > maxLevel || leaf.x >> leaf.level || leaf.y >> leaf.level)
            throw Error("a leaf of level {} at {},{} does not exist", leaf.level, leaf.x, leaf.y);
        area += 1.0 / double(1u << (2 * leaf.level));
    }
    result.leaves_ = leaves;
    constexpr uint32_t nothing = ~0u;
    result.table_.assign(tableCells * result.environments_, nothing);
    for (uint32_t i = 0; i < leaves.size(); ++i) result.fillTable(i);
    for (uint32_t cell : result.table_)
        if (cell == nothing || area != double(result.environments_))
            throw Error("the leaves do not cover all directions once");
    return result;
}

LightLeaves LightLeaves::withStates(const std::vector<int>& environmentOfState) const {
    LightLeaves result = *this;
    result.takeStates(environmentOfState);
    if (environments_ != 1 || result.environments_ != 1)
        throw Error("{} environments cannot share one quadtree", std::max(environments_, result.environments_));
    return result;
}

void LightLeaves::fillTable(uint32_t i) {
    const Leaf& leaf = leaves_[i];
    const int width = tableSide >> leaf.level;
    uint32_t* table = &table_[leaf.environment * tableCells];
    for (int y = leaf.y * width; y < (leaf.y + 1) * width; ++y)
        for (int x = leaf.x * width; x < (leaf.x + 1) * width; ++x) table[size_t(y) * tableSide + size_t(x)] = i;
}

void LightLeaves::split(size_t i) {
    const Leaf parent = leaves_[i];
    if (parent.level >= maxLevel) return;
    for (int k = 0; k < 4; ++k) {
        const Leaf child{uint8_t(parent.level + 1), uint16_t(2 * parent.x + k % 2), uint16_t(2 * parent.y + k / 2),
                         parent.environment};
        if (k == 0) leaves_[i] = child;
        else leaves_.push_back(child);
        fillTable(uint32_t(k == 0 ? i : leaves_.size() - 1));
    }
}

size_t LightLeaves::leafOf(const Vec3& direction, size_t environment) const {
    const Vec2 p = sphereToSquare(direction * axes_) * float(tableSide);
    return table_[environment * tableCells + size_t(std::min(int(p.y), tableSide - 1)) * tableSide +
                  size_t(std::min(int(p.x), tableSide - 1))];
}

std::vector<std::pair<uint32_t, uint32_t>> LightLeaves::neighbourPairs() const {
    std::vector<std::pair<uint32_t, uint32_t>> pairs;  // each once for every cell along the border
    const auto join = [&](uint32_t a, uint32_t b) {
        if (a != b) pairs.emplace_back(std::min(a, b), std::max(a, b));
    };
    for (size_t environment = 0; environment < environments_; ++environment) {
        const uint32_t* table = &table_[environment * tableCells];
        const auto at = [&](int x, int y) { return table[size_t(y) * tableSide + size_t(x)]; };
        for (int y = 0; y < tableSide; ++y)
            for (int x = 0; x < tableSide; ++x) {
                if (x + 1 < tableSide) join(at(x, y), at(x + 1, y));
                if (y + 1 < tableSide) join(at(x, y), at(x, y + 1));
            }
        // The square's edges fold onto themselves about their middles (octahedral map).
        for (int t = 0; t < tableSide / 2; ++t) {
            const int u = tableSide - 1 - t, last = tableSide - 1;
            join(at(t, 0), at(u, 0));
            join(at(t, last), at(u, last));
            join(at(0, t), at(0, u));
            join(at(last, t), at(last, u));
        }
    }
    std::sort(pairs.begin(), pairs.end());
    pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
    return pairs;
}

std::vector<uint32_t> LightLeaves::leafOfCells(const DirectionGrid& grid, size_t environment) const {
    std::vector<uint32_t> result(size_t(grid.cells()));
    const uint32_t* table = &table_[environment * tableCells];
    const int step = tableSide / grid.side;
    for (int c = 0; c < grid.cells(); ++c)
        result[size_t(c)] =
            table[size_t((c / grid.side) * step + step / 2) * tableSide + size_t((c % grid.side) * step + step / 2)];
    return result;
}

std::array<SparseCoefs, 3> environmentCoefs(const Lighting& lighting, int side) {
    const DirectionGrid grid{side};
    std::array<SparseCoefs, 3> result;
    std::vector<float> cells(size_t(grid.cells()));
    for (int channel = 0; channel < 3; ++channel) {
        std::fill(cells.begin(), cells.end(), 0.0f);
        // Leaves finer than the grid are averaged into their cell.
        for (size_t i = 0; i < lighting.leaves.size(); ++i) {
            const Leaf& leaf = lighting.leaves[i];
            if (leaf.environment > 0) continue;
            const int leafSide = 1 << leaf.level;
            const float value = lighting.leafRadiance[i][channel];
            if (leafSide >= side) {
                const int step = leafSide / side;
                cells[size_t(leaf.y / step) * side + size_t(leaf.x / step)] += value / float(step * step);
            } else {
                const int width = side / leafSide;
                for (int y = leaf.y * width; y < (leaf.y + 1) * width; ++y)
                    for (int x = leaf.x * width; x < (leaf.x + 1) * width; ++x)
                        cells[size_t(y) * side + size_t(x)] = value;
            }
        }
        for (float& value : cells) value *= std::sqrt(grid.cellSolidAngle());
        haarForward(cells, side);
        result[size_t(channel)] = sparsify(cells);
    }
    return result;
}

}  // namespace relamp
