// The frames of a plate on disk, and how their values become linear radiance.
#pragma once
#include <filesystem>
#include <functional>
#include <map>
#include <string>

#include "image/image.h"

namespace relamp {

/// The transfer curve of a plate's values.
enum class PlateCurve {
    automatic,  ///< as its files say: linear for floating point, sRGB for integers, what a DPX header names
    linear,
    srgb,    ///< IEC 61966-2-1
    rec709,  ///< ITU-R BT.709's camera curve
    gamma22,
    gamma24
};

/// Throws BadOption when `name` is none of auto, linear, srgb, rec709, gamma22, gamma24.
PlateCurve plateCurve(const std::string& name);

/// Linear value of an encoded one; values above 1 go on along the curve, negative ones stay.
float decoded(PlateCurve curve, float value);

/// Files by frame number.
using PlateFiles = std::map<int, std::filesystem::path>;

/// The files that `pattern` (plate.####.exr, plate.%04d.exr) stands for, or the one file it names, whose number is the
/// last one in its name, else 1. `what` names the option in errors. Throws BadOption for a pattern with two places,
/// Error when nothing is there. Cost: one listing of the folder.
PlateFiles plateFiles(const std::filesystem::path& pattern, const char* what);

/// The pattern of the sequence that `frame` is of: plate.1001.exr gives plate.####.exr; a name without a number stays.
std::filesystem::path platePattern(const std::filesystem::path& frame);

/// One frame as linear radiance; `saturation`: from where on it is clipped, 0: nowhere known. Throws Error naming the
/// file, and whatever `between` throws.
Image readPlate(const std::filesystem::path& file, PlateCurve curve, float& saturation,
                const std::function<void()>& between = {});

/// How much of each pixel is held out, in [0, 1], row by row: the file's first colour. Throws Error as readPlate, and
/// when the size is another than `width` x `height`.
std::vector<float> readMatte(const std::filesystem::path& file, int width, int height,
                             const std::function<void()>& between = {});

}  // namespace relamp
