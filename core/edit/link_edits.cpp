#include "edit/link_edits.h"

#include <algorithm>

namespace relamp {
namespace {

/// Drops the object from those that are named; false where it was not among them.
bool dropPart(LightLink& link, const Scene& scene, uint32_t seed) {
    return std::erase_if(link.parts, [&](uint32_t other) {
               return other < scene.component.size() && scene.component[other] == scene.component[seed];
           }) > 0;
}

}  // namespace

LightLink withoutPart(const LightLink& link, const Scene& scene, uint32_t seed) {
    LightLink out = link;
    if (seed >= scene.component.size()) return out;
    const bool named = dropPart(out, scene, seed);
    if (out.only && named && !out.parts.empty()) return out;
    if (out.only != named) return link;  // it does not fall there as it is
    out.only = false;
    out.parts.push_back(seed);
    return out;
}

LightLink onlyOnPart(const LightLink& link, const Scene& scene, uint32_t seed) {
    if (seed >= scene.component.size()) return link;
    LightLink out = link.only ? link : LightLink{true, {}};
    if (dropPart(out, scene, seed)) return link;
    out.parts.push_back(seed);
    return out;
}

LightLink forgetPart(const LightLink& link, const Scene& scene, uint32_t seed) {
    LightLink out = link;
    if (seed < scene.component.size()) dropPart(out, scene, seed);
    return out.parts.empty() ? LightLink{} : out;
}

LightLink linkThatFits(const LightLink& link, size_t vertices) {
    LightLink out = link;
    std::erase_if(out.parts, [&](uint32_t seed) { return seed >= vertices; });
    return out.parts.empty() ? LightLink{} : out;
}

}  // namespace relamp
