#include "viewport/thumbnail_textures.h"

#include "display/display_image.h"

namespace relamp::ui {

uint64_t ThumbnailTextures::texture(const std::string& key, const std::function<Image()>& make) {
    if (const auto found = textures_.find(key); found != textures_.end())
        return found->second.made() ? found->second.id() : 0;
    GlTexture& texture = textures_[key];
    Image image = make();
    if (image.pixels.empty()) return 0;
    const int longest = std::max(image.width, image.height);
    if (longest > longestSide)
        image = shrunk(image, std::max(1, image.width * longestSide / longest),
                       std::max(1, image.height * longestSide / longest));
    std::vector<uint8_t> bytes(image.pixels.size() * 4, 255);
    for (size_t i = 0; i < image.pixels.size(); ++i)
        for (int c = 0; c < 3; ++c) {
            const float value = image.pixels[i][c];
            bytes[4 * i + size_t(c)] =
                uint8_t(std::lround(255 * std::clamp(std::isfinite(value) ? value : 0.0f, 0.0f, 1.0f)));
        }
    uploadRgba8(texture, image.width, image.height, bytes.data());
    return texture.id();
}

void ThumbnailTextures::drop(const std::string& prefix) {
    for (auto it = textures_.lower_bound(prefix); it != textures_.end() && it->first.starts_with(prefix);)
        it = textures_.erase(it);
}

}  // namespace relamp::ui
