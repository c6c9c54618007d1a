#include "viewport/display_transform.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "base/error.h"
#include "image/image_io.h"

namespace relamp::ui {
namespace {

float shown(const DisplayTransform& t, const std::string& view, float value, float stops = 0) {
    Rgb c(value);
    t.apply(view, stops, &c, 1);
    return c.y;
}

TEST(DisplayTransform, BuiltInViewsGiveTheirPublishedValues) {
    const DisplayTransform t("");
    ASSERT_EQ(t.views(), (std::vector<std::string>{"Standard", "Soft highlights", "ACES 1.0 SDR", "Raw"}));
    EXPECT_EQ(t.source(), "built in");
    EXPECT_NEAR(shown(t, "Standard", 0.18f), 0.4614f, 1e-3f);
    EXPECT_NEAR(shown(t, "Standard", 1), 1, 1e-3f);
    EXPECT_NEAR(shown(t, "Standard", 8), 2.45f, 0.01f);  // not clamped
    EXPECT_NEAR(shown(t, "ACES 1.0 SDR", 0.18f), 0.3560f, 2e-3f);
    EXPECT_NEAR(shown(t, "ACES 1.0 SDR", 8), 0.9844f, 2e-3f);
    EXPECT_EQ(shown(t, "Raw", 3), 3);
}

TEST(DisplayTransform, SoftHighlightsKeepHueAndNeverClip) {
    const DisplayTransform t("");
    for (const float value : {0.02f, 0.18f, 0.5f})
        EXPECT_NEAR(shown(t, "Soft highlights", value), shown(t, "Standard", value), 0.01f) << value;
    float last = 0;
    for (float value = 0.1f; value < 100; value *= 1.1f) {
        const float now = shown(t, "Soft highlights", value);
        EXPECT_GT(now, last - 1e-4f) << value;
        EXPECT_LE(now, 1.005f) << value;
        last = now;
    }
    EXPECT_GT(last, 0.98f);
    // A warm light stays as warm as it is, however bright: ratios of linear display values.
    const auto linear = [](float v) { return srgbDecode(v); };
    for (const float brightness : {0.3f, 3.0f, 30.0f}) {
        Rgb c = brightness * Rgb(1, 0.65f, 0.33f);
        t.apply("Soft highlights", 0, &c, 1);
        EXPECT_NEAR(linear(c.y) / linear(c.x), 0.65f, 0.01f) << brightness;
        EXPECT_NEAR(linear(c.z) / linear(c.x), 0.33f, 0.01f) << brightness;
    }
}

TEST(DisplayTransform, ExposureComesFirstAndUnknownViewsFallBack) {
    const DisplayTransform t("");
    EXPECT_NEAR(shown(t, "Standard", 0.09f, 1), shown(t, "Standard", 0.18f), 1e-5f);
    EXPECT_NEAR(shown(t, "no such view", 0.18f), shown(t, t.defaultView(), 0.18f), 1e-6f);
}

TEST(DisplayTransform, EveryViewHasAShaderOfTheAgreedName) {
    const DisplayTransform t("");
    for (const std::string& view : t.views())
        EXPECT_NE(t.shader(view).source.find("vec4 displayTransform("), std::string::npos) << view;
}

TEST(DisplayTransform, AConfigurationThatCannotBeReadNamesItself) {
    const auto file = std::filesystem::temp_directory_path() / "relamp_broken.ocio";
    std::ofstream(file) << "ocio_profile_version: 2\nthis is: [not one\n";
    try {
        const DisplayTransform t(file.string());
        FAIL() << "accepted";
    } catch (const Error& error) {
        EXPECT_NE(std::string(error.what()).find("relamp_broken.ocio"), std::string::npos) << error.what();
    }
    std::filesystem::remove(file);
    EXPECT_THROW(DisplayTransform("/nowhere/config.ocio"), Error);
}

TEST(FalseColour, BandsAreOneStopWideAboutMiddleGrey) {
    EXPECT_EQ(falseColour(0.18f), falseColour(0.18f * 1.35f));
    EXPECT_NE(falseColour(0.18f), falseColour(0.18f * 1.5f));
    EXPECT_EQ(falseColour(0.18f * 64), Rgb(1));
    EXPECT_EQ(falseColour(1e9f), Rgb(1));
    EXPECT_EQ(falseColour(0), falseColour(-1));
}

}  // namespace
}  // namespace relamp::ui
