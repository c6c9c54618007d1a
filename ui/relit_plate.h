// The present frame of a plate relit as the export relights it, on a thread of its own.
#pragma once
#include <functional>
#include <memory>
#include <optional>

#include "base/job.h"
#include "editor_state.h"

namespace relamp::ui {

struct RelitPlateRequest {
    std::shared_ptr<const OpenPlate> plate;
    std::shared_ptr<const Scene> scene;
    std::shared_ptr<const Estimate> estimate;
    Look look;  ///< with its keys
    int frame = 0;
    int samples = defaultPlateSamples;
    bool denoise = true;
    Ratio ratio = Ratio::quotient;
    PlateUnsure unsure = PlateUnsure::model;
    bool operator==(const RelitPlateRequest&) const = default;
};

/// One frame as it is exported, but straightened and scaled as a PlateImage. `neighbours`: frames before and after that
/// steady its light. `gains`: of this plate and estimate; made where null. Cost: that of an exported frame, and where
/// they are made of matching the plate's colours. Throws Error, Cancelled.
PlateImage relitPlateImage(const RelitPlateRequest& request, int neighbours, std::shared_ptr<const PlateGains>& gains,
                           Progress& progress);

/// Used on one thread. A frame comes first from its own light alone, then steadied by its neighbours.
class RelitPlates {
public:
    /// `wake` is called on the working thread when there is something new.
    explicit RelitPlates(std::function<void()> wake) : wake_(std::move(wake)) {}

    /// What is wanted from now on; work on anything else is stopped, and never waited for. Nothing: none, what is there
    /// stays. `steadied`: also the second pass. Returns the trouble with the last request, once; else empty.
    std::string want(const std::optional<RelitPlateRequest>& request, bool steadied);
    /// The last one made, where it is of this frame of this plate; else null.
    std::shared_ptr<const PlateImage> image(const std::shared_ptr<const OpenPlate>& plate, int frame) const;
    /// The one made for just this; else null.
    std::shared_ptr<const PlateImage> image(const RelitPlateRequest& request) const {
        return made_ == request ? image_ : nullptr;
    }
    bool working() const { return job_ != nullptr; }

private:
    std::function<void()> wake_;
    std::optional<RelitPlateRequest> made_, making_;
    std::shared_ptr<const PlateImage> image_;
    int passes_ = 0, pass_ = 0;  ///< of `made_`, done; of `making_`, in work
    std::string trouble_;
    struct Made {
        PlateImage image;
        std::shared_ptr<const PlateGains> gains;
    };
    std::shared_ptr<const PlateGains> gains_;  ///< of `made_`
    std::unique_ptr<Job<Made>> job_;

    void take();
};

}  // namespace relamp::ui
