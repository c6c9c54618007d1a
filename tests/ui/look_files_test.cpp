// Looks as files: saved, loaded into other shots, and what those lack is named.
#include "look_files.h"

#include "settings.h"
#include "ui/editor_session.h"

namespace relamp::ui {
namespace {

TEST(LookFiles, aSavedLookIsLoadedByOneEditAndUndone) {
    Session s;
    s.openEstimated();
    Editor& e = *s.editor;
    e.edit("Move", [](Look& look) { moveEmitter(look, "emitter-1", relamp::test::translation({0.2f, 0, 0})); });
    e.edit("Bookmark", [](Look& look) { look.bookmarks.push_back({.name = "kept"}); });
    const Look wanted = e.look();
    saveLook(e, s.folder / "warm.json");
    ASSERT_TRUE(e.state.notices.empty()) << e.state.notices[0].text;
    EXPECT_TRUE(readLook(s.folder / "warm.json", e.state.document.capture->origin).bookmarks.empty());
    e.edit("Off", [](Look& look) { setEnabled(look, "emitter-1", false); });
    const size_t entries = e.history().entries().size();
    loadLook(e, s.folder / "warm.json");
    s.until([&] { return !e.job(); });
    EXPECT_TRUE(e.state.notices.empty()) << e.state.notices[0].text;
    ASSERT_EQ(e.history().entries().size(), entries + 1);
    EXPECT_EQ(e.history().entries().back().label, "Look warm");
    EXPECT_EQ(e.look(), wanted);
    e.undo();
    EXPECT_FALSE(e.emitter("emitter-1")->enabled);
    EXPECT_EQ(e.state.recentLooks, (std::vector<std::filesystem::path>{s.folder / "warm.json"}));
    saveSettings(e.configFolder(), e.state);
    EditorState again;
    loadSettings(e.configFolder(), again);
    EXPECT_EQ(again.recentLooks, e.state.recentLooks);
}

TEST(LookFiles, whatAShotLacksOfALookIsNamedAndTheRestIsLoaded) {
    Session s;
    s.openEstimated();
    Editor& e = *s.editor;
    s.folder.write("broken.exr", "no image");
    s.folder.write("other.json", R"({"version": 1,
        "environment": {"source": "file", "file": "broken.exr", "yaw_degrees": 30, "state": "night"},
        "emitters": [{"id": "emitter-1", "enabled": false}, {"id": "emitter-7"}, {"id": "emitter-8", "name": "Neon"}],
        "added_emitters": [
            {"id": "copy-1", "shape": "copy", "source": "emitter-8"},
            {"id": "spot-1", "shape": "spot", "name": "Key", "shaping": {"ies_file": "absent.ies"}}],
        "parts": [{"seed_vertex": 99999999}]})");
    loadLook(e, s.folder / "other.json");
    s.until([&] { return !e.job(); });
    ASSERT_EQ(e.state.notices.size(), 1u);
    for (const char* name : {"Light 7", "Neon", "Copy 1", "night", "broken.exr", "absent.ies", "an object"})
        EXPECT_NE(e.state.notices[0].text.find(name), std::string::npos) << name << ": " << e.state.notices[0].text;
    EXPECT_EQ(e.state.notices[0].text.find("Key"), std::string::npos) << e.state.notices[0].text;
    EXPECT_FALSE(e.emitter("emitter-1")->enabled);
    EXPECT_EQ(e.look().environment.source, EnvironmentLook::Source::recovered);
    EXPECT_EQ(e.look().environment.yawDegrees, 30);
    EXPECT_EQ(e.look().environment.state, "");
    ASSERT_EQ(e.look().added.size(), 1u);
    EXPECT_TRUE(e.look().added[0].shaping.iesFile.empty());
    EXPECT_TRUE(e.look().parts.empty());
}

TEST(LookFiles, aFileThatIsNoLookIsNeitherLoadedNorWrittenOver) {
    Session s;
    s.openEstimated();
    Editor& e = *s.editor;
    s.folder.write("bad.json", R"({"emitters": 3})");
    e.state.recentLooks = {s.folder / "gone.json"};
    const size_t entries = e.history().entries().size();
    for (const char* file : {"bad.json", "gone.json"}) {
        loadLook(e, s.folder / file);
        s.until([&] { return !e.job(); });
        ASSERT_EQ(e.state.notices.size(), 1u) << file;
        EXPECT_NE(e.state.notices[0].text.find(file), std::string::npos) << e.state.notices[0].text;
        e.state.notices.clear();
    }
    EXPECT_TRUE(e.state.recentLooks.empty());
    EXPECT_EQ(e.history().entries().size(), entries);
    const std::string cameras = R"({"version": 1, "frames": [], "environment": {}})";
    s.folder.write("transforms.json", cameras);
    saveLook(e, s.folder / "transforms.json");
    ASSERT_EQ(e.state.notices.size(), 1u);
    EXPECT_NE(e.state.notices[0].text.find("transforms.json"), std::string::npos);
    EXPECT_EQ(TemporaryFolder::read(s.folder / "transforms.json"), cameras);
    e.state.notices.clear();
    saveLook(e, s.folder / "mine.json");
    saveLook(e, s.folder / "mine.json");
    EXPECT_TRUE(e.state.notices.empty()) << "a look may take the place of a look";
}

}  // namespace
}  // namespace relamp::ui
