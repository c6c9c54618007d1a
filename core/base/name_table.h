// Names of an enumeration's values, for people and for files: an array of rows, one for each value, in their order. The
// last value is `other`, what a file of another version may hold.
#pragma once
#include <cstddef>
#include <string>

namespace relamp {

template <class Enum>
struct NameRow {
    Enum value;
    const char* name;
    const char* fileName = name;
};

/// For a static_assert beside the rows.
template <class Enum, size_t count>
constexpr bool inOrder(const NameRow<Enum> (&rows)[count]) {
    for (size_t i = 0; i < count; ++i)
        if (size_t(rows[i].value) != i) return false;
    return count == size_t(Enum::other) + 1;
}

/// By its name in files; `other` for a name that is not known.
template <class Enum, size_t count>
Enum valueNamed(const NameRow<Enum> (&rows)[count], const std::string& fileName) {
    for (const NameRow<Enum>& row : rows)
        if (fileName == row.fileName) return row.value;
    return Enum::other;
}

}  // namespace relamp
