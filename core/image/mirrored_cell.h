// Cells past the edge of the equal-area square.
#pragma once
#include <algorithm>

namespace relamp {

/// Index of cell (x, y) of a square of `side`; x or y may be one past an edge, where the map goes on mirrored about the
/// edge's middle.
inline int mirroredCell(int x, int y, int side) {
    const int last = side - 1;
    if (x < 0 || x > last) {
        x = std::clamp(x, 0, last);
        y = last - std::clamp(y, 0, last);
    } else if (y < 0 || y > last) {
        y = std::clamp(y, 0, last);
        x = last - x;
    }
    return y * side + x;
}

}  // namespace relamp
