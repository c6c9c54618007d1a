#include "shot/relit_looks.h"

namespace relamp {
namespace {

LookPivots pivotsOf(const Shot& shot) {
    LookPivots pivots;
    pivots.emitter = [&shot](const std::string& id) {
        for (const EmitterCluster& e : shot.estimate.emitters.emitters)
            if (e.id == id) return e.centroid;
        return Vec3(0);
    };
    pivots.vertex = [&shot](uint32_t v) {
        return v < shot.capture.mesh.vertexCount() ? shot.capture.mesh.positions[v] : Vec3(0);
    };
    return pivots;
}

}  // namespace

RelitLooks::RelitLooks(const Shot& shot, const Scene& scene, const LookTrack& track)
    : shot_(shot), scene_(scene), track_(track), pivots_(pivotsOf(shot)) {}

const RelitScene& RelitLooks::at(int frame, Progress& progress) {
    Look look = lookAt(frame);
    if (look == Look{}) return captured(progress);
    if (!relit_ || !(look == look_)) {
        relit_.reset();
        relit_ = std::make_shared<const RelitScene>(applyLook(scene_, shot_.estimate, look, progress));
        look_ = std::move(look);
    }
    return *relit_;
}

const RelitScene& RelitLooks::captured(Progress& progress) {
    if (!captured_) captured_ = std::make_shared<const RelitScene>(applyLook(scene_, shot_.estimate, Look{}, progress));
    return *captured_;
}

}  // namespace relamp
