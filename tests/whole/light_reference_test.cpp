// Light references given to the real program: light probes, mirror balls, grey cards, charts.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "image/environment_map.h"
#include "support/known_world.h"
#include "support/run_program.h"
#include "whole/relamp_program.h"

namespace relamp {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using test::relamp;

/// The known world without its emitter: background alone tells the scale.
struct OpenWorld {
    test::TemporaryFolder folder;
    test::KnownWorld truth = test::paintKnownWorld(folder / "capture", false, 6, 14);

    /// The sky, turned back by `yaw` degrees and times `exposure`.
    fs::path probe(const std::string& name, float yaw, float exposure) const {
        Image sky(256, 128);
        for (int y = 0; y < sky.height; ++y)
            for (int x = 0; x < sky.width; ++x)
                sky.at(x, y) = exposure * test::KnownWorld::sky(
                                              directionFromLatLong({(float(x) + 0.5f) / 256, (float(y) + 0.5f) / 128}));
        writeImage(folder / name, yawed(sky, -yaw));
        return folder / name;
    }
    test::ProgramResult solve(const std::string& shot, std::vector<std::string> more) const {
        std::vector<std::string> arguments{"solve", folder / "capture", "-o", folder / shot, "--quality", "draft"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        return relamp(arguments);
    }
    json info(const std::string& shot) const { return json::parse(relamp({"info", folder / shot, "--json"}).out); }
    /// A copy of the shot that is found without any reference; it is the same for every such world.
    void solveWithout(const std::string& shot) const {
        static const OpenWorld plain;
        static const test::ProgramResult solved = plain.solve("without.relamp", {"--accept-poor"});
        ASSERT_EQ(solved.exitCode, 0) << solved.error;
        fs::copy(plain.folder / "without.relamp", folder / shot, fs::copy_options::recursive);
    }
    /// Relative root mean square difference of the environment from the sky.
    double environmentError(const std::string& shot) const {
        const Image found = readImage(folder / shot / "environment.exr");
        double squares = 0, all = 0;
        for (int y = 4; y < found.height; y += 8)
            for (int x = 4; x < found.width; x += 8) {
                const Vec3 d = directionFromLatLong(
                    {(float(x) + 0.5f) / float(found.width), (float(y) + 0.5f) / float(found.height)});
                const DVec3 sky(test::KnownWorld::sky(d)), off = DVec3(found.at(x, y)) - sky;
                const double area = std::sqrt(1 - double(d.z) * d.z);
                squares += area * glm::dot(off, off);
                all += area * glm::dot(sky, sky);
            }
        return std::sqrt(squares / all);
    }
};

TEST(LightReference, AProbeIsTurnedExposedAndHalvesTheErrorOfTheEnvironment) {
    const OpenWorld world;
    world.solveWithout("without.relamp");
    const test::ProgramResult r =
        world.solve("with.relamp", {"--accept-poor", "--light-probe", world.probe("set.exr", -37.3f, 0.25f)});
    ASSERT_EQ(r.exitCode, 0) << r.error;
    EXPECT_NE(r.error.find("set.exr: turned by -37"), std::string::npos) << r.error;
    const json with = world.info("with.relamp");
    ASSERT_EQ(with["light_probes"].size(), 1u);
    const json& probe = with["light_probes"][0];
    EXPECT_TRUE(probe["used"].get<bool>());
    EXPECT_FALSE(probe["doubtful"].get<bool>()) << probe["words"];
    EXPECT_NEAR(probe["yaw_degrees"].get<double>(), -37.3, 1);
    for (size_t c = 0; c < 3; ++c) EXPECT_NEAR(probe["gain"][c].get<double>(), 4, 0.08);
    EXPECT_FALSE(world.info("without.relamp").contains("light_probes"));
    EXPECT_LT(world.environmentError("with.relamp"), 0.5 * world.environmentError("without.relamp"));
    EXPECT_NE(relamp({"info", world.folder / "with.relamp"}).out.find("light probe set.exr"), std::string::npos);
}

TEST(LightReference, AProbeOfAnotherPlaceChangesNothingAndIsSaid) {
    const OpenWorld world;
    Image other(128, 64);
    for (int y = 0; y < 64; ++y)
        for (int x = 0; x < 128; ++x) other.at(x, y) = (x / 9 + y / 7) % 2 ? Rgb(6, 2, 0.3f) : Rgb(0.02f, 0.1f, 0.3f);
    writeImage(world.folder / "other.exr", other);
    world.solveWithout("without.relamp");
    const test::ProgramResult r =
        world.solve("with.relamp", {"--accept-poor", "--light-probe", world.folder / "other.exr"});
    ASSERT_EQ(r.exitCode, 0) << r.error;
    EXPECT_NE(r.error.find("does not show the light of these photographs"), std::string::npos) << r.error;
    EXPECT_FALSE(world.info("with.relamp")["light_probes"][0]["used"].get<bool>());
    for (const char* file : {"reflectance.ply", "environment.exr"})
        EXPECT_TRUE(test::TemporaryFolder::read(world.folder / "with.relamp" / file) ==
                    test::TemporaryFolder::read(world.folder / "without.relamp" / file))
            << file;
}

TEST(LightReference, AGreyPatchTellsTheAlbedo) {
    const OpenWorld world;
    // A place on the floor, seen by the first view.
    const Camera camera = test::cameraAt({2.3 * std::cos(0.3), 2.3 * std::sin(0.3), 1.9}, {0.05, 0, 0.15}, 96, 72, 95);
    const Vec3 place(0.75f, -0.1f, 0);
    const auto pixel = camera.project(DVec3(place));
    ASSERT_TRUE(pixel);
    const Rgb told = test::KnownWorld::albedoAt(place);
    const std::string patch =
        fmt::format("0:{:.1f},{:.1f},1.5={:.4f},{:.4f},{:.4f}", pixel->x, pixel->y, told.x, told.y, told.z);
    const test::ProgramResult r = world.solve("x.relamp", {"--accept-poor", "--grey", patch});
    ASSERT_EQ(r.exitCode, 0) << r.error;
    const json info = world.info("x.relamp");
    EXPECT_EQ(info["gauge"]["kind"], "known albedo");
    ASSERT_EQ(info["known_patches"].size(), 1u);
    EXPECT_FALSE(info["known_patches"][0]["doubtful"].get<bool>()) << info["known_patches"][0]["words"];
    for (size_t c = 0; c < 3; ++c)
        EXPECT_NEAR(info["known_patches"][0]["found"][c].get<double>() / double(told[int(c)]), 1, 0.06) << c;
}

TEST(LightReference, BadOnesAreRefusedBeforeAnythingIsComputed) {
    const OpenWorld world;
    const fs::path good = world.probe("good.exr", 0, 1);
    const std::string bytes = test::TemporaryFolder::read(good);
    world.folder.write("truncated.exr", bytes.substr(0, bytes.size() / 3));
    writeImage(world.folder / "square.exr", Image(64, 64, Rgb(1)));
    const auto expect = [&](int code, const std::vector<std::string>& more, const std::string& word) {
        const test::ProgramResult r = world.solve("x.relamp", more);
        EXPECT_EQ(r.exitCode, code) << r.error;
        EXPECT_NE(r.error.find(word), std::string::npos) << r.error;
        EXPECT_FALSE(fs::exists(world.folder / "x.relamp"));
    };
    expect(3, {"--light-probe", world.folder / "truncated.exr"}, "truncated.exr");
    expect(3, {"--light-probe", world.folder / "absent.exr"}, "absent.exr");
    expect(3, {"--light-probe", world.folder / "square.exr"}, "twice as wide as high");
    expect(3, {"--mirror-ball", "7"}, "view 7 does not exist");
    expect(3, {"--mirror-ball", (world.folder / "square.exr").string() + "@0"}, "the shape of view 0");
    expect(3, {"--mirror-ball", "0"}, "mirror ball in view 0");
    expect(3, {"--grey", "9:10,10,2"}, "view 9 does not exist");
    expect(3, {"--grey", "1:0.5,0.5,0"}, "no surface of the mesh is seen");
    expect(2, {"--mirror-ball", "ball"}, "--mirror-ball");
    expect(2, {"--mirror-ball", "0:1,2"}, "--mirror-ball");
    expect(2, {"--mirror-ball", "@0"}, "--mirror-ball");
    expect(2, {"--grey", "0:10,10"}, "--grey");
    expect(2, {"--grey", "10,10,2"}, "--grey");
    expect(2, {"--grey", "0:10,10,2=1.5"}, "--grey");
    expect(2, {"--chart", "0:10,10,20,10,20,20"}, "--chart");
    expect(2, {"--chart", "0:0,0,60,0,0,40,60,40"}, "no convex shape");
    // A probe is not written over.
    EXPECT_EQ(relamp({"solve", world.folder / "capture", "-o", good, "--light-probe", good, "--overwrite"}).exitCode,
              3);
}

}  // namespace
}  // namespace relamp
