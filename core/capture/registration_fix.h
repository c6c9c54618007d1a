// What brings cameras and mesh of a capture together: poses and a displacement of the surface.
#pragma once
#include <string>
#include <vector>

#include "capture/camera.h"

namespace relamp {

struct Capture;
struct Mesh;

/// By how much a camera stands and looks elsewhere than its file says.
struct PoseFix {
    std::string view;  ///< View::name
    DVec3 turn{0};     ///< rotation vector, radians, camera axes
    DVec3 shift{0};    ///< metres, camera axes
    bool operator==(const PoseFix&) const = default;
};

/// The camera turned and shifted. Throws Error where a number is not finite or the turn exceeds a radian.
Camera corrected(const Camera& camera, const PoseFix& fix);

/// What `first` and then, from there, `second` come to. O(1).
PoseFix composed(const PoseFix& first, const PoseFix& second);

struct RegistrationFix {
    std::vector<PoseFix> poses{};     ///< views that are not named keep theirs
    float step = 0;                   ///< metres
    std::vector<int> steps{};         ///< along the normal of each of the first vertices; the others stay
    float outlineStep = 0;            ///< metres
    std::vector<int> outlineSteps{};  ///< the same for outlines: such vertices move, and their normals stay
    float flatStep = 0;               ///< metres
    std::vector<int> flatSteps{};     ///< as `steps`, after all others: onto large flat surfaces
    bool empty() const { return poses.empty() && flatSteps.empty() && steps.empty() && outlineSteps.empty(); }
    bool operator==(const RegistrationFix&) const = default;
};

/// Turns the normals of the first vertices as the faces about them turned. `before`: vertexNormalsFromFaces before the
/// mesh was moved.
void turnNormals(const std::vector<Vec3>& before, size_t vertices, Mesh& mesh);

/// Moves vertices; their normals turn as their triangles do under `flatSteps` and `steps`. Throws Error for a vertex
/// that the mesh does not have and for numbers that are not finite. O(triangles).
void applyRegistration(const RegistrationFix& fix, Mesh& mesh);

/// Moves cameras and vertices. Throws Error for a view or vertex that the capture does not have and for numbers that
/// are not finite. O(triangles).
void applyRegistration(const RegistrationFix& fix, Capture& capture);

}  // namespace relamp
