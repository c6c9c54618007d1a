#include "shot/shot_hash.h"

#include <fmt/format.h>

#include "base/atomic_file.h"
#include "base/is_there.h"

namespace relamp {

std::string shotHash(const std::filesystem::path& folder) {
    uint64_t hash = 0xcbf29ce484222325u;
    for (const char* name : {"shot.json", "environment.exr", "reflectance.ply", "added.ply", "albedo.exr"}) {
        const bool optional = std::string_view(name) == "added.ply" || std::string_view(name) == "albedo.exr";
        if (optional && !isThere(folder / name)) continue;
        for (const char c : readBytes(folder / name)) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3u;
    }
    return fmt::format("{:016x}", hash);
}

}  // namespace relamp
