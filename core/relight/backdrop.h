// What is seen behind the scene, where that is known finer than the cells of the distant environment.
#pragma once
#include <memory>
#include <vector>

#include "image/panorama.h"
#include "relight/environment_sides.h"

namespace relamp {

/// Panoramas of an environment, turned and coloured as its light is.
struct Backdrop {
    struct Layer {
        std::shared_ptr<const Panorama> panorama;
        float weight = 1;
    };
    std::vector<Layer> layers;  ///< summed
    float yawDegrees = 0;       ///< of the panoramas about +Z, counter-clockwise from above
    Rgb gain{1};
    EnvironmentSides sides = evenSides;  ///< of the world, as in EnvironmentLook

    /// Of a unit direction.
    Rgb radiance(const Vec3& direction) const;
};

/// The same with a factor on its light; null stays null.
std::shared_ptr<const Backdrop> brighter(const std::shared_ptr<const Backdrop>& backdrop, const Rgb& gain);
/// Turned about +Z by more degrees; null stays null.
std::shared_ptr<const Backdrop> turned(const std::shared_ptr<const Backdrop>& backdrop, float degrees);
/// With factors on its sides; null stays null.
std::shared_ptr<const Backdrop> sided(const std::shared_ptr<const Backdrop>& backdrop, const EnvironmentSides& sides);

}  // namespace relamp
