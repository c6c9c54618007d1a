#include "relight/live_gloss.h"

#include "base/parallel.h"
#include "base/random.h"

namespace relamp {
namespace {

constexpr int tapsOfLevel[] = {0, 32, 256};
constexpr int fewestTaps = 8;
constexpr size_t tapBudget = 640000;  // of a first picture: 20 ms on two cores
constexpr uint8_t done = 2;
constexpr float least = 1e-3f;  // of a lobe's weight and of the eye's cosine

/// Point i of a Hammersley set: the most even one for a number of points that is known.
Vec2 tapPoint(uint32_t i, int count) {
    uint32_t reversed = i;
    reversed = (reversed << 16) | (reversed >> 16);
    reversed = ((reversed & 0x00ff00ffu) << 8) | ((reversed & 0xff00ff00u) >> 8);
    reversed = ((reversed & 0x0f0f0f0fu) << 4) | ((reversed & 0xf0f0f0f0u) >> 4);
    reversed = ((reversed & 0x33333333u) << 2) | ((reversed & 0xccccccccu) >> 2);
    reversed = ((reversed & 0x55555555u) << 1) | ((reversed & 0xaaaaaaaau) >> 1);
    return {(float(i) + 0.5f) / float(count), std::min(float(reversed) * 0x1p-32f, 0x1.fffffep-1f)};
}

}  // namespace

EnvironmentPyramid::EnvironmentPyramid(const DistantLight& distant) : black_(distant.black()) {
    levels_.emplace_back(distant.grid().side, distant.cells());
    while (levels_.back().first > 1) {
        const int side = levels_.back().first / 2;
        const std::vector<Rgb>& fine = levels_.back().second;
        std::vector<Rgb> cells(size_t(side) * size_t(side));
        for (int y = 0; y < side; ++y)
            for (int x = 0; x < side; ++x) {
                const size_t at = size_t(2 * y) * size_t(2 * side) + size_t(2 * x);
                cells[size_t(y * side + x)] = 0.25f * ((fine[at] + fine[at + 1]) + (fine[at + size_t(2 * side)] + fine[at + size_t(2 * side) + 1]));
            }
        levels_.emplace_back(side, std::move(cells));
    }
}

Rgb EnvironmentPyramid::radiance(const Vec2& square, float steradians) const {
    size_t level = 0;
    const float wanted = 4 * pi / steradians;  // cells of that size on the sphere
    while (level + 1 < levels_.size() && float(levels_[level + 1].first) * float(levels_[level + 1].first) >= wanted) ++level;
    const int side = levels_[level].first, last = side - 1;
    const std::vector<Rgb>& cells = levels_[level].second;
    if (level == 0 && float(side) * float(side) < wanted)
        return cells[size_t(std::min(int(square.y * float(side)), last)) * size_t(side) + size_t(std::min(int(square.x * float(side)), last))];
    const Vec2 p = square * float(side) - Vec2(0.5f);
    const int x = int(std::floor(p.x)), y = int(std::floor(p.y));
    const float fx = p.x - float(x), fy = p.y - float(y);
    Rgb sum(0);
    for (int dy = 0; dy < 2; ++dy)
        for (int dx = 0; dx < 2; ++dx) {
            // Past the square's edge the map goes on mirrored about the edge's middle.
            int cx = x + dx, cy = y + dy;
            if (cx < 0 || cx > last) {
                cx = std::clamp(cx, 0, last);
                cy = last - std::clamp(cy, 0, last);
            } else if (cy < 0 || cy > last) {
                cy = std::clamp(cy, 0, last);
                cx = last - cx;
            }
            sum += (dx ? fx : 1 - fx) * (dy ? fy : 1 - fy) * cells[size_t(cy) * size_t(side) + size_t(cx)];
        }
    return sum;
}

struct LiveGloss::Surface {
    uint32_t vertex = 0;
    Vec3 position{0}, normal{0};
    Mat3 frame{1};
    Vec3 eye{0};               // in the frame
    std::span<const LobeWeight> lobes;
    float narrowest = 1;       // smallest alpha
};

void LiveGloss::setVertices(const LiveVertices& vertices, size_t emitters, bool neutral) {
    vertex_.clear();
    start_.assign(1, 0);
    lobes_.clear();
    placeOf_.assign(vertices.count(), EditedBody::none);
    const auto& weights = estimate_.reflectance.weight;
    for (uint32_t v = 0; v < vertices.count(); ++v) {
        const uint32_t origin = vertices.origin[v];
        if (!vertices.lit(v) || origin == EditedBody::none) continue;
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
    const size_t places = vertex_.empty() ? 0 : vertices.count();
    distant_.assign(places, Rgb(0));
    near_.assign(emitters, std::vector<Rgb>(places, Rgb(0)));
    distantLevel_.assign(vertex_.size(), 0);
    nearLevel_.assign(emitters, std::vector<uint8_t>(vertex_.size(), 0));
}

void LiveGloss::markAll() {
    markDistant();
    for (size_t e = 0; e < nearLevel_.size(); ++e) markNear(e);
}

void LiveGloss::markDistant(std::span<const uint32_t> vertices) {
    if (empty()) return;
    for (uint32_t v : vertices)
        if (placeOf_[v] != EditedBody::none) distantLevel_[placeOf_[v]] = 0;
}

void LiveGloss::markShadowed(size_t emitter, const NearEmitter& near) {
    for (size_t i = 0; i < vertex_.size(); ++i)
        if (nearLevel_[emitter][i] == 3 && !near.level[vertex_[i]]) nearLevel_[emitter][i] = 0;
}

bool LiveGloss::shadowed(size_t emitter, size_t vertex) const { return placeOf_[vertex] != EditedBody::none && nearLevel_[emitter][placeOf_[vertex]] == 3; }

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
    for (const LobeWeight& l : s.lobes) s.narrowest = std::min(s.narrowest, estimate_.reflectance.basis.lobes[l.lobe].alpha);
    return true;
}

Rgb LiveGloss::distantLight(const GlossInputs& in, const Surface& s, int taps) const {
    if (in.environment.black()) return Rgb(0);
    thread_local std::vector<uint8_t> masks;
    masks.resize(grid_.nibbleBytes());
    if (in.vertices.kind[s.vertex] == LiveVertices::ground) in.matte.seenNow(s.vertex, masks);
    else in.carried.seenNow(s.vertex, masks);
    const auto& basis = estimate_.reflectance.basis.lobes;
    Rgb sum(0);
    for (const LobeWeight& own : s.lobes)
        for (int i = 0; i < taps; ++i) {
            // The same pattern at every vertex: neighbours differ by the light alone and nothing flickers.
            const Vec3 light = sampleGgx(s.eye, basis[own.lobe].alpha, tapPoint(uint32_t(i), taps));
            if (light.z <= 0) continue;
            const Vec2 square = sphereToSquare(s.frame * light);
            const size_t quarter = grid_.quarterAt(square);
            if (!(nibbleOf(masks.data(), quarter / 4) >> (quarter % 4) & 1)) continue;
            float density = 0;
            Rgb reflectance(0);
            for (const LobeWeight& l : s.lobes) {
                density += ggxSampleDensity(light, s.eye, basis[l.lobe].alpha);
                reflectance += l.weight * evaluateLobe(basis[l.lobe], light, s.eye);
            }
            if (!(density > 0)) continue;
            sum += reflectance * (light.z / (float(taps) * density)) * in.environment.radiance(square, 1 / (float(taps) * density));
        }
    return sum;
}

Rgb LiveGloss::nearLight(const GlossInputs& in, const Surface& s, const NearEmitter& e, bool fine, bool shadows) const {
    if (glm::dot(e.centre - s.position, s.normal) < -e.radius) return Rgb(0);
    thread_local EmitterPieces cut;
    const auto& basis = estimate_.reflectance.basis.lobes;
    const Mat3 toLocal = glm::transpose(s.frame);
    const float share2 = fine ? 0.09f : 0.36f, width2 = s.narrowest * s.narrowest;
    // A piece may be as wide as the lobe changes there: about (alpha^2 + tan^2 of the half vector)^1/2.
    const auto finest = [&](const Vec3& to) {
        Vec3 h = toLocal * glm::normalize(to) + s.eye;
        h.z = std::max(h.z, 1e-3f);
        return share2 * (width2 + (h.x * h.x + h.y * h.y) / (h.z * h.z));
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
    for (const EmitterPieces::Piece& p : cut.pieces) {
        Vec3 target = p.centre, to = target - origin;
        const float distance = glm::length(to);
        if (!(distance > 0)) continue;
        const Vec3 light = toLocal * (to / distance);
        if (light.z <= 0) continue;
        Rgb reflectance(0);
        for (const LobeWeight& l : s.lobes) reflectance += l.weight * evaluateLobe(basis[l.lobe], light, s.eye);
        value[pending] = reflectance * (pi * p.factor);
        // A branch's centre lies inside a curved emitter: stop well before it.
        const float inside = p.begin != p.end ? std::sqrt(p.area) : 0.0f;
        rays[pending++] = {origin, to / distance, 0, std::max(0.0f, distance * (1 - 1e-4f) - back - inside)};
        if (pending == 8) flush();
    }
    flush();
    return sum;
}

size_t LiveGloss::coarse(const GlossInputs& in, Progress& progress) {
    if (empty()) return 0;
    constexpr size_t block = 128;
    // Fewer taps where there are many vertices; the number of vertices decides, not the clock, so that the picture does not depend on it.
    int taps = tapsOfLevel[1];
    while (taps > fewestTaps && vertex_.size() / 2 * size_t(taps) > tapBudget) taps /= 2;
    const size_t shaded = parallelSum(vertex_.size(), block, size_t(0), [&](size_t begin, size_t end) {
        size_t count = 0;
        Surface s;
        for (size_t i = begin; i < end; ++i) {
            const bool facing = surfaceOf(in, i, s);
            count += facing;
            if (!distantLevel_[i]) {
                distant_[s.vertex] = facing ? distantLight(in, s, taps) : Rgb(0);
                distantLevel_[i] = facing ? 1 : done;
            }
            for (size_t e = 0; e < near_.size(); ++e) {
                if (nearLevel_[e][i]) continue;
                near_[e][s.vertex] = facing ? nearLight(in, s, in.near[e], false, false) : Rgb(0);
                nearLevel_[e][i] = facing ? 1 : 2;
            }
        }
        return count;
    });
    progress.check();
    return shaded;
}

bool LiveGloss::refine(const GlossInputs& in, Progress& progress) {
    if (empty()) return false;
    progress.check();
    std::vector<uint32_t> wanted;
    for (uint32_t i = 0; i < vertex_.size() && wanted.size() < 2048; ++i) {
        bool any = distantLevel_[i] < done;
        for (size_t e = 0; e < near_.size(); ++e) any |= nearLevel_[e][i] < 2;
        if (any) wanted.push_back(i);
    }
    parallelFor(wanted.size(), 16, [&](size_t w) {
        const size_t i = wanted[w];
        Surface s;
        const bool facing = surfaceOf(in, i, s);
        if (distantLevel_[i] < done) {
            distant_[s.vertex] = facing ? distantLight(in, s, tapsOfLevel[2]) : Rgb(0);
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
