#include "relit_plate.h"

#include "plate_player.h"
#include "relight/look_track.h"
#include "shot/relit_looks.h"

namespace relamp::ui {
namespace {

/// The first pass shows something soon, the second what is exported (PlateRequest::neighbours).
const int passNeighbours[] = {0, PlateRequest{}.neighbours};

}  // namespace

PlateImage relitPlateImage(const RelitPlateRequest& request, int neighbours, std::shared_ptr<const PlateGains>& gains,
                           Progress& progress) {
    const Plate& plate = request.plate->plate;
    const PlateFrame* frame = request.plate->at(request.frame);
    if (!frame) throw Error("the plate has no frames");
    PlateRequest ofPlate = request.plate->request;
    ofPlate.ratio = request.ratio == Ratio::none ? Ratio::quotient : request.ratio;
    ofPlate.neighbours = neighbours;
    ofPlate.unsure = request.unsure;
    FrameOptions options;
    options.samplesPerPixel = request.samples;
    options.denoise = request.denoise;
    const LookTrack track(request.look);
    RelitLooks looks(*request.estimate, *request.scene, track);
    if (!gains)
        gains = std::make_shared<const PlateGains>(PlateRelighter(plate, ofPlate, looks, options, progress).gains());
    PlateRelighter relighter(plate, ofPlate, looks, options, *gains);
    RelitPlate relit = relighter.relit(size_t(frame - plate.frames.data()), progress);
    gains = std::make_shared<const PlateGains>(relighter.gains());  // with those that were matched for this frame
    return shownPlate(std::move(relit.image), *frame, relit.gain);
}

void RelitPlates::take() {
    if (!job_ || !job_->done()) return;
    const std::unique_ptr<Job<Made>> finished = std::move(job_);
    const std::optional<RelitPlateRequest> of = std::exchange(making_, {});
    try {
        Made made = finished->take();
        image_ = std::make_shared<const PlateImage>(std::move(made.image));
        gains_ = std::move(made.gains);
        passes_ = pass_;
    } catch (const Cancelled&) { return; } catch (const std::exception& error) {
        trouble_ = error.what();
        passes_ = int(std::size(passNeighbours));  // it would fail again
        image_.reset();
        gains_.reset();
    }
    made_ = of;
}

std::string RelitPlates::want(const std::optional<RelitPlateRequest>& request, bool steadied) {
    take();
    if (job_ && making_ != request) job_->progress().requestStop();
    const bool same = request && made_ == request;
    if (request && !job_ && (!same || passes_ < (steadied ? int(std::size(passNeighbours)) : 1))) {
        pass_ = same ? passes_ + 1 : 1;
        making_ = request;
        const bool known = made_ && made_->plate == request->plate && made_->estimate == request->estimate;
        job_ = std::make_unique<Job<Made>>(
            [of = *request, neighbours = passNeighbours[pass_ - 1],
             gains = known ? gains_ : nullptr](Progress& progress) mutable {
                PlateImage image = relitPlateImage(of, neighbours, gains, progress);
                return Made{std::move(image), std::move(gains)};
            },
            wake_);
    }
    return std::exchange(trouble_, {});
}

std::shared_ptr<const PlateImage> RelitPlates::image(const std::shared_ptr<const OpenPlate>& plate, int frame) const {
    return made_ && made_->plate == plate && image_ && image_->frame == frame ? image_ : nullptr;
}

}  // namespace relamp::ui
