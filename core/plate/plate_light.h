// What the model says of a plate's frame, before and after the edit, and the relit plate that follows from it.
#pragma once
#include <functional>
#include <map>
#include <optional>

#include "plate/plate_sequence.h"
#include "relight/frame.h"
#include "shot/ratio_frame.h"

namespace relamp {

/// What an edit does to one frame, row by row.
struct PlateLight {
    int width = 0, height = 0;
    float floor = 0;              ///< a thousandth of the frame's white (ratioFloor), in the capture's unit
    std::vector<Rgb> before;      ///< radiance as captured, in that unit
    std::vector<Rgb> logRatio;    ///< of (after + floor) / (before + floor); 0 where nothing changed
    std::vector<float> distance;  ///< from the eye to the surface, metres; 0: there is none, or it is an emitter
    /// 1 where look and capture show the same surface, and no emitter within two pixels changed by more than a tenth:
    /// its edge in the plate lies a fraction of a pixel off the model's, and a ratio would leave its outline behind.
    std::vector<uint8_t> same;
};

/// Renders both. Cost: two frames of beauty alone. Memory: 29 bytes a pixel. Advances `progress` by two a row. Throws
/// Cancelled.
PlateLight plateLight(const RelitScene& captured, const RelitScene& look, const Camera& camera,
                      const FrameOptions& options, Progress& progress);

/// What an edit multiplies the light groups by.
struct GroupFactors {
    Rgb world{1};
    std::vector<Rgb> byEmitter;
};
/// Of an edit that changes powers and colours alone (of recovered emitters, and of the environment as a whole): the
/// light afterwards is then known without rendering it. None for every other edit.
std::optional<GroupFactors> groupFactors(const RelitScene& captured, const Look& look);

/// The same by those factors. Cost: one frame with its groups; the ratio has no noise of its own.
PlateLight plateLight(const RelitScene& captured, const GroupFactors& factors, const Camera& camera,
                      const FrameOptions& options, Progress& progress);

/// One frame among its neighbours in time.
struct PlateMoment {
    const PlateLight* light = nullptr;
    const Camera* camera = nullptr;
    float weight = 1;
};

/// Radiance of `frame` under the look, with the noise of its ratio to the captured one averaged over the neighbours:
/// each surface point is found again in them by its place, and counts where the surface seen there lies within a
/// hundredth of its distance. The weighted mean is that of logarithms. The same light in every frame is assumed: what
/// moves or changes colour must not be among the neighbours. Cost: about 0.05 microseconds a pixel and neighbour.
std::vector<Rgb> steadied(const PlateMoment& frame, const std::vector<PlateMoment>& neighbours);

/// The relit plate in the plate's own scale: applyRatio on plate / gain. `after`: what steadied() gave.
Image relitPlate(const Image& plate, const Rgb& gain, const PlateLight& light, const std::vector<Rgb>& after,
                 const RatioOptions& options);

}  // namespace relamp
