// Photometric files and images of shaped lights, read once: a light that is dragged asks for them at every step.
#pragma once
#include <array>
#include <filesystem>
#include <memory>

#include "image/image.h"
#include "relight/ies_profile.h"
#include "relight/light_shaping.h"

namespace relamp {

/// The sides of an image of a light are made at most this long: finer detail is lost in its light.
inline constexpr int longestShapingSide = 1024;

/// The files that a light's shape is made of; empty where it has none.
using ShapingFile = std::filesystem::path LightShaping::*;
inline constexpr std::array<ShapingFile, 3> shapingFiles{&LightShaping::iesFile, &LightShaping::goboFile,
                                                         &LightShaping::surfaceFile};

struct ShapingImage {
    Image image;
    Rgb mean{0};
};

/// What the file holds; read again when its size or time has changed. The 16 last ones are kept. Safe on all threads.
/// Throws Error naming a file that cannot be read; a file that is larger than 64 megapixels.
std::shared_ptr<const IesProfile> iesOf(const std::filesystem::path& file);
std::shared_ptr<const ShapingImage> shapingImageOf(const std::filesystem::path& file);

}  // namespace relamp
