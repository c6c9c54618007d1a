#include "relight/live/carried.h"

#include "base/parallel.h"

namespace relamp {

void LiveCarried::setVertices(const LiveVertices& vertices) {
    vertex_.clear();
    placeOf_.assign(vertices.count(), EditedPart::none);
    for (uint32_t v = 0; v < vertices.count(); ++v) {
        if (vertices.kind[v] != LiveVertices::carried) continue;
        placeOf_[v] = uint32_t(vertex_.size());
        vertex_.push_back(v);
    }
    masks_.resize(vertex_.size() * grid_.nibbleBytes());
    level_.assign(vertex_.size(), 0);
    changed_.assign(vertex_.size(), 1);
    told_.assign(vertex_.size(), 1);
}

void LiveCarried::trace(const LiveVertices& vertices, const LiveOccluders& occluders, size_t i, bool coarse) {
    const Occluded8 occluded = [&](std::span<const Ray> rays) { return occluders.occluded8(rays); };
    const Vec3 normal = vertices.mesh->normals[vertex_[i]];
    traceCells(grid_, occluders.origin(vertices.mesh->positions[vertex_[i]], normal), normal, coarse, occluded,
               masksOf(i));
    level_[i] = coarse ? 1 : 2;
    changed_[i] = told_[i] = 1;
}

void LiveCarried::coarse(const LiveVertices& vertices, const LiveOccluders& occluders, Progress& progress) {
    parallelFor(vertex_.size(), 16, [&](size_t i) {
        if (!level_[i]) trace(vertices, occluders, i, true);
    });
    progress.check();
}

bool LiveCarried::refine(const LiveVertices& vertices, const LiveOccluders& occluders, Progress& progress) {
    progress.check();
    std::vector<uint32_t> wanted;
    for (uint32_t i = 0; i < level_.size() && wanted.size() < 256; ++i)
        if (level_[i] < 2) wanted.push_back(i);
    if (wanted.empty()) return false;
    parallelFor(wanted.size(), 4, [&](size_t i) { trace(vertices, occluders, wanted[i], false); });
    return true;
}

void LiveCarried::apply(const LiveVertices& vertices, const LiveLight& light, bool all, std::span<Rgb> out) {
    parallelBlocks(vertex_.size(), 64, [&](size_t begin, size_t end) {
        std::vector<float> weight(grid_.cells());
        for (size_t i = begin; i < end; ++i) {
            if (!all && !changed_[i]) continue;
            changed_[i] = 0;
            grid_.weights(vertices.mesh->normals[vertex_[i]], masksOf(i), weight);
            Rgb sum(0);
            for (size_t c = 0; c < weight.size(); ++c)
                if (weight[c] > 0) sum += weight[c] * light.cells[c];
            out[vertex_[i]] = sum;
        }
    });
}

void LiveCarried::seenNow(uint32_t vertex, std::span<uint8_t> masks) const {
    const size_t i = placeOf_[vertex];
    std::copy_n(masks_.begin() + long(i * grid_.nibbleBytes()), grid_.nibbleBytes(), masks.begin());
}

std::vector<uint32_t> LiveCarried::takeChanged() {
    std::vector<uint32_t> vertices;
    for (size_t i = 0; i < told_.size(); ++i)
        if (told_[i]) vertices.push_back(vertex_[i]);
    std::fill(told_.begin(), told_.end(), uint8_t(0));
    return vertices;
}

}  // namespace relamp
