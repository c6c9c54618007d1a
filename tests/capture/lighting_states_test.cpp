// Lighting states: which photograph belongs to which, by its frame's word or by its name.
#include "capture/lighting_states.h"

#include <gtest/gtest.h>

#include "capture/capture_source.h"
#include "capture/transforms_json.h"
#include "support/known_world.h"

namespace relamp {
namespace {

CaptureSource photographs(const std::vector<std::pair<std::string, std::string>>& namesAndStates) {
    CaptureSource source;
    for (const auto& [name, state] : namesAndStates) {
        FrameSource frame;
        frame.where = "transforms.json: frame " + std::to_string(source.frames.size());
        frame.name = name;
        frame.state = state;
        source.frames.push_back(frame);
    }
    return source;
}

std::string errorOf(const std::function<void()>& act) {
    try {
        act();
    } catch (const Error& error) { return error.what(); }
    return "";
}

TEST(LightingStates, AreInTheOrderOfTheirFirstPhotographs) {
    CaptureSource source = photographs({{"a", "on"}, {"b", "off"}, {"c", "on"}});
    assignStates({}, source);
    EXPECT_EQ(source.states, (std::vector<std::string>{"on", "off"}));
    EXPECT_EQ(source.frames[1].stateIndex, 1u);
    EXPECT_EQ(source.frames[2].stateIndex, 0u);
    CaptureSource plain = photographs({{"a", ""}, {"b", ""}});
    assignStates({}, plain);
    EXPECT_TRUE(plain.states.empty());
}

TEST(LightingStates, APatternSaysItAgainstTheFileAndTheLastOneCounts) {
    CaptureSource source = photographs({{"on/1.exr", "x"}, {"off/1.exr", "x"}, {"off/2.exr", "x"}});
    assignStates({{"lamp", "*"}, {"none", "off"}, {"dim", "*/2.???"}}, source);
    EXPECT_EQ(source.states, (std::vector<std::string>{"lamp", "none", "dim"}));
    EXPECT_EQ(source.frames[2].stateIndex, 2u);
}

TEST(LightingStates, PatternsMatchWholeNamesAndFoldersWithoutStars) {
    EXPECT_TRUE(matchesPattern("images/off/1.exr", "images/off"));
    EXPECT_TRUE(matchesPattern("images/off/1.exr", "images/off/"));
    EXPECT_FALSE(matchesPattern("images/office/1.exr", "images/off"));
    EXPECT_TRUE(matchesPattern("a_off_07.jpg", "*_off_*"));
    EXPECT_TRUE(matchesPattern("a_off_off_", "*_off_"));
    EXPECT_FALSE(matchesPattern("a_on_07.jpg", "*_off_*"));
    EXPECT_FALSE(matchesPattern("ab", "?"));
    EXPECT_TRUE(matchesPattern("a*b", "a*b"));
    EXPECT_TRUE(matchesPattern("", "*"));
}

TEST(LightingStates, WhatIsLeftWithoutOneIsNamed) {
    CaptureSource some = photographs({{"a", "on"}, {"b", ""}});
    EXPECT_EQ(errorOf([&] { assignStates({}, some); }),
              "transforms.json: frame 1: state is missing, though other frames name one (on is the first)");
    CaptureSource none = photographs({{"a", "on"}});
    EXPECT_NE(errorOf([&] {
                  assignStates({{"off", "dark/*"}}, none);
              }).find("--state off=dark/*: no photograph's name"),
              std::string::npos);
    for (const char* bad : {"off", "=x", "off=", "o\x01=x"})
        EXPECT_NE(errorOf([&] { statePatternOf(bad); }).find("--state"), std::string::npos) << bad;
    EXPECT_EQ(statePatternOf("lamp off=a=b"), (StatePattern{"lamp off", "a=b"}));
}

TEST(LightingStates, ATransformsFileNamesThemAndSaysWhatEnvironmentTheyHave) {
    const auto parsed = [](const std::string& state, const std::string& table) {
        return parseTransforms(R"({"w": 8, "h": 8, "fl_x": 8, )" + table +
                                   R"("frames": [{"file_path": "a.exr", "state": )" + state +
                                   R"(, "transform_matrix": [[1,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,1]]}]})",
                               {});
    };
    EXPECT_EQ(parsed("\"lamp on\"", "").frames[0].state, "lamp on");
    EXPECT_EQ(parsed("\"on\"", R"("states": {"on": {"environment": "shared"}}, )").frames[0].state, "on");
    for (const char* said : {"own", "none", "shared", "on"})
        EXPECT_EQ(parsed("\"on\"", fmt::format(R"("states": {{"on": {{"environment": "{}"}}}}, )", said)).environments,
                  (std::vector<StateEnvironment>{{"on", said}}));
    const std::pair<std::string, std::string> bad[] = {
        {"frame 0: state is a number, expected text", ""},
        {"states: \"on\": environment: expected a text", R"("states": {"on": {"environment": 2}}, )"},
        {"states: \"on\": environment is \"sunny\"", R"("states": {"on": {"environment": "sunny"}}, )"},
        {"states: \"off\": no frame names this state", R"("states": {"off": {}}, )"},
        {"states: \"on\": is a number", R"("states": {"on": 1}, )"},
        {"states is a list", R"("states": [], )"}};
    for (const auto& [message, table] : bad)
        EXPECT_NE(errorOf([&] { parsed(table.empty() ? "3" : "\"on\"", table); }).find(message), std::string::npos)
            << message << "; said: " << errorOf([&] { parsed(table.empty() ? "3" : "\"on\"", table); });
    EXPECT_NE(errorOf([&] { parsed("\"\"", ""); }).find("frame 0: state is empty"), std::string::npos);
}

TEST(LightingStates, HaveEnvironmentsInTheOrderOfTheirFirstStates) {
    CaptureSource source = photographs({{"a", "noon"}, {"b", "lamp"}, {"c", "dusk"}, {"d", "dark"}, {"e", "late"}});
    assignStates({}, source);
    assignEnvironments({}, source);
    EXPECT_TRUE(source.environmentOfState.empty()) << "all share one";
    source.environments = {{"dusk", "own"}, {"late", "dusk"}, {"dark", "none"}};
    assignEnvironments({}, source);
    EXPECT_EQ(source.environmentOfState, (std::vector<int>{0, 0, 1, -1, 1}));
    // What is told goes before what the file says.
    assignEnvironments({{"noon", "own"}, {"dusk", "shared"}, {"dark", "lamp"}}, source);
    EXPECT_EQ(source.environmentOfState, (std::vector<int>{0, 1, 1, 1, 1}));
    // States that patterns name anew are not those of which the file speaks.
    assignStates({{"all", "*"}, {"first", "a"}}, source);
    assignEnvironments({}, source);
    EXPECT_TRUE(source.environmentOfState.empty());
}

TEST(LightingStates, AnEnvironmentThatCannotBeIsNamed) {
    const auto told = [](const std::vector<StateEnvironment>& environments) {
        return errorOf([&] {
            CaptureSource source = photographs({{"a", "on"}, {"b", "off"}});
            assignStates({}, source);
            assignEnvironments(environments, source);
        });
    };
    EXPECT_EQ(told({{"off", "own"}}), "");
    EXPECT_EQ(told({{"dim", "own"}}), "--state-environment dim=own: no photograph is of this state");
    EXPECT_NE(told({{"on", "sunny"}}).find("the environment of state on is sunny, expected shared, own, none or"),
              std::string::npos);
    EXPECT_NE(told({{"on", "off"}, {"off", "on"}}).find("is that of a state that has its environment"),
              std::string::npos);
    EXPECT_NE(told({{"on", "none"}, {"off", "none"}}).find("no lighting state has an environment"), std::string::npos);
    for (const char* bad : {"dusk", "=own", "dusk="})
        EXPECT_NE(errorOf([&] { stateEnvironmentOf(bad); }).find("--state-environment"), std::string::npos) << bad;
    EXPECT_EQ(stateEnvironmentOf("a=b=own"), (StateEnvironment{"a=b", "own"}));
}

}  // namespace
}  // namespace relamp
