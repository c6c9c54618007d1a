#include "transport/shared_directions.h"

#include "base/random.h"

namespace relamp {
namespace {

/// Traces directions eight at a time and keeps those that meet light.
class Tracing {
public:
    Tracing(const DirectionScene& in, const SharedDirections& shared, const LobeRowOptions& rows,
            std::vector<MetLight>& met)
        : in_(in), shared_(shared), rows_(rows), environment_(in.leaves.environmentOf(rows.state)), met_(met) {}
    ~Tracing() { flush(); }
    Tracing(const Tracing&) = delete;
    Tracing& operator=(const Tracing&) = delete;

    void shoot(const Vec3& local) {
        if (local.z <= 0) return;
        local_[pending_] = local;
        rays_[pending_++] = {shared_.origin, shared_.frame * local, 0, 1e30f};
        if (pending_ == 8) flush();
    }

private:
    void flush() {
        if (!pending_) return;
        in_.scene.tracer->closest8({rays_, pending_}, {hits_, pending_});
        for (size_t i = 0; i < pending_; ++i) take(local_[i], rays_[i].direction, hits_[i]);
        pending_ = 0;
    }

    void take(const Vec3& local, const Vec3& direction, const Hit& hit) {
        MetLight m{.local = local};
        if (!hit) {
            if (environment_ < 0) return;
            m.level = rows_.shapeAt(direction, environment_);
            m.column = uint32_t(in_.leaves.leafOf(direction, size_t(environment_)));
            met_.push_back(m);
            return;
        }
        const int e = in_.emitterOfTriangle.empty() ? -1 : in_.emitterOfTriangle[hit.triangle];
        const bool fromBehind = glm::dot(in_.scene.mesh.faceNormal(hit.triangle), direction) >= 0;
        if (e < 0) {
            if (!rows_.outgoing || fromBehind) return;
            m.outgoing = rows_.outgoingAt(in_.scene, hit);
        } else {
            const EmitterSurface& emitter = in_.emitters[size_t(e)];
            const float formFactor = shared_.formFactor[size_t(e)];
            if (!(formFactor > 0) || (!emitter.twoSided && fromBehind)) return;
            m.column = uint32_t(in_.leaves.size() + size_t(e));
            m.areaDensity = local.z / (pi * formFactor) * float(rows_.emitterSamples);
            m.level = emitter.levelAt(shared_.origin + hit.distance * direction, -direction);
        }
        met_.push_back(m);
    }

    const DirectionScene& in_;
    const SharedDirections& shared_;
    const LobeRowOptions& rows_;
    const int environment_;
    std::vector<MetLight>& met_;
    Ray rays_[8];
    Hit hits_[8];
    Vec3 local_[8];
    size_t pending_ = 0;
};

}  // namespace

void drawSharedDirections(const DirectionScene& in, uint32_t vertex, const LobeRowOptions& rows,
                          SharedDirections& shared) {
    const Vec3 normal = in.scene.mesh.normals[vertex], position = in.scene.mesh.positions[vertex];
    const uint32_t rank = in.scene.rank[vertex];
    shared.vertex = vertex;
    shared.frame = frameAround(normal, in.leaves.axes());
    shared.origin = rayOrigin(in.scene, position, normal);
    shared.formFactor.assign(in.emitters.size(), 0);
    shared.emitters.clear();
    shared.cosine.clear();
    thread_local std::vector<EmitterSample> samples;
    for (size_t e = 0; e < in.emitters.size(); ++e) {
        // Density per steradian of one emitter's sampler is cos / (pi x unshadowed form factor).
        const float formFactor = sampleEmitter(in.scene, in.emitters[e], position, normal, rows.emitterSamples,
                                               mixBits(rows.seed + rank) + e, samples);
        shared.formFactor[e] = formFactor;
        for (const EmitterSample& s : samples) {
            const Vec3 local = glm::transpose(shared.frame) * s.direction;
            if (s.visible == 0 || local.z <= 0) continue;
            // 1 but for what a sample stands for more or less than its fraction.
            const float evenness = s.formFactor * float(samples.size()) / formFactor;
            shared.emitters.push_back({.local = local,
                                       .column = uint32_t(in.leaves.size() + e),
                                       .level = s.level * evenness,
                                       .areaDensity = local.z / (pi * formFactor) * float(samples.size())});
        }
    }
    Tracing tracing(in, shared, rows, shared.cosine);
    const Vec2 shift = randomShift(rows.seed, rank, 8);
    for (int i = 0; i < rows.cosineSamples; ++i) {
        const Vec2 u = r2Point(uint32_t(i), shift);
        const float radius = std::sqrt(u.x), angle = 2 * pi * u.y;
        tracing.shoot({radius * std::cos(angle), radius * std::sin(angle), std::sqrt(std::max(0.0f, 1 - u.x))});
    }
}

void drawFromLobes(const DirectionScene& in, const SharedDirections& shared, const Vec3& eye,
                   std::span<const float> widths, int each, size_t firstStream, const LobeRowOptions& rows,
                   std::vector<MetLight>& met) {
    Tracing tracing(in, shared, rows, met);
    for (size_t w = 0; w < widths.size(); ++w) {
        const Vec2 shift = randomShift(rows.seed, in.scene.rank[shared.vertex], firstStream + w);
        for (int i = 0; i < each; ++i) tracing.shoot(sampleGgx(eye, widths[w], r2Point(uint32_t(i), shift)));
    }
}

}  // namespace relamp
