#include "image/dpx_header.h"

#include <array>
#include <cstdint>
#include <fstream>
#include <string_view>

#include "base/error.h"

namespace relamp {

void checkDpxHeader(const std::filesystem::path& file) {
    std::array<unsigned char, 36> begin{};
    std::ifstream(file, std::ios::binary).read(reinterpret_cast<char*>(begin.data()), begin.size());
    const std::string_view magic(reinterpret_cast<const char*>(begin.data()), 4);
    const bool bigEndian = magic == "SDPX";
    if (!bigEndian && magic != "XPDS") return;
    uint32_t userData = 0;
    for (size_t i = 0; i < 4; ++i) userData = userData << 8 | begin[bigEndian ? 32 + i : 35 - i];
    constexpr uint32_t undefined = ~0u;
    std::error_code failed;
    const auto size = std::filesystem::file_size(file, failed);
    if (!failed && userData != undefined && userData > size)
        throw Error("{}: the header's user data is {} bytes large, the file {}", file.string(), userData, size);
}

}  // namespace relamp
