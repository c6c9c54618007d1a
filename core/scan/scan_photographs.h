// Which photograph of a scan is which: white, black, then bits along the projector's first and second axis, most
// significant first, each a pattern and its inverse.
#pragma once
#include <array>
#include <filesystem>
#include <string>
#include <vector>

namespace relamp {

/// Bits along the projector's columns (x) and rows (y).
using ScanBits = std::array<int, 2>;

/// Most bits along an axis.
constexpr int mostScanBits = 14;

/// Photographs by their place in the order; an empty path is one that is missing.
struct ScanPhotographs {
    std::filesystem::path folder;
    std::vector<std::filesystem::path> files;  ///< 2 + 2 (bits[0] + bits[1])
};

/// Place of the pattern of a bit, counted from the most significant; its inverse follows it.
inline size_t patternPlace(const ScanBits& bits, int axis, int bit) {
    return 2 + 2 * size_t(bit) + (axis == 1 ? 2 * size_t(bits[0]) : 0);
}

/// The photographs of every folder. Names that end in a number have their place by it, counted from the smallest number
/// of all folders, so photographs may be missing; other names are in alphabetical order. With `bits` of 0 the number of
/// photographs says how many bits there are, as many along both axes; they are filled in. Throws Error naming the
/// folder: not there, no photographs, white or black missing, a number of photographs that fits no number of bits, more
/// than the bits have.
std::vector<ScanPhotographs> findScanPhotographs(const std::vector<std::filesystem::path>& folders, ScanBits& bits);

/// "1st axis, bit 9 of 10: pattern", for people.
std::string nameOfPlace(const ScanBits& bits, size_t place);

}  // namespace relamp
