#include "base/stage.h"

#include "base/name_table.h"

namespace relamp {
namespace {

constexpr NameRow<Stage> rows[] = {
    {Stage::photographs, "photographs"},
    {Stage::unobservedLight, "looking for an unobserved light"},
    {Stage::scene, "scene"},
    {Stage::observations, "observations", "look-ups"},
    {Stage::emitters, "finding lights"},
    {Stage::registration, "cameras against the mesh", "registration"},
    {Stage::exposures, "exposures"},
    {Stage::normals, "normals"},
    {Stage::planning, "planning"},
    {Stage::resuming, "going on where an earlier solve stood"},
    {Stage::ratios, "lights' light, observations, pairs"},
    {Stage::visibility, "visibility"},
    {Stage::rows, "rows of the observations"},
    {Stage::coarseLight, "coarse light"},
    {Stage::firstSurfaces, "first surfaces"},
    {Stage::light, "light"},
    {Stage::bouncedLight, "bounced light"},
    {Stage::priorStrength, "strength of the priors"},
    {Stage::finerLight, "finer light"},
    {Stage::surfaces, "surfaces"},
    {Stage::glossLight, "light with gloss"},
    {Stage::glossSurfaces, "surfaces again"},
    {Stage::turns, "light and surfaces in turn"},
    {Stage::closing, "closing figures"},
    {Stage::texture, "albedo per texel", "texture"},
    {Stage::reproduction, "reproduction of the photographs"},
    {Stage::other, "another stage"},
};

static_assert(inOrder(rows), "one row for each stage, in the order of the enumeration");

}  // namespace

const char* nameOf(Stage stage) { return rows[size_t(stage)].name; }

const char* fileNameOf(Stage stage) { return rows[size_t(stage)].fileName; }

Stage stageNamed(const std::string& fileName) { return valueNamed(rows, fileName); }

}  // namespace relamp
