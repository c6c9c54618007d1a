// Images are read in bands of rows or tiles: the same pixels, and a way to stop between them.
#include <gtest/gtest.h>

#include <cstring>

#include "base/error.h"
#include "image/image_io.h"
#include "support/temporary_folder.h"

namespace relamp {
namespace {

Image bandedRamp(int width, int height) {
    Image image(width, height);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) image.at(x, y) = Rgb(0.5f + float(x) / 200, float(y % 256) / 256, 0.25f);
    return image;
}

template <class Value>
void put(std::string& bytes, Value value) {
    bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

void attribute(std::string& bytes, const char* name, const char* type, const std::string& value) {
    bytes += std::string(name) + '\0' + type + '\0';
    put(bytes, int32_t(value.size()));
    bytes += value;
}

/// An uncompressed EXR in tiles, 32-bit floats; its window begins at (`left`, `top`).
std::string tiledExr(const Image& image, int tile, int left, int top) {
    std::string bytes, channels, window, tiles;
    put(bytes, int32_t(20000630));
    put(bytes, int32_t(2 | 0x200));
    for (const char* name : {"B", "G", "R"}) {
        channels += std::string(name) + '\0';
        for (const int32_t value : {2, 0, 1, 1}) put(channels, value);
    }
    channels += '\0';
    for (const int32_t value : {left, top, left + image.width - 1, top + image.height - 1}) put(window, value);
    put(tiles, int32_t(tile));
    put(tiles, int32_t(tile));
    tiles += '\0';
    std::string one, centre;
    put(one, 1.0f);
    put(centre, 0.0f);
    put(centre, 0.0f);
    attribute(bytes, "channels", "chlist", channels);
    attribute(bytes, "compression", "compression", std::string(1, '\0'));
    attribute(bytes, "dataWindow", "box2i", window);
    attribute(bytes, "displayWindow", "box2i", window);
    attribute(bytes, "lineOrder", "lineOrder", std::string(1, '\0'));
    attribute(bytes, "pixelAspectRatio", "float", one);
    attribute(bytes, "screenWindowCenter", "v2f", centre);
    attribute(bytes, "screenWindowWidth", "float", one);
    attribute(bytes, "tiles", "tiledesc", tiles);
    bytes += '\0';
    const int across = (image.width + tile - 1) / tile, down = (image.height + tile - 1) / tile;
    std::string part;
    const size_t begin = bytes.size() + 8 * size_t(across * down);
    for (int ty = 0; ty < down; ++ty)
        for (int tx = 0; tx < across; ++tx) {
            put(bytes, uint64_t(begin + part.size()));
            const int right = std::min((tx + 1) * tile, image.width), bottom = std::min((ty + 1) * tile, image.height);
            for (const int32_t value : {tx, ty, 0, 0, (right - tx * tile) * (bottom - ty * tile) * 12})
                put(part, value);
            for (int y = ty * tile; y < bottom; ++y)
                for (int c = 2; c >= 0; --c)
                    for (int x = tx * tile; x < right; ++x) put(part, image.at(x, y)[c]);
        }
    return bytes + part;
}

TEST(ImageBands, EveryFormatIsReadAsAWholeAndCanBeStopped) {
    const test::TemporaryFolder folder;
    const Image image = bandedRamp(20, 700);
    for (const char* name : {"a.exr", "a.hdr", "a.png", "a.jpg"}) {
        writeImage(folder / name, image);
        int asked = 0;
        const Image back = readImage(folder / name, nullptr, false, size_t(1) << 20, [&] { ++asked; });
        EXPECT_EQ(asked, 3) << name;
        double off = 0;
        for (size_t i = 0; i < image.pixels.size(); ++i) off += glm::distance(back.pixels[i], image.pixels[i]);
        EXPECT_LT(off / double(image.pixels.size()), 0.02) << name;
        asked = 0;
        EXPECT_THROW(readImage(folder / name, nullptr, false, size_t(1) << 20,
                               [&] {
                                   if (++asked == 2) throw Cancelled{};
                               }),
                     Cancelled)
            << name;
        EXPECT_EQ(asked, 2) << name;
    }
    int asked = 0;
    const CodeImage codes = readCodes(folder / "a.png", size_t(1) << 20, [&] { ++asked; });
    EXPECT_EQ(asked, 3);
    ASSERT_EQ(codes.codes.size(), size_t(20 * 700 * 3));
    for (const int y : {0, 255, 256, 511, 512, 699})
        EXPECT_NEAR(double(codes.codes[size_t(y) * 60 + 10]) / 65535, double(srgbEncode(image.at(3, y).y)), 0.003) << y;
    EXPECT_THROW(readCodes(folder / "a.png", size_t(1) << 20, [] { throw Cancelled{}; }), Cancelled);
}

TEST(ImageBands, TilesAreReadRowByRow) {
    const test::TemporaryFolder folder;
    const Image image = bandedRamp(70, 50);
    for (const int corner : {0, -5}) {
        const auto file = folder.write("tiles.exr", tiledExr(image, 32, corner, 2 * corner));
        int asked = 0;
        const Image back = readImage(file, nullptr, false, size_t(1) << 20, [&] { ++asked; });
        EXPECT_EQ(asked, 2);
        EXPECT_EQ(back.pixels, image.pixels);
        EXPECT_TRUE(back.usable.empty());
    }
    const auto refusal = [&](const std::string& bytes) {
        return test::messageOf([&] { readImage(folder.write("bad.exr", bytes)); });
    };
    const std::string bad = (folder / "bad.exr").string();
    EXPECT_EQ(refusal(tiledExr(image, 1 << 16, 0, 0)),
              bad + ": packs 65536 x 65536 pixels of 3 channels together, expected at most 134217728 numbers");
    std::string half = tiledExr(image, 32, 0, 0);
    half.resize(half.size() - 8000);
    EXPECT_NE(test::messageOf([&] { readImage(folder.write("half.exr", half)); }).find("half.exr"), std::string::npos);
}

TEST(ImageBands, DeepFilesAreRefusedByNameAndLevelsAndViewsGiveTheFirst) {
    const std::filesystem::path corpus = std::filesystem::path(RELAMP_SOURCE_DIR) / "tests/fuzz/corpus/image-exr";
    const test::TemporaryFolder folder;
    const auto copy = [&](const char* name) {
        std::filesystem::copy_file(corpus / name, folder / (std::string(name) + ".exr"));
        return folder / (std::string(name) + ".exr");
    };
    for (const char* name : {"deep", "deep-tiled"})
        EXPECT_NE(test::messageOf([&] {
                      readImage(copy(name));
                  }).find(std::string(name) + ".exr: is a deep image, expected a flat one"),
                  std::string::npos);
    for (const char* name : {"mip-mapped", "two-views"}) {
        const Image image = readImage(copy(name));
        ASSERT_EQ(std::pair(image.width, image.height), std::pair(8, 4)) << name;
        for (int y = 0; y < 4; ++y)
            for (int x = 0; x < 8; ++x)
                EXPECT_EQ(image.at(x, y), Rgb(0.25f + float(x), 0.5f + float(y), 0.125f * float(x + y))) << name;
    }
}

}  // namespace
}  // namespace relamp
