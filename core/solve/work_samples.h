// Small components of the solver's heavy work on made-up numbers, for whoever wants to know how long the real ones will
// take.
#pragma once
#include <cstddef>

#include "base/progress.h"

namespace relamp {

/// The products of `rows` x `columns` influences between all channels, each row weighted with a dozen others.
void sampleGram(size_t rows, size_t columns, Progress& progress);
/// A bounded program of `columns` unknowns in which a fifth ends at its bound.
void sampleProgram(size_t columns, Progress& progress);
/// One reweighted albedo solve on a sheet of side x side vertices.
void sampleAlbedo(int side, Progress& progress);

}  // namespace relamp
