// Frames of a plate that cannot be used, among good ones.
#include <gtest/gtest.h>

#include "plate/plate_file.h"
#include "plate/plate_world.h"

namespace relamp {
namespace {

using test::PlateWorld;
using test::Relighting;
using test::TemporaryFolder;

bool names(const std::vector<std::string>& sentences, const std::string& words) {
    return std::any_of(sentences.begin(), sentences.end(),
                       [&](const std::string& one) { return one.find(words) != std::string::npos; });
}

TEST(PlateFaults, FramesThatCannotBeReadAreLeftOutOfTheColourMatching) {
    const PlateWorld world;
    const TemporaryFolder folder;
    PlateRequest request = world.writePlate(folder, std::vector<Rgb>(5, Rgb(1.2f, 1, 0.9f)));
    for (int i = 0; i < 5; ++i)
        writeImage(folder / fmt::format("matte.{}.exr", 1001 + i), Image(i == 1 ? 32 : 64, i == 1 ? 24 : 48));
    request.matte = folder / "matte.####.exr";
    writeImage(folder / "plate.1003.exr", Image(32, 24));
    const std::string whole = TemporaryFolder::read(folder / "plate.1004.exr");
    folder.write("plate.1004.exr", whole.substr(0, whole.size() / 2));
    Relighting run(world, request, PlateWorld::dimmed());
    EXPECT_NEAR(run.relighter.gains().at(1001).x, 1.2f, 0.01f);
    EXPECT_NEAR(run.relighter.gains().at(1005).z, 0.9f, 0.01f);
    const std::vector<std::string>& faults = run.relighter.gains().faults;
    EXPECT_EQ(faults.size(), 3u);
    for (const char* file : {"matte.1002.exr", "plate.1003.exr", "plate.1004.exr"}) EXPECT_TRUE(names(faults, file));
    // They alone cannot be relit.
    for (const size_t bad : {1, 2, 3}) EXPECT_THROW(run.relighter.relit(bad, run.progress), Error);
    for (const size_t good : {0, 4}) EXPECT_EQ(run.relighter.relit(good, run.progress).image.width, 64) << good;
}

TEST(PlateFaults, TheSizeIsThatOfMostFrames) {
    const PlateWorld world(4);
    const TemporaryFolder folder;
    const PlateRequest request = world.writePlate(folder);
    Progress progress;
    writeImage(folder / "plate.1001.exr", Image(32, 24));
    EXPECT_EQ(openPlate(world.shot.capture, request, progress).frames.at(2).camera.width, 64);
    folder.write("plate.1001.exr", "");
    EXPECT_EQ(openPlate(world.shot.capture, request, progress).frames.at(2).camera.width, 64);
    for (int i = 1; i < 4; ++i) folder.write(fmt::format("plate.{}.exr", 1001 + i), "");
    EXPECT_THROW(openPlate(world.shot.capture, request, progress), Error);
}

TEST(PlateFaults, AFrameIsNotThereWithoutTheLightOfItsMatte) {
    const PlateWorld world(1);
    const TemporaryFolder folder;
    RelitPlate relit;
    relit.image = Image(64, 48, Rgb(0.5f));
    relit.matteLight.emplace();
    const RelitScene scene = world.relit({});
    FrameSources sources;
    sources.look = &scene;
    Progress progress;
    const PlateFrame frame{1001, {}, {}, world.cameras[0]};
    const auto write = [&] { writePlateFrame(folder / "relit.exr", frame, relit, sources, {}, {}, progress); };
    std::filesystem::create_directories(folder / "relit.light.json");
    EXPECT_THROW(write(), Error);
    EXPECT_FALSE(std::filesystem::exists(folder / "relit.exr"));
    std::filesystem::remove(folder / "relit.light.json");
    write();
    EXPECT_TRUE(std::filesystem::exists(folder / "relit.exr"));
    EXPECT_NE(TemporaryFolder::read(plateLightFile(folder / "relit.exr")).find("\"frame\": 1001"), std::string::npos);
}

TEST(PlateFaults, ATrackThatGoesOnBeyondThePlateIsSaidOnce) {
    const PlateWorld world(8);
    const TemporaryFolder folder;
    const PlateRequest request = world.writePlate(folder);
    for (const int gone : {1001, 1007, 1008}) std::filesystem::remove(folder / fmt::format("plate.{}.exr", gone));
    Progress progress;
    const Plate plate = openPlate(world.shot.capture, request, progress);
    EXPECT_EQ(plate.frames.size(), 5u);
    EXPECT_TRUE(plate.faults.empty()) << "nothing is lacking";
    ASSERT_EQ(plate.notes.size(), 1u);
    EXPECT_TRUE(names(plate.notes, "frames 1001, 1007 to 1008, which have no plate")) << plate.notes[0];
    // A frame that is missing in between is lacking, and not said again.
    std::filesystem::remove(folder / "plate.1004.exr");
    const Plate gap = openPlate(world.shot.capture, request, progress);
    ASSERT_EQ(gap.faults.size(), 1u);
    ASSERT_EQ(gap.notes.size(), 1u);
    EXPECT_TRUE(names(gap.notes, "frames 1001, 1007 to 1008, which have no plate")) << gap.notes[0];
}

}  // namespace
}  // namespace relamp
