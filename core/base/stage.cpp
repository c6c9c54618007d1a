#include "base/stage.h"

#include <array>

namespace relamp {
namespace {

struct StageRow {
    Stage stage;
    const char* name;
    const char* fileName = nullptr;  ///< where files have another one
};

constexpr std::array rows{
    StageRow{Stage::photographs, "photographs"},
    StageRow{Stage::unobservedLight, "looking for an unobserved light"},
    StageRow{Stage::scene, "scene"},
    StageRow{Stage::observations, "observations", "look-ups"},
    StageRow{Stage::emitters, "finding lights"},
    StageRow{Stage::exposures, "exposures"},
    StageRow{Stage::normals, "normals"},
    StageRow{Stage::planning, "planning"},
    StageRow{Stage::resuming, "going on where an earlier solve stood"},
    StageRow{Stage::ratios, "lights' light, observations, pairs"},
    StageRow{Stage::visibility, "visibility"},
    StageRow{Stage::rows, "rows of the observations"},
    StageRow{Stage::coarseLight, "coarse light"},
    StageRow{Stage::firstSurfaces, "first surfaces"},
    StageRow{Stage::light, "light"},
    StageRow{Stage::bouncedLight, "bounced light"},
    StageRow{Stage::priorStrength, "strength of the priors"},
    StageRow{Stage::finerLight, "finer light"},
    StageRow{Stage::surfaces, "surfaces"},
    StageRow{Stage::glossLight, "light with gloss"},
    StageRow{Stage::glossSurfaces, "surfaces again"},
    StageRow{Stage::turns, "light and surfaces in turn"},
    StageRow{Stage::closing, "closing figures"},
    StageRow{Stage::reproduction, "reproduction of the photographs"},
    StageRow{Stage::other, "another stage"},
};

constexpr bool inOrder() {
    for (size_t i = 0; i < rows.size(); ++i)
        if (size_t(rows[i].stage) != i) return false;
    return rows.size() == size_t(Stage::other) + 1;
}
static_assert(inOrder(), "one row for each stage, in the order of the enumeration");

}  // namespace

const char* nameOf(Stage stage) { return rows[size_t(stage)].name; }

const char* fileNameOf(Stage stage) {
    const StageRow& row = rows[size_t(stage)];
    return row.fileName ? row.fileName : row.name;
}

Stage stageNamed(const std::string& fileName) {
    for (const StageRow& row : rows)
        if (fileName == fileNameOf(row.stage)) return row.stage;
    return Stage::other;
}

}  // namespace relamp
