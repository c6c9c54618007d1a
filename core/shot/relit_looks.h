// The looks of a sequence applied to a shot's scene, one at a time.
#pragma once
#include <map>
#include <memory>
#include <optional>

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
    /// The light that all looks edit from here on: that of a lighting state. Without it emitters are as bright as they
    /// are in any state.
    void base(std::optional<size_t> state) { base_ = state; }
    /// Good until the next call. Where the look edits nothing it is captured(progress, state), and with a base
    /// captured(progress). Throws Error as applyLook does, Cancelled.
    const RelitScene& at(int frame, Progress& progress, std::optional<size_t> state = {});
    /// The light as photographed, in a lighting state; none: the base. Good as long as this lives.
    const RelitScene& captured(Progress& progress, std::optional<size_t> state = {});

private:
    Look inState(Look look, std::optional<size_t> state) const;

    const Estimate& estimate_;
    const Scene& scene_;
    const LookTrack& track_;
    LookPivots pivots_;
    Look look_;
    std::optional<size_t> base_;
    std::shared_ptr<const RelitScene> relit_;
    std::map<std::optional<size_t>, std::shared_ptr<const RelitScene>> captured_;  ///< by state
};

}  // namespace relamp
