#include "image/jpeg_end.h"

#include <fstream>
#include <vector>

#include "base/error.h"

namespace relamp {
namespace {

constexpr int endOfFile = -1;

/// Bytes of a file, a large block at a time.
class Bytes {
public:
    explicit Bytes(const std::filesystem::path& file) : in_(file, std::ios::binary), block_(1 << 18) {}
    int next() {
        if (at_ == end_) {
            in_.read(block_.data(), std::streamsize(block_.size()));
            end_ = size_t(in_.gcount());
            at_ = 0;
            if (end_ == 0) return endOfFile;
        }
        ++count_;
        return static_cast<unsigned char>(block_[at_++]);
    }
    void skip(int count) {
        while (count-- > 0 && next() != endOfFile) continue;
    }
    uint64_t count() const { return count_; }

private:
    std::ifstream in_;
    std::vector<char> block_;
    size_t at_ = 0, end_ = 0;
    uint64_t count_ = 0;
};

/// The next marker, whether coded data or fill bytes stand before it.
int nextMarker(Bytes& bytes) {
    for (int c = bytes.next(); c != endOfFile; c = bytes.next()) {
        if (c != 0xff) continue;
        do c = bytes.next();
        while (c == 0xff);
        if (c == endOfFile) return c;
        const bool inData = c == 0 || (c >= 0xd0 && c <= 0xd7);  // a stuffed byte, a restart
        if (!inData) return c;
    }
    return endOfFile;
}

}  // namespace

void checkJpegEnd(const std::filesystem::path& file) {
    constexpr int start = 0xd8, end = 0xd9, temporary = 0x01;
    Bytes bytes(file);
    if (bytes.next() != 0xff || bytes.next() != start) return;
    for (int marker = nextMarker(bytes); marker != end; marker = nextMarker(bytes)) {
        if (marker == endOfFile)
            throw Error("{}: breaks off after {} bytes, its end is missing; was it copied whole?", file.string(),
                        bytes.count());
        if (marker == start || marker == temporary) continue;
        const int high = bytes.next(), low = bytes.next();
        if (high == endOfFile || low == endOfFile) continue;
        bytes.skip((high << 8 | low) - 2);
    }
}

}  // namespace relamp
