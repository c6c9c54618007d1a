#include "view_mode.h"

#include <gtest/gtest.h>

#include <set>
#include <string>

#include "actions.h"

namespace relamp::ui {
namespace {

TEST(ViewModes, HaveARowEachWithItsOwnNameCommandAndKey) {
    std::set<std::string> names, ids;
    std::set<int> keys;
    for (const ViewModeInfo& info : viewModes()) {
        EXPECT_EQ(&infoOf(info.mode), &info) << info.name;
        EXPECT_TRUE(names.insert(info.name).second) << info.name;
        EXPECT_TRUE(ids.insert(info.id).second) << info.id;
        if (info.key) { EXPECT_TRUE(keys.insert(info.key).second) << info.name; }
        ASSERT_FALSE(info.strips.empty()) << info.name;
        EXPECT_EQ(info.dividers.size() + 1, info.strips.size()) << info.name;
        for (const StripInfo& strip : info.strips) EXPECT_EQ(*strip.caption != 0, info.strips.size() > 1) << info.name;
    }
}

TEST(ViewModes, AreCommandsUnderTheirKeys) {
    for (const ViewModeInfo& info : viewModes()) {
        const Action* action = findAction(info.id);
        ASSERT_TRUE(action) << info.id;
        EXPECT_EQ(action->label, info.name);
        EXPECT_EQ(action->menu, "View");
        ASSERT_EQ(action->keys.size(), info.key ? 1u : 0u) << info.name;
        if (info.key) { EXPECT_EQ(action->keys[0].key, info.key); }
    }
}

TEST(ViewModes, ConfidenceIsWhereAColourComesFromAndNotHowSureItIs) {
    const std::string words = infoOf(ViewMode::confidence).explanation;
    EXPECT_EQ(words.find("sure"), std::string::npos) << words;
    EXPECT_NE(words.find("Known within"), std::string::npos) << words;
}

}  // namespace
}  // namespace relamp::ui
