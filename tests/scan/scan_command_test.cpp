// `relamp scan` as a user runs it, on photographs of the made scene.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "capture/load_capture.h"
#include "scan/painted_scan.h"
#include "support/temporary_folder.h"
#include "whole/relamp_program.h"

namespace relamp {
namespace {

namespace fs = std::filesystem;

nlohmann::json calibrationJson(const ScanCalibration& calibration) {
    nlohmann::json views = nlohmann::json::array();
    for (const ScanCamera& scan : calibration.cameras) {
        const Camera& c = scan.camera;
        const glm::dmat3 axes(c.worldFromCamera);
        nlohmann::json rows = nlohmann::json::array(), shift = nlohmann::json::array();
        for (int r = 0; r < 3; ++r) {
            const DVec3 axis = r == 0 ? axes[r] : -axes[r];
            rows.push_back({axis.x, axis.y, axis.z});
            shift.push_back(-glm::dot(axis, c.position()) * 1000);
        }
        views.push_back({{"name", scan.name},
                         {"image", scan.name + "/00.png"},
                         {"width", c.width},
                         {"height", c.height},
                         {"K", {{c.focalX, 0, c.centreX - 0.5}, {0, c.focalY, c.centreY - 0.5}, {0, 0, 1}}},
                         {"R", rows},
                         {"t", shift}});
    }
    return {{"units", "millimetre"}, {"views", views}};
}

TEST(ScanCommand, PhotographsBecomeACaptureThatOthersRead) {
    const test::TemporaryFolder folder;
    const test::PaintedScan scene;
    const ScanInput input = scene.input();
    const fs::path source = folder / "scan", out = folder / "capture";
    for (size_t c = 0; c < input.size(); ++c) {
        fs::create_directories(source / scene.calibration.cameras[c].name);
        for (size_t place = 0; place < input[c].there.size(); ++place) {
            const GreyImage grey = input[c].read(place);
            Image image(grey.width, grey.height);
            for (size_t i = 0; i < image.pixels.size(); ++i) image.pixels[i] = Rgb(grey.values[i]);
            writeImage(source / scene.calibration.cameras[c].name / fmt::format("{:02}.png", place), image);
        }
    }
    folder.write("scan/cameras.json", calibrationJson(scene.calibration).dump());
    const auto scan = [&](std::vector<std::string> more) {
        std::vector<std::string> words{"scan", source.string(), "--bits", "7,6"};
        words.insert(words.end(), more.begin(), more.end());
        return test::relamp(words);
    };

    const test::ProgramResult done = scan({"-o", out.string(), "--json"});
    ASSERT_EQ(done.exitCode, 0) << done.error;
    const auto report = nlohmann::json::parse(done.out);
    EXPECT_EQ(report, nlohmann::json::parse(test::TemporaryFolder::read(out / "scan.json")));
    EXPECT_EQ(report["projector"]["from"], "resection");
    EXPECT_EQ(report["up"], "y");
    // Y up became Z up: the wall is y = 0, before it is -y.
    const DVec3 truth = scene.projector.position();
    EXPECT_NEAR(report["projector"]["position"][0].get<double>(), truth.x, 0.03);
    EXPECT_NEAR(report["projector"]["position"][1].get<double>(), -truth.z, 0.03);
    EXPECT_NEAR(report["projector"]["position"][2].get<double>(), truth.y, 0.03);

    // The projector that was found is what a scan by one camera takes.
    nlohmann::json one = calibrationJson(scene.calibration);
    one["views"].erase(1);
    one["projector"] = report["projector"]["calibration"];
    for (auto& shift : one["projector"]["t"]) shift = shift.get<double>() * 1000;
    const fs::path calibration = folder.write("scan/one.json", one.dump());
    const test::ProgramResult alone =
        scan({"-o", (folder / "one").string(), "--cameras", calibration.string(), "--json"});
    ASSERT_EQ(alone.exitCode, 0) << alone.error;
    EXPECT_GT(nlohmann::json::parse(alone.out)["cameras"][0]["coverage"].get<double>(), 0.75);

    Progress progress;
    const Capture capture = loadCapture(out, {}, progress);
    ASSERT_EQ(capture.views.size(), 2u);
    EXPECT_GT(capture.mesh.triangles.size(), 5000u);
    EXPECT_FALSE(capture.views[0].image.usable.empty());
    const Vec3 inFiles = glm::transpose(capture.worldFromFile) * capture.mesh.positions[100];
    EXPECT_LT(scene.offSurface(DVec3(inFiles)), 0.005);
    EXPECT_EQ(test::relamp({"check", out.string()}).exitCode, 0);

    const std::string white = test::TemporaryFolder::read(source / "left/00.png");
    EXPECT_EQ(test::TemporaryFolder::read(out / "images/left.png"), white);
    const test::ProgramResult again = scan({"-o", out.string()});
    EXPECT_EQ(again.exitCode, 3);
    EXPECT_NE(again.error.find("--overwrite"), std::string::npos) << again.error;
    EXPECT_EQ(scan({"-o", out.string(), "--overwrite"}).exitCode, 0);
    EXPECT_EQ(scan({"-o", out.string(), "--bits", "7"}).exitCode, 2);
    EXPECT_EQ(scan({"-o", out.string(), "--projector-size", "wide"}).exitCode, 2);
    EXPECT_EQ(scan({}).exitCode, 2);
    // Another name of a photograph stands where the capture's would be written.
    fs::create_directories(folder / "trap/images");
    fs::create_hard_link(source / "left/00.png", folder / "trap/images/left.png");
    const test::ProgramResult trap = scan({"-o", (folder / "trap").string(), "--overwrite"});
    EXPECT_EQ(trap.exitCode, 3) << trap.out;
    EXPECT_NE(trap.error.find("left.png"), std::string::npos) << trap.error;
    EXPECT_EQ(test::TemporaryFolder::read(source / "left/00.png"), white);
}

}  // namespace
}  // namespace relamp
