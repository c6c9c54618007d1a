// Cryptomatte of the emitters, as its specification 1.2 has it: every name a number, every pixel a ranked list of
// numbers with coverages, the names in the header.
#pragma once
#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "relight/frame.h"

namespace relamp {

/// MurmurHash3, 32 bits, seed 0, of the UTF-8 name.
uint32_t cryptomatteHash(const std::string& name);

/// The hash as a float that every program keeps as it is: an exponent of all zeros or ones gets one bit changed.
float cryptomatteId(const std::string& name);

/// Levels of a layer, each four channels: id, coverage, id, coverage.
inline constexpr size_t cryptomatteLevels = Frame::ranks / 2;

/// Header entries of the layer called `layer` ("CryptoEmitter") over these names: name, hash, conversion, manifest.
std::map<std::string, std::string> cryptomatteHeader(const std::string& layer, const std::vector<std::string>& names);

}  // namespace relamp
