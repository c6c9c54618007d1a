// Units that the window shows lengths in. Files, exports and the core are in metres whatever is chosen.
#pragma once
#include <array>
#include <optional>
#include <string>

#include "base/math.h"

namespace relamp::ui {

enum class LengthUnit { metres, centimetres, millimetres, feet, inches };

struct LengthUnitInfo {
    const char* name;            ///< "centimetres"; the settings keep it
    const char* symbol;          ///< "cm"
    double inMetres;             ///< one of it
    int decimals;                ///< that are shown
    double snap;                 ///< step of a snapped move in a room, in the unit
    std::string format() const;  ///< for numbers of a field: "%.1f"
};

inline constexpr size_t lengthUnitCount = 5;
const LengthUnitInfo& infoOf(LengthUnit unit);
/// None has this name: nothing.
std::optional<LengthUnit> lengthUnitNamed(const std::string& name);

/// "0.250 m"
std::string lengthText(double metres, LengthUnit unit);
/// "1.200  0.300  0.100 m"
std::string placeText(const DVec3& metres, LengthUnit unit);
/// "0.25 m\u00b2"; small ones of metres in square centimetres.
std::string areaText(double squareMetres, LengthUnit unit);

}  // namespace relamp::ui
