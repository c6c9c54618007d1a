// A made capture whose cameras the tests write in other programs' formats, and the pixels that they must give. Nothing
// here uses the lenses of the core: projection is computed from the published formula of OpenCV's lens.
#pragma once
#include <gtest/gtest.h>

#include <random>

#include "capture/capture_formats.h"
#include "capture/capture_source.h"
#include "image/image_io.h"
#include "support/temporary_folder.h"

namespace relamp::test {

/// Image axes in the world, and where the camera stands.
struct ForeignShot {
    std::string name;
    DVec3 right, down, ahead, position;
};

/// Pixels and OpenCV's coefficients; the first pixel's centre is (0.5, 0.5).
struct ForeignLens {
    double f = 1234.5, fy = 1234.5, cx = 803.25, cy = 596.5;
    double k1 = 0, k2 = 0, k3 = 0, k4 = 0, p1 = 0, p2 = 0;
    double skew = 0;           ///< pixels that x grows by for y' of 1
    bool equidistant = false;  ///< the distortion is that of a fisheye's plane: the angle, in place of its tangent
};

constexpr int foreignWidth = 1600, foreignHeight = 1200;

/// Five cameras around the origin, each held a little askew, so that no sign can be wrong unseen.
inline std::vector<ForeignShot> foreignShots() {
    std::vector<ForeignShot> shots;
    for (int i = 0; i < 5; ++i) {
        const double angle = 0.4 + 1.1 * i, height = 0.5 + 0.4 * i;
        ForeignShot shot;
        shot.name = "img_" + std::to_string(i) + ".png";
        shot.position = DVec3(4 * std::cos(angle), 4 * std::sin(angle), height);
        shot.ahead = glm::normalize(DVec3(0.1, -0.2, 0.3) - shot.position);
        const DVec3 level = glm::normalize(glm::cross(shot.ahead, DVec3(0, 0, 1)));
        const DVec3 below = glm::cross(shot.ahead, level);
        const double roll = 0.05 * (i + 1);
        shot.right = level * std::cos(roll) + below * std::sin(roll);
        shot.down = glm::cross(shot.ahead, shot.right);
        shots.push_back(shot);
    }
    return shots;
}

inline glm::dvec2 expectedPixel(const ForeignShot& shot, const ForeignLens& lens, const DVec3& world) {
    const DVec3 d = world - shot.position;
    const double z = glm::dot(shot.ahead, d), slope = glm::length(d - z * shot.ahead) / z;
    const double plane = lens.equidistant && slope > 0 ? std::atan(slope) / slope : 1;
    const double x = plane * glm::dot(shot.right, d) / z, y = plane * glm::dot(shot.down, d) / z;
    const double r2 = x * x + y * y;
    const double radial =
        1 + lens.k1 * r2 + lens.k2 * std::pow(r2, 2) + lens.k3 * std::pow(r2, 3) + lens.k4 * std::pow(r2, 4);
    const double xd = x * radial + 2 * lens.p1 * x * y + lens.p2 * (r2 + 2 * x * x);
    const double yd = y * radial + lens.p1 * (r2 + 2 * y * y) + 2 * lens.p2 * x * y;
    return {lens.f * xd + lens.skew * yd + lens.cx, lens.fy * yd + lens.cy};
}

/// A capture folder with photographs of the right size and a mesh.
class ForeignCapture : public testing::Test {
protected:
    void SetUp() override {
        folder.write("mesh.obj", "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nf 1 2 3\n");
        std::filesystem::create_directories(folder / "images");
        writeImage(folder / "images/img_0.png", Image(foreignWidth, foreignHeight, Rgb(0.5f)));
        for (const ForeignShot& shot : shots)
            if (shot.name != "img_0.png")
                std::filesystem::copy_file(folder / "images/img_0.png", folder / ("images/" + shot.name));
    }
    CaptureSource read() {
        Progress progress;
        return captureSource(folder.path(), {}, progress);
    }
    std::string error() {
        return messageOf([&] { read(); });
    }
    /// The largest distance in pixels between what is read and what must be; `turn` takes the files' world to the one
    /// that cameras are read in.
    double worstPixel(const CaptureSource& source, const ForeignLens& lens, const glm::dmat3& turn = glm::dmat3(1.0)) {
        double worst = 0;
        EXPECT_EQ(source.frames.size(), shots.size());
        if (source.frames.size() != shots.size()) return 1e9;
        std::mt19937 random(7);
        std::uniform_real_distribution<double> uniform(-1, 1);
        for (size_t i = 0; i < shots.size(); ++i) {
            const FrameSource& frame = source.frames[i];
            EXPECT_TRUE(std::filesystem::is_regular_file(frame.file)) << frame.file;
            EXPECT_EQ(frame.file.filename(), shots[i].name);
            EXPECT_EQ(frame.camera.width, foreignWidth);
            EXPECT_EQ(frame.camera.height, foreignHeight);
            size_t inside = 0;
            for (int k = 0; k < 400; ++k) {
                const DVec3 world(2 * uniform(random), 2 * uniform(random), 2 * uniform(random));
                const glm::dvec2 wanted = expectedPixel(shots[i], lens, world);
                if (!(wanted.x > 0 && wanted.x < foreignWidth && wanted.y > 0 && wanted.y < foreignHeight)) continue;
                const auto pixel = frame.camera.projectByFormula(turn * world);
                EXPECT_TRUE(pixel);
                if (!pixel) continue;
                ++inside;
                worst = std::max(worst, glm::distance(*pixel, wanted));
            }
            EXPECT_GT(inside, 50u);
        }
        RecordProperty("worst_pixel", std::to_string(worst));
        return worst;
    }
    static bool holds(const std::vector<std::string>& notes, const std::string& part) {
        return std::any_of(notes.begin(), notes.end(),
                           [&](const std::string& note) { return note.find(part) != std::string::npos; });
    }
    TemporaryFolder folder;
    std::vector<ForeignShot> shots = foreignShots();
};

}  // namespace relamp::test
