#include "relight/live/near.h"

#include <atomic>

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
                  int level, bool groundClear = false, Vec3* flux = nullptr) {
    if (!e.reaches(v)) {
        e.factor[v] = e.open[v] = 0;
        if (!e.shape.empty()) e.shape[v] = Rgb(0);
        if (flux) *flux = Vec3(0);
        e.level[v] = uint8_t(level);
        return;
    }
    const Vec3 point = vertices.mesh->positions[v], to = e.centre - point;
    const bool close = level < 3 && glm::dot(to, to) < nearRadii * nearRadii * e.radius * e.radius;
    e.factor[v] = nearFactor(e, occluders, point, vertices.mesh->normals[v], level == 1 ? coarseCut : fineCut,
                             nearSamples(level) * (close ? 2 : 1), seedOf(seed, v, e), e.open[v], groundClear,
                             e.shape.empty() ? nullptr : &e.shape[v], flux);
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
                 const CutTolerance& tolerance, int count, uint64_t seed, float& open, bool groundClear, Rgb* shape,
                 Vec3* flux) {
    open = 0;
    if (flux) *flux = Vec3(0);
    if (shape) *shape = Rgb(0);
    if (glm::dot(e.centre - point, normal) < -e.radius) return 0;
    thread_local EmitterComponents cut;
    thread_local std::vector<float> cumulative;
    e.tree.cut(point, normal, tolerance, cut);
    open = cut.open;
    if (!(open > 0)) return 0;
    if (flux)
        for (const EmitterComponents::Piece& p : cut.components)
            if (const float height = glm::dot(p.centre - point, normal); height > 0)
                *flux += (p.factor / height) * (p.centre - point);
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

namespace {

/// Shadows of neighbours that differ by less are one: two of four samples.
constexpr float shadowStep = 0.3f;
/// Light that changes by a smaller factor among parents is within 1 % of what lies between them.
constexpr float fall = 1.3f;
constexpr float sameNormal = 0.995f;

bool wholeAbove(const NearEmitter& e, const LiveVertices& vertices, size_t v) {
    return glm::dot(e.centre - vertices.mesh->positions[v], vertices.mesh->normals[v]) > e.radius;
}

/// Takes the light of a vertex from its parents; false where that could be far off.
bool takeBetween(NearEmitter& e, const LiveVertices& vertices, NearLevels& detail, size_t v) {
    using Known = NearLevels::Known;
    const std::span<const LiveLevels::Parent> parents = detail.levels.parents(v);
    if (parents.empty() || !e.reaches(v)) return false;
    const Vec3 normal = vertices.mesh->normals[v];
    const bool rough = detail.gaze.misses(vertices.mesh->positions[v], normal), wholly = wholeAbove(e, vertices, v);
    Vec3 flux(0);
    Rgb shape(0);
    float factor = 0, seen = 0, leastSeen = 1, mostSeen = 0, leastFlux = 1e30f, mostFlux = 0, leastFactor = 1e30f,
          mostFactor = 0;
    bool above = wholly;
    for (const LiveLevels::Parent& p : parents) {
        const Known& own = detail.known[p.vertex];
        if (own.state == Known::nothing || !e.reaches(p.vertex)) return false;
        above &= own.state == Known::whole;
        flux += p.weight * own.flux;
        factor += p.weight * own.factor;
        seen += p.weight * own.seen;
        leastSeen = std::min(leastSeen, own.seen);
        mostSeen = std::max(mostSeen, own.seen);
        const float strength = glm::dot(own.flux, own.flux);
        leastFlux = std::min(leastFlux, strength);
        mostFlux = std::max(mostFlux, strength);
        leastFactor = std::min(leastFactor, own.factor);
        mostFactor = std::max(mostFactor, own.factor);
        if (!e.shape.empty()) shape += p.weight * e.shape[p.vertex];
    }
    // A vector, for any normal, where all of the emitter is above the horizon; else a number, for the same normal.
    if (!rough) {
        if (mostSeen - leastSeen > shadowStep) return false;
        if (above ? mostFlux > fall * fall * leastFlux : mostFactor > fall * leastFactor) return false;
        for (const LiveLevels::Parent& p : parents) {
            if (!above && glm::dot(vertices.mesh->normals[p.vertex], normal) < sameNormal) return false;
            if (!e.shape.empty() && maxChannel(glm::abs(e.shape[p.vertex] - shape)) > 0.05f * maxChannel(shape))
                return false;
        }
    }
    if (!e.shape.empty()) e.shape[v] = glm::max(shape, Rgb(0));
    e.open[v] = std::clamp(above || rough ? glm::dot(flux, normal) : factor, 0.0f, 1.0f);
    seen = std::clamp(seen, 0.0f, 1.0f);
    e.factor[v] = e.open[v] * seen;
    e.level[v] = 1;
    detail.known[v] = {flux, e.open[v], seen, wholly ? Known::whole : Known::open};
    detail.between[v] = rough ? 2 : 1;
    return true;
}

/// Computes what lies between others beside a vertex that is seen otherwise, and goes on from there: so a shadow is
/// followed along its edge once any vertex has met it.
template <class Compute>
void followShadows(NearEmitter& e, const LiveVertices& vertices, const VertexGraph& graph, NearLevels& detail,
                   const Compute& compute) {
    const size_t n = detail.between.size();
    std::vector<uint8_t> wanted(n, 0);
    const auto otherwise = [&](size_t v, uint32_t u) {
        return detail.between[u] == 1 && vertices.lit(u) && e.open[u] > 0 &&
               std::abs(e.seen(u) - e.seen(v)) > shadowStep;
    };
    parallelFor(n, 4096, [&](size_t v) {
        if (detail.between[v] || !vertices.lit(v) || !(e.open[v] > 0)) return;
        for (uint32_t i = graph.start[v]; i < graph.start[v + 1]; ++i)
            if (const uint32_t u = graph.to[i]; otherwise(v, u))
                std::atomic_ref(wanted[u]).store(1, std::memory_order_relaxed);
    });
    std::vector<uint32_t> front;
    for (uint32_t v = 0; v < n; ++v)
        if (wanted[v]) front.push_back(v);
    while (!front.empty()) {
        parallelFor(front.size(), 64, [&](size_t i) { compute(front[i]); });
        for (const uint32_t v : front) detail.between[v] = 0;
        std::vector<uint32_t> next;
        for (const uint32_t v : front)
            for (uint32_t i = graph.start[v]; i < graph.start[v + 1]; ++i)
                if (const uint32_t u = graph.to[i]; !wanted[u] && e.open[v] > 0 && otherwise(v, u)) {
                    wanted[u] = 1;
                    next.push_back(u);
                }
        front = std::move(next);
    }
}

/// In half shadow the mean over neighbours: four samples a vertex would crawl with the emitter.
void smoothShadows(NearEmitter& e, const LiveVertices& vertices, const VertexGraph& graph, const NearLevels& detail) {
    std::vector<float> smooth(detail.between.size(), -1);
    parallelFor(smooth.size(), 4096, [&](size_t v) {
        if (detail.between[v] || !vertices.lit(v) || !partlySeen(e, v)) return;
        float sum = e.seen(v), weight = 1;
        for (uint32_t i = graph.start[v]; i < graph.start[v + 1]; ++i) {
            const uint32_t u = graph.to[i];
            if (!vertices.lit(u) || !(e.open[u] > 0) || detail.between[u] == 2 ||
                glm::dot(vertices.mesh->normals[u], vertices.mesh->normals[v]) < 0.9f)
                continue;
            sum += e.seen(u);
            weight += 1;
        }
        smooth[v] = sum / weight;
    });
    parallelFor(smooth.size(), 4096, [&](size_t v) {
        if (smooth[v] >= 0) e.factor[v] = e.open[v] * smooth[v];
    });
}

}  // namespace

void nearCoarse(NearEmitter& e, const LiveVertices& vertices, const LiveOccluders& occluders,
                const std::function<bool(size_t)>& groundClear, uint64_t seed, Progress& progress, NearLevels* detail,
                const VertexGraph* graph) {
    const auto stale = [&](size_t v) { return !e.level[v] && vertices.lit(v); };
    const auto all = [&] {
        for (const std::vector<uint32_t>& set : detail->levels.sets())
            for (const uint32_t v : set)
                if (e.level[v] && vertices.lit(v)) return false;
        return true;
    };
    if (detail && graph && !detail->levels.empty() && all()) {
        detail->known.resize(vertices.count());
        detail->between.assign(graph->start.size() - 1, 0);
        const auto compute = [&](size_t v) {
            NearLevels::Known& known = detail->known[v];
            sampleVertex(e, vertices, occluders, seed, v, 1, groundClear(v), &known.flux);
            known.factor = e.open[v];
            known.seen = e.seen(v);
            known.state = wholeAbove(e, vertices, v) ? NearLevels::Known::whole : NearLevels::Known::open;
        };
        for (const std::vector<uint32_t>& set : detail->levels.sets())
            parallelFor(set.size(), 256, [&](size_t i) {
                if (!stale(set[i])) detail->known[set[i]].state = NearLevels::Known::nothing;
                else if (!takeBetween(e, vertices, *detail, set[i])) compute(set[i]);
            });
        followShadows(e, vertices, *graph, *detail, compute);
        smoothShadows(e, vertices, *graph, *detail);
        progress.check();
    }
    parallelFor(vertices.count(), 256, [&](size_t v) {
        if (stale(v)) sampleVertex(e, vertices, occluders, seed, v, 1, groundClear(v));
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
            if (!vertices.lit(e.next) || !e.reaches(e.next) || e.level[e.next] >= level) continue;
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
