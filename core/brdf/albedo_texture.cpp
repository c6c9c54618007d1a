#include "brdf/albedo_texture.h"

namespace relamp {
namespace {

/// From the copy of 2^level texels; 0 is the texture.
Rgb atLevel(const AlbedoTexture& texture, int level, const Vec2& place) {
    if (level == 0) return texture.at(place);
    const CoarserTexels& copy = texture.coarser[size_t(level - 1)];
    const TexelBlend blend = texelBlend(place / float(1 << level), copy.width, copy.height);
    Rgb sum(0);
    for (size_t k = 0; k < 4; ++k) sum += blend.weight[k] * copy.texels[blend.texel[k]];
    return sum;
}

/// Which part of the line place + f x along, f in [-1/2, 1/2], lies in the triangle; f = 0 always does.
Vec2 partInside(const std::array<Vec2, 3>& c, const Vec2& place, const Vec2& along) {
    const Vec2 p = c[1] - c[0], q = c[2] - c[0];
    const float side = p.x * q.y - p.y * q.x < 0 ? -1.0f : 1.0f;
    Vec2 part(-0.5f, 0.5f);
    for (size_t k = 0; k < 3; ++k) {
        const Vec2 edge = c[(k + 1) % 3] - c[k], from = place - c[k];
        const float here = std::max(0.0f, side * (edge.x * from.y - edge.y * from.x)),
                    change = side * (edge.x * along.y - edge.y * along.x);
        if (change > 0) part.x = std::max(part.x, -here / change);
        else if (change < 0) part.y = std::min(part.y, -here / change);
    }
    return part;
}

}  // namespace

Rgb AlbedoTexture::over(uint32_t triangle, const Vec2& place, const Vec2& side, const Vec2& otherSide) const {
    constexpr int mostPlaces = 8;
    const float a = glm::length(side), b = glm::length(otherSide), longer = std::max(a, b);
    if (!(longer > 1) || coarser.empty() || triangle >= ofTriangle.size()) return at(place);
    const std::array<Vec2, 3>& c = corners[triangle];
    const Vec2 p = c[1] - c[0], q = c[2] - c[0];
    const float edge = std::max(1.0f, std::sqrt(std::abs(p.x * q.y - p.y * q.x)));
    const float breadth = std::max({std::min(a, b), longer / mostPlaces, 1.0f});
    const float beyond = std::clamp(std::log2(breadth / edge), 0.0f, 1.0f);
    if (beyond >= 1) return ofTriangle[triangle];
    const float level = std::min(std::log2(std::min(breadth, edge)), float(coarser.size()));
    const int below = std::min(int(level), int(coarser.size()) - 1);
    const float above = level - float(below);
    const int places = std::clamp(int(std::ceil(longer / breadth)), 1, mostPlaces);
    const Vec2& along = a >= b ? side : otherSide;
    const Vec2 part = partInside(c, place, along);
    Rgb sum(0);
    for (int i = 0; i < places; ++i) {
        const Vec2 here = place + glm::mix(part.x, part.y, (float(i) + 0.5f) / float(places)) * along;
        Rgb value = atLevel(*this, below, here);
        if (above > 0) value = glm::mix(value, atLevel(*this, below + 1, here), above);
        sum += value;
    }
    return glm::mix(sum / float(places), ofTriangle[triangle], beyond);
}

}  // namespace relamp
