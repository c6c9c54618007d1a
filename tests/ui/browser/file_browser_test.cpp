// The file browser: its keys, and what can be chosen.
#include "browser/file_browser.h"

#include "ui/panels/panel_harness.h"

namespace relamp::ui::test {
namespace {
namespace fs = std::filesystem;

using Names = std::vector<std::string>;

/// Captures and JSON files, from `folder` on.
BrowserRequest captureRequest(const TemporaryFolder& folder) {
    BrowserRequest request;
    request.start = folder.path();
    request.captures = true;
    request.extensions = {".json"};
    return request;
}

/// A browser drawn alone.
struct Browsing : Panels {
    FileBrowser browser;
    FileBrowser::Answer answer = FileBrowser::Answer::none;
    explicit Browsing(const BrowserRequest& request) {
        browser.begin(request);
        windowSize(800, 560);
        frame([this] {
            if (const auto a = browser.draw({}); a != FileBrowser::Answer::none) answer = a;
        });
        for (int i = 0; i < 500 && browser.reading(); ++i) {
            std::this_thread::sleep_for(std::chrono::milliseconds(2));
            frames(1);
        }
        frames(2);
    }
};

TEST(FileBrowserKeys, arrowsEnterAndBackspaceWalkThroughFolders) {
    const TemporaryFolder folder;
    folder.write("inside/a.exr", "x");
    folder.write("inside/b.exr", "x");
    BrowserRequest request;
    request.start = folder.path();
    request.extensions = {".exr"};
    Browsing b(request);
    ASSERT_EQ(b.browser.names(), Names{"inside"});
    b.key(keyDown);
    b.key(keyEnter);
    EXPECT_EQ(b.browser.folder(), folder / "inside");
    EXPECT_EQ(b.browser.names(), (Names{"a.exr", "b.exr"}));
    b.key(keyBackspace);
    EXPECT_EQ(b.browser.folder(), folder.path());
    b.key(keyDown);
    b.key(keyEnter);
    b.type("b");
    EXPECT_EQ(b.browser.names(), Names{"b.exr"});
    b.key(keyEnter);
    EXPECT_EQ(b.answer, FileBrowser::Answer::chosen);
    EXPECT_EQ(b.browser.chosen(), folder / "inside" / "b.exr");
}

TEST(FileBrowserKeys, captureFoldersAreChosenNotEntered) {
    const TemporaryFolder folder;
    folder.write("room/transforms.json", "{}");
    const BrowserRequest request = captureRequest(folder);
    Browsing b(request);
    b.key(keyDown);
    b.key(keyEnter);
    EXPECT_EQ(b.answer, FileBrowser::Answer::chosen);
    EXPECT_EQ(b.browser.chosen(), folder / "room");
}

TEST(FileBrowserKeys, aColmapFolderIsACaptureLikeAnyOther) {
    const TemporaryFolder folder;
    folder.write("room/sparse/0/cameras.txt", "x");
    folder.write("room/sparse/0/images.txt", "x");
    folder.write("room/images/a.exr", "x");
    const BrowserRequest request = captureRequest(folder);
    Browsing b(request);
    b.key(keyDown);
    b.key(keyEnter);
    EXPECT_EQ(b.answer, FileBrowser::Answer::chosen);
    EXPECT_EQ(b.browser.chosen(), folder / "room");
}

TEST(FileBrowserKeys, savingAsksBeforeItReplaces) {
    const TemporaryFolder folder;
    folder.write("plot.svg", "x");
    BrowserRequest request;
    request.mode = BrowserRequest::Mode::save;
    request.start = folder.path();
    request.name = "plot";
    request.extensions = {".svg"};
    Browsing b(request);
    b.key(keyEnter);
    EXPECT_EQ(b.answer, FileBrowser::Answer::none);
    b.frames(2);
    b.key(keyEnter);
    EXPECT_EQ(b.answer, FileBrowser::Answer::chosen);
    EXPECT_EQ(b.browser.chosen(), folder / "plot.svg");
}

TEST(FileBrowserKeys, aFolderThatIsNoShotIsNeverReplaced) {
    const TemporaryFolder folder;
    folder.write("photos.relamp/important.txt", "x");
    BrowserRequest request;
    request.mode = BrowserRequest::Mode::save;
    request.replacesShots = true;
    request.start = folder.path();
    request.name = "photos.relamp";
    request.extensions = {".relamp"};
    Browsing b(request);
    b.key(keyEnter);
    b.key(keyEnter);
    b.key(keyEnter);
    EXPECT_EQ(b.answer, FileBrowser::Answer::none);
}

TEST(FileBrowserKeys, aPathThatIsTypedNeedsNoFieldAndIsMendedWhereItWasWrong) {
    const TemporaryFolder folder;
    folder.write("room/transforms.json", "{}");
    const BrowserRequest request = captureRequest(folder);
    const std::string path = (folder / "room").string();
    {
        Browsing b(request);
        b.type(path.substr(0, path.size() - 1));
        b.key(keyEnter);
        EXPECT_EQ(b.answer, FileBrowser::Answer::none);
        b.type("m");
        b.key(keyEnter);
        EXPECT_EQ(b.answer, FileBrowser::Answer::chosen);
        EXPECT_EQ(b.browser.chosen(), folder / "room");
    }
    // In the field, what is typed after a wrong path stands there too, and Open takes it without Enter.
    Browsing again(request);
    const auto field = again.find(Panels::idOf("test", {"##path"}));
    ASSERT_TRUE(field);
    again.click(*field);
    again.type("/nowhere");
    again.key(keyEnter);
    again.frames(2);
    EXPECT_EQ(again.answer, FileBrowser::Answer::none);
    again.type(path);
    EXPECT_EQ(again.browser.names(), Names{"room"}) << "it was no filter";
    const auto open = again.find(Panels::idOf("test", {"Open"}));
    ASSERT_TRUE(open);
    again.click(*open);
    EXPECT_EQ(again.answer, FileBrowser::Answer::chosen);
    EXPECT_EQ(again.browser.chosen(), folder / "room");
}

TEST(FileBrowserKeys, theButtonsStayInSightUnderALongMessage) {
    const TemporaryFolder folder;
    BrowserRequest request;
    request.start = folder.path();
    request.captures = true;
    Browsing b(request);
    b.key(keyEnter);  // nothing can be chosen here: a message of several lines says what could
    b.frames(3);
    EXPECT_EQ(ImGui::FindWindowByName("test")->ScrollMax.y, 0);
    EXPECT_TRUE(b.find(Panels::idOf("test", {"Open"})));
}

TEST(FileBrowserKeys, escCancels) {
    Browsing b({});
    b.key(keyEscape);
    EXPECT_EQ(b.answer, FileBrowser::Answer::cancelled);
}

TEST(FileBrowserKeys, manyFilesDoNotSlowTheWindowDown) {
    const TemporaryFolder folder;
    for (int i = 0; i < 20000; ++i)
        std::ofstream(folder / fmt::format("{}{}{}{}.txt", char('a' + i % 26), char('a' + i / 26 % 26),
                                           char('a' + i / 676 % 26), char('a' + i / 17576)));
    BrowserRequest request;
    request.start = folder.path();
    Browsing b(request);
    ASSERT_EQ(b.browser.names().size(), 20000u);
    const auto start = std::chrono::steady_clock::now();
    b.frames(50);
    EXPECT_LT(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() / 50, 0.02);
}

}  // namespace
}  // namespace relamp::ui::test
