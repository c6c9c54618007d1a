#include "shot/cryptomatte.h"

#include <fmt/format.h>

#include <bit>
#include <nlohmann/json.hpp>

#include "base/json_fields.h"

namespace relamp {
namespace {

/// The hash with an exponent that is neither zero nor infinite.
uint32_t floatBits(uint32_t hash) {
    const uint32_t exponent = hash >> 23 & 255;
    return exponent == 0 || exponent == 255 ? hash ^ (1u << 23) : hash;
}

}  // namespace

uint32_t cryptomatteHash(const std::string& name) {
    const auto byte = [&](size_t i) { return uint32_t(static_cast<unsigned char>(name[i])); };
    const auto scrambled = [](uint32_t k) { return std::rotl(k * 0xcc9e2d51u, 15) * 0x1b873593u; };
    uint32_t h = 0;
    const size_t blocks = name.size() / 4 * 4;
    for (size_t i = 0; i < blocks; i += 4) {
        h ^= scrambled(byte(i) | byte(i + 1) << 8 | byte(i + 2) << 16 | byte(i + 3) << 24);
        h = std::rotl(h, 13) * 5 + 0xe6546b64u;
    }
    uint32_t tail = 0;
    for (size_t i = name.size(); i-- > blocks;) tail = tail << 8 | byte(i);
    h ^= scrambled(tail) ^ uint32_t(name.size());
    h = (h ^ h >> 16) * 0x85ebca6bu;
    h = (h ^ h >> 13) * 0xc2b2ae35u;
    return h ^ h >> 16;
}

float cryptomatteId(const std::string& name) { return std::bit_cast<float>(floatBits(cryptomatteHash(name))); }

std::map<std::string, std::string> cryptomatteHeader(const std::string& layer, const std::vector<std::string>& names) {
    const std::string key = fmt::format("cryptomatte/{:08x}", cryptomatteHash(layer)).substr(0, 12 + 7);
    nlohmann::json manifest = nlohmann::json::object();
    for (const std::string& name : names) manifest[name] = fmt::format("{:08x}", floatBits(cryptomatteHash(name)));
    return {{key + "/name", layer},
            {key + "/hash", "MurmurHash3_32"},
            {key + "/conversion", "uint32_to_float32"},
            {key + "/manifest", dumpJson(manifest)}};
}

}  // namespace relamp
