// Stiff and extreme cases on the synthetic worlds: all of them, because they are small.
#include "report/stress.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "support/stopping.h"

namespace relamp {
namespace {

const StressReport& worlds() {
    static const StressReport report = [] {
        Progress progress;
        return runStress(nullptr, {}, progress);
    }();
    return report;
}

double figure(const StressCase& c, const std::string& name) {
    for (const auto& [key, value] : c.figures)
        if (key == name) return value;
    return -1;
}

const StressCase* named(const std::string& name) {
    for (const StressCase& c : worlds().cases)
        if (c.name == name) return &c;
    return nullptr;
}

TEST(Stress, EveryCaseEndsInFiniteNumbersAndSolvedEquations) {
    EXPECT_GE(worlds().cases.size(), 40u);
    EXPECT_EQ(worlds().finiteShare(), 1);
    for (const StressCase& c : worlds().cases) {
        EXPECT_TRUE(c.holds()) << c.name;
        EXPECT_TRUE(c.finite) << c.name << ": " << c.reason;
        EXPECT_LE(c.kkt, 1e-6) << c.name << ": " << c.reason;
        EXPECT_EQ(c.reason.find("fault"), std::string::npos) << c.name << ": " << c.reason;
    }
}

TEST(Stress, UnitsOrderAndAxesDoNotMatter) {
    // Powers of two are rounded nowhere: the same bits.
    for (const char* name : {"world: images x 2^-20", "world: lengths x 2^10"}) {
        ASSERT_TRUE(named(name)) << name;
        EXPECT_EQ(figure(*named(name), "difference"), 0) << name;
    }
    for (const char* name : {"world: images x 1e-6", "world: images x 1e6", "world: in millimetres", "world: in kilometres", "world: far from the origin", "world: views in another order",
                             "world: vertices in another order", "world: emitters in another order", "world: turned by 90 degrees", "world: turned by 33 degrees",
                             "world: turned about a slanting axis"}) {
        ASSERT_TRUE(named(name)) << name;
        EXPECT_LT(figure(*named(name), "difference"), 1e-4) << name;
    }
}

TEST(Stress, WhatCannotBeSolvedIsRefusedWithASentence) {
    const StressCase* c = named("world: 3 vertices");
    ASSERT_TRUE(c);
    EXPECT_TRUE(c->refused || c->kkt <= 1e-6);
    EXPECT_TRUE(!c->refused || !c->reason.empty());
}

TEST(Stress, ReportsAsJsonAndAsTable) {
    const nlohmann::json j = stressJson(worlds());
    ASSERT_EQ(j.at("cases").size(), worlds().cases.size());
    EXPECT_EQ(j.at("finite_share"), 1.0);
    for (const auto& c : j["cases"])
        for (const char* key : {"name", "finite", "kkt", "reason", "figures"}) EXPECT_TRUE(c.contains(key)) << key;
    EXPECT_NE(stressText(worlds()).find("world: near-mirror"), std::string::npos);
}

TEST(Stress, RunsOnlyWhatIsAskedForAndStops) {
    Progress progress;
    StressOptions options;
    options.only = "needle";
    const StressReport report = runStress(nullptr, options, progress);
    ASSERT_EQ(report.cases.size(), 1u);
    EXPECT_EQ(report.cases[0].name, "world: needle triangles");
    test::expectStopsHalfWay([](Progress& p) { runStress(nullptr, {}, p); });
}

}  // namespace
}  // namespace relamp
