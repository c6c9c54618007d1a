#include "capture/colmap.h"

#include <gtest/gtest.h>

#include <cstring>

#include "capture/check.h"
#include "capture/load_capture.h"
#include "support/temporary_folder.h"

namespace relamp {
namespace {

/// Bytes of a binary model.
class Bytes {
public:
    template <class T>
    Bytes& put(T value) {
        char raw[sizeof(T)];
        std::memcpy(raw, &value, sizeof raw);
        text.append(raw, sizeof raw);
        return *this;
    }
    Bytes& put(std::initializer_list<double> values) {
        for (const double v : values) put(v);
        return *this;
    }
    Bytes& name(const char* letters) {
        text.append(letters, std::strlen(letters) + 1);
        return *this;
    }
    std::string text;
};

/// Two cameras, one turned, and two points. Ids fall and have gaps; carriage returns and comments as other tools write
/// them. camera 7: x right, y down, z forward, at (0, 0, -2) of the model. "a.png" is image 40, "b two.png" image 3 at
/// (2, 0, 0) looking along -x: rotated by +90 degrees about y (x_cam = -z.., see the pinned values).
const char* const camerasText =
    "# Camera list\r\n7 SIMPLE_RADIAL 16 12 10 8 6 0.1\r\n\r\n2 OPENCV_FISHEYE 16 12 10 11 8 6 0 0 0 0\r\n";
const char* const imagesText =
    "# Image list with two lines of data per image:\r\n"
    "40 1 0 0 0 0 0 2 7 b two.png\r\n"
    "8 6 900 13 6.5 11 1 1 -1\r\n"
    "3 0.70710678118654752 0 0.70710678118654752 0 0 0 2 2 a.png\r\n"
    "\r\n";
const char* const pointsText = "900 0 0 0 10 20 30 0.25 40 0\r\n11 1 0 0 1 1 1 0.75 40 1\r\n";

class Colmap : public testing::Test {
protected:
    ColmapModel read() {
        Progress progress;
        return readColmapModel(folder.path(), limits, progress);
    }
    void writeText() {
        folder.write("cameras.txt", camerasText);
        folder.write("images.txt", imagesText);
        folder.write("points3D.txt", pointsText);
    }
    static std::string cameras(uint64_t count = 2) {
        Bytes b;
        b.put(count).put(uint32_t(7)).put(int32_t(2)).put(uint64_t(16)).put(uint64_t(12)).put({10, 8, 6, 0.1});
        b.put(uint32_t(2)).put(int32_t(5)).put(uint64_t(16)).put(uint64_t(12)).put({10, 11, 8, 6, 0, 0, 0, 0});
        return b.text;
    }
    static Bytes oneImage(uint64_t observations = 3, uint64_t count = 2) {
        Bytes b;
        b.put(count).put(uint32_t(40)).put({1, 0, 0, 0, 0, 0, 2}).put(uint32_t(7)).name("b two.png").put(observations);
        return b;
    }
    static std::string images() {
        Bytes b = oneImage();
        b.put({8, 6}).put(uint64_t(900)).put({13, 6.5}).put(uint64_t(11)).put({1, 1}).put(~uint64_t(0));
        b.put(uint32_t(3))
            .put({std::sqrt(0.5), 0, std::sqrt(0.5), 0, 0, 0, 2})
            .put(uint32_t(2))
            .name("a.png")
            .put(uint64_t(0));
        return b.text;
    }
    static std::string points(uint64_t count = 2, uint64_t track = 1) {
        Bytes b;
        b.put(count)
            .put(uint64_t(900))
            .put({0, 0, 0})
            .put(uint8_t(10))
            .put(uint8_t(20))
            .put(uint8_t(30))
            .put(0.25)
            .put(track)
            .put(uint32_t(40))
            .put(uint32_t(0));
        b.put(uint64_t(11))
            .put({1, 0, 0})
            .put(uint8_t(1))
            .put(uint8_t(1))
            .put(uint8_t(1))
            .put(0.75)
            .put(uint64_t(1))
            .put(uint32_t(40))
            .put(uint32_t(1));
        return b.text;
    }
    void writeBinary() {
        folder.write("cameras.bin", cameras());
        folder.write("images.bin", images());
        folder.write("points3D.bin", points());
    }
    std::string error() {
        return test::messageOf([&] { read(); });
    }
    static void expectTheModel(const ColmapModel& model) {
        ASSERT_EQ(model.views.size(), 2u);
        EXPECT_EQ(model.cameras, 2u);
        const ColmapView &a = model.views[0], &b = model.views[1];  // by name
        EXPECT_EQ(a.name, "a.png");
        EXPECT_EQ(a.id, 3u);
        EXPECT_EQ(b.name, "b two.png");
        EXPECT_EQ(b.camera.model, LensModel::simpleRadial);
        EXPECT_EQ(b.camera.focalX, 10);
        EXPECT_EQ(b.camera.focalY, 10);
        EXPECT_EQ(b.camera.centreY, 6);
        EXPECT_EQ(b.camera.distortion[0], 0.1);
        EXPECT_EQ(a.camera.model, LensModel::openCvFisheye);
        EXPECT_EQ(a.camera.focalY, 11);
        // x_cam = x + (0, 0, 2): the camera stands at (0, 0, -2), looks along +z, down is +y.
        EXPECT_NEAR(glm::distance(b.camera.position(), DVec3(0, 0, -2)), 0, 1e-12);
        EXPECT_NEAR(glm::distance(b.camera.forward(), DVec3(0, 0, 1)), 0, 1e-12);
        EXPECT_NEAR(glm::distance(DVec3(b.camera.worldFromCamera[1]), DVec3(0, -1, 0)), 0, 1e-12);
        EXPECT_NEAR(glm::determinant(glm::dmat3(b.camera.worldFromCamera)), 1, 1e-12);
        // A turn by 90 degrees about y sends x to -z and z to x, so the camera looks along -x; it stands at -R^T t =
        // (2, 0, 0).
        EXPECT_NEAR(glm::distance(a.camera.forward(), DVec3(-1, 0, 0)), 0, 1e-7);
        EXPECT_NEAR(glm::distance(a.camera.position(), DVec3(2, 0, 0)), 0, 1e-7);
        // Point 900 is seen where it projects, at the centre. Point 11: x / z = 0.5, 0.5 (1 + 0.1 / 4) = 0.5125,
        // pixel 13.125, 6: off by (0.125, 0.5).
        EXPECT_EQ(model.observations, 2u);
        EXPECT_NEAR(model.errorPixels, 0.5 * std::hypot(0.125, 0.5), 1e-9);
        EXPECT_NEAR(b.errorPixels, 0.5 * std::hypot(0.125, 0.5), 1e-9);
        EXPECT_NEAR(model.statedErrorPixels, 0.5, 1e-12);
        EXPECT_EQ(model.points.size(), 2u);
        EXPECT_EQ(model.behind, 0u);
    }

