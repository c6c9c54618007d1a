// Levels of detail over the vertices that stay in place: light of an emitter in a hand is taken at few of them and lies
// between them elsewhere, but where a shadow's edge runs.
#pragma once
#include <span>
#include <vector>

#include "scene/mesh.h"

namespace relamp {

/// Built once a scene. A vertex of a finer level lies among parents of the next coarser one, on the same surface, so
/// that weights of sum 1 give its position from theirs within its tangent plane.
class LiveLevels {
public:
    struct Parent {
        uint32_t vertex = 0;
        float weight = 0;
    };
    LiveLevels() = default;
    /// Levels over the vertices that `wanted` marks (a byte a vertex, 0: no), each about a third of the one before,
    /// until one has fewer than `fewest`. Cost: about a microsecond a vertex. Memory: 44 bytes a vertex.
    LiveLevels(const Mesh& mesh, const VertexGraph& graph, std::span<const uint8_t> wanted, size_t fewest);

    bool empty() const { return sets_.empty(); }
    /// Disjoint sets of vertices, coarsest first. Each vertex of a later set has its parents in earlier ones, or none.
    const std::vector<std::vector<uint32_t>>& sets() const { return sets_; }
    /// Empty: the vertex has to be computed.
    std::span<const Parent> parents(size_t vertex) const {
        return std::span(parents_).subspan(start_[vertex], start_[vertex + 1] - start_[vertex]);
    }

private:
    std::vector<std::vector<uint32_t>> sets_;
    std::vector<uint32_t> start_;
    std::vector<Parent> parents_;
};

}  // namespace relamp
