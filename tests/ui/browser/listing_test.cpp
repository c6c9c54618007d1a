// What the file browser lists: sequences, odd names, captures of every format, folders that cannot be read.
#include "browser/listing.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "support/temporary_folder.h"
#include "widgets.h"

namespace relamp::ui::test {
namespace {
namespace fs = std::filesystem;
using relamp::test::TemporaryFolder;

std::vector<std::string> collapsed(const std::vector<std::string>& names) {
    std::vector<FileEntry> entries;
    for (const std::string& name : names)
        entries.push_back({FileEntry::Kind::file, "/x/" + name, shown(name), 0, 0, 1});
    std::vector<std::string> out;
    for (const FileEntry& e : collapseSequences(entries)) out.push_back(e.name);
    return out;
}
using Names = std::vector<std::string>;

TEST(DemoCaptures, areFoundBesideAnInstalledProgramAndInTheSourceTree) {
    const TemporaryFolder folder;
    folder.write("usr/bin/relamp-editor", "");
    folder.write("usr/share/relamp/captures/desk-lamp/transforms.json", "{}");
    EXPECT_EQ(demoCaptures(folder / "usr/bin/relamp-editor"), folder / "usr/share/relamp/captures");
    folder.write("source/build/ui/relamp-editor", "");
    folder.write("source/assets/captures/desk-lamp/transforms.json", "{}");
    EXPECT_EQ(demoCaptures(folder / "source/build/ui/relamp-editor"), folder / "source/assets/captures");
    EXPECT_EQ(demoCaptures("/nowhere/bin/relamp-editor"), fs::path());
}

TEST(FileBrowserSequences, numberedRunsBecomeOneEntry) {
    Names frames;
    for (int i = 1; i <= 120; ++i) frames.push_back(fmt::format("frame.{:04}.exr", i));
    EXPECT_EQ(collapsed(frames), Names{"frame.0001-0120.exr"});
    EXPECT_EQ(collapsed({"0000.exr", "0001.exr", "0002.exr"}), Names{"0000-0002.exr"});
    EXPECT_EQ(collapsed({"a1.png", "a10.png", "a9.png"}), Names{"a1-10.png"});
    EXPECT_EQ(collapsed({"img_1.png", "img_2.png"}), (Names{"img_1.png", "img_2.png"}));
    EXPECT_EQ(collapsed({"a.0998.exr", "a.0999.exr", "a.1000.exr"}), Names{"a.0998-1000.exr"});
}

TEST(FileBrowserSequences, differentWidthsAndExtensionsStayApart) {
    EXPECT_EQ(collapsed({"a.001.exr", "a.002.exr", "a.003.exr", "a.0001.exr", "a.0002.exr", "a.0003.exr"}),
              (Names{"a.0001-0003.exr", "a.001-003.exr"}));
    EXPECT_EQ(collapsed({"a.1.exr", "a.2.exr", "a.3.exr", "a.1.png", "a.2.png", "a.3.png"}).size(), 2u);
}

TEST(FileBrowserSequences, gapsAreCounted) {
    std::vector<FileEntry> entries;
    for (const int i : {1, 2, 5})
        entries.push_back(
            {FileEntry::Kind::file, fmt::format("/x/f.{:03}.exr", i), fmt::format("f.{:03}.exr", i), 0, 0, 1});
    const auto out = collapseSequences(entries);
    ASSERT_EQ(out.size(), 1u);
    EXPECT_EQ(out[0].members, 3u);
    EXPECT_EQ(out[0].last - out[0].first + 1, 5);
    EXPECT_EQ(out[0].path, "/x/f.001.exr");
}

TEST(FileBrowserSequences, oddNamesSurvive) {
    for (const std::string name : {"", ".", ".hidden", "12345678901234567890.exr", "no number.exr", "\xff\xfe.exr",
                                   "a\nb", "####.exr", "ünï.exr", "-1.exr"})
        EXPECT_EQ(collapsed({name}).size(), 1u) << name;
    EXPECT_EQ(collapsed({"\xff.1.exr", "\xff.2.exr", "\xff.3.exr"}), Names{"?.1-3.exr"});
}

TEST(FileBrowserSequences, peopleSortNumbersByValue) {
    EXPECT_TRUE(naturalLess("take 9", "take 10"));
    EXPECT_TRUE(naturalLess("Apple", "banana"));
    EXPECT_TRUE(naturalLess("a007", "a8"));
    EXPECT_FALSE(naturalLess("a", "a"));
    EXPECT_TRUE(naturalLess("a1", "a01") != naturalLess("a01", "a1"));
}

TEST(FileBrowserNames, bytesThatAreNotUtf8AreShownAsQuestionMarks) {
    EXPECT_EQ(shown(std::string("caf\xe9.exr")), "caf?.exr");
    EXPECT_EQ(shown(std::string("caf\xc3\xa9.exr")), "caf\xc3\xa9.exr");
    EXPECT_EQ(shown(std::string("a\tb\x01")), "a?b?");
    EXPECT_EQ(shown(std::string("\xe2\x82")), "??");
}

TEST(FileBrowserListing, unreadableFoldersSayWhyAndNeverThrow) {
    const TemporaryFolder folder;
    EXPECT_NE(listFolder(folder / "absent", false).error, "");
    folder.write("file.txt", "x");
    EXPECT_NE(listFolder(folder / "file.txt", false).error.find("file"), std::string::npos);
    fs::create_directory(folder / "closed");
    ::chmod((folder / "closed").c_str(), 0);
    // Root may read everything: another user looks at it, in a process of its own.
    const pid_t other = ::fork();
    if (other == 0) {
        if (::geteuid() == 0 && (::chmod(folder.path().c_str(), 0755) != 0 || ::setuid(65534) != 0)) ::_exit(2);
        ::_exit(listFolder(folder / "closed", false).error.find("may not read") == std::string::npos);
    }
    int status = 0;
    ::waitpid(other, &status, 0);
    EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << status;
    ::chmod((folder / "closed").c_str(), 0700);
}

TEST(FileBrowserListing, foldersComeFirstAndHiddenOnesOnDemand) {
    const TemporaryFolder folder;
    folder.write("a.txt", "x");
    folder.write(".secret", "x");
    fs::create_directory(folder / "z");
    const auto listing = listFolder(folder.path(), false);
    ASSERT_EQ(listing.entries.size(), 2u);
    EXPECT_EQ(listing.entries[0].name, "z");
    EXPECT_EQ(listFolder(folder.path(), true).entries.size(), 3u);
}

TEST(FileBrowserListing, everyCaptureFormatIsNamed) {
    const TemporaryFolder folder;
    folder.write("a nerf/transforms.json", "{}");
    folder.write("b model/sparse/0/cameras.bin", "x");
    folder.write("b model/sparse/0/images.bin", "x");
    folder.write("c shot/shot.json", "{}");
    folder.write("d photos/a.exr", "x");
    const auto listing = listFolder(folder.path(), false);
    ASSERT_EQ(listing.entries.size(), 4u);
    EXPECT_EQ(detailOf(listing.entries[0]).capture, "transforms.json");
    EXPECT_EQ(detailOf(listing.entries[1]).capture, "COLMAP model");
    EXPECT_EQ(detailOf(listing.entries[2]).capture, "");
    EXPECT_TRUE(detailOf(listing.entries[2]).shot);
    EXPECT_EQ(detailOf(listing.entries[3]).capture, "");
}

}  // namespace
}  // namespace relamp::ui::test
