#include "transport/transport_cache.h"

#include <gtest/gtest.h>

#include <fstream>
#include <limits>

#include "base/log.h"
#include "base/random.h"
#include "support/temporary_folder.h"

namespace relamp {
namespace {

constexpr uint32_t cachedSide = 16, maskBytes = 24;

TransportBlock blockOf(uint64_t seed) {
    TransportBlock b;
    for (uint32_t i = 0; i < cachedSide * cachedSide; ++i)
        if (i == 0 || mixBits(seed ^ i) % 5 == 0) {
            b.index.push_back(uint16_t(i));
            for (size_t lane = 0; lane < transportLanes; ++lane)
                b.value.push_back(int16_t(mixBits(seed + 7 * i + lane)));
        }
    for (size_t lane = 0; lane < transportLanes; ++lane) b.scale[lane] = 1e-4f * float(lane + seed);
    return b;
}

struct Chunk {
    std::vector<uint8_t> masks;
    std::vector<TransportBlock> blocks;
};
Chunk chunkOf(size_t chunk, size_t count) {
    Chunk c;
    for (size_t i = 0; i < count; ++i) {
        c.blocks.push_back(blockOf(100 * chunk + i));
        for (uint32_t k = 0; k < maskBytes; ++k) c.masks.push_back(uint8_t(mixBits(chunk + 31 * i + k)));
    }
    return c;
}

const TransportCache::Layout layout{0x1234, cachedSide, 40, maskBytes};  // 3 chunks, the last one half full

void write(const TransportCache::Layout& l, const std::filesystem::path& folder, const std::vector<size_t>& chunks) {
    TransportCache cache(folder, l);
    for (const size_t c : chunks) {
        const Chunk chunk = chunkOf(c, l.blocksOf(c));
        cache.store(c, chunk.masks, chunk.blocks);
    }
}

bool matches(const TransportCache& cache, size_t c, const TransportCache::Layout& l = layout) {
    const Chunk expected = chunkOf(c, l.blocksOf(c));
    Chunk found{std::vector<uint8_t>(expected.masks.size()), std::vector<TransportBlock>(expected.blocks.size())};
    if (!cache.load(c, found.masks, found.blocks)) return false;
    EXPECT_EQ(found.masks, expected.masks);
    for (size_t b = 0; b < expected.blocks.size(); ++b) {
        EXPECT_EQ(found.blocks[b].index, expected.blocks[b].index);
        EXPECT_EQ(found.blocks[b].value, expected.blocks[b].value);
        EXPECT_EQ(found.blocks[b].scale, expected.blocks[b].scale);
    }
    return true;
}

std::string contents(const std::filesystem::path& path) {
    std::ifstream in(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}
void put(const std::filesystem::path& path, const std::string& bytes) {
    std::ofstream(path, std::ios::binary) << bytes;
}

/// Log lines while it lives.
struct Listening {
    std::vector<std::string> lines;
    Listening() {
        setLogSink([this](LogLevel, const std::string& line) { lines.push_back(line); });
    }
    ~Listening() { setLogSink({}); }
};

TEST(TransportCache, GivesBackWhatItWasGivenAfterItIsOpenedAgain) {
    const test::TemporaryFolder folder;
    write(layout, folder.path(), {2, 0});
    const TransportCache cache(folder.path(), layout);
    EXPECT_TRUE(matches(cache, 0));
    EXPECT_FALSE(matches(cache, 1));
    EXPECT_TRUE(matches(cache, 2));
}

TEST(TransportCache, AFileCutAnywhereLosesOnlyWhatWasCutAndGoesOn) {
    const test::TemporaryFolder folder;
    write(layout, folder.path(), {0, 1, 2});
    const std::filesystem::path path = TransportCache(folder.path(), layout).path();
    const std::string whole = contents(path);
    Listening listening;
    for (size_t length = 0; length < whole.size(); length += 1 + whole.size() / 37) {
        put(path, whole.substr(0, length));
        {
            TransportCache cache(folder.path(), layout);
            ASSERT_TRUE(cache.open());
            bool before = true;
            for (size_t c = 0; c < 3; ++c) {
                const bool there = matches(cache, c);
                EXPECT_TRUE(before || !there);
                before = there;
            }
            EXPECT_FALSE(before);
            const Chunk last = chunkOf(2, layout.blocksOf(2));
            cache.store(2, last.masks, last.blocks);
        }
        EXPECT_TRUE(matches(TransportCache(folder.path(), layout), 2)) << length;
    }
    EXPECT_FALSE(listening.lines.empty());
}

TEST(TransportCache, AnyDamagedByteIsNoticed) {
    const test::TemporaryFolder folder;
    write(layout, folder.path(), {0, 1, 2});
    const std::filesystem::path path = TransportCache(folder.path(), layout).path();
    const std::string whole = contents(path);
    Listening listening;
    for (size_t at = 0; at < whole.size(); at += at < 200 ? 1 : 1 + whole.size() / 101) {
        std::string broken = whole;
        broken[at] = char(broken[at] ^ 0x40);
        put(path, broken);
        const TransportCache cache(folder.path(), layout);
        int there = 0;
        for (size_t c = 0; c < 3; ++c) there += matches(cache, c);
        EXPECT_LT(there, 3) << at;
    }
    EXPECT_FALSE(listening.lines.empty());
}

TEST(TransportCache, ForeignFilesAreBakedAnewAndTakeNoMemory) {
    const test::TemporaryFolder folder;
    write(layout, folder.path(), {0});
    const std::filesystem::path path = TransportCache(folder.path(), layout).path();
    Listening listening;
    put(path, std::string(100000, 'x'));
    EXPECT_FALSE(matches(TransportCache(folder.path(), layout), 0));
    // A file of another layout under the same key.
    TransportCache::Layout other = layout;
    other.blocks = 48;
    write(layout, folder.path(), {0});
    EXPECT_FALSE(matches(TransportCache(folder.path(), other), 0, other));
    // Far longer than it says, full of holes.
    write(layout, folder.path(), {0});
    std::filesystem::resize_file(path, uint64_t(1) << 36);
    {
        const TransportCache cache(folder.path(), layout);
        EXPECT_TRUE(matches(cache, 0));
        EXPECT_FALSE(matches(cache, 1));
    }
    EXPECT_LT(std::filesystem::file_size(path), 1000000u);
    // A record that is whole by its sums but says nonsense.
    std::filesystem::remove(path);
    Chunk c = chunkOf(0, layout.blocksOf(0));
    c.blocks[3].index[2] = 9999;
    { TransportCache(folder.path(), layout).store(0, c.masks, c.blocks); }
    EXPECT_FALSE(matches(TransportCache(folder.path(), layout), 0));
    c = chunkOf(0, layout.blocksOf(0));
    c.blocks[3].scale[1] = std::numeric_limits<float>::quiet_NaN();
    { TransportCache(folder.path(), layout).store(0, c.masks, c.blocks); }
    EXPECT_FALSE(matches(TransportCache(folder.path(), layout), 0));
    EXPECT_FALSE(listening.lines.empty());
}

TEST(TransportCache, KeepsNothingWithoutAFolderOrInOneThatCannotBeOrWhileAnotherWrites) {
    EXPECT_FALSE(TransportCache({}, layout).open());
    const test::TemporaryFolder folder;
    Listening listening;
    put(folder.path() / "file", "x");
    TransportCache cache(folder.path() / "file" / "below", layout);
    EXPECT_FALSE(cache.open());
    EXPECT_FALSE(listening.lines.empty());
    const Chunk c = chunkOf(0, layout.blocksOf(0));
    cache.store(0, c.masks, c.blocks);
    EXPECT_FALSE(matches(cache, 0));
    const TransportCache first(folder.path(), layout), second(folder.path(), layout);
    EXPECT_TRUE(first.open());
    EXPECT_FALSE(second.open());
}

TEST(TransportCache, OldBakesGoWhenTheFolderIsFull) {
    const test::TemporaryFolder folder;
    std::vector<std::filesystem::path> paths;
    for (uint64_t key = 1; key <= 3; ++key) {
        TransportCache::Layout l = layout;
        l.key = key;
        write(l, folder.path(), {0, 1, 2});
        paths.push_back(TransportCache(folder.path(), l).path());
        std::filesystem::last_write_time(
            paths.back(), std::filesystem::file_time_type::clock::now() - std::chrono::hours(10 - int(key)));
    }
    TransportCache::Layout l = layout;
    l.key = 4;
    const TransportCache cache(folder.path(), l, std::filesystem::file_size(paths[0]) * 3 / 2);
    EXPECT_FALSE(std::filesystem::exists(paths[0]));
    EXPECT_FALSE(std::filesystem::exists(paths[1]));
    EXPECT_TRUE(std::filesystem::exists(paths[2]));
}

TEST(TransportCache, SumsDifferWhereBytesDo) {
    const auto sumOf = [](const std::string& s) {
        ByteSum sum;
        sum.add(s.data(), s.size());
        return sum.value();
    };
    EXPECT_NE(sumOf(""), sumOf(std::string(1, '\0')));
    EXPECT_NE(sumOf("abcdefgh"), sumOf("abcdefgi"));
    EXPECT_NE(sumOf(std::string(8, '\0')), sumOf(std::string(16, '\0')));
    EXPECT_EQ(sumOf("0123456789"), sumOf("0123456789"));
}

}  // namespace
}  // namespace relamp
