#include "shot/shot_hash.h"

#include <fmt/format.h>

#include "base/atomic_file.h"
#include "base/is_there.h"
#include "shot/shot_document.h"

namespace relamp {

std::string shotHash(const std::filesystem::path& folder) {
    uint64_t hash = 0xcbf29ce484222325u;
    std::vector<std::string> names{"shot.json",  "environment.exr",       "reflectance.ply",           "added.ply",
                                   "albedo.exr", "albedo_confidence.exr", "environment_background.exr"};
    for (int k = 1; isThere(folder / (environmentStem(k) + ".exr")); ++k)
        for (const char* end : {".exr", "_background.exr"}) names.push_back(environmentStem(k) + end);
    for (size_t k = 0; k < names.size(); ++k) {
        if (k > 2 && !isThere(folder / names[k])) continue;
        const std::string& name = names[k];
        for (const char c : readBytes(folder / name)) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3u;
    }
    return fmt::format("{:016x}", hash);
}

}  // namespace relamp
