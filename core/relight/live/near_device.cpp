#include "relight/live/near_device.h"

#include <chrono>
#include <utility>

#include "base/box.h"
#include "base/error.h"
#include "base/log.h"
#include "base/parallel.h"

namespace relamp {
namespace {

/// Rays that just pass an edge here may hit it there.
constexpr double agreement = 0.01;

double millisecondsOf(const auto& work) {
    const auto start = std::chrono::steady_clock::now();
    work();
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

bool suits(const NearEmitter& e, const LiveOccluders& occluders) {
    const bool sun = e.part < occluders.parts.size() && e.part && !occluders.parts[e.part].tracer;
    return !e.shaped && !sun && !e.tree.nodes().empty();
}

/// A square of a twentieth of the scene's size above its middle.
NearEmitter trialEmitter(const LiveVertices& vertices) {
    Box box;
    for (size_t v = 0; v < vertices.count(); ++v)
        if (vertices.lit(v)) box.grow(vertices.mesh->positions[v]);
    const float side = std::max(1e-6f, box.diagonal() / 20);
    const Vec3 middle(box.centre().x, box.centre().y, box.max.z + 4 * side);
    Mesh mesh;
    for (const Vec2 corner : {Vec2(-1, -1), Vec2(-1, 1), Vec2(1, 1), Vec2(1, -1)})
        mesh.positions.push_back(middle + Vec3(corner * (side / 2), 0));
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    EmitterCluster all;
    all.triangles = {0, 1};
    NearEmitter out;
    out.tree = LiveEmitterTree(emitterSurface(mesh, all));
    out.centre = out.tree.surface().centroid;
    out.radius = out.tree.surface().radius;
    return out;
}

}  // namespace

void NearPlace::fail(const std::exception& error) {
    logWarning("Near fields are computed on the processor: {}: {}", device_->name(), error.what());
    device_->giveUp();
    device_.reset();
    deviceMs_ = 0;
    started_.clear();
}

void NearPlace::choose(const NearEmitter* emitter, const LiveVertices& vertices, const LiveOccluders& occluders,
                       const DeviceBlockers& blockers, std::shared_ptr<NearDevice> device, bool force, uint64_t seed,
                       Progress& progress) {
    device_.reset();
    processorMs_ = deviceMs_ = 0;
    if (!device || device->gaveUp()) return;
    NearEmitter trial;
    if (emitter && suits(*emitter, occluders)) {
        trial.tree = emitter->tree;
        trial.part = emitter->part;
        trial.centre = emitter->centre;
        trial.radius = emitter->radius;
    } else {
        trial = trialEmitter(vertices);
    }
    std::vector<uint32_t> wanted;
    for (uint32_t v = 0; v < vertices.count(); ++v)
        if (vertices.lit(v)) wanted.push_back(v);
    if (wanted.empty()) return;
    NearEmitter here = trial;
    for (auto* values : {&here.factor, &here.open}) values->resize(vertices.count(), 0);
    here.level.resize(vertices.count(), 0);
    processorMs_ = millisecondsOf([&] {
        nearCoarse(
            here, vertices, occluders, [](size_t) { return false; }, seed, progress);
    });
    device_ = std::move(device);
    try {
        device_->forget();
        std::vector<NearAnswer> there(wanted.size());
        const NearQuery query{trial, vertices, occluders, blockers, wanted, 1, seed};
        for (int run = 0; run < 2; ++run) {  // the first one brings the scene there
            progress.check();
            deviceMs_ = millisecondsOf([&] {
                device_->start(query);
                device_->finish(there);
            });
        }
        double off = 0, sum = 0;
        for (size_t i = 0; i < wanted.size(); ++i) {
            off += std::abs(double(there[i].factor) - double(here.factor[wanted[i]]));
            sum += double(here.open[wanted[i]]);
        }
        if (!(off <= agreement * sum))
            throw Error("its form factors are off by {:.2g} of the light, expected {:.2g} at most", off / sum,
                        agreement);
        if (force || deviceMs_ < processorMs_) return;
        device_->clear();  // its memory is of use elsewhere
        device_.reset();

    } catch (const Cancelled&) { throw; } catch (const std::exception& error) {
        fail(error);
    }
}

void NearPlace::start(const std::vector<NearEmitter>& emitters, const LiveVertices& vertices,
                      const LiveOccluders& occluders, const DeviceBlockers& blockers, uint64_t seed) {
    const bool stopped = !std::exchange(started_, {}).empty();
    if (!used()) return;
    try {
        if (stopped) device_->forget();
        for (size_t e = 0; e < emitters.size(); ++e) {
            if (!suits(emitters[e], occluders)) continue;
            Started s{e, {}};
            s.wanted.reserve(vertices.count());
            for (uint32_t v = 0; v < vertices.count(); ++v)
                if (!emitters[e].level[v] && vertices.lit(v) && emitters[e].reaches(v)) s.wanted.push_back(v);
            if (s.wanted.empty()) continue;
            device_->start({emitters[e], vertices, occluders, blockers, s.wanted, 1, seed});
            started_.push_back(std::move(s));
        }
    } catch (const std::exception& error) { fail(error); }
}

void NearPlace::finish(std::vector<NearEmitter>& emitters) {
    if (!used()) return;
    try {
        for (const Started& s : started_) {
            answers_.resize(s.wanted.size());
            device_->finish(answers_);
            NearEmitter& e = emitters[s.emitter];
            parallelFor(s.wanted.size(), 4096, [&](size_t i) {
                e.factor[s.wanted[i]] = answers_[i].factor;
                e.open[s.wanted[i]] = answers_[i].open;
                e.level[s.wanted[i]] = 1;
            });
        }
        started_.clear();
    } catch (const std::exception& error) { fail(error); }
}

bool NearPlace::sample(NearEmitter& emitter, const LiveVertices& vertices, const LiveOccluders& occluders,
                       const DeviceBlockers& blockers, std::span<const uint32_t> chosen, int level, uint64_t seed) {
    if (!used() || chosen.empty() || !suits(emitter, occluders)) return false;
    try {
        answers_.resize(chosen.size());
        device_->start({emitter, vertices, occluders, blockers, chosen, level, seed});
        device_->finish(answers_);
    } catch (const std::exception& error) {
        fail(error);
        return false;
    }
    for (size_t i = 0; i < chosen.size(); ++i) {
        emitter.factor[chosen[i]] = answers_[i].factor;
        emitter.open[chosen[i]] = answers_[i].open;
        emitter.level[chosen[i]] = uint8_t(level);
    }
    return true;
}

}  // namespace relamp
