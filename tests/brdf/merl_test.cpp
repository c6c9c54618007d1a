#include "brdf/merl.h"

#include <gtest/gtest.h>

#include <cstring>
#include <functional>

#include "base/error.h"
#include "support/temporary_folder.h"

namespace relamp {
namespace {

constexpr size_t cells = 90 * 90 * 180;

Vec3 directionAt(double theta, double phi) {
    return Vec3(float(std::sin(theta) * std::cos(phi)), float(std::sin(theta) * std::sin(phi)), float(std::cos(theta)));
}

/// A file whose cells hold value(channel, half, difference, azimuth), stored as MERL stores them.
std::string merlBytes(const std::function<double(int, int, int, int)>& value) {
    std::string bytes(12 + cells * 24, '\0');
    const int32_t counts[3] = {90, 90, 180};
    std::memcpy(bytes.data(), counts, 12);
    const double scale[3] = {1500, 1500 / 1.15, 1500 / 1.66};
    size_t at = 12;
    for (int c = 0; c < 3; ++c)
        for (int h = 0; h < 90; ++h)
            for (int d = 0; d < 90; ++d)
                for (int a = 0; a < 180; ++a, at += 8) {
                    const double cell = value(c, h, d, a) * scale[c];
                    std::memcpy(&bytes[at], &cell, 8);
                }
    return bytes;
}

TEST(HalfAngles, AreThoseWorkedOutByHand) {
    // Light 60 degrees to one side, eye on the normal: the half vector leans 30 degrees, and so does the light from it.
    const HalfAngles a = halfAngles(directionAt(piD / 3, 0), Vec3(0, 0, 1));
    EXPECT_NEAR(a.half, piD / 6, 1e-6);
    EXPECT_NEAR(a.difference, piD / 6, 1e-6);
    EXPECT_NEAR(a.azimuth, 0, 1e-6);
    // Mirror pair: the half vector is the normal.
    const HalfAngles m = halfAngles(directionAt(0.7, 0.3), directionAt(0.7, 0.3 + piD));
    EXPECT_NEAR(m.half, 0, 1e-6);
    EXPECT_NEAR(m.difference, 0.7, 1e-6);
    // Light and eye side by side about a half vector that leans along x: the difference stands across.
    const HalfAngles s = halfAngles(glm::normalize(Vec3(0.5f, 0.5f, 1)), glm::normalize(Vec3(0.5f, -0.5f, 1)));
    EXPECT_NEAR(s.half, std::atan(0.5), 1e-6);
    EXPECT_NEAR(s.azimuth, piD / 2, 1e-6);
    EXPECT_NEAR(s.difference, std::asin(0.5 / std::sqrt(1.5)), 1e-6);
}

TEST(HalfAngles, AreTheSameWhenTheTwoAreExchangedTurnedOrMirrored) {
    for (int i = 0; i < 40; ++i) {
        const double t1 = 0.1 + 0.03 * i, p1 = 0.7 * i, t2 = 1.3 - 0.02 * i, p2 = 2.1 * i + 0.4;
        const HalfAngles a = halfAngles(directionAt(t1, p1), directionAt(t2, p2)),
                         b = halfAngles(directionAt(t2, p2), directionAt(t1, p1));
        const HalfAngles turned = halfAngles(directionAt(t1, p1 + 1), directionAt(t2, p2 + 1)),
                         mirrored = halfAngles(directionAt(t1, -p1), directionAt(t2, -p2));
        for (const HalfAngles& other : {b, turned, mirrored}) {
            EXPECT_NEAR(other.half, a.half, 1e-6);
            EXPECT_NEAR(other.difference, a.difference, 1e-6);
        }
        EXPECT_NEAR(std::abs(std::sin(b.azimuth - a.azimuth)), 0, 1e-5);
        EXPECT_NEAR(std::abs(std::sin(turned.azimuth - a.azimuth)), 0, 1e-5);
        EXPECT_NEAR(std::abs(std::sin(mirrored.azimuth + a.azimuth)), 0, 1e-5);
        EXPECT_GE(a.azimuth, 0);
        EXPECT_LT(a.azimuth, piD);
    }
}

class Merl : public testing::Test {
protected:
    MeasuredBrdf read(const std::string& bytes) { return readMerl(folder.write("paint.binary", bytes)); }
    std::string error(const std::string& bytes) {
        return test::messageOf([&] { read(bytes); });
    }
    std::string file() { return (folder / "paint.binary").string(); }
    test::TemporaryFolder folder;
};

TEST_F(Merl, CellsLieWhereTheFormatPutsThemAndChannelsAreScaled) {
    const MeasuredBrdf brdf =
        read(merlBytes([](int c, int h, int d, int a) { return c + 1 + 0.01 * h + 0.0001 * d + 0.000001 * a; }));
    EXPECT_EQ(brdf.name, "paint");
    EXPECT_EQ(brdf.missing, 0u);
    EXPECT_NEAR(brdf.cells[MeasuredBrdf::index(3, 5, 7)].x, 1.030507f, 1e-6);
    EXPECT_NEAR(brdf.cells[MeasuredBrdf::index(3, 5, 7)].y, 2.030507f, 1e-6);
    EXPECT_NEAR(brdf.cells[MeasuredBrdf::index(3, 5, 7)].z, 3.030507f, 1e-6);
    EXPECT_EQ(MeasuredBrdf::index(1, 0, 0), 90u * 180u);
    EXPECT_EQ(MeasuredBrdf::index(0, 1, 1), 181u);
}

TEST_F(Merl, LooksUpBetweenTheCells) {
    // Linear in the place along each axis, so interpolation is exact.
    const MeasuredBrdf brdf = read(merlBytes([](int, int h, int d, int) { return 1 + h + 0.01 * d; }));
    for (const auto& [l, e] :
         {std::pair{directionAt(0.5, 0.2), directionAt(0.3, 1.9)},
          std::pair{directionAt(1.1, 0), directionAt(0.2, 0.1)}, std::pair{Vec3(0, 0, 1), directionAt(0.9, 2)}}) {
        const HalfAngles a = halfAngles(l, e);
        const double expected = 1 + 90 * std::sqrt(a.half / (piD / 2)) + 0.01 * 90 * a.difference / (piD / 2);
        EXPECT_NEAR(brdf.evaluate(l, e).x, expected, 1e-4 * expected);
        EXPECT_NEAR(brdf.evaluate(l, e).x, brdf.evaluate(e, l).x, 1e-4 * expected);
    }
    EXPECT_EQ(brdf.evaluate({0, 0, -1}, {0, 0, 1}), Rgb(0));
    EXPECT_EQ(brdf.evaluate({0, 0, 1}, {1, 0, 0}), Rgb(0));
}

TEST_F(Merl, TheAzimuthGoesRound) {
    // Half a turn is the whole: the last cell's neighbour is the first.
    const MeasuredBrdf brdf = read(merlBytes([](int, int, int, int a) { return a == 0 ? 10 : a == 179 ? 20 : 1; }));
    // Half vector along x by 0.5, difference at an azimuth of 179.5 cells.
    const double azimuth = 179.5 / 180 * piD;
    const Vec3 h = directionAt(0.5, 0);
    const Vec3 across(0, 1, 0), along = glm::cross(across, h);
    const Vec3 side = along * float(std::cos(azimuth)) + across * float(std::sin(azimuth));
    const Vec3 light = h * std::cos(0.4f) + side * std::sin(0.4f), eye = h * std::cos(0.4f) - side * std::sin(0.4f);
    EXPECT_NEAR(brdf.evaluate(light, eye).x, 15, 0.01);
}

TEST_F(Merl, CellsWithoutAMeasurementAreLeftOut) {
    const MeasuredBrdf brdf = read(merlBytes([](int, int h, int d, int) { return h < 45 ? (d < 60 ? 0.5 : -1) : 2; }));
    EXPECT_EQ(brdf.missing, 45u * 30u * 180u);
    // Beside the border the known cells alone speak; beyond it nothing does.
    const double border = 59.6 / 90 * piD / 2, beyond = 70.0 / 90 * piD / 2;
    EXPECT_NEAR(brdf.evaluate(directionAt(border, 0), directionAt(border, piD)).x, 0.5f, 1e-5);
    EXPECT_EQ(brdf.evaluate(directionAt(beyond, 0), directionAt(beyond, piD)), Rgb(0));
}

TEST_F(Merl, BadFilesAreNamedWithWhatIsWrong) {
    EXPECT_EQ(error("short"), file() + ": is 5 bytes long, a MERL file has 34992012");
    EXPECT_EQ(test::messageOf([&] { readMerl(folder / "none.binary"); }),
              (folder / "none.binary").string() + ": cannot be read");
    std::string bytes = merlBytes([](int, int, int, int) { return 0.5; });
    const int32_t huge = 1 << 30;
    std::memcpy(bytes.data() + 4, &huge, 4);
    EXPECT_EQ(error(bytes), file() + ": its first numbers are 90 1073741824 180, expected 90 90 180");
    bytes = merlBytes([](int c, int h, int, int) { return c == 1 && h == 2 ? std::nan("") : 0.5; });
    EXPECT_EQ(error(bytes), file() + ": cell 32400 of channel 1 is nan, expected a finite number");
    EXPECT_EQ(error(merlBytes([](int, int, int, int) { return -1.0; })),
              file() + ": holds no measurement, every cell is negative");
}

}  // namespace
}  // namespace relamp
