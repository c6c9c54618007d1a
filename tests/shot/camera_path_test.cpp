#include "shot/camera_path.h"

#include <gtest/gtest.h>

#include "shot/frame_jobs.h"
#include "support/estimates.h"
#include "support/temporary_folder.h"

namespace relamp {
namespace {

/// Four views from the south, east, north and west that look at (1, 2, 0.5).
Capture fourViews() {
    Capture capture;
    const DVec3 centre(1, 2, 0.5);
    for (const DVec3& away : {DVec3(0, -3, 1), DVec3(3, 0, 1), DVec3(0, 3, 1), DVec3(-3, 0, 1)}) {
        View view;
        view.camera = test::cameraAt(centre + away, centre, 40, 30, 50);
        capture.views.push_back(view);
    }
    capture.views[2].camera.focalX = 80;
    return capture;
}

void expectNear(const DVec3& a, const DVec3& b, double within = 1e-9) {
    EXPECT_LT(glm::distance(a, b), within) << a.x << " " << a.y << " " << a.z;
}

TEST(CameraPath, TurntableGoesRoundWhatTheViewsLookAt) {
    const std::vector<Camera> cameras = cameraPath(fourViews(), "turntable:4");
    ASSERT_EQ(cameras.size(), 4u);
    const Capture capture = fourViews();
    for (size_t i = 0; i < 4; ++i) {
        expectNear(cameras[i].position(), capture.views[i].camera.position());
        expectNear(cameras[i].forward(), capture.views[i].camera.forward());
        EXPECT_EQ(cameras[i].focalX, 50);
    }
}

TEST(CameraPath, SplineGoesThroughTheViews) {
    const Capture capture = fourViews();
    const std::vector<Camera> cameras = cameraPath(capture, "path:0,1,2:9");
    ASSERT_EQ(cameras.size(), 9u);
    for (const auto& [frame, view] : std::vector<std::pair<size_t, size_t>>{{0, 0}, {4, 1}, {8, 2}}) {
        expectNear(cameras[frame].position(), capture.views[view].camera.position());
        expectNear(cameras[frame].forward(), capture.views[view].camera.forward());
        EXPECT_DOUBLE_EQ(cameras[frame].focalX, capture.views[view].camera.focalX);
    }
    EXPECT_NEAR(cameras[6].focalX, 65, 1e-9);
    for (const Camera& camera : cameras) EXPECT_NEAR(glm::determinant(glm::dmat3(camera.worldFromCamera)), 1, 1e-9);
    EXPECT_EQ(cameraPath(capture, "path:1:3")[2].position(), capture.views[1].camera.position());
}

TEST(CameraPath, RefusesWhatItCannotMean) {
    for (const char* text : {"turntable:", "turntable:0", "turntable:x", "turntable:99999999", "path:0,1", "path::5",
                             "path:0,9:5", "path:0,,1:5", "path:0,1:0"})
        EXPECT_EQ(test::messageOf([&] { cameraPath(fourViews(), text); }).substr(0, 8), "--camera") << text;
    EXPECT_FALSE(isCameraPath("camera.json"));
}

TEST(CameraPath, OfAFileIsASequenceOfItsFrames) {
    const test::TemporaryFolder folder;
    const auto file = folder.write("path.json", R"({"w": 64, "h": 48, "fl_x": 70, "frames": [
        {"transform_matrix": [[1,0,0,0],[0,1,0,0],[0,0,1,9],[0,0,0,1]]},
        {"fl_x": 90, "transform_matrix": [[1,0,0,0],[0,1,0,0],[0,0,1,7],[0,0,0,1]]}]})");
    const auto jobs = frameJobs(fourViews(), file.string(), "", "", "f.##.exr");
    ASSERT_EQ(jobs.size(), 2u);
    EXPECT_EQ(jobs[1].file, "f.02.exr");
    EXPECT_EQ(jobs[1].number, 2);
    EXPECT_EQ(jobs[1].view, -1);
    EXPECT_EQ(jobs[1].camera.focalX, 90);
    expectNear(jobs[1].camera.position(), DVec3(0, 0, 7));
    EXPECT_EQ(frameJobs(fourViews(), file.string(), "2-5", "", "f.##.exr").size(), 1u);
    folder.write("path.json", R"({"w": 64, "h": 48, "fl_x": 70, "frames": [{"transform_matrix": 3}]})");
    const std::string message = test::messageOf([&] { frameJobs(fourViews(), file.string(), "", "", "f.##.exr"); });
    EXPECT_NE(message.find("path.json"), std::string::npos) << message;
    EXPECT_NE(message.find("transform_matrix"), std::string::npos) << message;
    folder.write("path.json", R"({"w": 64, "h": 48, "fl_x": 70, "frames": []})");
    EXPECT_NE(test::messageOf([&] { frameJobs(fourViews(), file.string(), "", "", "f.##.exr"); }).find("frames"),
              std::string::npos);
}

TEST(CameraPath, MakesNumberedFramesOfWhichARangeCanBeChosen) {
    const auto jobs = frameJobs(fourViews(), "turntable:12", "3-4,40", "80x60", "out/t.%03d.png");
    ASSERT_EQ(jobs.size(), 2u);
    EXPECT_EQ(jobs[0].file, "out/t.003.png");
    EXPECT_TRUE(jobs[0].resized);
    EXPECT_EQ(jobs[0].camera.width, 80);
    EXPECT_NE(test::messageOf([&] { frameJobs(fourViews(), "turntable:12", "", "", "t.png"); }), "");
    EXPECT_EQ(frameJobs(fourViews(), "all", "2", "", "f.#.exr")[0].view, 1);
}

}  // namespace
}  // namespace relamp
