// What the model says of a plate's frame, before and after the edit, and the relit plate that follows from it.
#pragma once
#include <map>
#include <memory>
#include <optional>
#include <set>

#include "plate/plate_sequence.h"
#include "relight/frame.h"
#include "shot/ratio_frame.h"

namespace relamp {

/// A frame as captured, row by row.
struct PlateGround {
    int width = 0, height = 0;
    float floor = 0;                  ///< a thousandth of the frame's white (ratioFloor), in the capture's unit
    std::vector<Rgb> before;          ///< radiance, in that unit
    std::vector<float> distance;      ///< from the eye to what is seen, metres; 0: nothing
    std::vector<uint8_t> emits;       ///< 1 where that is an emitter
    std::vector<float> confidence{};  ///< modelConfidence; empty: not asked for
    /// Light groups that an edit multiplies: -1 of the environment, else of an emitter.
    std::map<int, std::vector<Rgb>> groups;
};

/// Renders the frame with these of its light groups. Cost: a frame of beauty alone, or with `groups` one with all of
/// them. Memory: 17 bytes a pixel, 12 for each group and 4 with `confidence`. Advances `progress` by one a row. Throws
/// Cancelled.
PlateGround plateGround(const RelitScene& captured, const Camera& camera, const std::set<int>& groups, bool confidence,
                        const FrameOptions& options, Progress& progress);

/// What an edit does to one frame, row by row. Memory: 13 bytes a pixel beside the ground.
struct PlateLight {
    std::shared_ptr<const PlateGround> ground;
    std::vector<Rgb> logRatio;  ///< of (after + floor) / (before + floor); 0 where nothing changed
    /// 1 where look and capture show the same surface, and no emitter within two pixels changed by more than a tenth:
    /// its edge in the plate lies a fraction of a pixel off the model's, and a ratio would leave its outline behind.
    std::vector<uint8_t> same;
};

/// Renders the frame under the look. Cost: a frame of beauty alone. Advances `progress` by one a row. Throws Cancelled.
PlateLight plateLight(std::shared_ptr<const PlateGround> ground, const RelitScene& look, const Camera& camera,
                      const FrameOptions& options, Progress& progress);

/// What an edit multiplies the light groups by.
struct GroupFactors {
    Rgb world{1};
    std::vector<Rgb> byEmitter;
    /// Those that are not multiplied by 1, as PlateGround names them.
    std::set<int> changed() const;
};
/// Of an edit that changes powers and colours alone (of recovered emitters, and of the environment as a whole): the
/// light afterwards is then known without rendering it. None for every other edit.
std::optional<GroupFactors> groupFactors(const RelitScene& captured, const Look& look);

/// The same by those factors; the ground holds the groups that change. Nothing is rendered, and the ratio has no noise
/// of its own.
PlateLight plateLight(std::shared_ptr<const PlateGround> ground, const GroupFactors& factors);

/// One frame among its neighbours in time.
struct PlateMoment {
    const PlateLight* light = nullptr;
    const Camera* camera = nullptr;
    float weight = 1;
};

/// Radiance of `frame` under the look, with the noise of its ratio to the captured one averaged over the neighbours:
/// each surface point is found again in them by its place, and counts where the surface seen there lies within a
/// hundredth of its distance. The weighted mean is that of logarithms. All of them are lit by the frame's own look.
/// Cost: about 0.05 microseconds a pixel and neighbour.
std::vector<Rgb> steadied(const PlateMoment& frame, const std::vector<PlateMoment>& neighbours);

/// What a pixel's factor is where the model rests on little: low confidence of the surface.
enum class PlateUnsure {
    model,   ///< what the model says, as elsewhere
    smooth,  ///< that of confident surfaces around it
    keep     ///< 1: the plate stays
};

/// Throws BadOption when `name` is none of model, smooth, keep.
PlateUnsure plateUnsure(const std::string& name);

/// `after` with the logarithm r of its factor replaced by w r + (1 - w) s, w = min(1, confidence / 0.25): s is 0 for
/// `keep`, else the mean of r over surfaces around, weighted by w (pulled down and pushed up a pyramid of halves).
/// Emitters stay, pixels where look and capture show different surfaces, and those where no surface is: the model lets
/// no emitter reach them. Cost: about 0.05 microseconds a pixel.
std::vector<Rgb> whereUnsure(PlateUnsure unsure, const PlateLight& light, std::vector<Rgb> after);

/// The relit plate in the plate's own scale: applyRatio on plate / gain. `after`: what steadied() gave.
Image relitPlate(const Image& plate, const Rgb& gain, const PlateLight& light, const std::vector<Rgb>& after,
                 const RatioOptions& options);

}  // namespace relamp
