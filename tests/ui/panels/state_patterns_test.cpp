// The lighting states of photographs, named in the check of the capture.
#include "panels/dialogs.h"
#include "ui/panels/panel_harness.h"

namespace relamp::ui::test {
namespace {

struct NamedStates : Panels {
    NamedStates() {
        openCapture();
        windowSize(700, 400);
        frame([this] { drawStatePatterns(*editor); });
        frames(2);
    }
    void press(const char* label) {
        const auto at = find(idOf("test", {label}));
        ASSERT_TRUE(at) << label;
        click(*at);
    }
    void fill(int row, const char* field, const std::string& words) {
        const auto at = find(ImHashStr(field, 0, ImHashData(&row, sizeof row, idOf("test", {}))));
        ASSERT_TRUE(at) << field;
        click(*at);
        type(words);
        frames(2);
    }
    /// Whether the capture was read again.
    bool apply() {
        press("Use these states");
        const bool reads = editor->job().has_value();
        until([&] { return !editor->job(); });
        frames(2);
        return reads;
    }
    void remove(int row) {
        const auto at = find(ImHashStr("##gone", 0, ImHashData(&row, sizeof row, idOf("test", {}))));
        ASSERT_TRUE(at);
        click(*at);
    }
};

TEST(StatePatterns, photographsAreGivenStatesByTheirNames) {
    NamedStates t;
    const Document& document = t.editor->state.document;
    ASSERT_EQ(document.capture->views.size(), 6u);
    EXPECT_TRUE(document.capture->states.empty());
    t.press("Add state");
    t.press("Add state");
    t.fill(0, "##name", "off");
    t.fill(0, "##pattern", "images/*");
    t.fill(1, "##name", "on");
    EXPECT_FALSE(t.apply()) << "a line is not finished";
    t.fill(1, "##pattern", "images/00.exr");
    EXPECT_TRUE(t.apply());
    EXPECT_EQ(document.capture->states, (std::vector<std::string>{"on", "off"}));
    EXPECT_EQ(document.capture->views[0].state, 0u);
    EXPECT_EQ(document.capture->views[5].state, 1u);
    t.remove(0);
    EXPECT_FALSE(t.apply()) << "five photographs would have no state";
    t.remove(0);
    EXPECT_FALSE(t.apply()) << "the history has the capture without states";
    EXPECT_TRUE(document.capture->states.empty());
    EXPECT_EQ(document.fix, CaptureFix{});
}

}  // namespace
}  // namespace relamp::ui::test
