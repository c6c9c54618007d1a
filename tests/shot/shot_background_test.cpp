#include <gtest/gtest.h>

#include <chrono>

#include "base/error.h"
#include "image/image_io.h"
#include "shot/shot_file.h"
#include "shot/shot_hash.h"
#include "shot/shot_leftovers.h"
#include "support/estimates.h"
#include "support/one_view_capture.h"
#include "support/temporary_folder.h"

namespace relamp {
namespace {

std::string errorOfOpening(const std::filesystem::path& shot) {
    Progress progress;
    try {
        openShot(shot, false, progress);
    } catch (const Error& error) { return error.what(); }
    return {};
}

TEST(ShotBackground, IsKeptBesideTheEnvironmentAndMayBeMissing) {
    test::TemporaryFolder folder;
    const Mesh mesh = test::sheet({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, 4, 4);
    test::writeOneViewCapture(folder, mesh);
    Shot shot;
    shot.captureFolder = folder / "capture";
    shot.estimate = test::matteEstimate(test::sceneOf(mesh), Rgb(0.5f), Rgb(1));
    shot.estimate.environmentSide = 256;  // as every solve has it
    shot.estimate.environment.assign(256 * 256, Rgb(1));
    Image seen(128, 64, Rgb(0.5f, 0.25f, 0.125f));
    seen.at(70, 20) = Rgb(3, 2, 1);
    shot.estimate.background = std::make_shared<const Panorama>(seen);
    const auto target = folder / "out.relamp", file = target / "environment_background.exr";
    saveShot(shot, mesh, target, false);
    EXPECT_TRUE(isPartOfShot("environment_background.exr") && isPartOfShot("environment-2_background.exr"));

    Progress progress;
    const std::shared_ptr<const Panorama> back = openShot(target, false, progress).estimate.background;
    ASSERT_TRUE(back);
    EXPECT_EQ(back->width(), 128);
    EXPECT_EQ(back->halves(), shot.estimate.background->halves());

    const std::string hash = shotHash(target), bytes = test::TemporaryFolder::read(file);
    folder.write("out.relamp/environment_background.exr", bytes.substr(0, bytes.size() / 2));
    EXPECT_NE(errorOfOpening(target).find("environment_background.exr"), std::string::npos) << errorOfOpening(target);
    writeImage(file, Image(64, 64));
    EXPECT_NE(errorOfOpening(target).find("environment_background.exr: is 64 x 64 pixels"), std::string::npos)
        << errorOfOpening(target);
    folder.write("out.relamp/environment_background.exr", bytes);
    const auto now = std::filesystem::file_time_type::clock::now();
    std::filesystem::last_write_time(target / "environment.exr", now + std::chrono::seconds(5));
    EXPECT_TRUE(openShot(target, false, progress).estimate.background) << "a copy of a shot has times of its own";
    writeImage(target / "environment.exr", Image(1024, 512, Rgb(7)));
    std::filesystem::last_write_time(target / "environment.exr", now + std::chrono::seconds(5));
    EXPECT_FALSE(openShot(target, false, progress).estimate.background) << "painted over: the environment is seen";
    std::filesystem::remove(file);
    EXPECT_FALSE(openShot(target, false, progress).estimate.background) << "shots of earlier versions have none";
    EXPECT_NE(shotHash(target), hash);
}

}  // namespace
}  // namespace relamp
