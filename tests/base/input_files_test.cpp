#include "base/input_files.h"

#include <gtest/gtest.h>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/printable.h"
#include "support/temporary_folder.h"

namespace relamp {
namespace {

namespace fs = std::filesystem;

TEST(InputFiles, KnowAFileByAllItsNames) {
    const test::TemporaryFolder folder;
    const fs::path file = folder.write("in/a.exr", "a");
    folder.write("in/b.exr", "b");
    fs::create_symlink(file, folder / "link.exr");
    fs::create_hard_link(file, folder / "hard.exr");
    fs::create_symlink("in", folder / "also-in");
    InputFiles files;
    files.add(file);
    files.add("");
    for (const char* name : {"in/a.exr", "in/../in/a.exr", "link.exr", "hard.exr", "also-in/a.exr"})
        EXPECT_NE(test::messageOf([&] { files.refuse(folder / name); }).find("not written over"), std::string::npos)
            << name;
    files.refuse(folder / "in/b.exr");
    files.refuse(folder / "new.exr");
    files.addFolder(folder / "in");
    EXPECT_THROW(files.refuse(folder / "in/b.exr"), Error);
    EXPECT_THROW(files.refuse("/dev/null"), Error) << "a rename would put a file in the place of the device";
}

TEST(InputFiles, OneNameIsClaimedOnce) {
    const test::TemporaryFolder folder;
    InputFiles files;
    files.claim(folder / "out.exr");
    files.claim(folder / "other.exr");
    files.claim("");
    files.claim("");
    EXPECT_THROW(files.claim(folder.path() / "." / "out.exr"), Error);
}

TEST(FollowedLinks, LeadToTheFileThatIsReplaced) {
    const test::TemporaryFolder folder;
    folder.write("real/a.txt", "old");
    fs::create_symlink("real/a.txt", folder / "one.txt");
    fs::create_symlink("one.txt", folder / "two.txt");
    fs::create_symlink("real/new.txt", folder / "dangling.txt");
    fs::create_symlink("circle.txt", folder / "circle.txt");
    writeBytesAtomically(folder / "two.txt", "new");
    EXPECT_TRUE(fs::is_symlink(folder / "two.txt") && fs::is_symlink(folder / "one.txt"));
    EXPECT_EQ(readBytes(folder / "real/a.txt"), "new");
    writeBytesAtomically(folder / "dangling.txt", "made");
    EXPECT_EQ(readBytes(folder / "real/new.txt"), "made");
    EXPECT_THROW(writeBytesAtomically(folder / "circle.txt", ""), Error);
    EXPECT_THROW(writeBytesAtomically(folder / "real", ""), Error);
    EXPECT_EQ(folderPlace(folder / "two.txt"), fs::canonical(folder / "real/a.txt"));
    EXPECT_THROW(folderPlace(""), Error);
}

TEST(Printable, ControlCharactersAreNumbersAndWordsStay) {
    EXPECT_EQ(printable("a\033[2J\n\t\x7f"), "a\\x1b[2J\\x0a\\x09\\x7f");
    EXPECT_EQ(printable("a\n\tb\r", true), "a\n\tb\\x0d");
    EXPECT_EQ(printable("Z\xc3\xbcrich \xe2\x80\x94 \xc2\x9b"), "Z\xc3\xbcrich \xe2\x80\x94 \\xc2\\x9b");
}

}  // namespace
}  // namespace relamp
