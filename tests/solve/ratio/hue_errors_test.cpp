// A red emitter before white light from afar.
#include "solve/ratio/hue_errors.h"

#include <gtest/gtest.h>

namespace relamp {
namespace {

/// One leaf and two emitters; the first row has the leaf alone, the second all of them.
struct Lights {
    InfluenceMatrix rows;
    std::array<Eigen::VectorXd, 3> light;
    std::array<Eigen::VectorXf, 3> irradiance;

    Lights(const Rgb& sky, const Rgb& first, const Rgb& second) {
        rows.rows = 2;
        rows.columns = 3;
        rows.values = {1, 0, 0, 1, 0.1f, 0.2f};
        for (size_t c = 0; c < 3; ++c) {
            const int channel = int(c);
            light[c] = Eigen::Vector3d(sky[channel], first[channel], second[channel]);
            irradiance[c] =
                Eigen::Vector2f(sky[channel], sky[channel] + 0.1f * first[channel] + 0.2f * second[channel]);
        }
    }
    std::vector<std::array<float, 6>> errors(float error) const { return hueErrors(rows, 1, light, irradiance, error); }
};

TEST(HueErrors, LightOfOneHueErrsInBrightnessAlone) {
    for (const auto& row : Lights(Rgb(1, 0.8f, 0.5f), Rgb(10, 8, 5), Rgb(0)).errors(0.03f))
        for (const float s : row) EXPECT_NEAR(s, 0, 1e-9);
}

TEST(HueErrors, ARedEmitterThatIsTooStrongMakesThePointRedder) {
    // It gives half of the red and none of the rest: 1/3, -1/6, -1/6 beside the common part.
    const auto errors = Lights(Rgb(1), Rgb(10, 0, 0), Rgb(0)).errors(0.03f);
    for (const float s : errors[0]) EXPECT_EQ(s, 0);
    const float unit = 2 * 0.03f * 0.03f;  // the emitter's error, and that of all other light
    const float expected[6] = {1 / 9.0f, 1 / 36.0f, 1 / 36.0f, -1 / 18.0f, -1 / 18.0f, 1 / 36.0f};
    for (size_t b = 0; b < 6; ++b) EXPECT_NEAR(errors[1][b], unit * expected[b], 1e-7f);
}

TEST(HueErrors, EmittersErrOnTheirOwn) {
    // Two that make up for each other's hue: together white, each of them coloured.
    const auto errors = Lights(Rgb(1), Rgb(5, 0, 0), Rgb(0, 2.5f, 2.5f)).errors(0.03f);
    EXPECT_GT(errors[1][0], 1e-5f);
}

}  // namespace
}  // namespace relamp
