#include "capture/registration_fix.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/quaternion.hpp>

#include "base/error.h"
#include "capture/capture.h"

namespace relamp {
namespace {

void moveAlong(const std::vector<Vec3>& directions, float step, const std::vector<int>& steps, Mesh& mesh) {
    if (steps.size() > mesh.vertexCount())
        throw Error("registration: {} displacements for a mesh of {} vertices", steps.size(), mesh.vertexCount());
    for (size_t v = 0; v < steps.size(); ++v) {
        mesh.positions[v] += directions[v] * (step * float(steps[v]));
        if (!isFinite(mesh.positions[v])) throw Error("registration: vertex {} is moved beyond all bounds", v);
    }
}

/// And turns the normals as the triangles turn.
void moveAndTurn(float step, const std::vector<int>& steps, Mesh& mesh) {
    if (steps.empty()) return;
    const std::vector<Vec3> before = vertexNormalsFromFaces(mesh);
    moveAlong(mesh.normals, step, steps, mesh);
    turnNormals(before, steps.size(), mesh);
}

glm::dquat turnOf(const PoseFix& fix) {
    const double angle = glm::length(fix.turn);
    return angle > 0 ? glm::angleAxis(angle, fix.turn / angle) : glm::dquat(1, 0, 0, 0);
}

DVec3 rotationVector(const glm::dquat& turn) { return glm::angle(turn) * glm::axis(turn); }

}  // namespace

void turnNormals(const std::vector<Vec3>& before, size_t vertices, Mesh& mesh) {
    const std::vector<Vec3> after = vertexNormalsFromFaces(mesh);
    for (size_t v = 0; v < vertices; ++v) {
        const Vec3 turned = mesh.normals[v] + (after[v] - before[v]);
        const float length = glm::length(turned);
        if (length > 0.1f) mesh.normals[v] = turned / length;
    }
}

PoseFix composed(const PoseFix& first, const PoseFix& second) {
    return {first.view, rotationVector(turnOf(first) * turnOf(second)), first.shift + turnOf(first) * second.shift};
}

Camera corrected(const Camera& camera, const PoseFix& fix) {
    const double angle = glm::length(fix.turn);
    if (!(angle <= 1) || !std::isfinite(glm::length(fix.shift)))
        throw Error("pose of {}: turned by {:g} radians, shifted by {:g} m", fix.view, angle, glm::length(fix.shift));
    Camera out = camera;
    DMat4 step(glm::mat3_cast(turnOf(fix)));
    step[3] = glm::dvec4(fix.shift, 1);
    out.worldFromCamera = camera.worldFromCamera * step;
    return out;
}

void applyRegistration(const RegistrationFix& fix, Mesh& mesh) {
    const std::vector<Vec3> along = mesh.normals;
    moveAndTurn(fix.step, fix.steps, mesh);
    moveAlong(along, fix.outlineStep, fix.outlineSteps, mesh);
    moveAndTurn(fix.flatStep, fix.flatSteps, mesh);
}

void applyRegistration(const RegistrationFix& fix, Capture& capture) {
    // Each view once: two may show the same file.
    std::vector<uint8_t> taken(capture.views.size(), 0);
    for (const PoseFix& pose : fix.poses) {
        size_t i = 0;
        while (i < taken.size() && (taken[i] || capture.views[i].name != pose.view)) ++i;
        if (i == taken.size()) throw Error("registration: the capture has no photograph {}", pose.view);
        taken[i] = 1;
        capture.views[i].camera = corrected(capture.views[i].camera, pose);
    }
    applyRegistration(fix, capture.mesh);
}

}  // namespace relamp
