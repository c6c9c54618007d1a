// Which objects lights fall on, as an artist changes it. Objects are connected components of the capture's mesh, told
// by any of their vertices.
#pragma once
#include "relight/look.h"
#include "scene/scene.h"

namespace relamp {

/// The link with the object left out: it joins what the light does not fall on, or leaves what it falls on alone.
/// Where that leaves nothing, the light falls on all but the object. A vertex that does not exist changes nothing.
LightLink withoutPart(const LightLink& link, const Scene& scene, uint32_t seed);
/// The light falls on this object, and on others that it falls on alone already.
LightLink onlyOnPart(const LightLink& link, const Scene& scene, uint32_t seed);
/// The object is no longer named; a light that falls on none alone falls on everything.
LightLink forgetPart(const LightLink& link, const Scene& scene, uint32_t seed);

/// Without vertices that a mesh of so many does not have.
LightLink linkThatFits(const LightLink& link, size_t vertices);

}  // namespace relamp
