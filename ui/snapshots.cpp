// Snapshots of the look in a shot's folder: looks/A.json to C.json, edits documents like any other.
#include <nlohmann/json.hpp>

#include "base/atomic_file.h"
#include "base/is_there.h"
#include "base/json_fields.h"
#include "editor_impl.h"

namespace relamp::ui {
namespace fs = std::filesystem;
namespace {

fs::path fileOf(const fs::path& shot, size_t which) {
    return shot / "looks" / (std::string(1, char('A' + which)) + ".json");
}

}  // namespace

void writeSnapshots(const Snapshots& snapshots, const fs::path& shot, const DVec3& origin) {
    for (size_t i = 0; i < snapshots.size(); ++i) {
        std::error_code failed;
        if (!snapshots[i]) {
            fs::remove(fileOf(shot, i), failed);
            continue;
        }
        fs::create_directories(shot / "looks", failed);
        writeBytesAtomically(fileOf(shot, i), dumpJson(lookToJson(snapshots[i]->look, origin), 1) + "\n");
    }
}

Snapshots readSnapshots(const fs::path& shot, const DVec3& origin) {
    Snapshots snapshots;
    for (size_t i = 0; i < snapshots.size(); ++i) {
        const fs::path file = fileOf(shot, i);
        if (!isThere(file)) continue;
        try {
            snapshots[i] = LookSnapshot{readLook(file, origin), {}};
        } catch (const Error& error) { logWarning("{}", error.what()); }
    }
    return snapshots;
}

}  // namespace relamp::ui