    test::TemporaryFolder folder;
    ColmapLimits limits;
};

TEST_F(Colmap, ReadsTextWithCarriageReturnsCommentsAndIdsInAnyOrder) {
    writeText();
    expectTheModel(read());
}

TEST_F(Colmap, ReadsBinaryTheSame) {
    writeBinary();
    expectTheModel(read());
}

TEST_F(Colmap, BinaryIsPreferredToText) {
    writeBinary();
    folder.write("cameras.txt", "nonsense");
    expectTheModel(read());
}

TEST_F(Colmap, PointsMayBeMissing) {
    writeBinary();
    std::filesystem::remove(folder / "points3D.bin");
    const ColmapModel model = read();
    EXPECT_EQ(model.views.size(), 2u);
    EXPECT_EQ(model.observations, 0u);
    EXPECT_EQ(model.errorPixels, 0);
}

TEST_F(Colmap, EveryLensModelPutsItsParametersWhereColmapDoes) {
    const struct {
        const char* line;
        double focalX, focalY, centreX, centreY;
        std::array<double, 8> distortion;
    } lenses[] = {
        {"SIMPLE_PINHOLE 9 9 1 2 3", 1, 1, 2, 3, {}},
        {"PINHOLE 9 9 1 2 3 4", 1, 2, 3, 4, {}},
        {"SIMPLE_RADIAL 9 9 1 2 3 .4", 1, 1, 2, 3, {.4}},
        {"RADIAL 9 9 1 2 3 .4 .5", 1, 1, 2, 3, {.4, .5}},
        {"OPENCV 9 9 1 2 3 4 .5 .6 .7 .8", 1, 2, 3, 4, {.5, .6, .7, .8}},
        {"OPENCV_FISHEYE 9 9 1 2 3 4 .5 .6 .7 .8", 1, 2, 3, 4, {.5, .6, .7, .8}},
        {"FULL_OPENCV 9 9 1 2 3 4 .1 .2 .3 .4 .5 .6 .7 .8", 1, 2, 3, 4, {.1, .2, .3, .4, .5, .6, .7, .8}},
        {"FOV 9 9 1 2 3 4 .5", 1, 2, 3, 4, {.5}},
        {"SIMPLE_RADIAL_FISHEYE 9 9 1 2 3 .4", 1, 1, 2, 3, {.4}},
        {"RADIAL_FISHEYE 9 9 1 2 3 .4 .5", 1, 1, 2, 3, {.4, .5}},
        {"THIN_PRISM_FISHEYE 9 9 1 2 3 4 .1 .2 .3 .4 .5 .6 .7 .8", 1, 2, 3, 4, {.1, .2, .3, .4, .5, .6, .7, .8}}};
    folder.write("images.txt", "1 1 0 0 0 0 0 0 5 a.png\n\n");
    for (const auto& lens : lenses) {
        folder.write("cameras.txt", std::string("5 ") + lens.line + "\n");
        const Camera camera = read().views[0].camera;
        EXPECT_EQ(lensModelName(camera.model), std::string(lens.line).substr(0, std::string(lens.line).find(' ')));
        EXPECT_EQ(DVec3(camera.focalX, camera.focalY, camera.centreX), DVec3(lens.focalX, lens.focalY, lens.centreX))
            << lens.line;
        EXPECT_EQ(camera.centreY, lens.centreY) << lens.line;
        EXPECT_EQ(camera.distortion, lens.distortion) << lens.line;
    }
}

TEST_F(Colmap, WrongTextNamesFileEntryAndField) {
    writeText();
    const auto with = [&](const char* file, const std::string& text) {
        writeText();
        folder.write(file, text);
        return error();
    };
    EXPECT_EQ(with("cameras.txt", "7 FISH 16 12 10\n"),
              "cameras.txt: camera 7: model is \"FISH\", expected SIMPLE_PINHOLE, PINHOLE, SIMPLE_RADIAL, OPENCV or "
              "another of COLMAP's");
    EXPECT_EQ(with("cameras.txt", "7 PINHOLE 16 12 10 10 8\n"),
              "cameras.txt: camera 7: parameter 3 of PINHOLE is missing");
    EXPECT_EQ(with("cameras.txt", "7 PINHOLE 16 12 10 10 8 6 1\n"),
              "cameras.txt: camera 7: has more than the 4 parameters of PINHOLE");
    EXPECT_EQ(with("cameras.txt", "7 PINHOLE 16 12 10 nan 8 6\n"),
              "cameras.txt: camera 7: parameter 1 is nan, expected a finite number of at most 1e9");
    EXPECT_EQ(with("cameras.txt", "7 PINHOLE 16 12 10 -3 8 6\n"),
              "cameras.txt: camera 7: the focal length is -3, expected 0.001 to 1e+09 pixels");
    for (const char* least : {"7 PINHOLE 16 12 10 1e-310 8 6\n", "7 SIMPLE_RADIAL 16 12 1e-310 8 6 0.1\n"})
        EXPECT_EQ(with("cameras.txt", least).rfind("cameras.txt: camera 7: the focal length is 1e-310, expected", 0),
                  0u)
            << error();
    EXPECT_EQ(with("cameras.txt", "7 PINHOLE 0 12 10 10 8 6\n"),
              "cameras.txt: camera 7: width is 0, expected 1 to 131072 pixels");
    EXPECT_EQ(with("cameras.txt", "-7 PINHOLE 16 12 10 10 8 6\n"),
              "cameras.txt: camera_id is \"-7\", expected a whole number from 0 to 4294967295");
    EXPECT_EQ(with("cameras.txt", "7 PINHOLE 16 12 10 10 8 6\n7 PINHOLE 16 12 10 10 8 6\n"),
              "cameras.txt: camera 7: is there twice");
    EXPECT_EQ(with("images.txt", "40 0 0 0 0 0 0 2 7 a.png\n\n"),
              "images.txt: image 40: qw qx qy qz are 0 0 0 0, expected a rotation");
    EXPECT_EQ(with("images.txt", "40 1 0 0 0 0 inf 2 7 a.png\n\n"),
              "images.txt: image 40: ty is inf, expected a finite number of at most 1e12");
    EXPECT_EQ(with("images.txt", "40 1 0 0 0 0 0 2 8 a.png\n\n"),
              "images.txt: image 40: camera_id is 8, which the cameras file does not hold");
    EXPECT_EQ(with("images.txt", "40 1 0 0 0 0 0 2 7\n\n"), "images.txt: image 40: name is empty");
    EXPECT_EQ(with("images.txt", "40 1 0 0 0 0 0 two 7 a.png\n\n"),
              "images.txt: image 40: tz is \"two\", expected a number");
    EXPECT_EQ(with("images.txt", "40 1 0 0 0 0 0 2 7 a.png\n1 1 77\n"),
              "images.txt: image 40: a 2D point names point 77, which the points file does not hold");
    EXPECT_EQ(with("images.txt", "40 1 0 0 0 0 0 2 7 a.png\n1 900\n"),
              "images.txt: image 40: the line of 2D points holds something else than X Y POINT3D_ID");
    EXPECT_EQ(with("images.txt", "40 1 0 0 0 0 0 2 7 a.png\nnan 1 900\n"),
              "images.txt: image 40: a 2D point is at nan 1, expected finite numbers");
    EXPECT_EQ(with("images.txt", "1 1 0 0 0 0 0 2 7 a.png\n\n2 1 0 0 0 0 0 2 7 a.png\n\n"),
              "images.txt: a.png is there twice");
    EXPECT_EQ(with("images.txt", "# nothing\n"), "images.txt: holds no image");
    EXPECT_EQ(with("points3D.txt", "900 0 0 inf 1 1 1 0\n"),
              "points3D.txt: point 900: z is inf, expected a finite number");
    EXPECT_EQ(with("points3D.txt", "900 0 0\n"), "points3D.txt: point 900: z is missing");
}

TEST_F(Colmap, CountsBeyondTheFileAreRefusedBeforeMemoryIsAskedFor) {
    writeBinary();
    const uint64_t huge = uint64_t(1) << 60;
    folder.write("points3D.bin", points(huge));
    EXPECT_EQ(error(), "points3D.bin: number of points: is 1152921504606846976, expected at most 50000000");
    folder.write("points3D.bin", points(40'000'000));
    EXPECT_EQ(error(), "points3D.bin: number of points: is 40000000, the file has room for 2");
    folder.write("points3D.bin", points(2, huge));
    EXPECT_EQ(error(), "points3D.bin: point 900: track length: is 1152921504606846976, expected at most 4294967295");
    folder.write("points3D.bin", points(2, 4'000'000'000));
    EXPECT_EQ(error(), "points3D.bin: point 900: track length: is 4000000000, the file has room for 8");
    writeBinary();
    folder.write("images.bin", oneImage(huge).text);
    EXPECT_EQ(error(), "images.bin: number of images: is 2, the file has room for 1");
    folder.write("images.bin", oneImage(huge, 1).text);
    EXPECT_EQ(error(), "images.bin: image 40: number of 2D points: is 1152921504606846976, the file has room for 0");
    folder.write("images.bin", oneImage(3, ~uint64_t(0)).text);
    EXPECT_EQ(error(), "images.bin: number of images: is 18446744073709551615, expected at most 100000");
    writeBinary();
    folder.write("cameras.bin", cameras(huge));
    EXPECT_EQ(error(), "cameras.bin: number of cameras: is 1152921504606846976, expected at most 100000");
}

TEST_F(Colmap, BinaryFilesCutAnywhereAreRefused) {
    for (const char* file : {"cameras.bin", "images.bin", "points3D.bin"}) {
        writeBinary();
        const std::string whole = test::TemporaryFolder::read(folder / file);
        for (size_t length = 0; length < whole.size(); ++length) {
            folder.write(file, whole.substr(0, length));
            const std::string message = error();
            EXPECT_EQ(message.find(file), 0u) << length << " " << message;
        }
        folder.write(file, whole + "x");
        EXPECT_EQ(error(), std::string(file) + ": 1 bytes are left over behind the last entry");
    }
}

TEST_F(Colmap, RandomBytesNeverCrash) {
    for (const char* file :
         {"cameras.bin", "images.bin", "points3D.bin", "cameras.txt", "images.txt", "points3D.txt"}) {
        for (uint64_t seed = 0; seed < 150; ++seed) {
            const bool binary = std::string(file).ends_with("bin");
            for (const char* name : {"cameras", "images", "points3D"})
                std::filesystem::remove(folder / (std::string(name) + ".bin"));
            binary ? writeBinary() : writeText();
            std::string bytes = test::TemporaryFolder::read(folder / file);
            for (uint64_t k = 0; k < 1 + seed % 5; ++k) {
                uint64_t h = seed * 31 + k + 1;
                h = (h ^ (h >> 30)) * 0xbf58476d1ce4e5b9ull;
                h ^= h >> 27;
                bytes[h % bytes.size()] = char(h >> 32);
            }
            folder.write(file, bytes);
            error();
        }
    }
}

TEST_F(Colmap, AReadCanBeCancelled) {
    writeBinary();
    Progress progress;
    progress.requestStop();
    EXPECT_THROW(readColmapModel(folder.path(), {}, progress), Cancelled);
}

TEST_F(Colmap, LimitsAreHeld) {
    writeText();
    limits.maxPoints = 1;
    EXPECT_EQ(error(), "points3D.txt: point 11: there are more than 1 points");
    limits.maxPoints = 10;
    limits.maxTextBytes = 20;
    EXPECT_NE(error().find("cameras.txt"), std::string::npos);
}

TEST(ColmapUp, HorizonsAboutAnAxisGiveThatAxis) {
    // Cameras on a ring about (0, -0.6, 0.8) that look down at its middle.
    const DVec3 axis(0, -0.6, 0.8);
    std::vector<Camera> cameras;
    for (int i = 0; i < 7; ++i) {
        const double a = 0.4 * i;
        const DVec3 side = std::cos(a) * DVec3(1, 0, 0) + std::sin(a) * glm::cross(axis, DVec3(1, 0, 0));
        const DVec3 ahead = glm::normalize(-side - 0.9 * axis), right = glm::normalize(glm::cross(ahead, axis));
        Camera camera;
        camera.worldFromCamera = DMat4(glm::dvec4(right, 0), glm::dvec4(glm::cross(right, ahead), 0),
                                       glm::dvec4(-ahead, 0), glm::dvec4(3.0 * side, 1));
        cameras.push_back(camera);
    }
    EXPECT_NEAR(glm::distance(*guessUp(cameras), axis), 0, 1e-5);
    cameras.resize(1);  // one camera knows only its own up
    EXPECT_NEAR(glm::distance(*guessUp(cameras), DVec3(cameras[0].worldFromCamera[1])), 0, 1e-9);
    EXPECT_FALSE(guessUp({}));
}

/// A COLMAP capture as a folder: sparse/0, images, mesh.
class ColmapCapture : public testing::Test {
protected:
    void SetUp() override {
        // Two cameras side by side at z = -2 of the model, looking along +z at a square at z = 0; down is +y.
        folder.write("sparse/0/cameras.txt", "1 SIMPLE_RADIAL 16 12 12 8 6 0.05\n");
        folder.write("sparse/0/images.txt", "5 1 0 0 0 0.1 0 2 1 b.png\n\n9 1 0 0 0 -0.1 0 2 1 a.png\n\n");
        std::string points;
        for (int i = 0; i < 40; ++i)
            points += fmt::format("{} {} {} 0 1 1 1 0.1\n", i + 1, -0.9 + 0.045 * i, 0.5 * std::sin(double(i)));
        folder.write("sparse/0/points3D.txt", points);
        folder.write("mesh.obj", "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nf 1 4 3 2\n");
        std::filesystem::create_directories(folder / "images");
        for (const char* name : {"images/a.png", "images/b.png"}) writeImage(folder / name, Image(16, 12, Rgb(0.5f)));
    }
    Capture load(const CaptureFix& fix = {}) {
        LoadOptions options;
        options.fix = fix;
        Progress progress;
        return loadCapture(folder.path(), options, progress);
    }
    test::TemporaryFolder folder;
};

TEST_F(ColmapCapture, AFolderWithASparseModelIsRecognisedAndStandsUpright) {
    const Capture capture = load();
    ASSERT_EQ(capture.views.size(), 2u);
    EXPECT_EQ(capture.views[0].name, "a.png");
    EXPECT_EQ(capture.up, Vec3(0, -1, 0));
    // -y goes to +z; x stays. The model's z becomes +y... with the sign that keeps the world right-handed.
    EXPECT_NEAR(glm::distance(capture.views[0].camera.position(), DVec3(capture.worldFromFile * Vec3(0.1f, 0, -2))), 0,
                1e-6);
    EXPECT_NEAR(capture.views[0].camera.worldFromCamera[1].z, 1, 1e-6);
    ASSERT_TRUE(capture.reconstruction);
    EXPECT_EQ(capture.reconstruction->points, 40u);
    Progress progress;
    const CaptureCheck check = checkCapture(capture, progress);
    EXPECT_EQ(check.pointsOnMesh, 1);
    EXPECT_FALSE(check.lookBackwards);
    EXPECT_EQ(check.up, "-y");
    EXPECT_EQ(check.upGuess, "-y");
    EXPECT_GT(check.views[0].meshFraction, 0.5);
}

TEST_F(ColmapCapture, PlacesAreTakenAsGiven) {
    std::filesystem::rename(folder / "images", folder / "photos");
    std::filesystem::rename(folder / "mesh.obj", folder / "scan.obj");
    std::filesystem::rename(folder / "sparse", folder / "recon");
    EXPECT_EQ(test::messageOf([&] { load(); }).find((folder / "transforms.json").string() + ": does not exist"), 0u);
    CaptureFix fix;
    fix.colmap = "recon/0";
    EXPECT_NE(test::messageOf([&] { load(fix); }).find("name it with --mesh"), std::string::npos);
    fix.mesh = "scan.obj";
    EXPECT_NE(test::messageOf([&] { load(fix); }).find("name it with --images"), std::string::npos);
    fix.images = (folder / "photos").string();
    EXPECT_EQ(load(fix).views.size(), 2u);
    fix.colmap = "nowhere";
    EXPECT_NE(test::messageOf([&] { load(fix); }).find("nowhere: holds no cameras.bin or cameras.txt"),
              std::string::npos);
}

TEST_F(ColmapCapture, ScaleTurnsUnitsIntoMetresAndTheMeshIntoTheCamerasUnit) {
    const Capture plain = load();
    CaptureFix fix;
    fix.scale = 0.5;
    const Capture half = load(fix);
    EXPECT_NEAR(glm::distance(half.views[0].camera.position(), 0.5 * plain.views[0].camera.position()), 0, 1e-9);
    EXPECT_EQ(half.mesh.positions[0], 0.5f * plain.mesh.positions[0]);
    EXPECT_EQ(half.points[0], 0.5 * plain.points[0]);
    fix = {};
    fix.meshScale = 10;
    EXPECT_EQ(load(fix).mesh.positions[0], 10.0f * plain.mesh.positions[0]);
    Progress progress;
    const CaptureCheck check = checkCapture(load(fix), progress);
    EXPECT_LT(check.pointsOnMesh, 1.01);
    EXPECT_NEAR(check.meshToPoints / checkCapture(plain, progress).meshToPoints, 10, 1e-3);
    fix.meshScale = 0;
    EXPECT_NE(test::messageOf([&] { load(fix); }).find("expected more than 0"), std::string::npos);
}

TEST_F(ColmapCapture, AMeshInAnotherUnitIsNamedWithItsFix) {
    folder.write("mesh.obj", "v 9 9 0\nv 209 9 0\nv 209 209 0\nv 9 209 0\nf 1 4 3 2\n");
    Progress progress;
    const CaptureCheck check = checkCapture(load(), progress);
    EXPECT_TRUE(std::any_of(check.warnings.begin(), check.warnings.end(),
                            [](const std::string& w) { return w.find("--mesh-scale 0.0") != std::string::npos; }));
}

TEST_F(ColmapCapture, SmallerImagesOfTheSameShapeScaleTheCamera) {
    for (const char* name : {"images/a.png", "images/b.png"}) writeImage(folder / name, Image(8, 6, Rgb(0.5f)));
    const Capture capture = load();
    EXPECT_EQ(capture.views[0].camera.width, 8);
    EXPECT_EQ(capture.views[0].camera.focalX, 6);
    EXPECT_EQ(capture.views[0].camera.centreY, 3);
    writeImage(folder / "images/a.png", Image(6, 8, Rgb(0.5f)));
    EXPECT_NE(test::messageOf([&] { load(); }).find("a.png: is 6 x 8 pixels, w and h say 16 x 12"), std::string::npos);
}

TEST_F(ColmapCapture, ExposuresBesideAViewAreMerged) {
    // A wedge, photographed by a square-root camera at three exposures a view; no EXIF, so the names say the stops.
    const auto photograph = [&](const std::string& name, double seconds) {
        Image image(64, 48);
        for (int y = 0; y < 48; ++y)
            for (int x = 0; x < 64; ++x)
                image.at(x, y) = Rgb(float(std::min(
                    1.0, seconds * std::exp2(-4 + 0.1 * x + 0.01 * y))));  // written as sRGB: about a square root
        writeImage(folder / ("images/" + name), image);
    };
    for (const std::string stem : {"a", "b"})
        for (const auto& [ending, stops] : {std::pair{"_ev-2", -2.0}, std::pair{"", 0.0}, std::pair{"_ev+1.5", 1.5}})
            photograph(stem + ending + ".png", std::exp2(stops));
    const Capture capture = load();
    ASSERT_EQ(capture.views.size(), 2u);
    EXPECT_EQ(capture.views[0].name, "a.png");
    // Full in the shortest exposure at four times what fills the middle one.
    EXPECT_NEAR(capture.views[0].saturation, 4, 0.3);
    const Image& image = capture.views[0].image;
    EXPECT_NEAR(std::log2(double(image.at(54, 24).y) / double(image.at(14, 24).y)), 4, 0.5);
    // The model may hold the exposures themselves: one view stays, with the pose of that nearest to +0.
    folder.write("sparse/0/images.txt",
                 "5 1 0 0 0 0.1 0 2 1 b_ev-2.png\n\n6 1 0 0 0 0.2 0 2 1 b.png\n\n7 1 0 0 0 0.3 0 2 1 b_ev+1.5.png\n\n9 "
                 "1 0 0 0 -0.1 0 2 1 a_ev+1.5.png\n\n");
    const Capture grouped = load();
    ASSERT_EQ(grouped.views.size(), 2u);
    EXPECT_EQ(grouped.views[1].name, "b.png");
    std::filesystem::remove(folder / "images/a_ev-2.png");
    std::filesystem::remove(folder / "images/a.png");
    EXPECT_NE(test::messageOf([&] { load(); }).find("exposures is missing"), std::string::npos);
}

TEST_F(ColmapCapture, UpCanBeAnyDirection) {
    CaptureFix fix;
    fix.up = "0.1,-0.9,0.3";
    const Capture capture = load(fix);
    EXPECT_NEAR(glm::distance(capture.worldFromFile * glm::normalize(Vec3(0.1f, -0.9f, 0.3f)), Vec3(0, 0, 1)), 0, 1e-6);
}

TEST_F(ColmapCapture, TheModelItselfIsACaptureToo) {
    Progress progress;
    LoadOptions options;
    EXPECT_EQ(loadCapture(folder / "sparse/0", options, progress).views.size(), 2u);
}

}  // namespace
}  // namespace relamp
