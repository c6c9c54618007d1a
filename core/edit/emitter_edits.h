// What an artist does to an emitter, as functions on the look: the same for recovered and added ones. The window's
// table, inspector and gizmo all go through these.
#pragma once
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "relight/look.h"
#include "scene/scene.h"
#include "solve/estimate.h"

namespace relamp {

/// A recovered or added emitter as the look has it.
struct EmitterState {
    std::string id;
    std::string name;  ///< what the artist calls it, else its id
    bool recovered = true;
    int index = 0;  ///< place in the estimate's emitters (recovered) or in look.added
    bool enabled = true, shadows = true;
    LightLink link{};          ///< which objects it falls on
    bool sun = false;          ///< shines from far away: radiance is what a white matte surface shows that faces it
    Mat4 matrix{1};            ///< as in the look
    Rgb radiance{0};           ///< when enabled: what it sends now, without its group
    Rgb groupFactor{1};        ///< what its group multiplies that by; 0: the group is off
    Rgb recoveredRadiance{0};  ///< what the solve found; for added ones the same as radiance
    Vec3 pivot{0};             ///< world: centroid after the matrix
    Mat3 axes{
        1};  ///< columns: local x, y and facing axis, unit, world; z points where it faces (away from the surface)
    float area = 0;        ///< square metres before the matrix
    bool changed = false;  ///< differs from what was recovered, by more than its name; added ones always
    /// Neither it nor its group is off.
    bool shines() const { return enabled && maxChannel(groupFactor) > 0; }
};

/// Recovered ones in order, then added ones.
std::vector<EmitterState> emittersOf(const Scene& scene, const Estimate& estimate, const Look& look);
std::optional<EmitterState> findEmitter(const Scene& scene, const Estimate& estimate, const Look& look,
                                        const std::string& id);

/// What a light sends when it is on; nothing for an id that is unknown.
std::optional<Rgb> radianceOf(const Look& look, const Estimate& estimate, const std::string& id);
void setEnabled(Look& look, const std::string& id, bool enabled);
/// Radiance it is to send, image units.
void setRadiance(Look& look, const Estimate& estimate, const std::string& id, const Rgb& radiance);
/// Applies `change` (world to world) on top of where the emitter is; attached parts follow.
void moveEmitter(Look& look, const std::string& id, const Mat4& change);
/// Width and height or diameter of an added rectangle, disk or sphere.
void setSize(Look& look, const std::string& id, const Vec2& size);

/// Whether it casts shadows.
void setShadows(Look& look, const std::string& id, bool shadows);
/// Which objects it falls on.
void setLink(Look& look, const std::string& id, const LightLink& link);
/// Changes the shaping of an added light; others have none.
void shapeEmitter(Look& look, const std::string& id, const std::function<void(LightShaping&)>& change);

enum class EmitterValue { place, radiance, enabled, all };
/// Back to what was recovered; its name stays. For added ones: place back to the identity matrix; the others stay.
void resetEmitter(Look& look, const std::string& id, EmitterValue value);

/// What it is called in the window, as a light group and in exported scenes; tidied (tidyName). Empty, or its id: its
/// id again.
void renameEmitter(Look& look, const std::string& id, const std::string& name);
/// Everything back to what was recovered, added emitters gone; what recovered ones are called stays.
void resetLook(Look& look);

/// Gives the emitter a fresh id ("rectangle-1") and returns it.
std::string addEmitter(Look& look, const Estimate& estimate, AddedEmitter emitter);
/// A copy beside the original, `offset` metres away, with keys of its own for the values that have keys. Empty when the
/// id is unknown.
std::string duplicateEmitter(Look& look, const Estimate& estimate, const std::string& id, const Vec3& offset);
/// Added ones disappear; recovered ones are switched off, because their part is part of the capture.
void removeEmitter(Look& look, const std::string& id);

/// The connected component of mesh follows the emitter from now on. A component follows one emitter at most.
void attachPart(Look& look, const Scene& scene, uint32_t seedVertex, const std::string& id);
/// The component stays where it is from now on.
void detachPart(Look& look, const Scene& scene, uint32_t seedVertex);
/// The component goes back to where it was captured and belongs to nothing.
void resetPart(Look& look, const Scene& scene, uint32_t seedVertex);
/// Components near the emitter that would plausibly follow it (touch its bounding box grown by its radius, and are not
/// the largest component of the scene), as seed vertices.
std::vector<uint32_t> likelyParts(const Scene& scene, const Estimate& estimate, const std::string& id);

/// Turns the emitter about its pivot so that its facing axis points at `target`; parts follow.
void aimEmitter(Look& look, const Scene& scene, const Estimate& estimate, const std::string& id, const Vec3& target);
/// Moves the emitter, keeping its distance from `point`, so that an eye at `eye` sees it mirrored at `point`; it is
/// then aimed at the point.
void placeByReflection(Look& look, const Scene& scene, const Estimate& estimate, const std::string& id,
                       const Vec3& point, const Vec3& normal, const Vec3& eye);
/// Moves the emitter straight above `point` along `normal`, keeping its distance, and aims it there: its light falls on
/// that spot.
void placeByLight(Look& look, const Scene& scene, const Estimate& estimate, const std::string& id, const Vec3& point,
                  const Vec3& normal);

}  // namespace relamp
