#include "solve/omission.h"

#include <nlohmann/json.hpp>

#include "base/name_table.h"

namespace relamp {
namespace {

constexpr NameRow<Omission> omissionRows[] = {
    {Omission::distantLight, "distant light"},
    {Omission::nearFieldEmitters, "near-field emitters"},
    {Omission::interreflection, "interreflection"},
    {Omission::glossyLobes, "glossy lobes"},
    {Omission::finerDistantLight, "finer distant light"},
    {Omission::triangles, "triangles"},
    {Omission::unobservedLight, "unobserved light"},
    {Omission::texture, "albedo per texel"},
    {Omission::ownTexcoords, "the mesh's own texture coordinates"},
    {Omission::fullInterreflection, "interreflection at full detail"},
    {Omission::unobservedVertices, "vertices that no photograph shows"},
    {Omission::agreeingRays, "rays between rays that agree"},
    {Omission::lobesOnMatte, "lobes on matte components"},
    {Omission::lostLobes, "lobes that lose at first glance"},
    {Omission::mattePointsInDetail, "what only metals tell apart, in matte points' equations"},
    {Omission::emptyColumns, "directions that light nothing"},
    {Omission::lastDigits, "iterations for the last digits"},
    {Omission::flatLevels, "finer light that explains nothing"},
    {Omission::bouncedLight, "bounced light"},
    {Omission::glossyPasses, "glossy passes"},
    {Omission::environment, "environment"},
    {Omission::nearLight, "near light"},
    {Omission::movedVisibility, "visibility of moved surfaces"},
    {Omission::glossOutside, "glossy light outside the image"},
    {Omission::other, "something else"},
};

static_assert(inOrder(omissionRows), "one row for each omission, in the order of the enumeration");

}  // namespace

const char* nameOf(Omission omission) { return omissionRows[size_t(omission)].name; }

Omission omissionNamed(const std::string& name) { return valueNamed(omissionRows, name); }

void to_json(nlohmann::json& json, Omission omission) { json = nameOf(omission); }

LeftOut::LeftOut(Omission part, std::string because) : what(part), why(std::move(because)) {}

LeftOut::LeftOut(const std::string& name, std::string because) : LeftOut(omissionNamed(name), std::move(because)) {}

}  // namespace relamp
