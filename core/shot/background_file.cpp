#include "shot/background_file.h"

#include "image/image_io.h"

namespace relamp {

void writeBackgroundFile(const std::filesystem::path& file, int width, const std::function<Rgb(int, int)>& texel) {
    constexpr float largestHalf = 65504;
    writeChannelRows(file, width, width / 2, 64, {{"", {{"R", true}, {"G", true}, {"B", true}}}},
                     [&](int first, int count, const std::vector<float*>& out) {
                         for (int y = 0; y < count; ++y)
                             for (int x = 0; x < width; ++x) {
                                 const Rgb value = glm::min(texel(x, first + y), Rgb(largestHalf));
                                 const size_t at = size_t(y) * size_t(width) + size_t(x);
                                 for (int c = 0; c < 3; ++c) out[size_t(c)][at] = value[c];
                             }
                     });
}

}  // namespace relamp
