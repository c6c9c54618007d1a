#include "image/image_io.h"

#include <gtest/gtest.h>

#include <limits>

#include "base/error.h"
#include "image/chromaticities.h"
#include "support/temporary_folder.h"
#include "support/without_override.h"

namespace relamp {
namespace {

Image ramp(int width, int height) {
    Image image(width, height);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) image.at(x, y) = Rgb(float(x) / 4, float(y) / 8, 0.5f);
    return image;
}

std::vector<float> plane(const Image& image, int channel) {
    std::vector<float> values;
    for (const Rgb& c : image.pixels) values.push_back(c[channel]);
    return values;
}

TEST(ImageIo, ExrAndHdrComeBackTopRowFirst) {
    test::TemporaryFolder folder;
    const Image image = ramp(70, 150);
    for (const char* name : {"a.exr", "a.hdr"}) {
        writeImage(folder / name, image);
        EXPECT_EQ(readImageSize(folder / name), std::pair(70, 150));
        ImageReport report;
        const Image back = readImage(folder / name, &report);
        ASSERT_EQ(back.width, 70);
        ASSERT_EQ(back.height, 150);
        for (size_t i = 0; i < image.pixels.size(); ++i)
            EXPECT_LT(glm::distance(back.pixels[i], image.pixels[i]), 0.01f * (0.1f + maxChannel(image.pixels[i])))
                << name << i;
        EXPECT_FALSE(report.integer);
        EXPECT_EQ(report.clipLevel, 0);
        EXPECT_TRUE(back.usable.empty());
    }
}

TEST(ImageIo, SunsBeyondHalfFloatsKeepTheirRadiance) {
    test::TemporaryFolder folder;
    Image image(4, 2, Rgb(1));
    image.at(2, 1) = Rgb(3e6f, 2e6f, 1e6f);
    writeImage(folder / "sun.exr", image);
    EXPECT_EQ(readImage(folder / "sun.exr").at(2, 1), Rgb(3e6f, 2e6f, 1e6f));
    writeChannels(folder / "sun2.exr", 4, 2,
                  {{"R", true, plane(image, 0)}, {"G", true, plane(image, 1)}, {"B", true, plane(image, 2)}});
    EXPECT_EQ(readImage(folder / "sun2.exr").at(2, 1), Rgb(3e6f, 2e6f, 1e6f));
}

TEST(ImageIo, EightBitFilesAreSrgb) {
    test::TemporaryFolder folder;
    Image image(3, 1);
    image.at(0, 0) = Rgb(0.2140411f);  // code 128 in sRGB is 0.2158605
    image.at(1, 0) = Rgb(7, 1, 0);
    writeImage(folder / "a.png", image);
    ImageReport report;
    const Image back = readImage(folder / "a.png", &report);
    EXPECT_NEAR(back.at(0, 0).x, 0.2140411f, 2e-3);
    EXPECT_EQ(back.at(1, 0), Rgb(1, 1, 0));
    EXPECT_TRUE(report.integer);
    EXPECT_FLOAT_EQ(report.clipLevel, 1);
    const Image data = readImage(folder / "a.png", nullptr, true);
    EXPECT_NEAR(data.at(0, 0).x, 0.5, 3e-3);
    writeImage(folder / "a.jpg", Image(16, 16, Rgb(0.5f)));
    EXPECT_NEAR(readImage(folder / "a.jpg").at(8, 8).y, 0.5, 5e-3);
}

TEST(ImageIo, SrgbCurveHasItsStandardValues) {
    EXPECT_NEAR(srgbDecode(0.5f), 0.21404114f, 1e-6);
    EXPECT_NEAR(srgbEncode(0.18f), 0.46135613f, 1e-6);
    EXPECT_FLOAT_EQ(srgbDecode(0.04045f), 0.04045f / 12.92f);
    EXPECT_EQ(srgbEncode(-1), 0);
    EXPECT_FLOAT_EQ(srgbEncode(2), 1);
    for (float x = 0; x <= 1; x += 0.01f) EXPECT_NEAR(srgbDecode(srgbEncode(x)), x, 1e-5);
}

TEST(ImageIo, PixelsThatAreNoRadianceAreCountedAndEmptied) {
    test::TemporaryFolder folder;
    constexpr float nan = std::numeric_limits<float>::quiet_NaN(), infinity = std::numeric_limits<float>::infinity();
    Image image(4, 2, Rgb(1));
    image.at(0, 0) = Rgb(1, nan, 1);
    image.at(1, 0) = Rgb(infinity, 1, 1);
    image.at(2, 0) = Rgb(1, 1, -0.001f);
    image.at(3, 1) = Rgb(-infinity, 0, 0);
    writeImage(folder / "bad.exr", image);
    ImageReport report;
    const Image back = readImage(folder / "bad.exr", &report);
    EXPECT_EQ(report.nan, 1u);
    EXPECT_EQ(report.infinite, 2u);
    EXPECT_EQ(report.negative, 1u);
    EXPECT_EQ(back.at(0, 0), Rgb(0));
    EXPECT_EQ(back.at(2, 0), Rgb(0));
    EXPECT_FALSE(back.usableAt(0, 0));
    EXPECT_FALSE(back.usableAt(1, 0));
    EXPECT_FALSE(back.usableAt(2, 0));
    EXPECT_FALSE(back.usableAt(3, 1));
    EXPECT_TRUE(back.usableAt(0, 1));
    EXPECT_EQ(back.at(0, 1), Rgb(1));
}

TEST(ImageIo, TransparentPixelsAreNotUsableAndKeepTheirColour) {
    test::TemporaryFolder folder;
    const std::vector<float> half(4, 0.25f);
    writeChannels(folder / "a.exr", 2, 2,
                  {{"R", true, half}, {"G", true, half}, {"B", true, half}, {"A", true, {1, 0, 0.75f, 0.25f}}});
    ImageReport report;
    const Image image = readImage(folder / "a.exr", &report);
    EXPECT_EQ(report.transparent, 2u);
    EXPECT_TRUE(image.usableAt(0, 0));
    EXPECT_FALSE(image.usableAt(1, 0));
    EXPECT_TRUE(image.usableAt(0, 1));
    EXPECT_FALSE(image.usableAt(1, 1));
    EXPECT_EQ(image.at(1, 0), Rgb(0.25f));
}

TEST(ImageIo, GreyIsSpreadOverThreeChannelsAndLayersArePassedOver) {
    test::TemporaryFolder folder;
    writeChannels(folder / "grey.exr", 2, 1, {{"Y", true, {0.5f, 2}}});
    EXPECT_EQ(readImage(folder / "grey.exr").at(1, 0), Rgb(2));
    writeChannels(folder / "layers.exr", 1, 1,
                  {{"B", true, {3}},
                   {"Combined_world.B", true, {8}},
                   {"G", true, {2}},
                   {"R", true, {1}},
                   {"depth.Z", false, {9}}});
    EXPECT_EQ(readImage(folder / "layers.exr").at(0, 0), Rgb(1, 2, 3));
}

TEST(ImageIo, WhatHasNoColoursIsRefusedAndTheirPartIsFound) {
    test::TemporaryFolder folder;
    const auto error = [&](const std::vector<const char*>& names) {
        std::vector<Channel> channels;
        for (const char* name : names) channels.push_back({name, true, {0.5f, 2}});
        writeChannels(folder / "a.exr", 2, 1, channels);
        return test::messageOf([&] { readImage(folder / "a.exr"); });
    };
    EXPECT_NE(error({"Z"}).find("a.exr: has the channels Z, expected R, G and B, or Y"), std::string::npos);
    EXPECT_NE(error({"R", "G"}).find("has the channels R, G"), std::string::npos);
    EXPECT_NE(error({"u", "v", "w"}).find("has the channels u, v, w"), std::string::npos);
    EXPECT_NE(error({"X", "Y", "Z"}).find("has the channels X, Y, Z"), std::string::npos);
    EXPECT_EQ(error({"Y", "Z"}), "") << "luminance and depth";
    EXPECT_EQ(error({"diffuse.B", "diffuse.G", "diffuse.R"}), "");
    const auto part = [](const char* name, const std::vector<const char*>& channels) {
        ChannelPart p{name, {}};
        for (const char* channel : channels) p.channels.push_back({channel, false});
        return p;
    };
    writeChannelRows(folder / "parts.exr", 2, 2, 2, {part("depth", {"Z"}), part("beauty", {"R", "G", "B"})},
                     [](int, int count, const std::vector<float*>& out) {
                         for (size_t c = 0; c < out.size(); ++c) std::fill_n(out[c], 2 * count, float(c));
                     });
    EXPECT_EQ(readImage(folder / "parts.exr").at(1, 1), Rgb(1, 2, 3));
}

TEST(ImageIo, PrimariesThatAreNoColourSpaceAreRefused) {
    test::TemporaryFolder folder;
    writeImage(folder / "a.exr", ramp(4, 4));
    std::string bytes = test::TemporaryFolder::read(folder / "a.exr");
    const std::string key = std::string("chromaticities") + '\0' + "chromaticities" + '\0';
    const size_t at = bytes.find(key);
    ASSERT_NE(at, std::string::npos);
    const float bad = std::numeric_limits<float>::quiet_NaN();
    std::memcpy(&bytes[at + key.size() + 4], &bad, sizeof bad);
    folder.write("a.exr", bytes);
    EXPECT_NE(test::messageOf([&] { readImage(folder / "a.exr"); }).find("a.exr: the header's chromaticities"),
              std::string::npos);
}

TEST(ImageIo, AJpegThatWasCutOffIsRefused) {
    test::TemporaryFolder folder;
    writeImage(folder / "a.jpg", ramp(200, 150));
    const std::string bytes = test::TemporaryFolder::read(folder / "a.jpg");
    for (const double kept : {0.1, 0.5, 0.9, 0.999}) {
        folder.write("cut.jpg", bytes.substr(0, size_t(double(bytes.size()) * kept)));
        EXPECT_NE(test::messageOf([&] { readImage(folder / "cut.jpg"); }).find("cut.jpg: "), std::string::npos) << kept;
        EXPECT_NE(test::messageOf([&] { readCodes(folder / "cut.jpg"); }).find("cut.jpg: "), std::string::npos) << kept;
    }
    // Cameras put previews and films behind the end.
    folder.write("more.jpg", bytes + std::string(1000, '\xff') + "film");
    EXPECT_EQ(test::messageOf([&] { readImage(folder / "more.jpg"); }), "");
}

TEST(ImageIo, ATiffThatWasCutOffIsRefused) {
    // 16 x 64 grey pixels in two strips behind the directory.
    std::string bytes("II*\0\x08\0\0\0", 8);
    const auto put = [&](uint32_t value, size_t size) {
        for (size_t i = 0; i < size; ++i) bytes += char(value >> (8 * i) & 255);
    };
    const std::vector<std::array<uint32_t, 4>> entries{{256, 3, 1, 16}, {257, 3, 1, 64}, {258, 3, 1, 8},
                                                       {259, 3, 1, 1},  {262, 3, 1, 1},  {273, 4, 2, 126},
                                                       {277, 3, 1, 1},  {278, 3, 1, 32}, {279, 4, 2, 134}};
    put(uint32_t(entries.size()), 2);
    for (const auto& [tag, type, count, value] : entries) put(tag, 2), put(type, 2), put(count, 4), put(value, 4);
    put(0, 4);
    ASSERT_LE(bytes.size(), 126u);
    bytes.resize(126);
    for (const uint32_t value : {142u, 142u + 512u, 512u, 512u}) put(value, 4);
    bytes += std::string(1024, 'x');
    test::TemporaryFolder folder;
    EXPECT_EQ(test::messageOf([&] { readImage(folder.write("a.tif", bytes)); }), "");
    for (const size_t cut : {1u, 300u, 700u}) {
        folder.write("a.tif", bytes.substr(0, bytes.size() - cut));
        EXPECT_NE(test::messageOf([&] { readImage(folder / "a.tif"); }).find("a.tif: cannot be read to its end"),
                  std::string::npos)
            << cut;
    }
}

TEST(ImageIo, APngThatWasCutOffIsRefusedInOneLine) {
    test::TemporaryFolder folder;
    writeImage(folder / "a.png", ramp(64, 64));
    const std::string bytes = test::TemporaryFolder::read(folder / "a.png");
    folder.write("a.png", bytes.substr(0, bytes.size() - 30));
    const std::string error = test::messageOf([&] { readImage(folder / "a.png"); });
    EXPECT_NE(error.find("a.png: cannot be read to its end"), std::string::npos) << error;
    EXPECT_EQ(error.find('\n'), std::string::npos) << error;
}

TEST(ImageIo, UnreadableFilesAreNamed) {
    test::TemporaryFolder folder;
    const auto error = [&](const std::filesystem::path& file) { return test::messageOf([&] { readImage(file); }); };
    EXPECT_EQ(error(folder / "none.exr"), (folder / "none.exr").string() + ": does not exist");
    EXPECT_EQ(error(folder.path()), folder.path().string() + ": is a folder, expected a file");
    EXPECT_NE(error(folder.write("text.exr", "no image")).find("text.exr: is not a readable image"), std::string::npos);
    EXPECT_NE(error(folder.write("empty.png", "")).find("empty.png: is not a readable image"), std::string::npos);
    EXPECT_THROW(readImageSize(folder / "text.exr"), Error);
    writeImage(folder / "good.exr", ramp(64, 64));
    const std::string bytes = test::TemporaryFolder::read(folder / "good.exr");
    EXPECT_NE(error(folder.write("cut.exr", bytes.substr(0, bytes.size() / 2))).find("cut.exr: "), std::string::npos);
    EXPECT_NE(test::messageOf([&] {
                  readImage(folder / "good.exr", nullptr, false, 1000);
              }).find("has 4096 pixels, expected at most 1000"),
              std::string::npos);
}

TEST(ImageIo, AFileWithoutPermissionIsSaidToBeOne) {
    const test::TemporaryFolder folder;
    writeImage(folder / "a.exr", Image(4, 4));
    writeImage(folder / "a.png", Image(4, 4));
    for (const char* name : {"a.exr", "a.png"}) {
        std::filesystem::permissions(folder / name, std::filesystem::perms::none);
        const test::WithoutOverride nobody;
        const std::string found = name + std::string(": cannot be read (Permission denied)");
        EXPECT_NE(test::messageOf([&] { readImage(folder / name); }).find(found), std::string::npos);
        EXPECT_NE(test::messageOf([&] { readImageSize(folder / name); }).find(found), std::string::npos);
    }
    EXPECT_NO_THROW(readImage(folder / "a.exr")) << "only for a while";
}

TEST(ImageIo, ImagesNamedWronglyAreReadByTheirContent) {
    const test::TemporaryFolder folder;
    const Image image = ramp(16, 8);
    folder.write("a.tif", test::TemporaryFolder::read(RELAMP_SOURCE_DIR "/tests/fuzz/corpus/image-tiff/lzw8"));
    for (const char* name : {"a.png", "a.jpg", "a.tif", "a.exr", "a.hdr"}) {
        if (!std::filesystem::exists(folder / name)) writeImage(folder / name, image);
        const Image right = readImage(folder / name);
        for (const char* wrong : {"b.png", "b.jpg", "b.exr", "b.hdr"}) {
            folder.write(wrong, test::TemporaryFolder::read(folder / name));
            const Image read = readImage(folder / wrong);
            EXPECT_EQ(read.pixels, right.pixels) << name << " as " << wrong;
        }
    }
}

TEST(ImageIo, WhatIsNoImageByItsNameOrBeginningIsNotTriedInOtherFormats) {
    const test::TemporaryFolder folder;
    // A portable pixmap, which the library would read under its own name.
    const std::string pixmap = "P3\n1 1\n255\n255 0 0\n";
    EXPECT_EQ(readImage(folder.write("a.ppm", pixmap)).pixels.size(), 1u);
    EXPECT_NE(test::messageOf([&] { readImage(folder.write("a.png", pixmap)); }).find("a.png: is not a readable image"),
              std::string::npos);
}

TEST(ImageIo, AnExrWhoseHeaderClaimsMoreThanTheFileHoldsIsNotBelieved) {
    const test::TemporaryFolder folder;
    writeImage(folder / "a.exr", Image(8, 6, Rgb(1)), {{"comment", "short"}});
    std::string bytes = test::TemporaryFolder::read(folder / "a.exr");
    const std::string key = std::string("comment") + '\0' + "string" + '\0';
    const size_t at = bytes.find(key);
    ASSERT_NE(at, std::string::npos);
    for (const char* size : {"\xff\xff\xff\x7f", "\xff\xff\xff\xff", "\x01\x01\x01\x01"}) {
        bytes.replace(at + key.size(), 4, size, 4);
        folder.write("a.exr", bytes);
        const std::string message = test::messageOf([&] { readImage(folder / "a.exr"); });
        EXPECT_NE(message.find("a.exr: the header's comment"), std::string::npos) << message;
    }
    folder.write("a.exr", bytes.substr(0, at + 3));
    EXPECT_NE(test::messageOf([&] { readImage(folder / "a.exr"); }).find("breaks off"), std::string::npos);
}

TEST(ImageIo, ADpxWhoseHeaderClaimsMoreThanTheFileHoldsIsNotBelieved) {
    const test::TemporaryFolder folder;
    std::string bytes(2048, '\0');
    bytes.replace(0, 4, "SDPX");
    bytes.replace(32, 4, "\x7f\xff\xff\xff");
    EXPECT_EQ(test::messageOf([&] { readImage(folder.write("a.dpx", bytes)); }),
              (folder / "a.dpx").string() + ": the header's user data is 2147483647 bytes large, the file 2048");
    bytes.replace(0, 4, "XPDS");
    EXPECT_EQ(test::messageOf([&] { readImage(folder.write("a.dpx", bytes)); }),
              (folder / "a.dpx").string() + ": the header's user data is 4294967167 bytes large, the file 2048");
}

TEST(ImageIo, FailedWritesNameTheFileAndLeaveTheOldOne) {
    test::TemporaryFolder folder;
    const auto missing = folder / "no/such/folder/a.exr";
    EXPECT_NE(test::messageOf([&] { writeImage(missing, ramp(4, 4)); }).find(missing.string()), std::string::npos);
    EXPECT_NE(test::messageOf([&] { writeImage(folder / "a.bmp", ramp(4, 4)); }).find("expected .exr"),
              std::string::npos);
    EXPECT_THROW(writeImage(folder / "a.exr", Image()), Error);
    const auto old = folder.write("old.exr", "as it was");
    EXPECT_THROW(writeChannels(old, 2, 2, {{"R", true, {1, 2, 3}}}), Error);
    EXPECT_EQ(test::TemporaryFolder::read(old), "as it was");
    // A folder in the target's place cannot be replaced by a file.
    std::filesystem::create_directories(folder / "taken.exr/inside");
    EXPECT_THROW(writeImage(folder / "taken.exr", ramp(4, 4)), Error);
    EXPECT_TRUE(std::filesystem::exists(folder / "taken.exr/inside"));
    EXPECT_EQ(folder.entries(), 2u);
}

TEST(ImageIo, WritingRowsCanBeStoppedBetweenThem) {
    const test::TemporaryFolder folder;
    const std::vector<ChannelPart> parts{{"", {{"R", true}, {"G", true}, {"B", true}}}};
    const auto fill = [](int, int count, const std::vector<float*>& out) {
        for (float* plane : out) std::fill_n(plane, size_t(count) * 8, 1.0f);
    };
    int asked = 0;
    writeChannelRows(folder / "a.exr", 8, 64, 32, parts, fill, {}, [&] { ++asked; });
    EXPECT_EQ(asked, 4);
    EXPECT_THROW(writeChannelRows(folder / "b.exr", 8, 64, 32, parts, fill, {},
                                  [&] {
                                      if (++asked == 7) throw Cancelled{};
                                  }),
                 Cancelled);
    EXPECT_EQ(asked, 7);
    EXPECT_EQ(folder.entries(), 1u);
}

TEST(ImageIo, SameImageGivesSameBytes) {
    test::TemporaryFolder folder;
    writeImage(folder / "a.exr", ramp(33, 70), {{"gauge", "auto"}});
    writeImage(folder / "b.exr", ramp(33, 70), {{"gauge", "auto"}});
    EXPECT_EQ(test::TemporaryFolder::read(folder / "a.exr"), test::TemporaryFolder::read(folder / "b.exr"));
}

TEST(Chromaticities, WhiteStaysWhiteAndAcesRedIsOutsideRec709) {
    EXPECT_TRUE(isRec709(rec709Chromaticities));
    const Chromaticities ap0{0.7347f, 0.2653f, 0.0f, 1.0f, 0.0001f, -0.077f, 0.32168f, 0.33767f};
    const Mat3 matrix = rec709From(ap0).value();
    EXPECT_LT(glm::distance(matrix * Vec3(1), Vec3(1)), 1e-3f);
    // The published ACES2065-1 to linear sRGB matrix (Bradford).
    EXPECT_NEAR(matrix[0].x, 2.52169f, 2e-3);
    EXPECT_NEAR(matrix[1].x, -1.13413f, 2e-3);
    EXPECT_NEAR(matrix[2].z, 1.16835f, 2e-3);
    EXPECT_FALSE(rec709From(Chromaticities{}));
    Chromaticities bad = ap0;
    bad[2] = std::numeric_limits<float>::quiet_NaN();
    EXPECT_FALSE(rec709From(bad));
}

}  // namespace
}  // namespace relamp
