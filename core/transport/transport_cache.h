// Baked transport on disk: written while it is baked, so that a killed bake goes on where it stood, and found again by
// a hash of everything it depends on. What cannot be trusted is baked anew: a file is never believed further than its
// sums.
#pragma once
#include <atomic>
#include <cstring>
#include <filesystem>
#include <mutex>

#include "transport/transport_store.h"

namespace relamp {

/// A 64-bit sum of bytes, for keys and against damage, not against malice.
class ByteSum {
public:
    void add(const void* bytes, size_t count);
    template <class T>
    void add(const T& value) {
        static_assert(std::has_unique_object_representations_v<T> || std::is_floating_point_v<T>);
        add(&value, sizeof value);
    }
    template <class T>
    void addAll(const std::vector<T>& values) {
        add(values.size());
        add(values.data(), values.size() * sizeof(T));
    }
    uint64_t value() const;

private:
    uint64_t sum_ = 0x9e3779b97f4a7c15u, count_ = 0;
};

/// One bake: blocks in chunks, each with bytes of its own beside the terms (the masks of its vertices).
class TransportCache {
public:
    static constexpr size_t blocksPerChunk = 16;
    struct Layout {
        uint64_t key = 0;    ///< hash of all inputs
        uint32_t side = 32;  ///< of the direction square: indices lie below side^2
        uint64_t blocks = 0;
        uint32_t maskBytes = 0;  ///< a block
        size_t chunks() const { return (blocks + blocksPerChunk - 1) / blocksPerChunk; }
        size_t blocksOf(size_t chunk) const {
            return std::min<size_t>(blocksPerChunk, blocks - chunk * blocksPerChunk);
        }
    };
    /// Opens the bake's file in the folder or starts it; drops what was left half written. An empty folder, one that
    /// cannot be written and a bake that another process is writing give a cache that keeps nothing (with a line in the
    /// log). Older bakes go when the folder holds more than `mostBytes`.
    TransportCache(const std::filesystem::path& folder, const Layout& layout, uint64_t mostBytes = uint64_t(8) << 30);
    ~TransportCache();
    TransportCache(const TransportCache&) = delete;
    TransportCache& operator=(const TransportCache&) = delete;

    bool open() const { return file_ >= 0; }
    const std::filesystem::path& path() const { return path_; }
    /// Reads a chunk: `masks` (blocksOf x maskBytes) and blocks. False when it is not there or damaged; memory stays
    /// within one chunk's largest size.
    bool load(size_t chunk, std::span<uint8_t> masks, std::span<TransportBlock> blocks) const;
    /// Appends a chunk. Thread-safe. When the disk is full nothing more is kept, with a line in the log, and the bake
    /// goes on.
    void store(size_t chunk, std::span<const uint8_t> masks, std::span<const TransportBlock> blocks);

private:
    struct Record {
        uint64_t at = 0, bytes = 0, sum = 0;  // at 0: none
    };
    Layout layout_;
    std::filesystem::path path_;
    int file_ = -1;
    uint64_t end_ = 0;
    std::atomic<bool> full_ = false;  // a write failed: what is there can still be read
    std::vector<Record> record_;
    std::mutex mutex_;
    size_t mostBytesOf(size_t chunk) const;
    void scan(uint64_t fileBytes);
    void close();
};

}  // namespace relamp
