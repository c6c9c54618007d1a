#include "image/exr_header.h"

#include <cstdint>
#include <fstream>
#include <string>

#include "base/error.h"

namespace relamp {
namespace {

class Reader {
public:
    explicit Reader(const std::filesystem::path& file) : in_(file, std::ios::binary) {
        in_.seekg(0, std::ios::end);
        size_ = in_ ? int64_t(in_.tellg()) : 0;
        in_.seekg(0);
    }
    /// Little-endian; 0 behind the end.
    uint32_t number() {
        unsigned char b[4] = {};
        in_.read(reinterpret_cast<char*>(b), 4);
        return uint32_t(b[0]) | uint32_t(b[1]) << 8 | uint32_t(b[2]) << 16 | uint32_t(b[3]) << 24;
    }
    /// Up to its zero; false when there is none within 256 bytes.
    bool word(std::string& text) {
        text.clear();
        for (int c = in_.get(); c != 0; c = in_.get()) {
            if (c < 0 || text.size() > 255) return false;
            text += char(c);
        }
        return true;
    }
    int64_t left() { return in_ ? size_ - int64_t(in_.tellg()) : 0; }
    void skip(int64_t count) { in_.seekg(count, std::ios::cur); }

private:
    std::ifstream in_;
    int64_t size_ = 0;
};

}  // namespace

void checkExrHeader(const std::filesystem::path& file) {
    Reader in(file);
    if (in.number() != 20000630) return;
    const bool severalParts = in.number() & 0x1000;
    std::string name, type;
    do {
        size_t attributes = 0;
        for (;; ++attributes) {
            if (!in.word(name)) throw Error("{}: the header breaks off", file.string());
            if (name.empty()) break;
            if (!in.word(type)) throw Error("{}: the header breaks off at {}", file.string(), name);
            const auto size = int64_t(int32_t(in.number()));
            if (size < 0 || size > in.left()) throw Error("{}: the header's {} says it is {} bytes large, {} are left", file.string(), name, size, in.left());
            in.skip(size);
        }
        if (attributes == 0) return;  // the empty header that ends the list of parts
    } while (severalParts);
}

}  // namespace relamp
