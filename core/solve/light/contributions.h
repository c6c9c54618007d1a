// What each direction gives of the light: by it strong ones are divided first.
#pragma once
#include "transport/incident.h"

namespace relamp {

/// Per leaf the fraction it gives of the light `lit` of a row, a channel at a time, mean over the given rows (numbers
/// of rows of `rows` and of entries of `lit`). Cost: their number times the leaves.
std::vector<Rgb> lightContributions(const InfluenceMatrix& rows, const Lighting& lighting, const std::vector<Rgb>& lit,
                                    const std::vector<uint32_t>& of);

}  // namespace relamp
