#include "relight/light_goal.h"

#include <gtest/gtest.h>

#include "base/error.h"
#include "base/random.h"

namespace relamp {
namespace {

/// 200 points under three lights, the last of which sends blue alone, and something that stays.
LightGoal scene() {
    LightGoal goal;
    goal.response.resize(3);
    for (uint32_t i = 0; i < 200; ++i) {
        const Vec2 u = r2Point(i, Vec2(0.1f));
        goal.weight.push_back(1);
        goal.rest.push_back(Rgb(0.02f, 0.03f, 0.04f));
        goal.response[0].push_back(Rgb(1, 0.8f, 0.6f) * u.x);
        goal.response[1].push_back(Rgb(0.5f) * (1 - u.x) * u.y);
        goal.response[2].push_back(Rgb(0, 0, 1) * u.y * u.y);
        goal.target.push_back(Rgb(0));
    }
    goal.present.assign(3, Rgb(1));
    return goal;
}

void aim(LightGoal& goal, const std::vector<Rgb>& scale) {
    for (size_t i = 0; i < goal.points(); ++i) {
        goal.target[i] = goal.rest[i];
        for (size_t a = 0; a < scale.size(); ++a) goal.target[i] += scale[a] * goal.response[a][i];
    }
}

TEST(LightGoal, ThatLightsCanReachIsReached) {
    LightGoal goal = scene();
    const std::vector<Rgb> wanted{Rgb(0.3f, 0.5f, 2), Rgb(1.5f), Rgb(1, 1, 0)};
    aim(goal, wanted);
    LightGoalOptions options;
    options.keep = 1e-6f;
    const LightGoalAnswer answer = reachGoal(goal, options);
    for (size_t a = 0; a < 2; ++a)
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(answer.scale[a][c], wanted[a][c], 2e-3) << a << c;
    EXPECT_NEAR(answer.scale[2].z, 0, 2e-3);
    EXPECT_EQ(answer.scale[2].x, 1) << "what it does not send stays as it is";
    EXPECT_GT(answer.before, 0.3f);
    EXPECT_LT(answer.after, 2e-3f);
    EXPECT_EQ(answer.tooDark + answer.tooBright, 0);
}

TEST(LightGoal, KeepsColoursWhenAskedTo) {
    LightGoal goal = scene();
    aim(goal, {Rgb(0.5f), Rgb(2), Rgb(1)});
    LightGoalOptions options;
    options.colour = false;
    options.keep = 1e-6f;
    const LightGoalAnswer answer = reachGoal(goal, options);
    EXPECT_NEAR(answer.scale[0].x, 0.5, 2e-3);
    EXPECT_EQ(answer.scale[0].x, answer.scale[0].z);
    EXPECT_NEAR(answer.scale[1].y, 2, 2e-3);
}

TEST(LightGoal, NeverAsksForNegativeLightAndSaysWhatStaysTooBright) {
    LightGoal goal = scene();
    for (Rgb& t : goal.target) t = Rgb(0.005f);  // darker than what may not change
    const LightGoalAnswer answer = reachGoal(goal);
    for (const Rgb& s : answer.scale)
        for (int c = 0; c < 3; ++c) EXPECT_GE(s[c], 0);
    EXPECT_LT(answer.scale[0].x, 1e-3f);
    EXPECT_EQ(answer.tooBright, 1);
    EXPECT_EQ(answer.tooDark, 0);
}

TEST(LightGoal, LeavesALightThatDoesNotReachThePointsAndSharesBetweenEqualOnes) {
    LightGoal goal = scene();
    goal.response.push_back(goal.response[0]);  // its twin
    goal.response.emplace_back(goal.points(), Rgb(0));
    goal.present = {Rgb(1), Rgb(1), Rgb(1), Rgb(1), Rgb(0.7f)};
    aim(goal, {Rgb(2), Rgb(1), Rgb(1), Rgb(2)});
    const LightGoalAnswer answer = reachGoal(goal);
    EXPECT_EQ(answer.scale[4], Rgb(0.7f));
    EXPECT_NEAR(answer.scale[0].y + answer.scale[3].y, 4, 0.02);
    EXPECT_NEAR(answer.scale[0].y, answer.scale[3].y, 0.02);
    EXPECT_LT(answer.after, 0.01f);
}

TEST(LightGoal, WithListsThatDifferOrNothingWantedIsRefused) {
    LightGoal goal = scene();
    goal.rest.pop_back();
    EXPECT_THROW(reachGoal(goal), Error);
    LightGoal nothing = scene();
    std::fill(nothing.weight.begin(), nothing.weight.end(), 0.0f);
    EXPECT_THROW(reachGoal(nothing), Error);
    EXPECT_THROW(reachGoal(LightGoal{}), Error);
}

}  // namespace
}  // namespace relamp
