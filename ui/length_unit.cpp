#include "length_unit.h"

#include "base/significant.h"

namespace relamp::ui {
namespace {

constexpr std::array<LengthUnitInfo, lengthUnitCount> units{{{"metres", "m", 1, 3, 0.1},
                                                             {"centimetres", "cm", 0.01, 1, 10},
                                                             {"millimetres", "mm", 0.001, 0, 100},
                                                             {"feet", "ft", 0.3048, 3, 0.25},
                                                             {"inches", "in", 0.0254, 2, 3}}};

}  // namespace

std::string LengthUnitInfo::format() const { return fmt::format("%.{}f", decimals); }

const LengthUnitInfo& infoOf(LengthUnit unit) { return units[size_t(unit)]; }

std::optional<LengthUnit> lengthUnitNamed(const std::string& name) {
    for (size_t i = 0; i < units.size(); ++i)
        if (name == units[i].name) return LengthUnit(i);
    return std::nullopt;
}

std::string lengthText(double metres, LengthUnit unit) {
    const LengthUnitInfo& info = infoOf(unit);
    return fmt::format("{:.{}f} {}", metres / info.inMetres, info.decimals, info.symbol);
}

std::string placeText(const DVec3& metres, LengthUnit unit) {
    const LengthUnitInfo& info = infoOf(unit);
    const DVec3 p = metres / info.inMetres;
    return fmt::format("{:.{}f}  {:.{}f}  {:.{}f} {}", p.x, info.decimals, p.y, info.decimals, p.z, info.decimals,
                       info.symbol);
}

std::string areaText(double squareMetres, LengthUnit unit) {
    const LengthUnitInfo& info =
        infoOf(unit == LengthUnit::metres && squareMetres < 0.1 ? LengthUnit::centimetres : unit);
    return fmt::format("{} {}\u00b2", significant(squareMetres / (info.inMetres * info.inMetres), 3), info.symbol);
}

}  // namespace relamp::ui
