#include "shot/shot_places.h"

#include <nlohmann/json.hpp>

#include "base/atomic_file.h"
#include "base/is_there.h"
#include "base/json_fields.h"
#include "relight/plate_look.h"
#include "shot/frame_numbers.h"

namespace relamp {
namespace fs = std::filesystem;
namespace {

bool isFolder(const fs::path& path) {
    std::error_code failed;
    return fs::is_directory(path, failed);
}

fs::path from(const fs::path& folder, const fs::path& named) {
    return (fs::absolute(folder) / named).lexically_normal();
}

/// A text of an object that may be anything else; empty: none.
std::string textIn(const Json& object, const char* key) {
    if (!object.is_object()) return {};
    const auto at = object.find(key);
    return at != object.end() && at->is_string() ? at->get<std::string>() : std::string();
}

/// The environment of a document's look, if it is an image; null otherwise.
Json* environmentOf(Json& document) {
    if (!document.contains("look") || !document["look"].is_object()) return nullptr;
    Json& look = document["look"];
    if (!look.contains("environment") || !look["environment"].is_object()) return nullptr;
    Json& environment = look["environment"];
    return textIn(environment, "file").empty() ? nullptr : &environment;
}

template <class Each>
void eachMeasured(Json& document, Each&& each) {
    if (!document.contains("basis") || !document["basis"].is_array()) return;
    for (Json& lobe : document["basis"])
        if (const std::string file = textIn(lobe, "file"); !file.empty()) each(lobe, fs::path(file));
}

/// Files of a sequence count as there when their folder is; of FILE#NAME the file.
bool plateIsThere(const fs::path& path) {
    if (numberPlace(path.filename().string()) && isFolder(path.parent_path())) return true;
    const std::string text = path.string();
    const size_t mark = text.rfind('#');
    return isThere(path) || (mark != std::string::npos && isThere(text.substr(0, mark)));
}

/// Files of a plate that are not at their relative paths are taken from their absolute ones, where those are there.
void placePlate(Json& document, const fs::path& folder) {
    if (!document.contains("look") || !document["look"].is_object() || !document["look"].contains("plate")) return;
    Json& plate = document["look"]["plate"];
    for (const char* key : plateFileKeys) {
        const std::string named = textIn(plate, key), whole = textIn(plate, (std::string(key) + "_absolute").c_str());
        if (!named.empty() && !whole.empty() && !plateIsThere(from(folder, named)) && plateIsThere(whole))
            plate[key] = whole;
    }
}

}  // namespace

void placeShot(Json& document, const fs::path& folder, const ShotPlaces& places) {
    if (!document.is_object()) return;
    if (!places.capture.empty()) {
        document["capture"] = fs::absolute(places.capture).string();
    } else if (const std::string named = textIn(document, "capture"), whole = textIn(document, "capture_absolute");
               !named.empty() && !whole.empty() && !isFolder(from(folder, named)) && isFolder(whole)) {
        document["capture"] = whole;
    }
    placePlate(document, folder);
    if (places.withoutEnvironment)
        if (Json* environment = environmentOf(document)) {
            environment->erase("file");
            (*environment)["source"] = "recovered";
        }
    if (!places.environment.empty())
        if (Json* environment = environmentOf(document))
            (*environment)["file"] = fs::absolute(places.environment).string();
    if (!places.measured.empty())
        eachMeasured(document, [&](Json& lobe, const fs::path& file) {
            lobe["file"] = (fs::absolute(places.measured) / file.filename()).string();
        });
}

MissingPlaces missingPlaces(const fs::path& folder, const ShotPlaces& places) {
    const fs::path file = folder / "shot.json";
    Json document = parseJson(readBytes(file, 256 << 20), file.string());
    MissingPlaces missing;
    if (!document.is_object()) return missing;
    placeShot(document, folder, places);
    if (const std::string named = textIn(document, "capture");
        !named.empty() && !places.withoutCapture && !isFolder(from(folder, named)))
        missing.capture = from(folder, named);
    if (Json* environment = environmentOf(document))
        if (const fs::path image = from(folder, textIn(*environment, "file")); !isThere(image))
            missing.environment = image;
    eachMeasured(document, [&](Json&, const fs::path& named) {
        if (!isThere(folder / "merl" / named.filename()) && !isThere(from(folder, named)) && missing.measured.empty())
            missing.measured = from(folder, named);
    });
    return missing;
}

}  // namespace relamp
