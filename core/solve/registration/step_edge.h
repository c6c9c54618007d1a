// A step between two smooth sides of a profile, found to a fraction of a pixel.
#pragma once
#include <array>
#include <optional>

#include "capture/capture.h"

namespace relamp {

/// Values of a profile at positions -6 to 6 pixels, every half pixel.
constexpr size_t profileSize = 25;
constexpr float profileStep = 0.5f;
using Profile = std::array<Rgb, profileSize>;

/// Radiance of a photograph across a place: means over three pixels along the edge that is looked for, relative to the
/// profile's mean. (Logarithms would move the step of a blurred edge towards its dark side.) `outward`: unit, in
/// pixels. `floor`: radiance that counts as dark. None where a pixel is clipped, masked or outside.
std::optional<Profile> profileAcross(const View& view, const Vec2& middle, const Vec2& outward, float floor);

/// Where the step lies, pixels from the middle, within 4. Either side is a straight line, and a pixel's width blurs the
/// step. None where a line with a bend explains the profile nearly as well, or a step 1.5 pixels and more away does.
/// `noise`: standard deviation of a value, below which a step is none.
std::optional<float> findStep(const Profile& profile, float noise);

}  // namespace relamp
