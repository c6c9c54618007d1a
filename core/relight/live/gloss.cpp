#include "relight/live/gloss.h"

#include "base/parallel.h"

namespace relamp {
namespace {

constexpr int fewestTaps = 16, mostTaps = 256;
constexpr size_t tapBudget = 2500000;  // of a first image: 25 ms on two cores
constexpr uint8_t done = 2;
constexpr float least = 1e-3f;  // of a lobe's weight and of the eye's cosine

/// The pattern of `count` taps, a power of two from fewestTaps to mostTaps.
const TapPattern& patternOf(int count) {
    static const TapPattern patterns[] = {TapPattern(16), TapPattern(32), TapPattern(64), TapPattern(128),
                                          TapPattern(256)};
    size_t i = 0;
    while (patterns[i].count < count) ++i;
    return patterns[i];
}

}  // namespace

struct LiveGloss::Surface {
    uint32_t vertex = 0;
    Vec3 position{0}, normal{0};
    Mat3 frame{1};
    Vec3 eye{0};  // in the frame
    std::span<const LobeWeight> lobes;
    float narrowest = 1;  // smallest alpha
};

void LiveGloss::setVertices(const LiveVertices& vertices, size_t emitters, bool neutral) {
    vertex_.clear();
    start_.assign(1, 0);
    lobes_.clear();
    placeOf_.assign(vertices.count(), EditedPart::none);
    const auto& weights = estimate_.reflectance.weight;
    for (uint32_t v = 0; v < vertices.count(); ++v) {
        const uint32_t origin = vertices.origin[v];
        if (!vertices.lit(v) || origin == EditedPart::none) continue;
        for (size_t k = 1; k < weights.size(); ++k) {
            Rgb w = weights[k][origin];
            if (neutral) w = Rgb(luminance(w));
            if (maxChannel(w) > least) lobes_.push_back({uint8_t(k), w});
        }
        if (lobes_.size() == start_.back()) continue;
        placeOf_[v] = uint32_t(vertex_.size());
        vertex_.push_back(v);
        start_.push_back(uint32_t(lobes_.size()));
    }
    queueStale_ = true;
    const size_t places = vertex_.empty() ? 0 : vertices.count();
    distant_.assign(places, Rgb(0));
    near_.assign(emitters, std::vector<Rgb>(places, Rgb(0)));
    distantLevel_.assign(vertex_.size(), 0);
    nearLevel_.assign(emitters, std::vector<uint8_t>(vertex_.size(), 0));
}

void LiveGloss::moveVertices(const LiveVertices& vertices, std::span<const uint8_t> partMoved,
                             std::span<const uint8_t> emitterMoved) {
    queueStale_ = true;
    for (size_t e = 0; e < emitterMoved.size(); ++e)
        if (emitterMoved[e]) markNear(e);
    for (size_t i = 0; i < vertex_.size(); ++i) {
        if (vertices.kind[vertex_[i]] != LiveVertices::carried || !partMoved[vertices.part[vertex_[i]]]) continue;
        distantLevel_[i] = 0;
        for (std::vector<uint8_t>& level : nearLevel_) level[i] = 0;
    }
}

void LiveGloss::markAll() {
    queueStale_ = true;
    markDistant();
    for (size_t e = 0; e < nearLevel_.size(); ++e) markNear(e);
}

void LiveGloss::markDistant(std::span<const uint32_t> vertices) {
    if (empty()) return;
    for (uint32_t v : vertices)
        if (placeOf_[v] != EditedPart::none) distantLevel_[placeOf_[v]] = 0;
}

void LiveGloss::markDistant(std::span<const uint32_t> vertices, std::span<const LivePart> spheres,
                            const GlossInputs& in) {
    if (empty()) return;
    // Nine tenths of a GGX lobe lie where the half vector's tangent is below this many alphas.
    constexpr float reach = 3;
    parallelFor(vertices.size(), 256, [&](size_t k) {
        const uint32_t i = placeOf_[vertices[k]];
        if (i == EditedPart::none || distantLevel_[i] == 0) return;
        Surface s;
        if (!surfaceOf(in, i, s)) return;
        float widest = 0;
        for (const LobeWeight& l : s.lobes) widest = std::max(widest, estimate_.reflectance.basis.lobes[l.lobe].alpha);
        const Vec3 mirror = s.frame * Vec3(-s.eye.x, -s.eye.y, s.eye.z);
        const float angle = 2 * std::atan(reach * widest);
        bool meets = false;
        for (const LivePart& b : spheres) meets |= b.mayCover(s.position, mirror, angle, 1e30f);
        distantLevel_[i] = meets ? 0 : 1;
    });
}

void LiveGloss::markShadowed(size_t emitter, const NearEmitter& near) {
    for (size_t i = 0; i < vertex_.size(); ++i)
        if (nearLevel_[emitter][i] == 3 && !near.level[vertex_[i]]) nearLevel_[emitter][i] = 0;
}

bool LiveGloss::shadowed(size_t emitter, size_t vertex) const {
    return placeOf_[vertex] != EditedPart::none && nearLevel_[emitter][placeOf_[vertex]] == 3;
}

bool LiveGloss::surfaceOf(const GlossInputs& in, size_t i, Surface& s) const {
    s.vertex = vertex_[i];
    s.position = in.vertices.mesh->positions[s.vertex];
    s.normal = in.vertices.mesh->normals[s.vertex];
    const Vec3 to = in.eye.orthographic ? -in.eye.forward : in.eye.position - s.position;
    const float distance = glm::length(to);
    if (!(glm::dot(to, s.normal) > least * distance)) return false;
    s.frame = frameAround(s.normal);
    s.eye = glm::transpose(s.frame) * (to / distance);
    s.lobes = std::span(lobes_).subspan(start_[i], start_[i + 1] - start_[i]);
    s.narrowest = 1;
    for (const LobeWeight& l : s.lobes)
        s.narrowest = std::min(s.narrowest, estimate_.reflectance.basis.lobes[l.lobe].alpha);
    return true;
}

Rgb LiveGloss::distantLight(const GlossInputs& in, const Surface& s, const TapPattern& taps) const {
    if (in.environment.black()) return Rgb(0);
    thread_local std::vector<uint8_t> masks;
    masks.resize(grid_.nibbleBytes());
    if (in.vertices.kind[s.vertex] == LiveVertices::ground) in.matte.seenNow(s.vertex, masks);
    else in.carried.seenNow(s.vertex, masks);
    return tapEnvironment(in.environment, estimate_.reflectance.basis, s.lobes, taps, s.frame, s.eye, grid_,
                          masks.data());
}

Rgb LiveGloss::nearLight(const GlossInputs& in, const Surface& s, const NearEmitter& e, bool fine, bool shadows) const {
    if (!e.reaches(s.vertex) || glm::dot(e.centre - s.position, s.normal) < -e.radius) return Rgb(0);
    thread_local EmitterComponents cut;
    const auto& basis = estimate_.reflectance.basis.lobes;
    const Mat3 toLocal = glm::transpose(s.frame);
    const float fraction2 = fine ? 0.09f : 0.36f, width2 = s.narrowest * s.narrowest;
    // A component may be as wide as the lobe changes there: about (alpha^2 + tan^2 of the half vector)^1/2.
    const auto finest = [&](const Vec3& to) {
        Vec3 h = toLocal * glm::normalize(to) + s.eye;
        h.z = std::max(h.z, 1e-3f);
        return fraction2 * (width2 + (h.x * h.x + h.y * h.y) / (h.z * h.z));
    };
    e.tree.cut(s.position, s.normal, fine ? fineCut : coarseCut, finest, cut);
    const Vec3 origin = in.occluders.origin(s.position, s.normal);
    const float back = 8 * in.occluders.offset;
    Rgb sum(0);
    Ray rays[8];
    Rgb value[8];
    uint32_t pending = 0;
    const auto flush = [&] {
        const uint32_t blocked = shadows && pending ? in.occluders.occluded8({rays, pending}) : 0u;
        for (uint32_t i = 0; i < pending; ++i)
            if (!(blocked >> i & 1)) sum += value[i];
        pending = 0;
    };
    for (const EmitterComponents::Piece& p : cut.components) {
        Vec3 target = p.centre, to = target - origin;
        const float distance = glm::length(to);
        if (!(distance > 0)) continue;
        const Vec3 light = toLocal * (to / distance);
        if (light.z <= 0) continue;
        Rgb reflectance(0);
        for (const LobeWeight& l : s.lobes) reflectance += l.weight * evaluateLobe(basis[l.lobe], light, s.eye);
        value[pending] = reflectance * (pi * p.factor);
        if (e.shaped) value[pending] *= e.shaped->factor(-to / distance, target);
        // A branch's centre lies inside a curved emitter: stop well before it.
        const float inside = p.begin != p.end ? std::sqrt(p.area) : 0.0f;
        rays[pending++] = {origin, to / distance, 0, std::max(0.0f, distance * (1 - 1e-4f) - back - inside)};
        if (pending == 8) flush();
    }
    flush();
    return sum;
}

void LiveGloss::fillQueue(const GlossInputs& in) {
    // How much of the image a vertex covers, in steps of a factor of two; 0: it faces away, 1: outside the image.
    constexpr int steps = 64;
    std::vector<uint8_t> step(vertex_.size());
    const Mesh& mesh = *in.vertices.mesh;
    const bool cone = !in.eye.orthographic && in.eye.halfAngle > 0;
    const float inside = std::cos(in.eye.halfAngle);
    parallelFor(vertex_.size(), 1024, [&](size_t i) {
        const Vec3 to = in.eye.orthographic ? -in.eye.forward : in.eye.position - mesh.positions[vertex_[i]];
        const float distance = glm::length(to), cosine = glm::dot(to, mesh.normals[vertex_[i]]) / distance;
        if (!(cosine > least)) return;
        step[i] = 1;
        if (cone && -glm::dot(to, in.eye.forward) < inside * distance) return;
        const float size = in.eye.orthographic ? cosine : cosine / (distance * distance);
        step[i] = uint8_t(std::clamp(std::ilogb(size) + steps / 2, 2, steps - 1));
    });
    std::vector<size_t> place(steps + 1, 0);
    for (const uint8_t s : step) ++place[s];
    outside_ = place[1];
    queue_.resize(vertex_.size() - place[0] - place[1]);
    size_t next = 0;
    for (int s = steps - 1; s >= 2; --s) {
        const size_t count = place[size_t(s)];
        place[size_t(s)] = next;
        next += count;
    }
    for (uint32_t i = 0; i < step.size(); ++i) {
        if (step[i] >= 2) queue_[place[step[i]]++] = i;
        if (step[i] != 0) continue;
        distant_[vertex_[i]] = Rgb(0);
        distantLevel_[i] = done;
        for (size_t e = 0; e < near_.size(); ++e) {
            near_[e][vertex_[i]] = Rgb(0);
            nearLevel_[e][i] = done;
        }
    }
    queueStale_ = false;
}

size_t LiveGloss::coarse(const GlossInputs& in, Progress& progress) {
    if (empty()) return 0;
    if (queueStale_) fillQueue(in);
    std::vector<uint32_t> wanted;
    size_t lobes = 0;
    for (const uint32_t i : queue_) {
        bool any = !distantLevel_[i];
        for (size_t e = 0; e < near_.size(); ++e) any |= !nearLevel_[e][i];
        if (!any) continue;
        if ((lobes + start_[i + 1] - start_[i]) * fewestTaps > tapBudget) break;
        wanted.push_back(i);
        lobes += start_[i + 1] - start_[i];
    }
    if (wanted.empty()) return 0;
    // Fewer taps where there are many vertices; their number decides, not the clock, so that the image does not
    // depend on it.
    int taps = mostTaps;
    while (taps > fewestTaps && lobes * size_t(taps) > tapBudget) taps /= 2;
    const TapPattern& pattern = patternOf(taps);
    parallelFor(wanted.size(), 64, [&](size_t w) {
        const size_t i = wanted[w];
        Surface s;
        const bool facing = surfaceOf(in, i, s);
        if (!distantLevel_[i]) {
            distant_[s.vertex] = facing ? distantLight(in, s, pattern) : Rgb(0);
            distantLevel_[i] = facing && taps < mostTaps ? 1 : done;
        }
        for (size_t e = 0; e < near_.size(); ++e) {
            if (nearLevel_[e][i]) continue;
            near_[e][s.vertex] = facing ? nearLight(in, s, in.near[e], false, false) : Rgb(0);
            nearLevel_[e][i] = facing ? 1 : 2;
        }
    });
    progress.check();
    return wanted.size();
}

bool LiveGloss::refine(const GlossInputs& in, Progress& progress) {
    if (empty()) return false;
    progress.check();
    if (queueStale_) fillQueue(in);
    std::vector<uint32_t> wanted;
    for (const uint32_t i : queue_) {
        bool any = distantLevel_[i] < done;
        for (size_t e = 0; e < near_.size(); ++e) any |= nearLevel_[e][i] < 2;
        if (any) wanted.push_back(i);
        if (wanted.size() == 4096) break;
    }
    parallelFor(wanted.size(), 16, [&](size_t w) {
        const size_t i = wanted[w];
        Surface s;
        const bool facing = surfaceOf(in, i, s);
        if (distantLevel_[i] < done) {
            distant_[s.vertex] = facing ? distantLight(in, s, patternOf(mostTaps)) : Rgb(0);
            distantLevel_[i] = done;
        }
        for (size_t e = 0; e < near_.size(); ++e) {
            if (nearLevel_[e][i] > 1) continue;
            const float seen = in.near[e].seen(s.vertex);
            const bool partly = facing && seen > 1e-3f && seen < 0.999f;
            near_[e][s.vertex] = facing ? nearLight(in, s, in.near[e], true, partly) : Rgb(0);
            nearLevel_[e][i] = partly ? 3 : 2;
        }
    });
    return !wanted.empty();
}

}  // namespace relamp
