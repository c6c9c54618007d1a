#include "shot/shot_texture.h"

#include "base/error.h"
#include "base/is_there.h"
#include "image/image_io.h"
#include "scene/texcoords.h"
#include "texture/coarser_texels.h"

namespace relamp {
namespace {

/// Where corners lie in an image of `size`; negative where that says nothing of use.
std::array<Vec2, 3> cornersOf(const FaceTexcoords& places, const Vec2& size) {
    const std::array<Vec2, 3> nowhere{Vec2(-1), Vec2(-1), Vec2(-1)};
    if (places == FaceTexcoords{}) return nowhere;
    std::array<Vec2, 3> corners = nowhere;
    for (size_t k = 0; k < 3; ++k) {
        const Vec2 uv = places[k];
        if (!(uv.x >= 0 && uv.x <= 1 && uv.y >= 0 && uv.y <= 1)) return nowhere;
        corners[k] = Vec2(uv.x, 1 - uv.y) * size;
    }
    return corners;
}

std::vector<uint8_t> readConfidence(const std::filesystem::path& file, const AlbedoTexture& texture) {
    const Image image = readImage(file);
    if (image.width != texture.width || image.height != texture.height)
        throw Error("{}: is {} x {} pixels, expected {} x {} as the texture", file.string(), image.width, image.height,
                    texture.width, texture.height);
    std::vector<uint8_t> confidence;
    confidence.reserve(image.pixels.size());
    for (const Rgb& c : image.pixels) confidence.push_back(uint8_t(std::lround(255 * std::clamp(c.x, 0.0f, 1.0f))));
    return confidence;
}

}  // namespace

FaceTexcoords texcoordsOf(const AlbedoTexture& texture, uint32_t triangle) {
    FaceTexcoords result{};
    if (!texture.has(triangle)) return result;
    for (size_t k = 0; k < 3; ++k) {
        const Vec2& p = texture.corners[triangle][k];
        result[k] = Vec2(p.x / float(texture.width), 1 - p.y / float(texture.height));
    }
    return result;
}

void writeTexture(const AlbedoTexture& texture, const std::filesystem::path& file) {
    const char* names[] = {"R", "G", "B"};
    std::vector<Channel> channels;
    for (int c = 0; c < 3; ++c) {
        channels.push_back({names[c], true, {}});
        for (const Rgb& texel : texture.texels) channels.back().values.push_back(texel[c]);
    }
    writeChannels(file, texture.width, texture.height, channels);
}

void writeTextureConfidence(const AlbedoTexture& texture, const std::filesystem::path& file) {
    std::vector<Channel> channels{{"Y", true, {}}};
    for (const uint8_t c : texture.confidence) channels[0].values.push_back(float(c) / 255);
    writeChannels(file, texture.width, texture.height, channels);
}

std::shared_ptr<const AlbedoTexture> readTexture(const std::filesystem::path& image,
                                                 const std::vector<TexturedFace>& textured,
                                                 const std::vector<Triangle>& triangles,
                                                 const std::filesystem::path& confidence) {
    if (textured.empty()) return nullptr;
    Image pixels = readImage(image);
    if (pixels.width < 2 || pixels.height < 2)
        throw Error("{}: is {} x {} pixels, expected at least 2 x 2", image.string(), pixels.width, pixels.height);
    auto texture = std::make_shared<AlbedoTexture>();
    texture->width = pixels.width;
    texture->height = pixels.height;
    texture->texels = std::move(pixels.pixels);
    const Vec2 size(float(pixels.width), float(pixels.height));
    for (const FaceTexcoords& places : texcoordsOf(textured, triangles))
        texture->corners.push_back(cornersOf(places, size));
    if (!confidence.empty() && isThere(confidence)) texture->confidence = readConfidence(confidence, *texture);
    addCoarser(*texture);
    return texture;
}

}  // namespace relamp
