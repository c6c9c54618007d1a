// The keys of shot.json that version 2 renamed.
#include <nlohmann/json.hpp>

#include "shot/shot_document.h"

namespace relamp {
namespace {

struct RenamedKey {
    const char* holder;  ///< an object of the document, or a list of such
    const char* before;  ///< in version 1
    const char* now;
};
constexpr RenamedKey renamedKeys[] = {
    {"emitters", "power", "radiance"},
    {"emitters", "power_stddev", "radiance_stddev"},
    {"emitters", "clipped_share", "clipped_fraction"},
    {"emitters", "unseen", "unobserved"},
    {"environment", "kept_coefficients", "leaves"},
    {"interreflection", "share", "fraction"},
    {"palette", "share", "fraction"},
};

/// Calls change(object, key of version 1, key of version 2) for each object that may hold a renamed key.
template <class Change>
void eachRenamed(Json& document, Change&& change) {
    for (const auto& [holder, before, now] : renamedKeys) {
        const auto at = document.find(holder);
        if (at == document.end()) continue;
        if (at->is_object()) change(*at, before, now);
        if (!at->is_array()) continue;
        for (Json& element : *at)
            if (element.is_object()) change(element, before, now);
    }
}

}  // namespace

void upgradeShotDocument(Json& document) {
    const auto version = document.find("version");
    if (version == document.end() || *version != 1) return;
    eachRenamed(document, [](Json& object, const char* before, const char* now) {
        const auto at = object.find(before);
        if (at == object.end()) return;
        if (!object.contains(now)) object[now] = *at;
        object.erase(before);
    });
    *version = 2;
}

void addKeysOfVersion1(Json& document) {
    eachRenamed(document, [](Json& object, const char* before, const char* now) {
        if (object.contains(now) && !object.contains(before)) object[before] = object[now];
    });
}

}  // namespace relamp
