#include "base/atomic_file.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <stdexcept>

#include "base/error.h"

namespace relamp {
namespace fs = std::filesystem;
namespace {

/// An empty folder of its own for each test.
class AtomicFile : public testing::Test {
protected:
    void SetUp() override {
        const std::string name = testing::UnitTest::GetInstance()->current_test_info()->name();
        folder = fs::path(testing::TempDir()) / fmt::format("relamp_{}_{}", ::getpid(), name);
        fs::create_directories(folder);
        target = folder / "result.exr";
    }
    void TearDown() override { fs::remove_all(folder); }
    size_t filesInFolder() const { return size_t(std::distance(fs::directory_iterator(folder), {})); }

    fs::path folder, target;
};

TEST_F(AtomicFile, BytesComeBackAsWritten) {
    const std::string bytes("a\0b\r\n\xff", 6);
    writeBytesAtomically(target, bytes);
    EXPECT_EQ(readBytes(target), bytes);
    EXPECT_EQ(filesInFolder(), 1u);
    writeBytesAtomically(target, "");
    EXPECT_EQ(readBytes(target), "");
}

TEST_F(AtomicFile, SecondWriteReplacesTheFirst) {
    writeBytesAtomically(target, "a long first version");
    writeBytesAtomically(target, "second");
    EXPECT_EQ(readBytes(target), "second");
    EXPECT_EQ(filesInFolder(), 1u);
}

TEST_F(AtomicFile, FailingWriterLeavesTheOldFileUntouchedAndNoTemporary) {
    writeBytesAtomically(target, "old");
    const auto failHalfWay = [](const fs::path& file) {
        std::ofstream(file) << "half";
        throw std::runtime_error("half way");
    };
    EXPECT_THROW(writeFileAtomically(target, failHalfWay), std::runtime_error);
    EXPECT_EQ(readBytes(target), "old");
    EXPECT_EQ(filesInFolder(), 1u);
}

TEST_F(AtomicFile, FailingFirstWriteLeavesNothing) {
    EXPECT_THROW(writeFileAtomically(target, [](const fs::path&) { throw std::runtime_error("no"); }),
                 std::runtime_error);
    EXPECT_EQ(filesInFolder(), 0u);
}

TEST_F(AtomicFile, WriterSeesATemporaryInTheSameFolderWithTheSameExtension) {
    writeFileAtomically(target, [&](const fs::path& file) {
        EXPECT_NE(file, target);
        EXPECT_EQ(file.parent_path(), folder);
        EXPECT_EQ(file.extension(), ".exr");
        std::ofstream(file) << "x";
        EXPECT_FALSE(fs::exists(target));
    });
    EXPECT_TRUE(fs::exists(target));
}

TEST_F(AtomicFile, WriterThatWritesNothingIsAnErrorNamingTheFile) {
    writeBytesAtomically(target, "old");
    try {
        writeFileAtomically(target, [](const fs::path&) {});
        FAIL() << "expected an error";
    } catch (const Error& error) {
        EXPECT_NE(std::string(error.what()).find("result.exr"), std::string::npos) << error.what();
    }
    EXPECT_EQ(readBytes(target), "old");
}

TEST_F(AtomicFile, TargetThatCannotBeReplacedIsAnErrorAndLeavesNoTemporary) {
    fs::create_directories(target / "occupied");
    EXPECT_THROW(writeBytesAtomically(target, "new"), Error);
    EXPECT_TRUE(fs::is_directory(target));
    EXPECT_EQ(filesInFolder(), 1u);
}

TEST_F(AtomicFile, FolderThatDoesNotExistIsAnErrorNamingTheFile) {
    const fs::path missing = folder / "missing" / "result.json";
    try {
        writeBytesAtomically(missing, "x");
        FAIL() << "expected an error";
    } catch (const Error& error) {
        EXPECT_NE(std::string(error.what()).find(missing.string()), std::string::npos) << error.what();
    }
}

TEST_F(AtomicFile, ReadingWhatIsMissingOrTooLargeIsAnErrorNamingTheFile) {
    EXPECT_THROW(readBytes(target), Error);
    EXPECT_THROW(readBytes(folder), Error);
    writeBytesAtomically(target, "12345");
    EXPECT_EQ(readBytes(target, 5), "12345");
    try {
        readBytes(target, 4);
        FAIL() << "expected an error";
    } catch (const Error& error) {
        EXPECT_NE(std::string(error.what()).find("result.exr"), std::string::npos) << error.what();
    }
}

}  // namespace
}  // namespace relamp
