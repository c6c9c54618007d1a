#include "plot.h"

#include "ui/panels/panel_harness.h"

namespace relamp::ui::test {
namespace {

std::array<RunCurve, 2> curves() {
    std::array<RunCurve, 2> c;
    c[0].entries = {
        {0.5, "ratios", 1, 0, 0.2}, {1.5, "lighting, first", 1, 12.5, 0.05}, {4, "lighting, first", 2, 11, 0.02}};
    c[1].entries = {{1, "lighting", 1, 3, 0.4}};
    return c;
}

TEST(Plot, rangesHoldAllPointsAndIgnoreWhatHasNoPlaceOnALogarithm) {
    std::vector<PlotCurve> c{{"a", "#ffffff", false, {{1, 0.1, ""}, {100, 0, ""}, {0, 5, ""}, {10, 2, ""}}}};
    const PlotRange x = plotRange(c, true), y = plotRange(c, false);
    EXPECT_LT(x.low, 1);
    EXPECT_GT(x.high, 10);
    EXPECT_LT(x.high, 100);
    EXPECT_LT(y.low, 0.1);
    EXPECT_GT(y.high, 2);
    const PlotRange none = plotRange({}, true);
    EXPECT_EQ(none.low, 1);
    EXPECT_EQ(none.high, 10);
    const PlotRange one = plotRange({{"a", "", false, {{3, 3, ""}}}}, true);
    EXPECT_GT(one.high / one.low, 1.2);
}

TEST(Plot, ticksAreRoundNumbersAndNoMoreThanAskedFor) {
    EXPECT_EQ(plotTicks({0.9, 11}, 4), (std::vector<double>{1, 2, 5, 10}));
    for (const int most : {2, 3, 5, 9})
        for (const double high : {1.5, 20.0, 1e5, 1e30})
            EXPECT_LE(int(plotTicks({1e-4, high}, most).size()), most) << most << " " << high;
}

TEST(Plot, csvHasALineForEachStepAndQuotesWhatNeedsIt) {
    const std::string csv = timelineCsv(curves());
    EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 5);
    EXPECT_NE(csv.find("near-field,1.5000,\"lighting, first\",1,12.5,0.05"), std::string::npos);
    EXPECT_NE(csv.find("distant-only,1.0000,lighting,1,3,0.4"), std::string::npos);
}

TEST(Plot, svgStandsAlone) {
    const std::string svg = timelineSvg(curves());
    EXPECT_TRUE(svg.starts_with("<svg xmlns=\"http://www.w3.org/2000/svg\""));
    EXPECT_NE(svg.find("distant light only"), std::string::npos);
    EXPECT_EQ(timelineSvg({}), "");
}

TEST(Plot, drawsAtAnySizeWithAndWithoutPoints) {
    Panels p;
    for (const float width : {0.0f, 40.0f, 300.0f, 900.0f})
        for (const float height : {0.0f, 30.0f, 300.0f}) {
            p.frame([&] {
                drawLogPlot("##a", timelineCurves(curves()), "seconds", "error", {width, height}, "nothing");
                drawLogPlot("##b", {}, "seconds", "error", {width, height}, "nothing");
            });
            p.mouse({width / 2, height / 2});
            p.frames(2);
        }
}

}  // namespace
}  // namespace relamp::ui::test
