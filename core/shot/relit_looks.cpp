#include "shot/relit_looks.h"

#include "relight/state_look.h"

namespace relamp {
namespace {

LookPivots pivotsOf(const Estimate& estimate, const Mesh& mesh) {
    LookPivots pivots;
    pivots.emitter = [&estimate](const std::string& id) {
        for (const EmitterCluster& e : estimate.emitters.emitters)
            if (e.id == id) return e.centroid;
        return Vec3(0);
    };
    pivots.vertex = [&mesh](uint32_t v) { return v < mesh.vertexCount() ? mesh.positions[v] : Vec3(0); };
    return pivots;
}

}  // namespace

RelitLooks::RelitLooks(const Estimate& estimate, const Scene& scene, const LookTrack& track)
    : estimate_(estimate), scene_(scene), track_(track), pivots_(pivotsOf(estimate, scene.mesh)) {}

const RelitScene& RelitLooks::at(int frame, Progress& progress, std::optional<size_t> state) {
    Look look = lookAt(frame);
    if (look == Look{}) return captured(progress, base_ ? base_ : state);
    look = inState(std::move(look), base_);
    if (!relit_ || !(look == look_)) {
        relit_.reset();
        relit_ = std::make_shared<const RelitScene>(applyLook(scene_, estimate_, look, progress));
        look_ = std::move(look);
    }
    return *relit_;
}

const RelitScene& RelitLooks::captured(Progress& progress, std::optional<size_t> state) {
    if (!state) state = base_;
    if (estimate_.states.empty()) state = {};
    std::shared_ptr<const RelitScene>& relit = captured_[state];
    if (!relit) relit = std::make_shared<const RelitScene>(applyLook(scene_, estimate_, inState({}, state), progress));
    return *relit;
}

Look RelitLooks::inState(Look look, std::optional<size_t> state) const {
    return state ? relamp::inState(std::move(look), estimate_, *state) : look;
}

}  // namespace relamp
