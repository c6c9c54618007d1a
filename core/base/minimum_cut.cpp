#include "base/minimum_cut.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace relamp {
namespace {

/// What still fits through each arc, in whole units: the same answer in whatever order sums are taken.
class FlowNetwork {
public:
    explicit FlowNetwork(size_t nodes) : arcsOf_(nodes), level_(nodes), next_(nodes) {}
    void join(uint32_t from, uint32_t to, int64_t there, int64_t back) {
        arcsOf_[from].push_back(uint32_t(to_.size()));
        to_.push_back(to);
        room_.push_back(there);
        arcsOf_[to].push_back(uint32_t(to_.size()));
        to_.push_back(from);
        room_.push_back(back);
    }
    /// Afterwards reached() tells the source's side.
    void fill(uint32_t source, uint32_t sink) {
        while (spread(source, sink)) {
            std::fill(next_.begin(), next_.end(), 0u);
            while (push(source, sink)) {}
        }
    }
    bool reached(uint32_t node) const { return level_[node] >= 0; }

private:
    std::vector<std::vector<uint32_t>> arcsOf_;
    std::vector<uint32_t> to_;
    std::vector<int64_t> room_;
    std::vector<int> level_;
    std::vector<uint32_t> next_;

    bool spread(uint32_t source, uint32_t sink) {
        std::fill(level_.begin(), level_.end(), -1);
        std::vector<uint32_t> queue{source};
        level_[source] = 0;
        for (size_t at = 0; at < queue.size(); ++at)
            for (const uint32_t arc : arcsOf_[queue[at]])
                if (room_[arc] > 0 && level_[to_[arc]] < 0) {
                    level_[to_[arc]] = level_[queue[at]] + 1;
                    queue.push_back(to_[arc]);
                }
        return level_[sink] >= 0;
    }
    /// One more path of the level graph; false when there is none.
    bool push(uint32_t source, uint32_t sink) {
        std::vector<uint32_t> path;
        for (uint32_t node = source; node != sink;) {
            uint32_t& next = next_[node];
            while (next < arcsOf_[node].size() && !leads(node, arcsOf_[node][next])) ++next;
            if (next < arcsOf_[node].size()) {
                path.push_back(arcsOf_[node][next]);
                node = to_[path.back()];
                continue;
            }
            if (node == source) return false;
            node = to_[path.back() ^ 1];
            path.pop_back();
            ++next_[node];
        }
        int64_t most = std::numeric_limits<int64_t>::max();
        for (const uint32_t arc : path) most = std::min(most, room_[arc]);
        for (const uint32_t arc : path) {
            room_[arc] -= most;
            room_[arc ^ 1] += most;
        }
        return true;
    }
    bool leads(uint32_t node, uint32_t arc) const { return room_[arc] > 0 && level_[to_[arc]] == level_[node] + 1; }
};

}  // namespace

std::vector<uint8_t> minimumCut(const std::vector<double>& gain, const std::vector<CutEdge>& edges) {
    constexpr double unit = 1e-4;
    const auto units = [&](double x) { return int64_t(std::llround(std::min(x, 1e9) / unit)); };
    const uint32_t source = uint32_t(gain.size()), sink = source + 1;
    FlowNetwork network(gain.size() + 2);
    for (uint32_t i = 0; i < gain.size(); ++i) {
        if (gain[i] > 0) network.join(source, i, units(gain[i]), 0);
        if (gain[i] < 0) network.join(i, sink, units(-gain[i]), 0);
    }
    for (const CutEdge& e : edges)
        if (e.a != e.b) network.join(e.a, e.b, units(e.cost), units(e.cost));
    network.fill(source, sink);
    std::vector<uint8_t> label(gain.size());
    for (uint32_t i = 0; i < gain.size(); ++i) label[i] = network.reached(i);
    return label;
}

}  // namespace relamp
