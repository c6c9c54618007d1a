#include "relight/backdrop.h"

namespace relamp {
namespace {

template <class Change>
std::shared_ptr<const Backdrop> changed(const std::shared_ptr<const Backdrop>& backdrop, const Change& change) {
    if (!backdrop) return nullptr;
    Backdrop next = *backdrop;
    change(next);
    return std::make_shared<const Backdrop>(std::move(next));
}

}  // namespace

Rgb Backdrop::radiance(const Vec3& direction) const {
    const float angle = yawDegrees * pi / 180, cosine = std::cos(angle), sine = std::sin(angle);
    const Vec3 unturned(cosine * direction.x + sine * direction.y, cosine * direction.y - sine * direction.x,
                        direction.z);
    Rgb sum(0);
    for (const Layer& layer : layers) sum += layer.weight * layer.panorama->radiance(unturned);
    return gain * (sides == evenSides ? sum : sum * sideFactor(sides, direction));
}

std::shared_ptr<const Backdrop> brighter(const std::shared_ptr<const Backdrop>& backdrop, const Rgb& gain) {
    return changed(backdrop, [&](Backdrop& next) { next.gain *= gain; });
}

std::shared_ptr<const Backdrop> turned(const std::shared_ptr<const Backdrop>& backdrop, float degrees) {
    return changed(backdrop, [&](Backdrop& next) { next.yawDegrees += degrees; });
}

std::shared_ptr<const Backdrop> sided(const std::shared_ptr<const Backdrop>& backdrop, const EnvironmentSides& sides) {
    return changed(backdrop, [&](Backdrop& next) {
        for (size_t k = 0; k < sides.size(); ++k) next.sides[k] *= sides[k];
    });
}

}  // namespace relamp
