// The panel that searches for lights that no photograph shows, with a mouse: what it finds is undone and redone.
#include "support/hidden_emitter.h"
#include "ui/panels/panel_harness.h"

namespace relamp::ui::test {
namespace {

TEST(UnobservedPanel, AFoundLightIsOneEntryAndTakingItAwayGivesTheEstimateBeforeItBack) {
    const TemporaryFolder folder;
    relamp::test::KnownWorld world = relamp::test::paintSmallWorld(folder / "dark", 8, 16);
    relamp::test::hideEmitter(folder / "dark", world);
    Panels p;
    Editor& editor = *p.editor;
    editor.state.solve.texture = 0;
    const auto ended = [&] { p.until([&] { return !editor.job(); }); };
    const auto vertices = [&] { return editor.state.document.scene->mesh.vertexCount(); };
    editor.openNow(folder / "dark");
    ended();
    editor.solve(editor.state.solve);
    ended();
    editor.edit("turn", [](Look& look) { look.environment.yawDegrees = 30; });
    const Version before = editor.history().present();
    ASSERT_TRUE(before.estimate);
    const size_t own = vertices(), entries = editor.history().entries().size();

    const auto draw = [&] { drawUnobservedLights(editor); };
    const auto press = [&](ImGuiID id) {
        const auto at = p.find(id);
        ASSERT_TRUE(at);
        p.click(*at);
    };
    p.windowSize(500, 300);
    p.frame(draw);
    p.frames();
    press(p.idOf("test", {"Find off-camera light"}));
    ASSERT_TRUE(editor.job());
    ended();
    ASSERT_EQ(editor.state.document.fix.proxies.size(), 1u) << editor.state.unobservedSearch.words;
    EXPECT_LT(glm::length(Vec3(editor.state.document.fix.proxies[0].centre) - world.emitterCentre), 0.25f);
    ASSERT_EQ(editor.history().entries().size(), entries + 1);
    EXPECT_EQ(editor.history().entries().back().label, "Find off-camera light");
    EXPECT_EQ(vertices(), own + proxyVertices);
    EXPECT_FALSE(editor.estimate());
    EXPECT_NE(p.wordsOf(draw).find("Light at"), std::string::npos);

    editor.undo();
    EXPECT_EQ(editor.estimate(), before.estimate);
    EXPECT_EQ(editor.look(), before.look);
    EXPECT_EQ(vertices(), own);
    EXPECT_EQ(p.wordsOf(draw).find("Light at"), std::string::npos);
    editor.redo();
    EXPECT_EQ(vertices(), own + proxyVertices);
    editor.solve(editor.state.solve);
    ended();
    const auto with = editor.estimate();
    ASSERT_TRUE(with);
    const std::vector<EmitterCluster>& found = with->emitters.emitters;
    EXPECT_TRUE(std::any_of(found.begin(), found.end(), [](const EmitterCluster& e) { return e.unobserved; }));

    p.frame(draw);
    p.frames();
    const int first = 0;
    press(ImHashStr("Remove", 0, ImHashData(&first, sizeof first, p.idOf("test", {}))));
    EXPECT_FALSE(editor.job()) << "nothing has to be read";
    EXPECT_EQ(editor.estimate(), before.estimate);
    EXPECT_EQ(editor.look(), before.look);
    EXPECT_EQ(vertices(), own);
    editor.undo();
    EXPECT_EQ(editor.estimate(), with);
    EXPECT_EQ(editor.state.document.fix.proxies.size(), 1u);
    EXPECT_EQ(vertices(), own + proxyVertices);
}

}  // namespace
}  // namespace relamp::ui::test
