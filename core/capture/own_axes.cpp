#include "capture/own_axes.h"

namespace relamp {

Mat3 ownAxes(const Capture& capture) {
    if (capture.views.empty()) return Mat3(1);
    const View* first = &capture.views[0];
    DVec3 up(0);
    for (const View& view : capture.views) {
        if (view.name < first->name) first = &view;
        up += glm::normalize(DVec3(view.camera.worldFromCamera[1]));
    }
    // Cameras that are turned against each other have no upper side in common.
    if (glm::length(up) < 0.2 * double(capture.views.size())) up = DVec3(first->camera.worldFromCamera[1]);
    up = glm::normalize(up);
    const auto level = [&](const DVec3& direction) { return direction - glm::dot(direction, up) * up; };
    DVec3 ahead = level(first->camera.forward());
    // One that looks straight up or down: where its right side points.
    if (glm::length(ahead) < 0.1) ahead = level(glm::normalize(DVec3(first->camera.worldFromCamera[0])));
    ahead = glm::normalize(ahead);
    return Mat3(glm::dmat3(ahead, glm::cross(up, ahead), up));
}

}  // namespace relamp
