// The looks of a sequence applied to a shot's scene, one at a time.
#pragma once
#include <memory>
#include "relight/look_track.h"
#include "relight/relit_scene.h"

#include "shot/shot_file.h"

namespace relamp {

/// Each look is kept as long as it lasts. Keeps references to estimate, scene and track.
class RelitLooks {
public:
    RelitLooks(const Shot& shot, const Scene& scene, const LookTrack& track)
        : RelitLooks(shot.estimate, scene, track) {}
    RelitLooks(const Estimate& estimate, const Scene& scene, const LookTrack& track);

    Look lookAt(int frame) const { return track_.at(frame, pivots_); }
    /// Good until the next call. Throws Error as applyLook does, Cancelled.
    const RelitScene& at(int frame, Progress& progress);
    /// The light as photographed; the same object as at() gives where the look edits nothing. Good as long as this
    /// lives.
    const RelitScene& captured(Progress& progress);

private:
    const Estimate& estimate_;
    const Scene& scene_;
    const LookTrack& track_;
    LookPivots pivots_;
    Look look_;
    std::shared_ptr<const RelitScene> relit_, captured_;
};

}  // namespace relamp
