#include "relight/ies_profile.h"

#include <gtest/gtest.h>

#include "base/error.h"

namespace relamp {
namespace {

std::string head(const std::string& rest) {
    return "IESNA:LM-63-2002\n[TEST] 1\n[LUMINAIRE] Down light\nTILT=NONE\n" + rest;
}

/// Cosine candela about the axis, the lower half alone, in steps of 5 degrees.
std::string cosine() {
    std::string angles, values;
    for (int v = 0; v <= 90; v += 5) {
        angles += std::to_string(v) + " ";
        values += std::to_string(200 * std::cos(v * piD / 180)) + (v % 25 ? " " : "\n");
    }
    return head("1 1000 2 19 1 1 2 0.1 0.1 0\n1 1 10\n" + angles + "\n0\n" + values);
}

std::string messageOf(const std::string& text) {
    try {
        iesFromText(text);
    } catch (const Error& e) { return e.what(); }
    return "";
}

TEST(IesProfile, OfACosineIsThatCosine) {
    const IesProfile p = iesFromText(cosine());
    EXPECT_FLOAT_EQ(p.most, 400);  // times the candela multiplier
    EXPECT_FLOAT_EQ(p.at({0, 0, -1}), 1);
    EXPECT_EQ(p.at({0, 0, 1}), 0);
    for (float degrees : {10.0f, 33.0f, 61.0f, 89.0f}) {
        const float a = degrees * pi / 180;
        EXPECT_NEAR(p.at({std::sin(a) * 0.6f, std::sin(a) * 0.8f, -std::cos(a)}), std::cos(a), 2e-3) << degrees;
    }
}

TEST(IesProfile, RepeatsAQuadrantByItsSymmetry) {
    // Straight ahead bright at 0 degrees about the axis, dark at 90.
    const IesProfile p = iesFromText(head("1 -1 1 2 3 1 2 0 0 0 1 1 5\n0 90\n0 45 90\n1 4 1 2 1 0"));
    const auto sideways = [&](float degrees) {
        const float a = degrees * pi / 180;
        return p.at({std::cos(a), std::sin(a), 0});
    };
    for (float at : {0.0f, 180.0f}) EXPECT_NEAR(sideways(at), 1, 1e-5);
    for (float at : {45.0f, 135.0f, 225.0f, 315.0f}) EXPECT_NEAR(sideways(at), 0.5, 1e-5);
    for (float at : {90.0f, 270.0f}) EXPECT_NEAR(sideways(at), 0, 1e-5);
    for (float at : {22.5f, 157.5f, 202.5f, 337.5f}) EXPECT_NEAR(sideways(at), 0.75, 1e-5);
}

TEST(IesProfile, SkipsTheTiltTableAndTakesCommasAndOddLineEnds) {
    const IesProfile p = iesFromText(
        "IESNA91\r\n[LUMCAT] A-1\r\nTILT=INCLUDE\r\n1\r\n3\r\n0,45,90\r\n1,0.9,0.8\r\n1 500 1 3 1 1 1 0 0 0\r\n0.5 1 "
        "7\r\n0,90,180\r\n0\r\n10,20,40");
    EXPECT_FLOAT_EQ(p.most, 20);  // ballast factor
    EXPECT_FLOAT_EQ(p.at({0, 0, 1}), 1);
    EXPECT_FLOAT_EQ(p.at({1, 0, 0}), 0.5f);
}

TEST(IesProfile, ThatIsBrokenIsRefusedByTheFieldThatIs) {
    const struct {
        std::string text, says;
    } cases[] = {
        {"", "TILT: is missing"},
        {"not a photometric file", "TILT: is missing"},
        {head("1 1000"), "candela multiplier: is missing"},
        {head("1 1000 x"), "candela multiplier: is x"},
        {head("1 1000 nan"), "candela multiplier: is nan"},
        {head("1 1000 1 1e9 1 1 1 0 0 0 1 1 1"), "number of vertical angles: is 1000000000"},
        {head("1 1000 1 2 0 1 1 0 0 0 1 1 1"), "number of horizontal angles: is 0"},
        {head("1 1000 1 2 1 2 1 0 0 0 1 1 1"), "photometric type: is B"},
        {head("1 1000 1 2 1 7 1 0 0 0 1 1 1"), "photometric type: is 7"},
        {head("1 1000 1 2 1 1 1 0 0 0 1 1 1 90 0 0 1 1"), "vertical angles: 0 follows 90"},
        {head("1 1000 1 2 1 1 1 0 0 0 1 1 1 -20 90 0 1 1"), "vertical angles: run from -20"},
        {head("1 1000 1 2 2 1 1 0 0 0 1 1 1 0 90 0 77 1 1 1 1"), "horizontal angles: run from 0 to 77"},
        {head("1 1000 1 2 1 1 1 0 0 0 1 1 1 0 90 0 1"), "candela values: is missing"},
        {head("1 1000 1 2 1 1 1 0 0 0 1 1 1 0 90 0 1 -1"), "candela values: one is -1"},
        {head("1 1000 1 2 1 1 1 0 0 0 1 1 1 0 90 0 0 0"), "candela values: are all 0"},
    };
    for (const auto& c : cases) EXPECT_NE(messageOf(c.text).find(c.says), std::string::npos) << messageOf(c.text);
}

}  // namespace
}  // namespace relamp
