// Numbers in the file names of sequences: frame.####.exr and frame.%04d.exr.
#pragma once
#include <filesystem>
#include <optional>
#include <string>

#include "base/error.h"

namespace relamp {

/// A command-line option that cannot be meant.
class BadOption : public Error {
public:
    using Error::Error;
};

/// The first place for a number in a file name, #### or %04d: where it begins, where it ends, and its digits.
struct NumberPlace {
    size_t begin = 0, end = 0, width = 0;
};
std::optional<NumberPlace> numberPlace(const std::string& name, size_t from = 0);

/// FRAME.####.exr or FRAME.%04d.exr with a number put in; empty when the file name has no place for one. Throws
/// BadOption for a number of more than 32 digits, and for two places.
std::string numbered(const std::filesystem::path& path, int number);

/// The last whole number in a file name's stem, as sequences end in one; none without digits or beyond a billion.
std::optional<int> numberInName(const std::filesystem::path& file);

}  // namespace relamp
