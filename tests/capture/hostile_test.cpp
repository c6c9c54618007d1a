// Files made to hurt: a clear error that names the file, memory that stays small, no crash. COLMAP's and MERL's own are
// in their tests.
#include <gtest/gtest.h>

#include <unistd.h>

#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "capture/load_capture.h"
#include "image/image_io.h"
#include "support/temporary_folder.h"

namespace relamp {
namespace {

/// Memory in use now, MiB.
double residentMib() {
    std::ifstream in("/proc/self/statm");
    double all = 0, resident = 0;
    in >> all >> resident;
    return resident * double(::sysconf(_SC_PAGESIZE)) / (1 << 20);
}

/// A small EXR whose header says it has `side` x `side` pixels.
std::string exrOf(const test::TemporaryFolder& folder, int32_t side) {
    writeImage(folder / "small.exr", Image(4, 4, Rgb(0.5f)));
    std::string bytes = test::TemporaryFolder::read(folder / "small.exr");
    for (const char* name : {"dataWindow", "displayWindow"}) {
        const std::string key = std::string(name) + '\0' + "box2i" + '\0';
        const size_t at = bytes.find(key);
        if (at == std::string::npos) throw std::runtime_error("no window in the header");
        const int32_t corner = side - 1;
        std::memcpy(&bytes[at + key.size() + 4 + 8], &corner, 4);
        std::memcpy(&bytes[at + key.size() + 4 + 12], &corner, 4);
    }
    return bytes + std::string(2'000'000, '\x55');  // room for the table of rows, else the header alone is refused
}

class HostileCapture : public testing::Test {
protected:
    void SetUp() override {
        folder.write("mesh.obj", "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nf 1 2 3\n");
        writeImage(folder / "a.exr", Image(16, 12, Rgb(0.5f)));
    }
    static nlohmann::json frames() {
        return {
            {{"file_path", "a.exr"}, {"transform_matrix", {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 2}, {0, 0, 0, 1}}}}};
    }
    std::string error(const std::string& text) {
        folder.write("transforms.json", text);
        const double before = residentMib();
        const std::string message = test::messageOf([&] {
            Progress progress;
            loadCapture(folder.path(), {}, progress);
        });
        EXPECT_LT(residentMib() - before, 200) << message;
        return message;
    }
    test::TemporaryFolder folder;
};

TEST_F(HostileCapture, AnImageOfAMillionPixelsSquareIsRefusedFromItsHeader) {
    folder.write("a.exr", exrOf(folder, 1'000'000));
    const double before = residentMib();
    EXPECT_EQ(test::messageOf([&] { readImage(folder / "a.exr"); }),
              (folder / "a.exr").string() + ": has 1000000000000 pixels, expected at most 268435456");
    const std::string size = error(nlohmann::json{{"fl_x", 12}, {"frames", frames()}}.dump());
    EXPECT_EQ(size, "transforms.json: frame 0: w is 1000000, expected a whole number from 1 to 131072");
    EXPECT_EQ(error(nlohmann::json{{"fl_x", 12}, {"w", 16}, {"h", 12}, {"frames", frames()}}.dump()),
              "transforms.json: frame 0: " + (folder / "a.exr").string() +
                  ": has 1000000000000 pixels, expected at most 268435456");
    EXPECT_LT(residentMib() - before, 200);
}

TEST_F(HostileCapture, NestedListsAreRefusedWithoutBeingParsed) {
    EXPECT_EQ(error(std::string(5'000'000, '[')), "transforms.json: is nested deeper than 32 levels");
    EXPECT_EQ(error("{\"frames\": " + std::string(1'000'000, '[') + std::string(1'000'000, ']') + "}"),
              "transforms.json: is nested deeper than 32 levels");
    EXPECT_EQ(error("{\"frames\": [" + std::string(9'000'000, ',') + "]}"),
              "transforms.json: holds more than 8000000 values");
}

TEST_F(HostileCapture, MeshesThatClaimWhatTheyCannotHoldAreRefused) {
    const std::string good = nlohmann::json{{"fl_x", 12}, {"mesh_path", "bad.ply"}, {"frames", frames()}}.dump();
    for (const char* count :
         {"-5", "-1152921504606846976", "1152921504606846976", "99999999999999999999999", "4294967297", "1e9", "NaN"}) {
        folder.write(
            "bad.ply",
            fmt::format("ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty float x\nproperty float "
                        "y\nproperty float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\nabc",
                        count));
        EXPECT_NE(error(good).find((folder / "bad.ply").string()), std::string::npos) << count;
    }
    folder.write(
        "bad.ply",
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face "
        "1\nproperty list int int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n-3 0 1 2\n");
    EXPECT_NE(error(good).find((folder / "bad.ply").string()), std::string::npos);
}

TEST_F(HostileCapture, BracketsOfHostileImagesAreRefused) {
    writeImage(folder / "b.png", Image(16, 12, Rgb(0.5f)));
    std::string png = test::TemporaryFolder::read(folder / "b.png");
    png[16 + 1] = '\x7f';  // a width of 8 million; the header's checksum no longer fits either
    folder.write("c.png", png);
    folder.write("d.png", test::TemporaryFolder::read(folder / "b.png").substr(0, 60));
    for (const char* bad : {"c.png", "d.png", "none.png", "mesh.obj"}) {
        nlohmann::json list = frames();
        list[0]["exposures"] = {{{"file_path", "b.png"}, {"exposure_time", 1}},
                                {{"file_path", bad}, {"exposure_time", 4}}};
        list[0]["file_path"] = "b.png";
        EXPECT_NE(error(nlohmann::json{{"fl_x", 12}, {"w", 16}, {"h", 12}, {"frames", list}}.dump())
                      .find((folder / bad).string()),
                  std::string::npos)
            << bad;
    }
}

}  // namespace
}  // namespace relamp
