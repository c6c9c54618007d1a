#include "capture/camera_fault.h"

#include <fmt/format.h>

#include <tuple>

namespace relamp {

std::string faultOf(const Camera& camera, const IntrinsicNames& names) {
    constexpr double smallest = 1e-3, largest = 1e9, mostImages = 1000;
    for (const auto& [name, focal] : {std::pair{names.focalX, camera.focalX}, std::pair{names.focalY, camera.focalY}})
        if (!(focal >= smallest && focal <= largest))
            return fmt::format("{} is {}, expected {} to {:g} pixels", name, focal, smallest, largest);
    for (const auto& [name, centre, side] : {std::tuple{names.centreX, camera.centreX, camera.width},
                                             std::tuple{names.centreY, camera.centreY, camera.height}})
        if (!(std::abs(centre - 0.5 * side) <= mostImages * side))
            return fmt::format("{} is {}, too far from an image of {} pixels", name, centre, side);
    return "";
}

}  // namespace relamp
