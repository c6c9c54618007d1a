// How well an estimate explains the photographs it came from: the first thing a solve says of itself.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "base/math.h"

namespace relamp {

/// One photograph against the frame through its camera. PSNR: dB of display values (luminance's 99.5th percentile is 1,
/// clipped, sRGB) over the pixels that see the mesh and no emitter; the photograph's own noise is taken off, as far as
/// it is known. 0 where there are no such pixels.
struct ViewReproduction {
    std::string name;
    double psnr = 0;
    double observed = 0;  ///< PSNR of the plain median of each vertex's observations: what the mesh allows without a
                          ///< light model; 0 where it was not measured
    double heldOut = 0;   ///< PSNR when the albedo came from the other views alone; 0: the view was not held out
    size_t pixels = 0;    ///< rendered and compared
};

/// Why photographs are not explained, likeliest first in this order.
enum class MisfitCause { none, movingLight, poses, exposures, someViews, shape, model };
/// "moving-light" and so on: what files say.
std::string causeName(MisfitCause cause);
std::optional<MisfitCause> causeNamed(const std::string& name);

struct Reproduction {
    std::vector<ViewReproduction> views;
    double median = 0;    ///< of the views' PSNR, dB; 0: not measured
    double observed = 0;  ///< of the views' `observed`
    double heldOut = 0;   ///< mean of the views that were held out, dB: how good new views will be; 0: none was
    MisfitCause cause = MisfitCause::none;
    std::string advice{};  ///< below the gate: the likeliest cause and what to do, one or two sentences
    size_t worst() const;  ///< index of the view with the lowest PSNR; views must not be empty
    bool measured() const { return !views.empty(); }
    /// True when the photographs are too badly explained to trust the estimate.
    bool poor() const { return measured() && median < gateDb; }
    static constexpr double gateDb = 20;
};

/// Albedo of every vertex as the other views alone tell it, under the light of the whole estimate.
struct HeldOutAlbedo {
    size_t view = 0;
    std::vector<Rgb> albedo;
};

}  // namespace relamp
