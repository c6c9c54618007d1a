#include "relight/live/near.h"

#include "base/parallel.h"
#include "base/random.h"

namespace relamp {
namespace {

/// Nearer than this many radii an emitter gets twice the samples, because that is where the image is brightest.
constexpr float nearRadii = 2.5f;
constexpr size_t batch = 4096;

uint64_t seedOf(uint64_t seed, size_t vertex, const NearEmitter& emitter) {
    return mixBits(mixBits(seed + emitter.part) ^ vertex);
}

void sampleVertex(NearEmitter& e, const LiveVertices& vertices, const LiveOccluders& occluders, uint64_t seed, size_t v,
                  int level, bool groundClear = false) {
    const Vec3 point = vertices.mesh->positions[v], to = e.centre - point;
    const bool close = level < 3 && glm::dot(to, to) < nearRadii * nearRadii * e.radius * e.radius;
    e.factor[v] = nearFactor(e, occluders, point, vertices.mesh->normals[v], level == 1 ? coarseCut : fineCut,
                             nearSamples(level) * (close ? 2 : 1), seedOf(seed, v, e), e.open[v], groundClear,
                             e.shape.empty() ? nullptr : &e.shape[v]);
    e.level[v] = uint8_t(level);
}

Rgb shapeOf(const NearEmitter& e, const Vec3& point, const EmitterComponents& cut) {
    Rgb sum(0);
    for (const EmitterComponents::Piece& p : cut.components)
        sum += p.factor * e.shaped->factor(glm::normalize(point - p.centre), p.centre);
    return sum / cut.open;
}

bool partlySeen(const NearEmitter& e, size_t v) {
    return e.open[v] > 0 && e.factor[v] > 1e-3f * e.open[v] && e.factor[v] < 0.999f * e.open[v];
}

/// Whether a shadow's edge may run near the vertex: its own samples disagree, or its neighbours are lit otherwise.
bool atEdge(const NearEmitter& e, const LiveVertices& vertices, const VertexGraph& graph, size_t v) {
    if (!(e.open[v] > 0)) return false;
    if (partlySeen(e, v)) return true;
    const uint32_t origin = vertices.origin[v];
    if (origin == EditedPart::none) return false;
    const float own = e.seen(v);
    for (uint32_t i = graph.start[origin]; i < graph.start[origin + 1]; ++i) {
        const uint32_t u = graph.to[i];
        if (vertices.lit(u) && e.open[u] > 0 && std::abs(e.seen(u) - own) > 0.02f) return true;
    }
    return false;
}

}  // namespace

float nearFactor(const NearEmitter& e, const LiveOccluders& occluders, const Vec3& point, const Vec3& normal,
                 const CutTolerance& tolerance, int count, uint64_t seed, float& open, bool groundClear, Rgb* shape) {
    open = 0;
    if (shape) *shape = Rgb(0);
    if (glm::dot(e.centre - point, normal) < -e.radius) return 0;
    thread_local EmitterComponents cut;
    thread_local std::vector<float> cumulative;
    e.tree.cut(point, normal, tolerance, cut);
    open = cut.open;
    if (!(open > 0)) return 0;
    if (shape && e.shaped) {
        *shape = shapeOf(e, point, cut);
        if (!(maxChannel(*shape) > 0)) return open;
    }
    if (!e.shadows) return open;
    // Parts that can stand between; its own hides nothing of a convex emitter.
    const Vec3 toCentre = e.centre - point;
    const float distance = glm::length(toCentre),
                reach = distance > e.radius ? std::asin(std::min(1.0f, e.radius / distance)) : pi;
    const Vec3 axis = distance > 0 ? toCentre / distance : normal;
    const LivePart* between[16];
    size_t parts = 0;
    for (uint32_t b = 1; b < occluders.parts.size() && parts < 16; ++b)
        if (!(b == e.part && e.tree.convex()) && occluders.parts[b].tracer &&
            occluders.parts[b].mayCover(point, axis, reach, distance + e.radius))
            between[parts++] = &occluders.parts[b];
    if (groundClear && !parts) return open;
    cumulative.clear();
    float sum = 0;
    for (const EmitterComponents::Piece& p : cut.components) cumulative.push_back(sum += p.factor);
    const Vec3 origin = occluders.origin(point, normal);
    const Vec2 shift = randomShift(seed, 0x51, 0x7f);
    const float first = unitFloat(mixBits(seed ^ 0x9d)), back = 8 * occluders.offset;
    Ray rays[8];
    float weight[8];
    uint32_t pending = 0;
    float all = 0, seen = 0;
    const auto flush = [&] {
        if (!pending) return;
        uint32_t blocked = groundClear ? 0u : occluders.groundOccluded8({rays, pending});
        for (size_t b = 0; b < parts; ++b) blocked |= between[b]->occluded8({rays, pending});
        for (uint32_t i = 0; i < pending; ++i)
            if (!(blocked >> i & 1)) seen += weight[i];
        pending = 0;
    };
    for (int i = 0; i < count; ++i) {
        const float pick = (float(i) + first) / float(count) * sum;
        const size_t p =
            std::min(size_t(std::upper_bound(cumulative.begin(), cumulative.end(), pick) - cumulative.begin()),
                     cumulative.size() - 1);
        const EmitterComponents::Piece& component = cut.components[p];
        Vec3 facing;
        const Vec3 target = e.tree.pointOn(component, r2Point(uint32_t(i), shift), facing);
        const Vec3 straight = target - point;
        const float d2 = glm::dot(straight, straight), height = glm::dot(straight, normal),
                    cosine = -glm::dot(straight, facing);
        if (!(d2 > 0) || height <= 0 || (cosine <= 0 && !e.tree.surface().twoSided)) continue;
        // Points lie evenly over a component's area, its form factor does not: cosines and distance at the point set
        // that right.
        const float w = std::min(8.0f, height * std::abs(cosine) * component.area / (pi * d2 * d2 * component.factor));
        const Vec3 to = target - origin;
        const float length = glm::length(to);
        if (!(length > 0)) continue;
        all += w;
        weight[pending] = w;
        rays[pending++] = {origin, to / length, 0, std::max(0.0f, length * (1 - 1e-4f) - back)};
        if (pending == 8) flush();
    }
    flush();
    return all > 0 ? open * (seen / all) : open;
}

void nearCoarse(NearEmitter& e, const LiveVertices& vertices, const LiveOccluders& occluders,
                const std::function<bool(size_t)>& groundClear, uint64_t seed, Progress& progress) {
    parallelFor(vertices.count(), 256, [&](size_t v) {
        if (e.level[v] || !vertices.lit(v)) return;
        sampleVertex(e, vertices, occluders, seed, v, 1, groundClear(v));
    });
    progress.check();
}

bool nearRefine(NearEmitter& e, const LiveVertices& vertices, const VertexGraph& graph, const LiveOccluders& occluders,
                uint64_t seed, Progress& progress, const SampleElsewhere& elsewhere) {
    const size_t most = elsewhere ? 8 * batch : batch;
    while (e.pass < NearEmitter::passes) {
        progress.check();
        // Which vertices is decided before any of them changes, so that it does not depend on the order of threads.
        const int level = e.pass == 0 ? 2 : e.pass < 3 ? 3 : 4;
        std::vector<uint32_t> chosen;
        for (; e.next < vertices.count() && chosen.size() < most / (e.pass == 0 ? 1 : e.pass < 3 ? 4 : 16); ++e.next) {
            if (!vertices.lit(e.next) || e.level[e.next] >= level) continue;
            const bool wanted = e.pass == 0 || (e.pass < 3 ? atEdge(e, vertices, graph, e.next)
                                                           : e.level[e.next] == 3 && partlySeen(e, e.next));
            if (wanted) chosen.push_back(uint32_t(e.next));
        }
        const bool last = e.next == vertices.count();
        if (!elsewhere || !elsewhere(e, chosen, level))
            parallelFor(chosen.size(), 32,
                        [&](size_t i) { sampleVertex(e, vertices, occluders, seed, chosen[i], level); });
        if (last) {
            ++e.pass;
            e.next = 0;
        }
        if (!chosen.empty()) return true;
    }
    return false;
}

void markShadowed(NearEmitter& e, const LiveVertices& vertices, const LivePart& part) {
    if (!(part.radius > 0)) return;
    std::vector<uint8_t> mark(vertices.count(), 0);
    parallelFor(vertices.count(), 1024, [&](size_t v) {
        if (!vertices.lit(v)) return;
        const Vec3 point = vertices.mesh->positions[v], to = e.centre - point;
        if (glm::dot(to, vertices.mesh->normals[v]) < -e.radius) return;
        const float distance = glm::length(to),
                    reach = distance > e.radius ? std::asin(std::min(1.0f, e.radius / distance)) : pi;
        mark[v] = part.mayCover(point, distance > 0 ? to / distance : Vec3(0, 0, 1), reach, distance + e.radius);
    });
    for (size_t v = 0; v < mark.size(); ++v)
        if (mark[v]) e.markStale(v);
}

}  // namespace relamp
