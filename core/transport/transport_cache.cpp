#include "transport/transport_cache.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>

#include "base/log.h"

namespace relamp {
namespace {

constexpr char magic[8] = {'R', 'L', 'T', 'R', 'A', 'N', 'S', '1'};
constexpr uint32_t version = 1, chunkMark = 0x4b4e4843;

// Both are written as they lie in memory, little-endian; their sums tell a machine that reads them otherwise.
struct FileHead {
    char word[8];
    uint32_t version, side;
    uint64_t key, blocks;
    uint32_t maskBytes, blocksPerChunk;
    uint64_t sum;
};
struct ChunkHead {
    uint32_t mark, chunk;
    uint64_t bytes, payloadSum, sum;
};
static_assert(sizeof(FileHead) == 48 && sizeof(ChunkHead) == 32);

template <class Head>
uint64_t sumOf(const Head& head) {
    ByteSum sum;
    sum.add(&head, sizeof head - sizeof head.sum);
    return sum.value();
}

bool readAt(int file, void* to, size_t count, uint64_t at) {
    char* next = static_cast<char*>(to);
    while (count) {
        const ssize_t got = ::pread(file, next, count, off_t(at));
        if (got < 0 && errno == EINTR) continue;
        if (got <= 0) return false;
        next += got;
        at += uint64_t(got);
        count -= size_t(got);
    }
    return true;
}

bool writeAt(int file, const void* from, size_t count, uint64_t at) {
    const char* next = static_cast<const char*>(from);
    while (count) {
        const ssize_t put = ::pwrite(file, next, count, off_t(at));
        if (put < 0 && errno == EINTR) continue;
        if (put <= 0) return false;
        next += put;
        at += uint64_t(put);
        count -= size_t(put);
    }
    return true;
}

template <class T>
void append(std::vector<uint8_t>& out, const T* values, size_t count) {
    const uint8_t* bytes = reinterpret_cast<const uint8_t*>(values);
    out.insert(out.end(), bytes, bytes + count * sizeof(T));
}

/// Takes values off the front of a span; false when it is too short.
template <class T>
bool take(std::span<const uint8_t>& from, T* to, size_t count) {
    if (from.size() < count * sizeof(T)) return false;
    std::memcpy(to, from.data(), count * sizeof(T));
    from = from.subspan(count * sizeof(T));
    return true;
}

/// Removes the bakes that were used longest ago until the rest fits.
void prune(const std::filesystem::path& folder, const std::filesystem::path& keep, uint64_t mostBytes) {
    struct Old {
        std::filesystem::file_time_type used;
        std::filesystem::path path;
        uint64_t bytes;
    };
    std::vector<Old> all;
    uint64_t sum = 0;
    std::error_code failed;
    for (std::filesystem::directory_iterator at(folder, failed), end; !failed && at != end; at.increment(failed)) {
        const std::filesystem::directory_entry& entry = *at;
        std::error_code ec;
        if (entry.path().extension() != ".transport" || entry.path() == keep || !entry.is_regular_file(ec)) continue;
        const uint64_t bytes = entry.file_size(ec);
        if (ec) continue;
        sum += bytes;
        all.push_back({entry.last_write_time(ec), entry.path(), bytes});
    }
    std::sort(all.begin(), all.end(),
              [](const Old& a, const Old& b) { return a.used != b.used ? a.used < b.used : a.path < b.path; });
    for (const Old& old : all) {
        if (sum <= mostBytes) break;
        std::error_code ec;
        if (std::filesystem::remove(old.path, ec)) sum -= old.bytes;
    }
}

}  // namespace

void ByteSum::add(const void* bytes, size_t count) {
    const uint8_t* next = static_cast<const uint8_t*>(bytes);
    uint64_t sum = sum_ + count;
    const auto mix = [&](uint64_t word) {
        sum = (sum ^ word) * 0x9fb21c651e98df25u;
        sum ^= sum >> 29;
    };
    count_ += count;
    for (; count >= 8; count -= 8, next += 8) {
        uint64_t word;
        std::memcpy(&word, next, 8);
        mix(word);
    }
    uint64_t rest = 0;
    if (count) std::memcpy(&rest, next, count);
    mix(rest);
    sum_ = sum;
}

uint64_t ByteSum::value() const {
    uint64_t x = sum_ ^ count_;
    x = (x ^ x >> 32) * 0xd6e8feb86659fd93u;
    return x ^ x >> 32;
}

size_t TransportCache::mostBytesOf(size_t chunk) const {
    const size_t terms = size_t(layout_.side) * layout_.side,
                 block = sizeof(uint32_t) + terms * (sizeof(uint16_t) + transportLanes * sizeof(int16_t)) +
                         transportLanes * sizeof(float);
    return layout_.blocksOf(chunk) * (layout_.maskBytes + block);
}

TransportCache::TransportCache(const std::filesystem::path& folder, const Layout& layout, uint64_t mostBytes)
    : layout_(layout) {
    if (folder.empty() || layout.blocks == 0) return;
    std::error_code ec;
    std::filesystem::create_directories(folder, ec);
    path_ = folder / fmt::format("{:016x}.transport", layout.key);
    file_ = ::open(path_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0644);
    if (file_ < 0) {
        logWarning("transport cache {}: {}; nothing is kept", path_.string(), std::strerror(errno));
        return;
    }
    if (::flock(file_, LOCK_EX | LOCK_NB) != 0) {
        logInfo("transport cache {}: another process is writing it; nothing is kept", path_.string());
        close();
        return;
    }
    record_.resize(layout.chunks());
    const off_t bytes = ::lseek(file_, 0, SEEK_END);
    FileHead wanted{};
    std::memcpy(wanted.word, magic, sizeof magic);
    wanted.version = version;
    wanted.side = layout.side;
    wanted.key = layout.key;
    wanted.blocks = layout.blocks;
    wanted.maskBytes = layout.maskBytes;
    wanted.blocksPerChunk = uint32_t(blocksPerChunk);
    wanted.sum = sumOf(wanted);
    FileHead found{};
    if (bytes >= off_t(sizeof found) && readAt(file_, &found, sizeof found, 0) &&
        !std::memcmp(&found, &wanted, sizeof found)) {
        scan(uint64_t(bytes));
    } else {
        if (bytes > 0) logWarning("transport cache {}: not a bake of this scene; it is baked anew", path_.string());
        end_ = sizeof wanted;
        if (::ftruncate(file_, 0) != 0 || !writeAt(file_, &wanted, sizeof wanted, 0)) {
            logWarning("transport cache {}: {}; nothing is kept", path_.string(), std::strerror(errno));
            close();
            return;
        }
    }
    std::filesystem::last_write_time(path_, std::filesystem::file_time_type::clock::now(), ec);
    prune(folder, path_, mostBytes);
}

TransportCache::~TransportCache() { close(); }

void TransportCache::close() {
    if (file_ >= 0) ::close(file_);
    file_ = -1;
}

void TransportCache::scan(uint64_t fileBytes) {
    uint64_t at = sizeof(FileHead);
    ChunkHead head;
    while (at + sizeof head <= fileBytes && readAt(file_, &head, sizeof head, at)) {
        if (head.mark != chunkMark || head.sum != sumOf(head) || head.chunk >= record_.size() ||
            head.bytes > mostBytesOf(head.chunk) || head.bytes > fileBytes - at - sizeof head)
            break;
        record_[head.chunk] = {at + sizeof head, head.bytes, head.payloadSum};
        at += sizeof head + head.bytes;
    }
    if (at != fileBytes) {
        logWarning("transport cache {}: {} bytes at its end were left half written or are damaged; they are dropped",
                   path_.string(), fileBytes - at);
        if (::ftruncate(file_, off_t(at)) != 0) {
            record_.assign(record_.size(), {});
            close();
        }
    }
    end_ = at;
}

bool TransportCache::load(size_t chunk, std::span<uint8_t> masks, std::span<TransportBlock> blocks) const {
    if (!open() || !record_[chunk].at) return false;
    const Record& r = record_[chunk];
    const auto damaged = [&] {
        logWarning("transport cache {}: chunk {} is damaged; it is baked anew", path_.string(), chunk);
        return false;
    };
    std::vector<uint8_t> payload(r.bytes);
    if (!readAt(file_, payload.data(), payload.size(), r.at)) return damaged();
    ByteSum sum;
    sum.add(payload.data(), payload.size());
    if (sum.value() != r.sum) return damaged();
    std::span<const uint8_t> left(payload);
    if (masks.size() != blocks.size() * layout_.maskBytes || !take(left, masks.data(), masks.size())) return damaged();
    const uint32_t cells = layout_.side * layout_.side;
    for (TransportBlock& b : blocks) {
        uint32_t terms = 0;
        if (!take(left, &terms, 1) || terms > cells) return damaged();
        b.index.resize(terms);
        b.value.resize(size_t(terms) * transportLanes);
        if (!take(left, b.scale.data(), b.scale.size()) || !take(left, b.index.data(), b.index.size()) ||
            !take(left, b.value.data(), b.value.size()))
            return damaged();
        for (size_t t = 0; t < terms; ++t)
            if (b.index[t] >= cells || (t && b.index[t] <= b.index[t - 1])) return damaged();
        for (const float s : b.scale)
            if (!std::isfinite(s)) return damaged();
    }
    return left.empty() || damaged();
}

void TransportCache::store(size_t chunk, std::span<const uint8_t> masks, std::span<const TransportBlock> blocks) {
    if (!open() || full_) return;
    std::vector<uint8_t> bytes(sizeof(ChunkHead));
    append(bytes, masks.data(), masks.size());
    for (const TransportBlock& b : blocks) {
        const uint32_t terms = uint32_t(b.index.size());
        append(bytes, &terms, 1);
        append(bytes, b.scale.data(), b.scale.size());
        append(bytes, b.index.data(), b.index.size());
        append(bytes, b.value.data(), b.value.size());
    }
    ByteSum sum;
    sum.add(bytes.data() + sizeof(ChunkHead), bytes.size() - sizeof(ChunkHead));
    ChunkHead head{chunkMark, uint32_t(chunk), bytes.size() - sizeof(ChunkHead), sum.value(), 0};
    head.sum = sumOf(head);
    std::memcpy(bytes.data(), &head, sizeof head);
    const std::lock_guard lock(mutex_);
    if (full_) return;
    if (!writeAt(file_, bytes.data(), bytes.size(), end_)) {
        logWarning("transport cache {}: {}; the rest of this bake is not kept", path_.string(), std::strerror(errno));
        full_ = true;  // the next scan drops the half-written end
        return;
    }
    record_[chunk] = {end_ + sizeof head, head.bytes, head.payloadSum};
    end_ += bytes.size();
}

}  // namespace relamp
