#include "solve/omission.h"

#include <array>
#include <nlohmann/json.hpp>

namespace relamp {
namespace {

struct OmissionRow {
    Omission omission;
    const char* name;
};

constexpr std::array rows{
    OmissionRow{Omission::distantLight, "distant light"},
    OmissionRow{Omission::nearFieldEmitters, "near-field emitters"},
    OmissionRow{Omission::interreflection, "interreflection"},
    OmissionRow{Omission::glossyLobes, "glossy lobes"},
    OmissionRow{Omission::finerDistantLight, "finer distant light"},
    OmissionRow{Omission::triangles, "triangles"},
    OmissionRow{Omission::unobservedLight, "unobserved light"},
    OmissionRow{Omission::fullInterreflection, "interreflection at full detail"},
    OmissionRow{Omission::unobservedVertices, "vertices that no photograph shows"},
    OmissionRow{Omission::agreeingRays, "rays between rays that agree"},
    OmissionRow{Omission::lobesOnMatte, "lobes on matte components"},
    OmissionRow{Omission::lostLobes, "lobes that lose at first glance"},
    OmissionRow{Omission::mattePointsInDetail, "what only metals tell apart, in matte points' equations"},
    OmissionRow{Omission::emptyColumns, "directions that light nothing"},
    OmissionRow{Omission::lastDigits, "iterations for the last digits"},
    OmissionRow{Omission::flatLevels, "finer light that explains nothing"},
    OmissionRow{Omission::bouncedLight, "bounced light"},
    OmissionRow{Omission::glossyPasses, "glossy passes"},
    OmissionRow{Omission::environment, "environment"},
    OmissionRow{Omission::nearLight, "near light"},
    OmissionRow{Omission::movedVisibility, "visibility of moved surfaces"},
    OmissionRow{Omission::glossOutside, "glossy light outside the image"},
    OmissionRow{Omission::other, "something else"},
};

constexpr bool inOrder() {
    for (size_t i = 0; i < rows.size(); ++i)
        if (size_t(rows[i].omission) != i) return false;
    return rows.size() == size_t(Omission::other) + 1;
}
static_assert(inOrder(), "one row for each omission, in the order of the enumeration");

}  // namespace

const char* nameOf(Omission omission) { return rows[size_t(omission)].name; }

Omission omissionNamed(const std::string& name) {
    for (const OmissionRow& row : rows)
        if (name == row.name) return row.omission;
    return Omission::other;
}

void to_json(nlohmann::json& json, Omission omission) { json = nameOf(omission); }

LeftOut::LeftOut(Omission part, std::string because) : what(part), why(std::move(because)) {}

LeftOut::LeftOut(const std::string& name, std::string because) : LeftOut(omissionNamed(name), std::move(because)) {}

}  // namespace relamp
