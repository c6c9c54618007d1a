#include "relight/environment_sides.h"

#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/json_fields.h"
#include "relight/backdrop.h"

namespace relamp {

Rgb sideFactor(const EnvironmentSides& sides, const Vec3& direction) {
    Rgb factor(0);
    for (size_t k = 0; k < sides.size(); ++k) factor += sidePart(k, direction) * sides[k];
    return factor;
}

std::shared_ptr<const DistantLight> sided(std::shared_ptr<const DistantLight> light, const EnvironmentSides& sides) {
    if (sides == evenSides || light->black()) return light;
    std::vector<Rgb> cells = light->cells();
    for (size_t c = 0; c < cells.size(); ++c) cells[c] *= sideFactor(sides, light->grid().direction(int(c)));
    return std::make_shared<const DistantLight>(light->grid(), std::move(cells), sided(light->backdrop(), sides));
}

EnvironmentSides sidesFromJson(const Json& value, const std::string& where) {
    EnvironmentSides sides = evenSides;
    if (!value.is_array() || value.size() != sides.size())
        throw Error("{}: expected six lists of three numbers", where);
    for (size_t k = 0; k < sides.size(); ++k) {
        if (!value[k].is_array() || value[k].size() != 3) throw Error("{}[{}]: expected three numbers", where, k);
        for (int c = 0; c < 3; ++c) {
            const std::string field = fmt::format("{}[{}][{}]", where, k, c);
            const double factor = numberOf(value[k][size_t(c)], field);
            if (!(factor >= 0 && factor <= 1e30)) throw Error("{}: is {}, expected 0 or more", field, factor);
            sides[k][c] = float(factor);
        }
    }
    return sides;
}

Json sidesToJson(const EnvironmentSides& sides) {
    Json list = Json::array();
    for (const Rgb& side : sides) list.push_back({side.x, side.y, side.z});
    return list;
}

}  // namespace relamp
