// Lists of indices as sets.
#pragma once
#include <algorithm>
#include <vector>

namespace relamp {

/// Ascending, each once. n log n.
template <typename T>
void sortUnique(std::vector<T>& list) {
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
}

}  // namespace relamp
