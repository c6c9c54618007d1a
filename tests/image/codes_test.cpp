// Reading images as they are stored, and how they were exposed.
#include <gtest/gtest.h>

#include "image/image_io.h"
#include "support/temporary_folder.h"

namespace relamp {
namespace {

/// 2 x 1 pixels of 8 bits, and a header that says how it was exposed: a TIFF written by hand.
std::string tinyTiff(uint32_t numerator, uint32_t denominator) {
    std::string bytes = "II*";
    bytes += '\0';
    const auto put = [&](uint32_t value, int count) {
        for (int i = 0; i < count; ++i) bytes += char(value >> (8 * i));
    };
    put(8 + 6, 4);  // the directory lies behind the pixels
    for (const int v : {1, 2, 3, 253, 254, 255}) bytes += char(v);
    const uint32_t entries = 10, after = 14 + 2 + entries * 12 + 4;
    put(entries, 2);
    const auto entry = [&](uint32_t tag, uint32_t type, uint32_t count, uint32_t value) {
        put(tag, 2), put(type, 2), put(count, 4), put(value, 4);
    };
    entry(256, 3, 1, 2), entry(257, 3, 1, 1), entry(258, 3, 3, after), entry(259, 3, 1, 1), entry(262, 3, 1, 2);
    entry(273, 4, 1, 8), entry(277, 3, 1, 3), entry(278, 3, 1, 1), entry(279, 4, 1, 6), entry(34665, 4, 1, after + 6);
    put(0, 4);
    for (int i = 0; i < 3; ++i) put(8, 2);
    put(3, 2);  // EXIF: time, f-number, sensitivity
    const uint32_t rationals = after + 6 + 2 + 3 * 12 + 4;
    entry(0x829a, 5, 1, rationals), entry(0x829d, 5, 1, rationals + 8), entry(0x8827, 3, 1, 400);
    put(0, 4);
    put(numerator, 4), put(denominator, 4), put(28, 4), put(10, 4);
    return bytes;
}

TEST(Codes, AreReadAsStored) {
    const test::TemporaryFolder folder;
    const CodeImage image = readCodes(folder.write("a.tif", tinyTiff(1, 250)));
    EXPECT_EQ(image.width, 2);
    EXPECT_EQ(image.height, 1);
    EXPECT_FALSE(image.linear);
    EXPECT_EQ(image.codes, (std::vector<uint16_t>{257, 514, 771, 253 * 257, 254 * 257, 65535}));
}

TEST(Codes, ExposureComesFromExif) {
    const test::TemporaryFolder folder;
    writeImage(folder / "plain.jpg", Image(8, 8, Rgb(0.5f)));
    const std::string plain = test::TemporaryFolder::read(folder / "plain.jpg");
    const auto with = [&](uint32_t numerator, uint32_t denominator) {
        const std::string exif = std::string("Exif\0\0", 6) + tinyTiff(numerator, denominator);
        const size_t length = exif.size() + 2;
        return readExposureTags(folder.write(
            "a.jpg", plain.substr(0, 2) + "\xff\xe1" + char(length >> 8) + char(length) + exif + plain.substr(2)));
    };
    const ExposureTags tags = with(1, 250);
    EXPECT_NEAR(tags.seconds, 0.004, 1e-7);
    EXPECT_NEAR(tags.aperture, 2.8, 1e-6);
    EXPECT_EQ(tags.iso, 400);
    EXPECT_EQ(with(1, 0).seconds, 0);  // one by nothing, as some programs write
    EXPECT_NEAR(readExposureTags(folder.write("a.tif", tinyTiff(3, 2))).seconds, 1.5, 1e-7);
}

TEST(Codes, RadianceAndTooManyPixelsAreRefused) {
    const test::TemporaryFolder folder;
    writeImage(folder / "a.exr", Image(4, 4, Rgb(0.5f)));
    EXPECT_EQ(test::messageOf([&] { readCodes(folder / "a.exr"); }),
              (folder / "a.exr").string() + ": is no 8 or 16 bit image, so it is radiance already");
    writeImage(folder / "a.png", Image(4, 4, Rgb(0.5f)));
    EXPECT_EQ(test::messageOf([&] { readCodes(folder / "a.png", 15); }),
              (folder / "a.png").string() + ": has 16 pixels, expected at most 15");
    const CodeImage image = readCodes(folder / "a.png");
    EXPECT_EQ(image.codes[0], 188 * 257);
    EXPECT_EQ(readExposureTags(folder / "a.png").seconds, 0);
}

}  // namespace
}  // namespace relamp
